"""Drives with backlash under torque: the teeth are found from afar, and found again where they have parted."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from mpi4py import MPI

from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.analysis.drive_model import build_drive_model
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.design.design_file import load_design
from swgpar.design.load_states import Stage, load_sequence
from swgpar.meshing import load_recipe


@lru_cache
def loaded(*overrides: str) -> tuple[LoadStepper, dict[str, float], int]:
    """The small drive after step 3, its row, and how often increments were cut."""
    design = load_design(DESIGN, overrides)
    runner = LoadStepper(build_drive_model(design, load_recipe(RECIPE), comm=MPI.COMM_WORLD))
    solves = 0
    solve = runner.solver.solve

    def counted(*arguments, **words):
        nonlocal solves
        solves += 1
        return solve(*arguments, **words)

    runner.solver.solve = counted
    items = [item for item in load_sequence(design) if item.stage <= Stage.LOAD]
    for item in items:
        runner.advance(item)
    return runner, runner.row(), solves - len(items)


def backlash(c_p: float, *more: str) -> tuple[LoadStepper, dict[str, float], int]:
    return loaded(*more, f"ring_gear.c_P={c_p}")


@pytest.mark.parametrize(
    ("more", "c_p"),
    [
        ((), 0.8),
        (PLANE, 0.8),
        (PLANE, 0.9),
        ((*PLANE, "flexible_spline.c_P=0.7"), 0.9),
        ((*PLANE, "drive.layout=spline_fixed"), 0.8),
    ],
)
@pytest.mark.parallel([1, 2])
def test_large_backlash_closes_in_one_solve(more: tuple[str, ...], c_p: float) -> None:
    runner, row, cuts = backlash(c_p, *more)
    print(f"{c_p}: {row['newton_iterations']} iterations, output at {row['output_angle_deg']:.4f} degrees")
    assert cuts == 0 and row["newton_iterations"] <= 10
    assert row["pairs_in_contact"] > 0
    torque = 1000.0 * runner.design.load.torque
    # of the teeth on the spline: with the ring gear fixed the wave generator's torque comes on top
    assert -row["tooth_torque_Nmm"] > 0.99 * torque
    assert row["torque_balance_Nmm"] < 1e-6 * torque


@pytest.mark.parallel([1, 2])
def test_the_output_turns_through_the_backlash() -> None:
    """Against the output's motion, by eq. 6.4; what the teeth and the bent spline give is common to both drives."""
    (a, near, _), (b, far, _) = backlash(0.9, *PLANE), backlash(0.8, *PLANE)
    turned = far["output_angle_deg"] - near["output_angle_deg"]
    # contact moves along the flanks, which are not radial: a per cent
    assert turned == pytest.approx(np.degrees(b.design.backlash_angle - a.design.backlash_angle), rel=0.01)
    assert near["output_angle_deg"] > 0.0


@pytest.mark.parallel([1, 2])
def test_a_drive_that_has_parted_is_loaded_again() -> None:
    """From the middle of its backlash, where nothing holds the output, the torque brings it back to the same state."""
    design = load_design(DESIGN, [*PLANE, "ring_gear.c_P=0.8"])
    runner = LoadStepper(build_drive_model(design, load_recipe(RECIPE), comm=MPI.COMM_WORLD))
    items = [item for item in load_sequence(design) if item.stage <= Stage.LOAD]
    for item in items:
        runner.advance(item)
    before = runner.row()
    middle = replace(items[-1], control="rotation", output_rotation=0.0, torque=0.0)
    runner.advance(middle)
    assert runner.row()["pairs_in_contact"] == 0
    runner.iterations = 0
    runner.advance(items[-1])
    after = runner.row()
    assert after["newton_iterations"] <= 25
    for name in ("output_angle_deg", "wg_torque_Nmm", "tooth_torque_Nmm", "pairs_in_contact"):
        assert after[name] == pytest.approx(before[name], rel=1e-7), name
