"""Designs that are allowed and deserve a word: teeth that overlap and jam, torques that count as
none."""

from __future__ import annotations

import numpy as np
import pytest

import swgpar
from support.commands import execute
from support.commands import swgpar as command
from support.messages import Messages
from support.paths import DATA, DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.analysis import model_sources
from swgpar.checks.clearance import clearances
from swgpar.checks.remarks import remarks
from swgpar.design.drive_design import DriveDesign
from swgpar.design.negligible_torque import RING_FLEXIBILITY
from swgpar.evaluation.jamming import energy_remark, jamming_remark
from swgpar.evaluation.rigid_clearance import rigid_clearance
from swgpar.load.load_sequence import load_sequence

PERIOD = ("steps.rotation=9", "steps.increment=3")


def design(*overrides: str) -> DriveDesign:
    return swgpar.load_design(DESIGN, [*PLANE, *overrides])


def test_check_names_interference() -> None:
    overlapping = execute(command("check", DESIGN, "--set", "ring_gear.c_P=1.04"), timeout=120.0)
    (warning,) = [line for line in overlapping.stdout.splitlines() if line.startswith("warning: ")]
    assert (
        overlapping.returncode == 0
        and "interference: smallest flank clearance, kinematic (mm) = -0.0" in warning
    )
    assert "warning" not in execute(command("check", DESIGN), timeout=120.0).stdout


def test_check_looks_between_the_minor_axes() -> None:
    """Tip over tip at 62 degrees from the lobe, 17 degrees beyond half of the way."""
    clearance = rigid_clearance(
        clearances(swgpar.load_design(DATA / "public" / "tip_clash.toml").rigid_pairs)
    )
    assert clearance.ring_gear == pytest.approx(-0.0645, abs=1e-4)
    (sentence,) = clearance.interference
    assert "62.0° from the tip of a lobe, tip of the flexible spline to flank" in sentence
    (answer,) = clearance.answers()
    assert answer.value == clearance.ring_gear and answer.place in sentence
    assert not rigid_clearance(clearances(swgpar.load_design(DESIGN).rigid_pairs)).interference


@pytest.mark.parametrize(("samples", "shown"), [(0, None), (2, 1), (6, 3), (5, None)])
def test_angles_that_show_the_same_state_are_said(samples: int, shown: int | None) -> None:
    odd = design("drive.teeth_fs=41", "drive.teeth_rg=43", f"steps.samples={samples}", *PERIOD)
    said = [one for one in remarks(odd) if "steps.samples" in one]
    expected = f"steps.samples = {samples} shows {shown} different states of the drive"
    assert len(said) == (shown is not None) and all(one.startswith(expected) for one in said)


def test_a_thin_rim_is_said_before_it_runs() -> None:
    """0.2 modules under teeth of 1.8 modules, of a machined drive."""
    machined = swgpar.load_design(DATA / "public" / "hd40b.toml")
    (sentence,) = [one for one in remarks(machined) if "flexible_spline.rim = 0.08" in one]
    assert "0.11 of the height of the teeth (0.72 mm)" in sentence


@pytest.mark.parametrize(
    ("gear", "words"),
    [
        (
            "flexible_spline",
            "flexible spline come 18 µm nearer to those of the ring gear by growth",
        ),
        ("ring_gear", "flexible spline come 19 µm farther from those of the ring gear by growth"),
    ],
)
def test_teeth_that_come_nearer_by_growth_are_said(gear: str, words: str) -> None:
    """75 K at 12e-6 / K on pitch circles of 20 and 21 mm; bodies that grow alike are not named."""
    warm = ("material.expansion=12e-6", f"{gear}.temperature=95")
    (sentence,) = [one for one in remarks(design(*warm)) if "rigid teeth" in one]
    assert words in sentence
    both = [*warm, "flexible_spline.temperature=25", "ring_gear.temperature=25"]
    assert not [one for one in remarks(design(*both)) if "rigid teeth" in one]


def test_a_cam_longer_than_the_bore_is_said() -> None:
    """With a minor axis as large as the bore, an ellipse is longer by about half of the
    deflection."""
    bore = design().inner_radius
    longer = design(f"wave_generator.minor_axis={2.0 * bore}")
    (sentence,) = [one for one in remarks(longer) if "longer than the bore" in one]
    line = longer.tooth_motion().line
    assert line.stretch == pytest.approx(0.25 * longer.deflection / line.radius, rel=0.05)
    assert f"by {100.0 * line.stretch:.3g} %" in sentence
    hoop = line.stretch * longer.materials["flexible_spline"].modulus
    assert f"{hoop:.4g} MPa" in sentence
    assert not [one for one in remarks(design()) if "longer than the bore" in one]


def test_a_run_says_it_before_it_computes(monkeypatch: pytest.MonkeyPatch) -> None:
    class Begun(Exception):
        pass

    def begin(*_: object, **__: object) -> None:
        raise Begun

    monkeypatch.setattr(model_sources, "build_drive_model", begin)
    with Messages() as messages, pytest.raises(Begun):
        swgpar.run(design("ring_gear.c_P=1.06", *PERIOD), RECIPE, plain=True)
    assert sum("interference: smallest flank clearance" in text for text in messages.texts) == 1


