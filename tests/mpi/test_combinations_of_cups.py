"""Bolts and a slope of the cam together with all else that a cup drive can have, in one design
file."""

from __future__ import annotations

import pytest
from mpi4py import MPI

import swgpar
from support.bearing import BEARING
from support.paths import RECIPE
from support.stepping import small
from swgpar.analysis.deviating_drive import DeviatingDrive
from swgpar.meshing import load_recipe
from swgpar.presentation.drive_result import DriveResult

DRIVE = (
    "micro_geometry.wg_slope=0.1",
    'cup.attachment="bolted"',
    "cup.bolts=8",
    "cup.bolt_circle=20.0",
    "cup.washer_diameter=2.0",
)
"""A slope, and the closed end on bolts."""

WINDOWS, ROUGH = "output.root_stress=true", "contact.friction=0.1"
STANDING = ("steps.rotation=0", "steps.samples=0")
PERIODS = ("steps.samples=6", "steps.rotation=86", "solver.rtol=1e-6")
"""Two periods of teeth and eight bolts, six angles of the five pitches of one."""


def run(*overrides: str) -> DriveResult:
    return swgpar.run(small("cup", *DRIVE, *overrides), RECIPE, progress=False)


@pytest.mark.parallel(1)
def test_everything_under_a_torque_in_one_run() -> None:
    """Windows, friction, fatigue and a period in one run give what a run with windows and one with
    the period do. The fatigue of all together is that of the resolved stress."""
    evaluated = "fatigue.size_factor=1.0"
    together = run(ROUGH, WINDOWS, *PERIODS, evaluated)
    windows = run(ROUGH, WINDOWS, *STANDING, "solver.rtol=1e-6")
    period = run(ROUGH, *PERIODS, evaluated, "output.root_stress=false")
    resolved, alone = together.summary.root_stress, windows.summary.root_stress
    assert resolved.s1 == pytest.approx(alone.s1, rel=1e-6)
    for name in ("fs_s1", "wg_torque_Nmm", "output_angle_deg"):
        assert together.history[name] == pytest.approx(period.history[name], rel=1e-4), name
    for name in ("bolts.shear_force", "bolts.axial_force", "mean.wg_torque_Nmm"):
        expected = period.summary[name].value
        assert together.summary[name].value == pytest.approx(expected, rel=1e-4), name
    # without a rotation bolts are seen under one place of the wave
    assert windows.summary["bolts.shear_force"].value < period.summary["bolts.shear_force"].value
    factors = [
        period.summary.fatigue.least[name].safety / together.summary.fatigue.least[name].safety
        for name in ("goodman", "crossland")
    ]
    assert factors == pytest.approx([resolved.s1 / resolved.on_mesh] * 2, rel=2e-3)
    strength, mises = together.summary.design.fatigue.yield_strength, "largest.fs_vm_off_corners"
    of_yield = strength / together.summary[mises].value
    assert together.summary.fatigue.least["yield"].safety == pytest.approx(of_yield, rel=2e-3)


@pytest.mark.parallel(1)
def test_a_loop_of_the_stiffness_ends_at_the_angle_of_its_torque() -> None:
    """Windows are for one torque, and change nothing."""
    points = ("stiffness.positions=1", "stiffness.points=1", "stiffness.torque=1")
    loop = run(*points, "stiffness.mesh_error=false", WINDOWS)
    alone = run("load.torque=1", *STANDING)
    torques, angles = (loop.history[name] for name in ("output_torque_Nmm", "output_angle_deg"))
    expected = abs(alone.history["output_angle_deg"][-1])
    for place in (torques.argmax(), torques.argmin()):
        assert abs(torques[place]) == pytest.approx(1000.0, rel=1e-6)
        assert abs(angles[place]) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parallel(1)
def test_an_output_that_is_rotated_needs_the_torque_that_rotates_it() -> None:
    rotated = run("ratcheting.limit=0.1")
    torque = rotated.history["output_torque_Nmm"][-1]
    loaded = run(f"load.torque={1e-3 * torque}", *STANDING)
    expected = rotated.history["output_angle_deg"][-1]
    assert loaded.history["output_angle_deg"][-1] == pytest.approx(expected, rel=1e-4)


@pytest.mark.parallel(1)
def test_deviations_beside_friction_windows_and_fatigue() -> None:
    """The whole turns of the transmission error are those of the design without them."""
    ring = (
        "deviations.ring_gear.eccentricity=0.01",
        'deviations.mesh="same"',
        "deviations.angles_per_pitch=1",
    )

    def angles(*overrides: str) -> dict[int, float]:
        design = small("cup", *DRIVE, *ring, *overrides)
        drive = DeviatingDrive(design, load_recipe(RECIPE), MPI.COMM_SELF)
        known = set(range(2, drive.angles))
        found = {point.index: point.output_angle for point in drive.points(known)}
        drive.destroy()
        return found

    together = angles(ROUGH, WINDOWS, "fatigue.size_factor=1.0", *PERIODS)
    assert together == pytest.approx(angles(), abs=1e-9)


@pytest.mark.parallel(1)
def test_a_bearing_on_a_bolted_cup() -> None:
    """The bolts carry the torque, and the balls' loads are those of a cup on its bore within a
    tenth."""
    without_slope = ("micro_geometry.wg_slope=0", "solver.rtol=1e-8", *STANDING)
    bolted = run(*BEARING, *without_slope)
    bore = swgpar.run(small("cup", *BEARING, *without_slope), RECIPE, progress=False)
    last = bolted.bolts["increment"] == bolted.bolts["increment"].max()
    around = [bolted.bolts[name][last].sum() for name in ("tangential_N", "twisting_Nmm")]
    moment = 10.0 * abs(around[0]) + abs(around[1])
    torque = bolted.history["output_torque_Nmm"][-1]
    # the condition that keeps the race from rotating in the spline acts on the bolts' coupling
    assert moment == pytest.approx(abs(torque), rel=1e-3)
    loads = [one.summary["bearing.largest_load"].value for one in (bolted, bore)]
    assert loads[0] == pytest.approx(loads[1], rel=0.1)
