"""Deviations of teeth: tolerances of ISO 1328-1, random pitch errors, moved flanks, files, spectra
and causes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from support.cup_shapes import bolted, shaped
from support.paths import DRIVERS
from swgpar import load_design
from swgpar.design.deviations import gear_deviations
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.evaluation.transmission_error import COLUMNS, Causes, doubtful_extremes, spectrum
from swgpar.geometry.pitch_deviations import pitch_tolerances, random_pitch_errors
from swgpar.geometry.rotation import MIRROR, rotated
from swgpar.profiles.flank_deviations import GearDeviations

PLANE = DRIVERS / "plane_half_turn.toml"


def plane(*overrides: str) -> DriveDesign:
    return load_design(PLANE, overrides)


def test_tolerances_of_iso_1328() -> None:
    """Module 3 mm, 40 teeth, class 6, by hand: (0.12 + 1.2 + 5) and (0.24 + 6.0249 + 2.1 + 12)
    times sqrt(2)."""
    found = pitch_tolerances(120.0, 3.0, 6)
    assert found.single == pytest.approx(8.938, abs=1e-3)
    assert found.total == pytest.approx(28.800, abs=1e-3)
    finer = pitch_tolerances(120.0, 3.0, 5)
    assert np.array(found) / np.array(finer) == pytest.approx(np.sqrt(2.0))


@pytest.mark.parametrize("grade", [3, 7])
@pytest.mark.parametrize("teeth", [40, 122, 300])
def test_random_pitch_errors_just_meet_their_grade(teeth: int, grade: int) -> None:
    tolerances = pitch_tolerances(float(teeth), 1.0, grade)
    for seed in range(5):
        errors = random_pitch_errors(teeth, tolerances, (seed,))
        single, total = np.abs(errors - np.roll(errors, 1)).max(), np.ptp(errors)
        assert single <= tolerances.single * (1.0 + 1e-12) and total <= tolerances.total * (
            1.0 + 1e-12
        )
        assert max(single / tolerances.single, total / tolerances.total) == pytest.approx(1.0)
        assert abs(errors.mean()) < 1e-12
    assert not np.allclose(errors, random_pitch_errors(teeth, tolerances, (0,)))
    assert np.array_equal(errors, random_pitch_errors(teeth, tolerances, (4,)))


@pytest.mark.parametrize("side", [1, -1])
def test_heights_are_those_of_moved_flanks(side: int) -> None:
    """The distance of a rotated and shifted flank from the ideal one, to first order."""
    profile = plane().profile("flexible_spline")
    s = np.linspace(0.1, profile.root_start * 0.95, 40)
    mirror = MIRROR if side < 0 else np.ones(2)
    angle, amount = np.array([0.0, 0.7]), 1e-4
    deviations = GearDeviations(
        60.0, np.array([amount, -amount]), np.array([0.5 * amount, 2.0 * amount])
    )
    heights = deviations.heights(profile, s, np.zeros_like(s), angle, side)
    for k, pitch in enumerate(deviations.pitch):
        points = rotated(profile.point(s) * mirror, pitch / 60.0) + rotated(
            deviations.shift, -angle[k]
        )
        distance, _ = profile.distance(points * mirror)
        assert heights[k] == pytest.approx(distance, abs=2e-3 * amount)
        moved, turned = deviations.flank_shift(profile, s, angle, side)
        assert profile.point(s) * mirror + moved[k] == pytest.approx(points, abs=1e-9)
        assert turned[k] == pytest.approx(
            pitch / 60.0 * profile.tangent(s) * mirror @ [[0.0, 1.0], [-1.0, 0.0]]
        )


def test_an_oval_ring_does_not_stretch() -> None:
    """The diameter changes by half of the ovality, and the circumferential strain v' + w
    vanishes."""
    angle = np.linspace(0.0, 2.0 * np.pi, 401)
    deviations = GearDeviations(60.0, np.zeros(401), ovality=0.02, oval_angle=0.3)
    moved = deviations.moved(np.array([[0.0, 60.0]]), angle)[:, 0]
    outward, around = moved[:, 1], -moved[:, 0]
    assert np.ptp(2.0 * outward) == pytest.approx(0.02, rel=1e-3)
    assert np.gradient(around, angle)[1:-1] == pytest.approx(-outward[1:-1], abs=1e-5)


def test_profile_deviations_have_their_size() -> None:
    profile = plane().profile("ring_gear")
    s = np.linspace(0.0, profile.root_start, 301)
    inside = profile.crowning_weight(s) == 1.0
    slope, _ = GearDeviations(61.0, np.zeros(2), profile_slope=0.01).profile_height(profile, s)
    form, rise = GearDeviations(61.0, np.zeros(2), profile_form=0.01).profile_height(profile, s)
    assert slope[inside] == pytest.approx(0.01 * (0.5 - s[inside] / s[-1]))
    assert np.ptp(form[inside]) == pytest.approx(0.01, rel=0.1)
    assert np.gradient(form, s)[5:-5] == pytest.approx(rise[5:-5], abs=2e-3)


def test_pitch_errors_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "pitch.csv"
    path.write_text("tooth,F_um\n" + "".join(f"{k},{k % 3}.5\n" for k in range(122)))
    design = plane(
        f'deviations.ring_gear.pitch_file="{path}"', "deviations.ring_gear.pitch_column=F_um"
    )
    assert design.deviations.ring_gear.pitch_errors[:4] == [0.5, 1.5, 2.5, 0.5]
    again = design.with_values({"deviations.turns": 2})
    assert again.deviations.ring_gear.pitch_errors == design.deviations.ring_gear.pitch_errors
    with pytest.raises(
        InputError, match='pitch_column = "F" is not a column of .*: allowed tooth, F_um'
    ):
        plane(f'deviations.ring_gear.pitch_file="{path}"', "deviations.ring_gear.pitch_column=F")
    with pytest.raises(InputError, match="cannot be read: No such file"):
        plane('deviations.ring_gear.pitch_file="nowhere.csv"')


def test_seeds_and_gears_are_independent() -> None:
    def errors(seed: int, gear: str) -> np.ndarray:
        design = plane(f"deviations.{gear}.pitch_grade=6", f"deviations.seed={seed}")
        return gear_deviations(design.deviations, gear, design.teeth(gear)).pitch

    first = errors(1, "ring_gear")
    assert np.array_equal(first, errors(1, "ring_gear"))
    assert not np.allclose(first, errors(2, "ring_gear"))
    assert not np.allclose(first[:120], errors(1, "flexible_spline"), atol=1e-4)


def test_amplitudes_of_a_spectrum() -> None:
    angle = 2.0 * np.pi * np.arange(96) / 48  # two turns
    values = (
        5.0 + 3.0 * np.cos(2.0 * angle) + 0.5 * np.sin(3.5 * angle) + 0.25 * np.cos(24.0 * angle)
    )
    order, amplitude = spectrum(values, 2)
    found = dict(zip(order, amplitude))
    assert (found[2.0], found[3.5], found[24.0]) == pytest.approx((3.0, 0.5, 0.25))
    assert sum(amplitude) == pytest.approx(3.75)


def test_causes() -> None:
    design = plane(
        "deviations.ring_gear.pitch_grade=6", "deviations.flexible_spline.eccentricity=0.01"
    )
    causes = Causes(design.kinematics, design.deviations, 60)
    assert causes.of(2.0) == "ring gear (pitch), 2 per turn against it"
    assert causes.of(2.0 * 61 / 60) == "flexible spline (eccentricity), 2 per turn against it"
    assert causes.of(2 / 60) == "output, 2 per turn"
    assert causes.of(122.0) == "mesh of the teeth"
    assert " or " in Causes(design.kinematics, design.deviations, 1).of(2.0)
    odd = plane("drive.teeth_fs=119", "drive.teeth_rg=121")
    assert Causes(odd.kinematics, odd.deviations, 1).of(242.0) == "mesh of the teeth"


@pytest.mark.parametrize(("bolts", "per_turn"), [(8, 8), (9, 18)])
def test_bolts_have_orders_of_their_own(bolts: int, per_turn: int) -> None:
    """The waves pass them 1 - 1 / ratio times per turn; two waves pass an odd number twice."""
    design = shaped(bolted(bolts))
    causes = Causes(design.kinematics, design.deviations, 20)
    assert causes.of(per_turn * 1.05) == "bolts"
    assert causes.of(2 * per_turn * 1.05) == "bolts, 2 times"
    assert causes.of(42.0) == "mesh of the teeth"
    assert "bolts" not in causes.of(4.0 * 1.05)
    still = shaped(bolted(bolts), 'drive.layout="spline_fixed"')
    assert Causes(still.kinematics, None, 21).of(float(per_turn)) == "bolts"


BAD = [
    ("deviations.ring_gear.pitch_errors=[1.0, 2.0]", "has 2 values: allowed 122"),
    ("deviations.ring_gear.pitch_grade=12", "allowed 0 to 11"),
    ("deviations.ring_gear.eccentricity=-0.1", "allowed 0 to 1000000 mm"),
    ("deviations.ring_gear.eccentricity=0.2", "allowed up to 0.1 mm"),
    ("deviations.ring_gear.ovality=0.3", "allowed up to 0.1 mm"),
    ("deviations.flexible_spline.profile_slope=-200.0", "allowed up to 100 µm"),
    ("deviations.wave_generator.tilt=0.1", 'only 0 with drive.model = "plane"'),
    ("deviations.cup.eccentricity=0.1", 'only 0 with drive.model = "plane"'),
    ("deviations.turns=0", "allowed 1 to 1000"),
    ("deviations.angles_per_pitch=1.5", "a whole number"),
    ('deviations.mesh="fine"', '"coarse" or "same"'),
    ("deviations.ring_gear.pitch_column=x", "allowed with pitch_file"),
    ("deviations.ring_gear.pich_grade=5", "did you mean deviations.ring_gear.pitch_grade"),
]


@pytest.mark.parametrize(("override", "reason"), BAD)
def test_bad_deviations(override: str, reason: str) -> None:
    with pytest.raises(InputError) as caught:
        plane(override)
    message = str(caught.value)
    assert "deviations." in message and reason in message and "\n" not in message


def test_deviations_need_a_torque() -> None:
    with pytest.raises(InputError, match="load.torque = 0 holds the output: allowed above 0"):
        plane("deviations.turns=1", "load.torque=0")


def test_extremes_by_a_linear_model_are_doubtful() -> None:
    """Newton's iteration gives 0 and 10, from which the model differed by -0.5 and 1."""
    rows = [dict.fromkeys(COLUMNS, 0.0) | {"by_linear_model": 1} for _ in range(6)]
    for row, value in zip(rows, (0.0, 10.0, 9.6, 9.4, 0.9, 1.1)):
        row["transmission_error_arcsec"] = value
        row["linear_model_arcsec"] = row["linear_model_Nmm"] = float("nan")
    for row, differs in zip(rows[:2], (-0.5, 1.0)):
        row |= {"by_linear_model": 0, "linear_model_arcsec": differs, "linear_model_Nmm": 0.0}
    assert doubtful_extremes(rows) == [2, 4]
    # nothing is known of a model that was not compared
    for row in rows:
        row["linear_model_Nmm"] = float("nan")
    assert doubtful_extremes(rows) == [2, 3, 4, 5]
    assert doubtful_extremes(rows[:2]) == []
