"""Closed ends and flanges that are clamped or bolted: exact invariants, on several ranks and on
half of the drive."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from support.cup_shapes import ATTACHMENTS, CLAMPED, HAT_CLAMPED, Changes, bolted, shaped
from support.stepping import WORLD, Row, assert_agree, load_stepper, loaded, rotate
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.constraints.distributing_coupling import ROTATION
from swgpar.constraints.rigid_attachment import RigidAttachment
from swgpar.geometry.rotation import rotated

TORQUE = 2000.0
"""N mm, at the output with the ring gear fixed."""

PHYSICAL = ("fs_s1", "fs_s3", "fs_vm", "wg_torque_Nmm", "tooth_torque_Nmm", "output_angle_deg")

attachments = pytest.mark.parametrize("name", list(ATTACHMENTS))


@lru_cache
def on(name: str) -> tuple[LoadStepper, Row]:
    return loaded(shaped(ATTACHMENTS[name]))


@attachments
def test_torques_balance_and_the_attached_area_is_rigid(name: str) -> None:
    stepper, row = on(name)
    total = row["wg_torque_Nmm"] + row["tooth_torque_Nmm"] + row["output_torque_Nmm"]
    assert row["output_torque_Nmm"] == pytest.approx(TORQUE) and abs(total) < 1e-6 * TORQUE
    problem = stepper.problem
    coupling, u = problem.supports.couplings[0], problem.displacement()
    assert isinstance(coupling, RigidAttachment)
    rotation = coupling.evaluate(u).value[ROTATION]
    assert rotation == pytest.approx(np.radians(row["output_angle_deg"]), rel=1e-12)
    moved = coupling.undeformed + u[coupling.nodes] - rotated(coupling.undeformed, rotation)
    # nodes carry with the area that is attached: those of elements wider than a washer move beside
    # it
    mean = np.sqrt(coupling.sum(coupling.weight * (moved**2).sum(axis=1)))
    print(f"{name}: mean displacement from the rigid flange {1000.0 * mean:.3f} um")
    assert mean < (1e-4 if "clamped" in name else 2e-3) and abs(rotation) > 1e-4


def test_the_stiffness_of_the_bedding_does_not_show() -> None:
    def ten_times(stepper: LoadStepper) -> None:
        stepper.problem.supports.couplings[0].stiffness *= 10.0

    (_, usual), (_, harder) = on("clamped"), loaded(shaped(CLAMPED), prepare=ten_times)
    for quantity in PHYSICAL:
        print(f"{quantity}: {harder[quantity] / usual[quantity] - 1.0:+.1e}")
    assert_agree(harder, usual, PHYSICAL, 5e-3)


def test_the_areas_are_those_of_ring_and_washers() -> None:
    for name, exact in (
        ("clamped", 2.0 * np.pi * (9.0**2 - 6.0**2)),
        ("hat, clamped", 2.0 * np.pi * (26.0**2 - 23.0**2)),
        ("eight bolts", 2.0 * 8.0 * np.pi * 1.0**2),
        ("hat, ten bolts", 2.0 * 10.0 * np.pi * 1.5**2),
    ):
        stepper = load_stepper(shaped(ATTACHMENTS[name]))
        area = stepper.problem.supports.couplings[0].total * stepper.model.copies
        # the mesh has chords of 9 degrees, 0.4 % less; the rims of washers are met by points 0.1 mm
        # apart
        assert area == pytest.approx(exact, rel=0.01 if "clamped" in name else 0.05), name


@pytest.mark.parallel([2, 3])
@pytest.mark.parametrize("changes", [CLAMPED, bolted(8)], ids=["clamped", "bolted"])
def test_any_number_of_ranks_gives_the_same(changes: Changes) -> None:
    (_, several), (_, alone) = loaded(shaped(changes)), loaded(shaped(changes), MPI.COMM_SELF)
    assert_agree(several, alone, PHYSICAL, 1e-7)


@pytest.mark.parametrize("changes", [CLAMPED, bolted(8)], ids=["clamped", "bolted"])
def test_half_the_drive_equals_the_whole(changes: Changes) -> None:
    (_, half), (stepper, whole) = (
        loaded(shaped(changes)),
        loaded(shaped(changes, "solver.symmetry=false")),
    )
    assert stepper.model.copies == 1
    assert_agree(half, whole, PHYSICAL, 1e-6)


def test_an_odd_number_of_bolts_takes_the_whole_drive() -> None:
    assert shaped(bolted(8)).copies == 2 and shaped(bolted(9)).copies == 1
    _, row = loaded(shaped(bolted(9)))
    parallel_assert(row["torque_balance_Nmm"] < 1e-6 * TORQUE)


@pytest.mark.parametrize(
    "changes", [CLAMPED, HAT_CLAMPED, bolted(40, 1.0)], ids=["clamped", "hat", "a bolt per tooth"]
)
def test_period_and_work(changes: Changes) -> None:
    """Where all teeth are alike the state repeats after a pitch, and the mean input torque is T /
    ratio."""
    stepper, _ = loaded(shaped(changes))
    pitch, samples = 2.0 * np.pi / 42, 6
    first = rotate(stepper, 0.2 * pitch)
    rows = [rotate(stepper, (0.2 + k / samples) * pitch) for k in range(1, samples + 1)]
    assert_agree(rows[-1], first, PHYSICAL[:-1], 1e-6)
    turned = rows[-1]["output_angle_deg"] - first["output_angle_deg"]
    assert turned == pytest.approx(-np.degrees(pitch) / 20.0, rel=1e-6)
    mean = np.mean([r["wg_torque_Nmm"] for r in rows])
    print(f"mean input torque / (T / ratio) = {mean * 20.0 / TORQUE:.5f}")
    assert mean == pytest.approx(TORQUE / 20.0, rel=0.01)


def test_work_of_bolts_over_the_period_that_they_leave() -> None:
    """Eight bolts on 40 teeth: the drive repeats after five pitches of the wave, half of it is
    modelled."""
    stepper, _ = loaded(shaped(bolted(8)))
    pitch, samples = 2.0 * np.pi / 42, 6
    first = rotate(stepper, 0.2 * pitch)
    rows = [rotate(stepper, (0.2 + k / samples) * pitch) for k in range(1, 5 * samples + 1)]
    assert_agree(rows[-1], first, PHYSICAL[:-1], 1e-6)
    mean = np.mean([r["wg_torque_Nmm"] for r in rows])
    print(f"mean input torque / (T / ratio) = {mean * 20.0 / TORQUE:.5f}")
    assert mean == pytest.approx(TORQUE / 20.0, rel=0.01)


def test_the_other_layout() -> None:
    """The spline stands still on its clamped ring, the ring gear turns with the load."""
    _, row = loaded(shaped(CLAMPED, 'drive.layout="spline_fixed"', "load.torque=2.1"), WORLD)
    assert row["output_torque_Nmm"] == pytest.approx(-2100.0)
    assert (
        abs(row["tooth_torque_Nmm"] + 2100.0) < 1e-6 * TORQUE
        and row["torque_balance_Nmm"] < 1e-6 * TORQUE
    )
