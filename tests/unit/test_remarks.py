"""Designs that are allowed and deserve a word: teeth that overlap and jam, torques that count as
none."""

from __future__ import annotations

import numpy as np
import pytest

import swgpar
from support.commands import execute
from support.commands import swgpar as command
from support.messages import Messages
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.jamming import jamming_remark
from swgpar.load.load_sequence import load_sequence
from swgpar.load.negligible_torque import RING_FLEXIBILITY, negligible_torque

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


def test_a_jammed_drive_is_named() -> None:
    with Messages() as messages:
        result = swgpar.run(design("ring_gear.c_P=1.04", *PERIOD), RECIPE, plain=True)
    remark = result.summary.rotation.jammed
    assert "N·mm is far from the 10 N·mm of the energy balance: the teeth may jam" in remark
    assert messages.texts.count(remark) == 1


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
        assert bool(jamming_remark(sequence, rows, {"wg_torque_Nmm": mean}, 0.0)) == jams
        assert (
            jamming_remark(sequence, rows[:1], {"wg_torque_Nmm": mean}, 0.0) is None
        )  # less than a period
        assert jamming_remark(unloaded, rows, {"wg_torque_Nmm": mean}, 0.0) is None
    assert jamming_remark(sequence, [], {}, 0.0) is None


def test_the_ring_between_two_forces() -> None:
    """Castigliano: the change of the diameter from the bending moment F r (1 / pi - sin(phi) /
    2)."""
    phi = (np.arange(4000) + 0.5) * 0.5 * np.pi / 4000
    moment = 1.0 / np.pi - 0.5 * np.sin(phi)
    assert RING_FLEXIBILITY == pytest.approx(4.0 * np.mean(moment**2) * 0.5 * np.pi, rel=1e-6)


@pytest.mark.parametrize("share", [1e-5, 0.99, 1.01, 3.0])
def test_small_torques_converge_or_count_as_none(share: float) -> None:
    """1e-5 of the smallest torque that is resolved is less than 1e-9 N·m."""
    least = 1e-3 * negligible_torque(design())
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