def test_a_departure_from_the_energy_balance_has_its_pair() -> None:
    good = design(*PERIOD)
    rows = [
        {"wg_angle_deg": angle, "wg_torque_Nmm": torque}
        for angle, torque in ((3.0, 9.0), (6.0, 5.0), (9.0, 13.0))
    ]
    columns = "wg_angle_deg", "tooth", "ring_tooth", "angle_deg", "force_N", "torque_Nmm"
    pairs = [
        dict(zip(columns, values))
        for values in (
            (6.0, 5, 6, 66.0, 7.0, 40.0),
            (6.0, 1, 1, 8.0, 9.0, -90.0),
            (9.0, 2, 2, 8.0, 9.0, 90.0),
            (9.0, 3, 3, 12.0, 5.0, -30.0),
        )
    ]

    def remark(mean: float, left: float = 0.0, *, friction: bool = False) -> str | None:
        sequence, torque = load_sequence(good), {"wg_torque_Nmm": mean}
        return energy_remark(sequence, rows, torque, left, pairs, friction=friction)

    low, high = remark(9.0), remark(12.0)
    assert "by 10 %, more than its error of 5 %: most at 6° of the wave generator, where" in low
    assert "where tooth 5 of the flexible spline pushes on tooth 6 of the ring gear with 7 N" in low
    assert "most at 9° of the wave generator, where tooth 3 " in high
    assert remark(9.0, left=0.6) is None and remark(9.6) is None
    assert remark(12.0, friction=True) is None and remark(9.0, friction=True)


def test_a_jammed_drive_is_named() -> None:
    with Messages() as messages:
        result = swgpar.run(design("ring_gear.c_P=1.06", *PERIOD), RECIPE, plain=True)
    remark = result.summary.rotation.jammed
    assert "N·mm is far from the 10 N·mm of the energy balance, most at " in remark
    assert "the teeth may jam" in remark and " of the flexible spline pushes on tooth " in remark
    assert messages.texts.count(remark) == 1


def test_a_run_that_departs_from_its_energy_balance_names_the_pair() -> None:
    """Flanks that overlap by micrometres: the input torque is off by a third, but not jammed."""
    result = swgpar.run(design("ring_gear.c_P=1.04", *PERIOD), RECIPE, plain=True)
    rotation = result.summary.rotation
    assert rotation.jammed is None and "departs from the 10 N·mm of the energy" in rotation.energy
    pushing = {(int(a), int(b)) for a, b in zip(result.pairs["tooth"], result.pairs["ring_tooth"])}
    words = (f"tooth {a} of the flexible spline pushes on tooth {b} of" for a, b in pushing)
    assert any(word in rotation.energy for word in words)


def test_few_angles_may_be_what_a_mean_torque_departs_by() -> None:
    """22 N·mm in place of 10, of values that scatter by 400."""
    sequence = load_sequence(design(*PERIOD))
    torques = (-180.0, 60.0, 216.0, 100.0, -86.0)
    rows = [
        {"wg_angle_deg": 1.8 * (k + 1), "wg_torque_Nmm": torque} for k, torque in enumerate(torques)
    ]
    few = "5 angles are too few for the mean of a torque that varies by 396 N·mm: steps.samples"
    for mean, scatters, said in ((22.0, True, True), (120.0, True, False), (22.0, False, False)):
        sampled = rows if scatters else [{**row, "wg_torque_Nmm": mean} for row in rows]
        remark = jamming_remark(sequence, sampled, {"wg_torque_Nmm": mean}, 0.0, [])
        assert remark is not None
        assert remark.endswith(few) == said
    departs = energy_remark(sequence, rows, {"wg_torque_Nmm": 15.0}, 0.0, [], friction=False)
    assert departs is not None
    assert departs.endswith(few)


def test_a_running_drive_is_not() -> None:
    good = design(*PERIOD)
    sequence = load_sequence(good)
    rows = [
        {"wg_angle_deg": angle, "wg_torque_Nmm": torque}
        for angle, torque in ((3.0, 9.0), (6.0, 8.0), (9.0, 13.0))
    ]
    expected = 1000.0 * good.load.torque / abs(good.kinematics.ratio)
    assert expected == pytest.approx(10.0)
    unloaded = load_sequence(design("load.torque=0", *PERIOD))
    for mean, jams in (
        (10.0, False),
        (5.1, False),
        (19.9, False),
        (4.9, True),
        (20.1, True),
        (-10.0, True),
    ):
        assert bool(jamming_remark(sequence, rows, {"wg_torque_Nmm": mean}, 0.0, [])) == jams
        assert (
            jamming_remark(sequence, rows[:1], {"wg_torque_Nmm": mean}, 0.0, []) is None
        )  # less than a period
        assert jamming_remark(unloaded, rows, {"wg_torque_Nmm": mean}, 0.0, []) is None
    assert jamming_remark(sequence, [], {}, 0.0, []) is None


def test_the_ring_between_two_forces() -> None:
    """Castigliano: the change of the diameter from the bending moment F r (1 / pi - sin(phi) /
    2)."""
    phi = (np.arange(4000) + 0.5) * 0.5 * np.pi / 4000
    moment = 1.0 / np.pi - 0.5 * np.sin(phi)
    assert RING_FLEXIBILITY == pytest.approx(4.0 * np.mean(moment**2) * 0.5 * np.pi, rel=1e-6)


@pytest.mark.parametrize("share", [1e-5, 0.99, 1.01, 3.0])
def test_small_torques_converge_or_count_as_none(share: float) -> None:
    """1e-5 of the smallest torque that is resolved is less than 1e-9 N·m."""
    least = 1e-3 * design().negligible_torque
    torque = share * least
    assert 1e-5 * least < 1e-9
    with Messages() as messages:
        result = swgpar.run(
            design(f"load.torque={torque!r}", "steps.rotation=2", "steps.increment=2"),
            RECIPE,
            plain=True,
        )
    counts_as_none = [text for text in messages.texts if "counts as none" in text]
    assert len(counts_as_none) == (1 if share < 1.0 else 0)
    held = result.history["output_angle_deg"][
        -1
    ]  # without a torque the output is held at its kinematic angle
    assert (abs(held - 2.0 / result.summary.ratio) < 1e-9) == (share < 1.0)
