"""What a run leaves out by itself, and what keeps it from doing so."""

from __future__ import annotations

import numpy as np
import pytest

import swgpar
from support.messages import Messages
from support.paths import DESIGN, DRIVERS, RECIPE, REFERENCE
from support.small_drive import NO_SHORTCUTS, PLANE
from swgpar.analysis.shortcuts import RTOL, SAMPLES, with_shortcuts
from swgpar.meshing import load_recipe
from swgpar.meshing.recipe_counts import with_counts

PERIOD = 360.0 / 42.0
"""Of the small drive, degrees."""


def test_a_design_without_the_keys_takes_all() -> None:
    found = with_shortcuts(swgpar.load_design(REFERENCE), load_recipe("full"))
    steps = found.design.steps
    assert (steps.samples, steps.bent_start, steps.start_levels) == (SAMPLES["cup"], True, 2)
    assert (
        steps.rotation == 45.0
        and found.design.solver.rtol == RTOL["cup"]
        and len(found.left_out) == 4
    )
    assert "42.05 of 45 degrees" in found.left_out[0]


@pytest.mark.parametrize(
    ("recipe", "levels"),
    [("coarse", 0), ("forces", 0), ("medium", 0), ("full", 2), ("plane_coarse", 0), ("plane", 2)],
)
def test_a_start_uses_meshes_that_find_the_contacts(recipe: str, levels: int) -> None:
    name = "plane_half_turn.toml" if recipe.startswith("plane") else "cup_45deg.toml"
    found = with_shortcuts(swgpar.load_design(DRIVERS / name), load_recipe(recipe))
    assert found.design.steps.start_levels == levels


def test_a_pancake_starts_on_a_coarser_mesh() -> None:
    found = with_shortcuts(swgpar.load_design(DRIVERS / "pancake.toml"), load_recipe("forces"))
    assert found.design.steps.start_levels == 1


def test_very_fine_recipes_start_on_four_meshes_at_most() -> None:
    fine = with_counts(
        load_recipe("plane"), lambda section, name, value: 200 if name == "flank" else value
    )
    assert (
        with_shortcuts(
            swgpar.load_design(DRIVERS / "plane_half_turn.toml"), fine
        ).design.steps.start_levels
        == 4
    )
    without = with_shortcuts(
        swgpar.load_design(DRIVERS / "plane_half_turn.toml"), fine, levels=False
    )
    assert without.design.steps.start_levels == 0


def test_few_increments_are_computed_as_they_are() -> None:
    few = with_shortcuts(
        swgpar.load_design(REFERENCE, ["steps.rotation=10"]), load_recipe("coarse")
    )
    assert few.design.steps.samples == 0
    partial = with_shortcuts(
        swgpar.load_design(REFERENCE, ["steps.load_increments=5"]), load_recipe("coarse")
    )
    assert not partial.design.steps.bent_start


def test_keys_of_the_design_are_kept() -> None:
    design = swgpar.load_design(REFERENCE, NO_SHORTCUTS)
    found = with_shortcuts(design, load_recipe("full"))
    assert found.design == design and found.left_out == ()
    found = with_shortcuts(swgpar.load_design(REFERENCE, ["steps.samples=3"]), load_recipe("full"))
    assert found.design.steps.samples == 3 and found.design.steps.bent_start


def test_friction_and_short_rotations() -> None:
    assert (
        with_shortcuts(
            swgpar.load_design(REFERENCE, ["contact.friction=0.1"]), load_recipe("full")
        ).left_out
        == ()
    )
    short = with_shortcuts(
        swgpar.load_design(REFERENCE, ["steps.rotation=2.9"]), load_recipe("coarse")
    )
    assert (
        short.design.steps.samples == 0
        and short.left_out[0] == "deflection and engagement step by step"
    )


def test_a_run_with_shortcuts_ends_in_the_same_states() -> None:
    """The angles of one period are among those of the plain run; the line says what is left out."""
    samples = SAMPLES["plane"]
    steps = [
        f"steps.rotation={1.5 * PERIOD}",
        f"steps.increment={PERIOD / samples}",
        "solver.rtol=1e-9",
    ]
    design = swgpar.load_design(DESIGN, [*PLANE, *steps])
    plain = swgpar.run(design, RECIPE, plain=True).history
    with Messages() as messages:
        fast = swgpar.run(design, RECIPE)
    assert any("left out: " in text and "step by step" in text for text in messages.texts)
    assert len(fast.history["step"]) == 1 + 3 * samples // 2 and fast.summary.increments == samples
    for name in ("fs_s1", "wg_torque_Nmm", "output_angle_deg"):
        assert np.allclose(fast.history[name], plain[name][2:], rtol=1e-6)
    curves = fast.curves()
    assert np.allclose(curves.values["fs_s1"], plain["fs_s1"][2 : 2 + samples], rtol=1e-6)
    assert curves.fine["fs_s1"][0] == pytest.approx(curves.fine["fs_s1"][-1])
    # the curve passes through the points
    at_points = np.interp(curves.angle, curves.fine_angle, curves.fine["fs_s1"])
    assert np.allclose(at_points, curves.values["fs_s1"], rtol=2e-3)


@pytest.mark.parametrize("model", [PLANE, ()], ids=["plane", "cup"])
def test_the_tolerance_keeps_the_digits_that_are_printed(model: tuple[str, ...]) -> None:
    steps = [
        *model,
        f"steps.rotation={1.5 * PERIOD}",
        f"steps.increment={PERIOD / SAMPLES['plane']}",
    ]
    tight = swgpar.run(swgpar.load_design(DESIGN, [*steps, "solver.rtol=1e-11"]), RECIPE).history
    fast = swgpar.run(swgpar.load_design(DESIGN, steps), RECIPE).history
    for name in ("fs_s1", "fs_vm", "wg_torque_Nmm"):
        assert np.allclose(fast[name], tight[name], rtol=2e-5)
