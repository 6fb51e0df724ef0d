"""Drives with backlash under torque: the teeth are found from afar, and found again where they have
parted."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from support.paths import DESIGN
from support.small_drive import PLANE
from support.stepping import load_stepper, loaded
from swgpar import load_design
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.load.load_sequence import load_sequence
from swgpar.load.load_states import Stage


@lru_cache
def backlash(c_p: float, *more: str) -> tuple[LoadStepper, dict[str, float]]:
    """The small drive under its torque, every increment in one solve: it may not be cut."""
    return loaded(load_design(DESIGN, [*more, f"ring_gear.c_P={c_p}", "solver.max_cutbacks=0"]))


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
    stepper, row = backlash(c_p, *more)
    print(
        f"{c_p}: {row['newton_iterations']} iterations, output at {row['output_angle_deg']:.4f} "
        f"degrees"
    )
    assert row["newton_iterations"] <= 8  # 5 to 7 are needed
    assert row["pairs_in_contact"] > 0
    torque = 1000.0 * stepper.design.load.torque
    # of the teeth on the spline: with the ring gear fixed the wave generator's torque comes on top
    assert -row["tooth_torque_Nmm"] > 0.99 * torque
    assert row["torque_balance_Nmm"] < 1e-6 * torque


@pytest.mark.parallel([1, 2])
def test_the_output_turns_through_the_backlash() -> None:
    """Against the output's motion, by eq. 6.4; what the teeth and the bent spline give is common to
    both drives."""
    (a, near), (b, far) = backlash(0.9, *PLANE), backlash(0.8, *PLANE)
    turned = far["output_angle_deg"] - near["output_angle_deg"]
    # contact moves along the flanks, which are not radial: a per cent
    assert turned == pytest.approx(
        np.degrees(b.design.backlash_angle - a.design.backlash_angle), rel=0.01
    )
    assert near["output_angle_deg"] > 0.0


@pytest.mark.parallel([1, 2])
def test_a_drive_that_has_parted_is_loaded_again() -> None:
    """From the middle of its backlash, where nothing holds the output, the torque brings it back to
    the same state."""
    design = load_design(DESIGN, [*PLANE, "ring_gear.c_P=0.8"])
    stepper = load_stepper(design)
    items = [item for item in load_sequence(design).states if item.stage <= Stage.LOAD]
    for item in items:
        stepper.advance(item)
    before = stepper.row()
    middle = replace(items[-1], control="rotation", output_rotation=0.0, torque=0.0)
    stepper.advance(middle)
    assert stepper.row()["pairs_in_contact"] == 0
    stepper.iterations = 0
    stepper.advance(items[-1])
    after = stepper.row()
    assert after["newton_iterations"] <= 25
    for name in ("output_angle_deg", "wg_torque_Nmm", "tooth_torque_Nmm", "pairs_in_contact"):
        assert after[name] == pytest.approx(before[name], rel=1e-7), name
