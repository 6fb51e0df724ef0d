"""The drive with deviations over whole turns: renamed states, spectra, symmetries that are kept,
ranks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

import swgpar
from support.paths import RECIPE
from support.stepping import WORLD, load_stepper, rotate, small
from swgpar.analysis import deviating_drive, turn_drive
from swgpar.analysis.deviating_drive import DeviatingDrive, TurnPoint
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.turn_drive import turn_design
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import ConvergenceError
from swgpar.evaluation.transmission_error import spectrum
from swgpar.fem.body import RING_GEAR
from swgpar.load.load_sequence import load_sequence
from swgpar.load.load_states import Stage
from swgpar.meshing import load_recipe

TEETH_FS, TEETH_RG, RATIO = 40, 42, -20.0
ONE_ANGLE = "deviations.angles_per_pitch=1"
TURN_ONLY = ('deviations.mesh="same"', "steps.bent_start=true", "steps.rotation=0")
"""Overrides of a run that has no more than its turn to compute."""

PITCH = [f"deviations.{gear}.pitch_errors={errors}" for gear, errors in (
    ("ring_gear", np.random.default_rng(1).normal(0.0, 3.0, TEETH_RG).round(2).tolist()),
    ("flexible_spline", np.random.default_rng(2).normal(0.0, 3.0, TEETH_FS).round(2).tolist()),
)]  # fmt: skip


def deviating(*overrides: str, model: str = "plane", comm: MPI.Comm = WORLD) -> DeviatingDrive:
    """The small drive on its smallest mesh."""
    return DeviatingDrive(
        small(model, 'deviations.mesh="same"', *overrides), load_recipe(RECIPE), comm
    )


def points(
    drive: DeviatingDrive, indices: Iterable[int] | None = None, *, linear_model: bool = False
) -> dict[int, TurnPoint]:
    """Points by index, at some indices or at all."""
    total = drive.angles
    known = set() if indices is None else set(range(total)).difference(indices)
    found = {point.index: point for point in drive.points(known, linear_model=linear_model)}
    drive.destroy()
    return found


def error(found: dict[int, TurnPoint]) -> np.ndarray:
    """Transmission error (n,) arc seconds."""
    return (
        np.degrees([found[k].output_angle - found[k].wg_angle / RATIO for k in sorted(found)])
        * 3600.0
    )


def loaded_stepper(design: DriveDesign) -> LoadStepper:
    stepper = load_stepper(design)
    for state in load_sequence(design).states:
        if state.stage <= Stage.LOAD:
            stepper.advance(state)
    return stepper


@pytest.mark.parametrize("layout", ["ring_fixed", "spline_fixed"])
def test_renamed_deviations_are_those_of_a_drive_that_is_rotated(layout: str) -> None:
    """States of a turn by renaming equal those of a drive whose wave generator is rotated step by
    step."""
    overrides = (
        *PITCH,
        "deviations.angles_per_pitch=2",
        f"drive.layout={layout}",
        "deviations.ring_gear.eccentricity=0.01",
        "deviations.ring_gear.direction=30",
        "deviations.wave_generator.eccentricity=0.01",
        "deviations.flexible_spline.profile_slope=5",
    )
    drive = deviating(*overrides)
    tables, step, ratio = (
        drive.tables,
        drive.design.kinematics.period_angle / 2.0,
        drive.design.kinematics.ratio,
    )
    found = points(drive, (0, 1, 7))
    stepper = loaded_stepper(turn_design(small("plane", 'deviations.mesh="same"', *overrides)))
    drive.model.problem = stepper.problem
    drive._displace_cam()
    stepper.problem.flanks_of(RING_GEAR).deviate(tables)
    stepper.advance(stepper.load_state)
    for index in (0, 1, 7):
        row = rotate(stepper, index * step) if index else stepper.row()
        kinematic = np.degrees(index * step / ratio)
        mine, brute = (
            np.degrees(found[index].output_angle) - kinematic,
            row["output_angle_deg"] - kinematic,
        )
        # deviations of a ring gear that rotates keep their directions: step by step they are off by
        # its angle
        rel = 1e-6 if layout == "ring_fixed" else 1e-6 + abs(index * step / ratio)
        print(layout, index, mine, brute, found[index].wg_torque, row["wg_torque_Nmm"])
        assert mine == pytest.approx(brute, rel=rel)
        assert found[index].wg_torque == pytest.approx(row["wg_torque_Nmm"], rel=max(rel, 1e-5))
    stepper.model.destroy()


def test_an_ideal_drive_has_mesh_orders_only() -> None:
    """A whole turn step by step: all amplitudes but those of the mesh are below 1e-6 of it."""
    design = small("plane")
    stepper = loaded_stepper(design)
    count = 3 * TEETH_RG
    angles = 2.0 * np.pi * np.arange(count) / count
    rows = [rotate(stepper, angle) if angle else stepper.row() for angle in angles]
    output = np.array([row["output_angle_deg"] for row in rows])
    order, amplitude = spectrum(3600.0 * (output - np.degrees(angles) / RATIO), 1)
    mesh = np.isclose(order % TEETH_RG, 0.0)
    print(amplitude[mesh], amplitude[~mesh].max())
    assert amplitude[~mesh].max() < 1e-6 * amplitude[mesh].max()
    stepper.model.destroy()


def test_amplitudes_are_linear_in_small_deviations() -> None:
    """Errors of a thousandth of a micrometre and twice as large ones: all amplitudes double."""
    base = np.random.default_rng(1).normal(0.0, 1e-3, TEETH_RG)
    spectra = []
    for factor in (1.0, 2.0):
        errors = f"deviations.ring_gear.pitch_errors={(factor * base).tolist()}"
        spectra.append(spectrum(error(points(deviating(ONE_ANGLE, errors))), 1)[1])
    largest = spectra[0].max()
    print(largest, np.abs(spectra[1] - 2.0 * spectra[0]).max() / largest)
    assert np.abs(spectra[1] - 2.0 * spectra[0]).max() < 2e-3 * largest


def test_an_eccentric_ring_gear_is_seen_twice_per_turn() -> None:
    """Both waves pass it: even orders only, the second the largest. An eccentric cam beside it adds
    the first."""
    ring = "deviations.ring_gear.eccentricity=0.01"
    order, amplitude = spectrum(error(points(deviating(ONE_ANGLE, ring))), 1)
    odd = order % 2 == 1
    assert amplitude[odd].max() < 1e-6 * amplitude.max()
    assert order[amplitude.argmax()] == 2
    _, both = spectrum(
        error(points(deviating(ONE_ANGLE, ring, "deviations.wave_generator.eccentricity=0.005"))), 1
    )
    print(amplitude[:4], both[:4])
    assert both[0] > 0.05 * both.max()


def test_an_eccentric_spline_is_seen_twice_per_turn_against_it() -> None:
    """A whole turn of the output: multiples of 2 (1 - 1 / ratio) = 2.1 only."""
    drive = deviating(
        ONE_ANGLE, "deviations.turns=20", "deviations.flexible_spline.eccentricity=0.01"
    )
    assert drive.periods == (TEETH_FS, 1)
    found = points(drive)
    assert sum(point.iterations > 0 for point in found.values()) <= TEETH_FS
    order, amplitude = spectrum(error(found), 20)
    own = np.isclose(order / 2.1, np.round(order / 2.1))
    assert amplitude[~own].max() < 1e-6 * amplitude.max()
    assert order[amplitude.argmax()] == pytest.approx(2.1)


def test_a_linear_model_knows_the_contacts(monkeypatch: pytest.MonkeyPatch) -> None:
    """From its guess Newton's iteration reaches the same states in half of the iterations, also
    where the cam is displaced. Its own states are near."""
    eccentric = [f"deviations.{part}.eccentricity" for part in ("wave_generator", "ring_gear")]
    keys = (*PITCH, ONE_ANGLE, f"{eccentric[0]}=0.005", f"{eccentric[1]}=0.02", "load.torque=2")
    found = []
    for least in (1, 1000):
        monkeypatch.setattr(deviating_drive, "WORTH_GUESSES", least)
        found.append(points(deviating(*keys), (0, 5, 9, 21)))
    guessed, last = found
    for k in guessed:
        assert guessed[k].output_angle == pytest.approx(last[k].output_angle, rel=1e-6)
        assert guessed[k].wg_torque == pytest.approx(last[k].wg_torque, rel=1e-5)
    counts = [sum(point.iterations for point in some.values()) for some in found]
    print(counts)
    assert counts[0] <= 0.5 * counts[1]
    # the states of the model itself, but for the first, which checks it
    monkeypatch.setattr(deviating_drive, "WORTH_GUESSES", 1)
    monkeypatch.setattr(turn_drive, "LEAST_CHECKED", 1)
    modelled = points(deviating(*keys), guessed, linear_model=True)
    assert [point.by_linear_model for _, point in sorted(modelled.items())] == [False] + [True] * 3
    assert modelled[0].output_angle == pytest.approx(guessed[0].output_angle, rel=1e-6)
    apart = error(modelled) - error(guessed)
    exact, torque = (np.array([of[k].wg_torque for k in sorted(of)]) for of in (guessed, modelled))
    print(apart, np.ptp(error(guessed)), torque - exact, np.ptp(exact))
    assert 0.0 < np.abs(apart[1:]).max() < 0.02 * np.ptp(error(guessed))
    assert np.abs(torque - exact).max() < 0.1 * np.ptp(exact)
    assert modelled[0].difference is not None and modelled[5].difference is None


@pytest.mark.parallel([1, 2])
def test_an_oval_ring_gear_keeps_half_of_the_model() -> None:
    oval = ("deviations.ring_gear.ovality=0.02", ONE_ANGLE)
    indices = (0, 3, 8)
    half, whole = deviating(*oval), deviating(*oval, "solver.symmetry=false")
    assert (half.model.copies, whole.model.copies) == (2, 1)
    a, b = points(half, indices), points(whole, indices)
    for k in indices:
        parallel_assert(a[k].wg_torque == pytest.approx(b[k].wg_torque, rel=1e-6))
        parallel_assert(a[k].output_angle == pytest.approx(b[k].output_angle, rel=1e-6))


@pytest.mark.parallel(2)
def test_ranks_do_not_matter() -> None:
    indices = (0, 5)
    several, one = (
        points(deviating(*PITCH), indices),
        points(deviating(*PITCH, comm=MPI.COMM_SELF), indices),
    )
    for k in indices:
        parallel_assert(several[k].output_angle == pytest.approx(one[k].output_angle, rel=1e-6))
        parallel_assert(several[k].wg_torque == pytest.approx(one[k].wg_torque, rel=1e-5))


@pytest.mark.parallel([1, 2, 3])
def test_ranks_share_the_states_of_a_turn() -> None:
    design = small("plane", "deviations.ring_gear.ovality=0.02", *TURN_ONLY)
    several, one = (
        swgpar.run(design, RECIPE, comm=comm, plain=True) for comm in (WORLD, MPI.COMM_SELF)
    )
    for name, rel in (("output_angle_deg", 1e-6), ("wg_torque_Nmm", 1e-5)):
        found, expected = several.transmission_error[name], one.transmission_error[name]
        parallel_assert(len(found) == TEETH_RG and found == pytest.approx(expected, rel=rel), name)


@pytest.mark.parallel(2)
def test_a_state_that_fails_on_one_rank_ends_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """The states before it are kept."""
    points = DeviatingDrive.points

    def failing(drive: DeviatingDrive, *arguments: Any, **keys: Any) -> Iterator[TurnPoint]:
        for count, point in enumerate(points(drive, *arguments, **keys)):
            if WORLD.rank == 1 and count == 2:
                raise ConvergenceError("no state here")
            yield point

    monkeypatch.setattr(DeviatingDrive, "points", failing)
    with pytest.raises(ConvergenceError, match="no state here"):
        swgpar.run(
            small("plane", "deviations.ring_gear.ovality=0.02", *TURN_ONLY),
            RECIPE,
            comm=WORLD,
            plain=True,
        )


def test_only_the_relative_position_of_the_axes_matters() -> None:
    """A cup drive whose ring gear is displaced, and one whose cam and bore are displaced the other
    way.

    A tilt of the ring gear is taken along the normals of the facing flanks and at the axial travel
    of the teeth at the major axis: some per cent of what it changes.
    """

    def output(tilt: float, *displaced: str, angle: float) -> float:
        keys = [
            f"deviations.{part}.{key}={value}"
            for part in displaced
            for key, value in {
                "eccentricity": 0.01,
                "direction": angle,
                "tilt": tilt,
                "tilt_direction": angle,
            }.items()
        ]
        return points(deviating(*keys, model="cup"), (0,))[0].output_angle

    first, second = (
        [output(tilt, *parts, angle=angle) for tilt in (0.0, 0.1)]
        for parts, angle in ((("ring_gear",), 60.0), (("wave_generator", "cup"), 240.0))
    )
    print(first, second)
    assert first[0] == pytest.approx(second[0], rel=1e-8)
    assert first[1] - first[0] == pytest.approx(second[1] - second[0], rel=0.05)
