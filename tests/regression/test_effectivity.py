"""Estimated over true error of the tension at the teeth, on drives that the estimate was not made
with.

`scripts/bench/effectivity` has more drives and all quantities. Here are a few small plane drives,
in the loaded state.
"""

from __future__ import annotations

from statistics import median

import pytest

import swgpar
from support.sensible_drives import MESHES, SensibleDrive, sensible_drives
from swgpar.largest_stress import root_stress
from swgpar.meshing.recipe_counts import refined

SEED, MOST_TEETH, DRIVES = 7, 80, 3


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


def test_errors_cover_the_truth(monkeypatch: pytest.MonkeyPatch) -> None:
    """Against a mesh two levels finer with a further window: never below half of the true error,
    and above it for most."""
    ratios = []
    for drive in small_drives():
        design = swgpar.load_design(drive.table).with_values({"steps.rotation": 0.0})
        usual = swgpar.run(design, progress=False).summary["root.s1"]
        finer = refined(refined(swgpar.load_mesh(MESHES["plane"])))
        with monkeypatch.context() as patch:
            patch.setitem(root_stress.LEVELS, "plane", root_stress.LEVELS["plane"] + 1)
            true = swgpar.run(design, finer, progress=False).summary["root.s1"].value
        ratios.append(usual.error / abs(usual.value - true))
        print(
            f"{drive.name} ({drive.kind}): {usual.value:.2f} ± {usual.error:.2f} for {true:.2f} MPa"
        )
    assert min(ratios) >= 0.5
    assert median(ratios) >= 1.0
