"""The layout with the ring gear driven and the wave generator fixed: the drive of `ring_fixed`,
seen from its cam."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import NO_SHORTCUTS, PLANE
from swgpar.errors import InputError
from swgpar.fem.stress import rotated_tensor
from swgpar.geometry.rotation import rotated
from swgpar.presentation.drive_result import DriveResult

SAMPLES = 24
FIXED = "drive.layout=wave_generator_fixed"
STRESSES = ("fs_s1", "fs_s3", "fs_vm", "rg_s1", "rg_s3", "rg_vm")
TEETH_FS, TEETH_RG, TORQUE = 40, 42, 200.0


@lru_cache
def run(*overrides: str) -> DriveResult:
    """The plane drive over one period in `SAMPLES` increments."""
    period = 360.0 / TEETH_RG
    steps = (
        f"steps.rotation={period!r}",
        f"steps.increment={period / SAMPLES!r}",
        "output.fields=true",
    )
    return swgpar.run(
        swgpar.load_design(DESIGN, [*PLANE, *NO_SHORTCUTS, *steps, *overrides]),
        RECIPE,
        progress=False,
    )


def test_stresses_and_transmission_error_are_those_with_the_ring_gear_fixed() -> None:
    ring, wave = run(), run(FIXED)
    for name in (
        *STRESSES,
        "wg_angle_deg",
        "wg_torque_Nmm",
        "tooth_torque_Nmm",
        "output_torque_Nmm",
    ):
        assert wave.history[name] == pytest.approx(ring.history[name], rel=1e-12), name
    error = ring.summary.rotation.transmission_error_arcsec
    assert wave.summary.rotation.transmission_error_arcsec == pytest.approx(error, rel=1e-9)
    assert set(wave.history) - set(ring.history) == {"input_angle_deg", "input_torque_Nmm"}
    # from the columns alone: the output's angle less the input's over the ratio
    loaded = wave.history["step"] >= 3
    angle, output = (wave.history[name][loaded] for name in ("input_angle_deg", "output_angle_deg"))
    deviation = 3600.0 * (output - angle / wave.summary.ratio)
    assert np.ptp(deviation[1:]) == pytest.approx(error, rel=1e-6)
    drawn = wave.curves().values["transmission_error"]
    assert drawn == pytest.approx(ring.curves().values["transmission_error"], abs=1e-7)


def test_kinematics_balance_and_energy() -> None:
    """Torques on the drive from outside add up to zero, and over a period so does their work."""
    wave = run(FIXED)
    h = wave.history
    assert wave.summary.ratio == pytest.approx(TEETH_FS / TEETH_RG)
    assert swgpar.check(swgpar.load_design(DESIGN, [*PLANE, FIXED]))[
        "ratio (ring gear / output)"
    ] == pytest.approx(TEETH_FS / TEETH_RG)
    loaded = h["step"] >= 3
    assert h["input_angle_deg"] == pytest.approx(-h["wg_angle_deg"])
    total = h["input_torque_Nmm"] + h["output_torque_Nmm"] + h["wg_torque_Nmm"]
    assert np.abs(total[loaded]).max() < 1e-6 * TORQUE
    angle, output = (
        np.radians(h[name][loaded]) for name in ("input_angle_deg", "output_angle_deg")
    )
    assert output[-1] - output[0] == pytest.approx(
        (angle[-1] - angle[0]) * TEETH_RG / TEETH_FS, rel=1e-6
    )
    # mean over the period without its first state, which the last one repeats; kinks as in
    # test_invariants
    work_in = h["input_torque_Nmm"][loaded][1:].mean() * (angle[-1] - angle[0])
    work_out = TORQUE * (output[-1] - output[0])
    assert work_in > 0.0 > work_out
    assert work_in + work_out == pytest.approx(0.0, abs=1e-3 * work_in)
    driven = wave.summary.rotation.input
    assert driven.torque_expected_Nmm == pytest.approx(-TORQUE * TEETH_RG / TEETH_FS)
    assert driven.torque_Nmm == pytest.approx(driven.torque_expected_Nmm, rel=1e-3)
    ripple = np.ptp(h["input_torque_Nmm"][loaded][1:]) / abs(driven.torque_Nmm)
    assert wave.summary.rotation.torque_ripple == pytest.approx(ripple)
    assert run().summary.rotation.input is None


def test_fields_are_those_of_a_standing_wave_generator() -> None:
    """The deformed drive is that with the ring gear fixed, rotated back by the angle of the wave
    generator."""
    ring, wave = run(), run(FIXED)
    back = -np.radians(ring.history["wg_angle_deg"][-1])
    for body in ("flexible_spline", "ring_gear"):
        points = ring.mesh(body)[0]
        moved = {r: points + r.field("displacement", body=body) for r in (ring, wave)}
        expected = rotated(moved[ring][None], np.array([[back]]))[0]
        assert np.abs(moved[wave] - expected).max() < 1e-9
        assert wave.field("vm", body=body) == pytest.approx(ring.field("vm", body=body), rel=1e-9)
    # the ring gear has turned as a whole by the input's angle
    x, y = moved[wave][:, :2].T
    turned = np.angle((x + 1j * y) / (points[:, 0] + 1j * points[:, 1]))
    assert turned == pytest.approx(back, abs=1e-4)


def test_a_rotated_tensor() -> None:
    values, angle = np.array([3.0, -1.0, 2.0, 0.5, -0.7, 1.1]), 0.3
    xx, yy, zz, xy, yz, zx = values
    tensor = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    expected = turn @ tensor @ turn.T
    found = rotated_tensor(values, angle)
    assert found == pytest.approx(
        [expected[i] for i in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))]
    )


def test_a_restart_goes_on_from_the_state_of_the_computation(tmp_path: Path) -> None:
    overrides = [*PLANE, *NO_SHORTCUTS, FIXED, "steps.increment=2", "output.fields=true"]
    whole = swgpar.run(
        swgpar.load_design(DESIGN, [*overrides, "steps.rotation=6"]), RECIPE, tmp_path / "whole"
    )
    swgpar.run(
        swgpar.load_design(DESIGN, [*overrides, "steps.rotation=4"]), RECIPE, tmp_path / "parts"
    )
    parts = swgpar.run(
        swgpar.load_design(DESIGN, [*overrides, "steps.rotation=6"]),
        RECIPE,
        tmp_path / "parts",
        restart=True,
    )
    again = swgpar.open_result(tmp_path / "parts")
    for name in (*STRESSES, "input_angle_deg", "output_angle_deg", "input_torque_Nmm"):
        assert parts.history[name] == pytest.approx(whole.history[name], rel=1e-6), name
        assert again.history[name] == pytest.approx(parts.history[name], rel=0.0), name
    shift = [result.field("displacement") for result in (whole, parts)]
    assert np.abs(shift[0] - shift[1]).max() < 1e-7


def test_losses_refer_to_the_input() -> None:
    """The same power is lost at the same speed of the input, of a power that is larger by the
    ratios."""
    overrides = (
        *PLANE,
        "losses.bearing_diameter=30",
        "steps.samples=4",
        "steps.rotation=10",
        "output.fields=false",
    )
    ring, wave = (
        swgpar.run(
            swgpar.load_design(DESIGN, [*overrides, *layout]), RECIPE, progress=False
        ).summary.losses
        for layout in ((), (FIXED,))
    )
    assert wave.loss_torque_Nmm == pytest.approx(ring.loss_torque_Nmm, rel=1e-9)
    useful = TORQUE * TEETH_RG / TEETH_FS
    assert wave.efficiency == pytest.approx(useful / (useful + wave.loss_torque_Nmm))


@pytest.mark.parallel(2)
def test_ranks_do_not_matter() -> None:
    steps = ("steps.rotation=4", "steps.increment=2", "output.fields=true")
    design = swgpar.load_design(DESIGN, [*PLANE, *NO_SHORTCUTS, FIXED, *steps])
    both = [
        swgpar.run(design, RECIPE, progress=False, comm=comm)
        for comm in (MPI.COMM_WORLD, MPI.COMM_SELF)
    ]
    for name in (*STRESSES, "input_angle_deg", "output_angle_deg", "input_torque_Nmm"):
        # the absolute part is for rows without a load
        same = both[0].history[name] == pytest.approx(both[1].history[name], rel=1e-8, abs=1e-8)
        parallel_assert(same, name)
    shift = [result.field("displacement") for result in both]
    parallel_assert(np.abs(shift[0] - shift[1]).max() < 1e-7)


def test_the_starter_designs_no_such_drive() -> None:
    """Its ratio does not say how many teeth it has."""
    with pytest.raises(InputError, match='allowed "ring_fixed", "spline_fixed"'):
        swgpar.new(ratio=50.0, diameter=50.0, torque=10.0, layout="wave_generator_fixed")
