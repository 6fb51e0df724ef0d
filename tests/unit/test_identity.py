"""What a run computes, and in which keys another run differs."""

from __future__ import annotations

from support.paths import DESIGN, RECIPE
from swgpar import load_design, load_mesh
from swgpar.analysis.identity import RunContent, identity


def computed(*overrides: str, accuracy: float | None = None) -> RunContent:
    design = load_design(DESIGN, list(overrides))
    return RunContent.of(design.decisive_keys, load_mesh(RECIPE), accuracy)


def test_the_output_changes_nothing() -> None:
    assert computed("output.fields=true") == computed()
    assert computed().differs_from(computed()) == ""


def test_differences_name_keys_and_values() -> None:
    text = computed("load.torque=3").differs_from(computed("load.torque=1.5"))
    assert text == "load.torque = 3, there 1.5"
    assert computed(accuracy=0.02).differs_from(computed()) == "accuracy = 0.02, there not given"
    many = ("load.torque=3", "material.E=1e5", "flexible_spline.rim=0.5", "ring_gear.rim=2")
    assert computed(*many).differs_from(computed()).endswith("; 1 more")


def test_a_section_that_another_run_lacks() -> None:
    given = computed("fatigue.surface_factor=0.9")
    assert given.differs_from(computed()) == "fatigue = given, there not given"
    other = computed("fatigue.surface_factor=0.8")
    assert given.differs_from(other) == "fatigue.surface_factor = 0.9, there 0.8"


def test_the_identity_is_that_of_the_content() -> None:
    design = load_design(DESIGN)
    assert computed().identity == identity(design.decisive_keys, load_mesh(RECIPE), None)
    assert computed("load.torque=3").identity != computed().identity
