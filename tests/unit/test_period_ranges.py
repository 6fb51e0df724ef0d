"""Ranges over a period with their errors by the angles and by a coarser mesh."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.analysis.shortcuts import with_shortcuts
from swgpar.answers.missed_peaks import missed_range
from swgpar.design.kinematics import Kinematics
from swgpar.evaluation.period import places, sampling_error
from swgpar.evaluation.period_ranges import (
    INPUT_TORQUE,
    CoarsePeriod,
    PeriodCurves,
    PeriodRanges,
    period_curves,
    range_errors,
)
from swgpar.load.load_sequence import load_sequence
from swgpar.results.history import Row, transmission_error

Curve = Callable[[np.ndarray], np.ndarray]


@pytest.fixture
def kinematics() -> Kinematics:
    return swgpar.load_design(DESIGN, PLANE).kinematics


def rows_of(kinematics: Kinematics, errors: np.ndarray, torques: np.ndarray) -> list[Row]:
    """Rows at even angles of a period with these transmission errors (arc seconds) and torques
    (N mm)."""
    angles = np.degrees(kinematics.period_angle) * np.arange(len(errors)) / len(errors)
    return [
        {
            "wg_angle_deg": float(angle),
            "output_angle_deg": float(angle / kinematics.ratio + error / 3600.0),
            INPUT_TORQUE: float(torque),
        }
        for angle, error, torque in zip(angles, errors, torques, strict=True)
    ]


def kinked(x: np.ndarray) -> np.ndarray:
    """A curve (n,) that falls over 0.65 of a period and rises over the rest, along straight
    lines."""
    x = x % 1.0
    return np.where(x < 0.65, 1.0 - 2.0 / 0.65 * x, 2.0 / 0.35 * (x - 0.65) - 1.0)


def smooth(x: np.ndarray) -> np.ndarray:
    """A smooth curve (n,)."""
    return np.sin(2.0 * np.pi * x) + 0.3 * np.sin(4.0 * np.pi * x)


def errors_of(kinematics: Kinematics, values: np.ndarray, before: np.ndarray) -> PeriodRanges:
    """Errors of curves (n,) that are those of transmission error and torque alike, from those of a
    coarser mesh."""
    rows = rows_of(kinematics, values, values)
    coarse = CoarsePeriod(PeriodCurves(before.tolist(), before.tolist()), factor=1.6)
    found = range_errors(kinematics, rows, INPUT_TORQUE, coarse)
    assert found is not None
    return found


@pytest.mark.parametrize("angles", [5, 6])
@pytest.mark.parametrize(("curve", "most"), [(kinked, 1.01), (smooth, 0.6)])
def test_what_angles_miss_of_known_curves(curve: Curve, most: float, angles: int) -> None:
    """Where the curve is straight up to its kink all of it is known, of a smooth one less is
    missed: with the first angle at any place."""
    true = np.ptp(curve(np.linspace(0.0, 1.0, 10001)))
    shares = []
    for first in np.linspace(0.0, 1.0, 200, endpoint=False):
        values = curve(first + np.arange(angles) / angles)
        shares.append((true - np.ptp(values)) / missed_range(values))
    print(f"{curve.__name__}, {angles}: {min(shares):.2f} to {max(shares):.2f}")
    assert 0.0 <= min(shares) and 0.25 < max(shares) < most


def test_a_coarser_mesh_with_another_curve_of_the_same_range_shows_an_error(
    kinematics: Kinematics,
) -> None:
    values = np.array([0.0, 2.0, 0.0, 0.0, 2.0, 0.0])
    before = np.roll(values, 1) + 7.0  # its mean does not count
    errors = errors_of(kinematics, values, before)
    assert np.ptp(values) == np.ptp(before)
    assert errors.torque >= 1.6 * 2.0 and errors.transmission_error >= 1.6 * 2.0


def test_lobes_that_do_not_divide_the_teeth_repeat_a_state_within_the_period(
    kinematics: Kinematics,
) -> None:
    """With two lobes and an odd number of teeth six angles show three states, five show five."""
    assert kinematics.repeats(0) == 1 and kinematics.apart(6) == 6
    odd = dataclasses.replace(kinematics, teeth_fs=41, teeth_rg=43)
    assert odd.repeats(0) == 2 and odd.apart(6) == 5 and odd.apart(4) == 3
    assert dataclasses.replace(odd, lobes_are_alike=False).repeats(0) == 1
    three = dataclasses.replace(odd, teeth_fs=40, lobes=3)
    assert three.repeats(0) == 3 and three.apart(6) == 5 and three.apart(4) == 4
    assert dataclasses.replace(three, teeth_fs=39, teeth_rg=42).repeats(0) == 1
    values = np.arange(6.0)
    coarse = CoarsePeriod(PeriodCurves(values.tolist(), values.tolist()), factor=1.6)
    rows = rows_of(odd, values, values)
    assert range_errors(odd, rows, INPUT_TORQUE, coarse) is None  # half of three shows nothing


@pytest.mark.parametrize(("teeth", "angles"), [(42, 6), (43, 5)])
def test_means_of_half_of_the_angles(kinematics: Kinematics, teeth: int, angles: int) -> None:
    """Of a curve along straight lines between every other place both means agree."""
    kinematics = dataclasses.replace(kinematics, teeth_rg=teeth)
    design = swgpar.load_design(DESIGN, [*PLANE, f"steps.samples={angles}", "steps.rotation=9"])
    sequence = dataclasses.replace(load_sequence(design), kinematics=kinematics)
    rows = rows_of(kinematics, np.zeros(angles), np.zeros(angles))
    known = np.unique(places(kinematics, rows))
    every = known[::2]
    heights = np.arange(len(every)) ** 2.0

    def of(place: float) -> float:
        return float(np.interp(place, [*every, 1.0], [*heights, heights[0]]))

    for row, place in zip(rows, places(kinematics, rows), strict=True):
        row["fs_s1"] = of(place)
    gaps = np.diff([*every, 1.0])
    mean = float(gaps @ (0.5 * (heights + np.roll(heights, -1))))
    found = sampling_error(sequence, rows, ("fs_s1",))["fs_s1"]
    assert found == pytest.approx(abs(np.mean([row["fs_s1"] for row in rows]) - mean), abs=1e-12)


def test_a_run_takes_angles_that_show_different_states() -> None:
    """The transmission error of an odd number of teeth repeats after half of a period."""
    odd = {"drive.teeth_fs": 41, "drive.teeth_rg": 43, "steps.increment": 1.0}
    design = swgpar.load_design(DESIGN, PLANE).with_values({**odd, "steps.rotation": 9.0})
    taken = with_shortcuts(design, swgpar.load_mesh(RECIPE)).design
    assert taken.steps.samples == 5
    result = swgpar.run(taken.with_values({"steps.samples": 4}), RECIPE, progress=False)
    kinematics = taken.kinematics
    assert kinematics.repeats(0) == 2
    history = {name: result.history[name][:4] for name in ("wg_angle_deg", "output_angle_deg")}
    errors = transmission_error(*history.values(), kinematics.ratio)
    torques = result.history[INPUT_TORQUE][:4]
    for values in (errors, torques):
        assert values[:2] == pytest.approx(values[2:], rel=1e-4)
        assert abs(values[1] - values[0]) > 1e-3 * abs(values[0])


def test_without_a_coarser_mesh_or_with_few_angles_nothing_is_known(
    kinematics: Kinematics,
) -> None:
    values = np.array([0.0, 4.0, 1.0, -2.0])
    rows = rows_of(kinematics, values, values)
    every = period_curves(kinematics, rows, INPUT_TORQUE).ranges
    assert every.transmission_error == pytest.approx(6.0) and every.torque == 6.0
    assert range_errors(kinematics, rows, INPUT_TORQUE, None) is None
    coarse = CoarsePeriod(PeriodCurves([0.0] * 3, [0.0] * 3), factor=1.6)
    few = rows_of(kinematics, values[:3], values[:3])
    assert range_errors(kinematics, few, INPUT_TORQUE, coarse) is None


def test_a_run_states_them(kinematics: Kinematics) -> None:
    """On a mesh with a coarser one, over a sampled period. The error of the mean torque is that of
    the energy balance."""
    rotation = 2.0 * float(np.degrees(kinematics.period_angle))
    design = swgpar.load_design(DESIGN, PLANE).with_values(
        {"steps.rotation": rotation, "steps.increment": 1.0, "output.root_stress": True}
    )
    summary = swgpar.run(design, swgpar.load_mesh("plane_coarse"), progress=False).summary
    names = ("rotation.torque_ripple", "rotation.transmission_error", "contact.pressure_off_edges")
    for name in names:
        found = summary[name]
        print(f"{name} {found.value:.4g} ± {found.error:.2g}")
        assert 0.0 < found.error
    assert summary["sharing.largest_force_share"].value == 0.5  # one pair in a lobe
    assert summary["sharing.largest_force"].error is None
    mean = summary["mean.wg_torque_Nmm"]
    expected = summary["rotation.expected_wg_torque"].value
    left = summary["residue.torque"].value
    assert mean.error == pytest.approx(2.0 * abs(mean.value - expected) + left)
    # a mesh without a coarser one: the balance of energy is known all the same
    tiny = swgpar.run(design, swgpar.load_mesh(RECIPE), progress=False).summary
    assert tiny["rotation.torque_ripple"].error is None
    assert tiny["mean.wg_torque_Nmm"].error > 0.0
