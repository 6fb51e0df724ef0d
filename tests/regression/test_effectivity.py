"""Estimated over true errors, on drives that the estimates were not made with.

`scripts/bench/effectivity` has more drives and all quantities. Here are a few small plane drives,
in the loaded state and in a stiffness loop.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from statistics import median

import pytest

import swgpar
from support.bearing import BEARING
from support.sensible_drives import MESHES, SensibleDrive, sensible_drives
from support.stepping import small
from swgpar.answers.answer import NO_ESTIMATE, Answer
from swgpar.largest_stress import root_stress
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe_counts import refined

SEED, MOST_TEETH, DRIVES = 7, 80, 3


@cache
def small_drives() -> list[SensibleDrive]:
    """The first drives of few teeth, of which a part is modelled by symmetry."""
    found: list[SensibleDrive] = []
    count = 0
    while len(found) < DRIVES:
        count += 10
        found = [
            drive
            for drive in sensible_drives(count, SEED)
            for teeth in [drive.table["drive"]["teeth_fs"]]
            if teeth <= MOST_TEETH and teeth % 2 == 0
        ]
    return found[:DRIVES]


def ratio(usual: Answer, true: Answer, drive: SensibleDrive) -> float:
    """Estimated over true error."""
    print(
        f"{drive.name} ({drive.kind}): {usual.name} {usual.value:.5g} ± {usual.error:.2g} for "
        f"{true.value:.5g} {usual.unit}"
    )
    return usual.error / abs(usual.value - true.value)


def finer() -> MeshRecipe:
    """Two levels finer than the usual mesh."""
    return refined(refined(swgpar.load_mesh(MESHES["plane"])))


def judge(ratios: Mapping[str, list[float]]) -> None:
    """Never below half of the true error, and above it for most."""
    for name, values in ratios.items():
        assert min(values) >= 0.5, name
        assert median(values) >= 1.0, name


@pytest.mark.parametrize("which", [slice(1, 2), slice(None)], ids=["one", "all"])
def test_errors_under_load_cover_the_truth(which: slice, monkeypatch: pytest.MonkeyPatch) -> None:
    """The reference has a further window."""
    ratios: dict[str, list[float]] = {"root.s1": [], "contact.pressure_off_edges": []}
    for drive in small_drives()[which]:
        design = swgpar.load_design(drive.table).with_values({"steps.rotation": 0.0})
        usual = swgpar.run(design, progress=False).summary
        with monkeypatch.context() as patch:
            patch.setitem(root_stress.LEVELS, "plane", root_stress.LEVELS["plane"] + 1)
            true = swgpar.run(design, finer(), progress=False).summary
        for name, values in ratios.items():
            values.append(ratio(usual[name], true[name], drive))
    judge(ratios)


def test_a_run_in_steps_states_the_same_errors() -> None:
    """Friction changes the loaded state a little on every mesh, and the errors with it."""
    names = "root.s1", "largest.fs_vm_apart", "sharing.largest_force_share"
    drive = small_drives()[1]
    design = swgpar.load_design(drive.table).with_values({"steps.rotation": 0.0})
    at_once = swgpar.run(design, progress=False).summary
    in_steps = swgpar.run(design, plain=True, progress=False).summary
    rough = swgpar.run(design.with_values({"contact.friction": 0.05}), progress=False).summary
    for name in names:
        assert in_steps[name].error == pytest.approx(at_once[name].error, rel=0.01), name
        assert rough[name].error == pytest.approx(at_once[name].error, rel=0.5), name


def test_errors_with_a_bearing_cover_the_truth(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of stresses and of what the bearing gives, on the small drive of the tests."""
    names = (
        "root.s1",
        "largest.fs_vm_apart",
        "bearing.largest_load",
        "bearing.mean_load",
        "bearing.life_turns",
        "bearing.race_s1",
        "bearing.torsional_share",
    )
    design = small("plane", *BEARING, "output.root_stress=true", "steps.rotation=0")
    drive = SensibleDrive("small", "plane", {}, "with a bearing")
    usual = swgpar.run(design, progress=False).summary
    with monkeypatch.context() as patch:
        patch.setitem(root_stress.LEVELS, "plane", root_stress.LEVELS["plane"] + 1)
        true = swgpar.run(design, finer(), progress=False).summary
    judge({name: [ratio(usual[name], true[name], drive)] for name in names[:-1]})
    # the tangent of balls with little load decides: half of the true error
    assert ratio(usual[names[-1]], true[names[-1]], drive) >= 0.5
    assert usual["bearing.race_vm"].no_error == usual["bearing.load_ripple"].no_error == NO_ESTIMATE


def test_errors_of_the_stiffness_cover_the_truth() -> None:
    names = "stiffness.K1", "stiffness.K2", "stiffness.K3", "stiffness.lost_motion"
    ratios: dict[str, list[float]] = {name: [] for name in names}
    for drive in small_drives()[:2]:
        values = {"stiffness.positions": 1, "output.root_stress": False}
        design = swgpar.load_design(drive.table).with_values(values)
        usual = swgpar.run(design, progress=False).summary
        without = design.with_values({"stiffness.mesh_error": False})
        true = swgpar.run(without, finer(), progress=False).summary
        for name in names:
            ratios[name].append(ratio(usual[name], true[name], drive))
    judge(ratios)
