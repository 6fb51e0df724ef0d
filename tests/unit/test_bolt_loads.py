"""Loads of bolts against statics: torque, tilting moment and force on a circle of bolts; sliding
and gaping."""

from __future__ import annotations

import numpy as np
import pytest

from support.cup_shapes import CLAMPED, bolted, shaped
from swgpar.drive_results.summary import known_answers
from swgpar.errors import InputError
from swgpar.evaluation.bolt_loads import BoltLoads, evaluate_bolts, tilting_moment, washer_loads
from swgpar.geometry.rotation import rotated
from swgpar.results.history import Row

BOLTS, RADIUS, WASHER = 6, 20.0, 8.0
TORQUE, MOMENT, FORCE = 30e3, 12e3, 900.0
"""N mm and N."""


def washers() -> np.ndarray:
    """Points (n, 3) mm that stand for equal areas of all washers: rings of points, with the second
    moment D² / 16 of a circle."""
    count, radii = 24, 0.5 * WASHER * np.sqrt((np.arange(10) + 0.5) / 10.0)
    angle = 2.0 * np.pi * np.arange(count) / count
    one = np.stack(np.broadcast_arrays(np.cos(angle), np.sin(angle)))[:, None] * radii[:, None]
    at = one.reshape(2, -1).T + np.array([0.0, RADIUS])
    turned = [rotated(at, np.array(2.0 * np.pi * k / BOLTS)) for k in range(BOLTS)]
    flat = np.concatenate(turned)
    return np.column_stack([flat, np.zeros(len(flat))])


def loads(places: np.ndarray, forces: np.ndarray) -> np.ndarray:
    return washer_loads(places, forces, BOLTS, RADIUS)


def test_a_torque_is_shared_by_all_bolts() -> None:
    """T / (n r) on each by a rigid flange; of washers that are not small a share is their own
    moment."""
    places = washers()
    x, y, _ = places.T
    tangential = np.column_stack([-y, x, np.zeros(len(x))])
    found = loads(places, TORQUE / np.sum(x**2 + y**2) * tangential)
    share = 1.0 / (1.0 + WASHER**2 / (8.0 * RADIUS**2))
    assert -found[:, 0] == pytest.approx(share * TORQUE / (BOLTS * RADIUS), rel=1e-12)
    assert found[:, 5] == pytest.approx((1.0 - share) * TORQUE / BOLTS, rel=1e-12)
    assert np.abs(found[:, 1:5]).max() < 1e-9 * TORQUE


def test_a_tilting_moment_is_carried_by_axial_forces() -> None:
    """2 M / (n r) cos(angle) by a rigid flange, less what washers carry by their own moments."""
    places = washers()
    y = places[:, 1]
    forces = np.zeros_like(places)
    forces[:, 2] = MOMENT / np.sum(y**2) * y
    found = loads(places, forces)
    angle = 2.0 * np.pi * np.arange(BOLTS) / BOLTS
    share = 1.0 / (1.0 + WASHER**2 / (8.0 * RADIUS**2))
    expected = share * 2.0 * MOMENT / (BOLTS * RADIUS) * np.cos(angle)
    assert found[:, 2] == pytest.approx(expected, abs=1e-9 * MOMENT)
    own = tilting_moment(found, 0.0)
    assert own == pytest.approx((1.0 - share) * MOMENT / BOLTS, rel=1e-12)


def test_a_force_goes_to_the_axes_of_every_bolt() -> None:
    """Along +y: outwards at the first bolt, clockwise a quarter of a turn behind it."""
    places = washers()
    found = loads(places, np.tile([0.0, FORCE / len(places), 0.0], (len(places), 1)))
    angle = 2.0 * np.pi * np.arange(BOLTS) / BOLTS
    assert found[:, 1] == pytest.approx(FORCE / BOLTS * np.cos(angle), abs=1e-9)
    assert found[:, 0] == pytest.approx(FORCE / BOLTS * np.sin(angle), abs=1e-9)
    # in the middle of the thickness; on a face 2 mm away it has a moment
    assert tilting_moment(found, 2.0) == pytest.approx(2.0 * FORCE / BOLTS, rel=1e-9)


def test_half_of_the_nodes_stand_for_all() -> None:
    """A washer that is cut: its nodes are at both ends of the half."""
    places = washers()
    x, y, _ = places.T
    forces = np.column_stack([-y, x, np.hypot(x, y)])
    half = (np.arctan2(-x, y) - 0.05) % (2.0 * np.pi) < np.pi
    one = washer_loads(places[half], forces[half], BOLTS, RADIUS, copies=2)
    assert one == pytest.approx(loads(places, forces), rel=1e-9, abs=1e-6)


def row(bolt: int, **values: float) -> Row:
    names = ("tangential_N", "radial_N", "axial_N", "tilting_Nmm", "twisting_Nmm")
    usual = {"increment": 3, "step": 3, "wg_angle_deg": 0.0, "bolt": bolt, "angle_deg": 60.0 * bolt}
    return {**usual, **dict.fromkeys(names, 0.0), **values}


def evaluated(*rows: Row, **keys: float) -> BoltLoads:
    cup = shaped(bolted(6, 4.0) | keys).cup
    found = evaluate_bolts(cup, list(rows), [3])
    assert found is not None
    return found


PRELOAD = {"bolt_preload": 1000.0, "joint_friction": 0.1}


def test_sliding() -> None:
    """60 and 80 N need 1000 N at mu = 0.1; 100 N that lift need 100 N more."""
    rows = row(0), row(1, tangential_N=-60.0, radial_N=80.0)
    assert evaluated(*rows, **PRELOAD).sliding == pytest.approx(1.0)
    lifted = evaluated(row(2, tangential_N=100.0, axial_N=-100.0), **PRELOAD)
    assert lifted.sliding == pytest.approx(1000.0 / 1100.0)
    assert lifted.places["sliding"].startswith("bolt 2, 120.0°")
    assert any("a washer slides" in remark for remark in lifted.remarks())


def test_gaping() -> None:
    """The pressure at the edge of a circle vanishes: F / A = N / A + M / W."""
    diameter, axial = 4.0, 200.0
    area, modulus = 0.25 * np.pi * diameter**2, np.pi * diameter**3 / 32.0
    moment = (1000.0 - axial) / area * modulus
    found = evaluated(row(1, axial_N=axial, tilting_Nmm=moment), **PRELOAD)
    assert found.gaping == pytest.approx(1.0)
    assert evaluated(row(1, axial_N=500.0), **PRELOAD).gaping == pytest.approx(2.0)


def test_a_joint_without_load_and_without_preload() -> None:
    found = {one.name: one for one in evaluated(row(0), **PRELOAD).answers()}
    assert found["bolts.sliding_safety"].value is None
    assert found["bolts.sliding_safety"].remark == "nothing loads the joint of a bolt"
    plain = evaluated(row(0, tangential_N=5.0))
    assert "bolts.sliding_safety" not in {one.name for one in plain.answers()}
    assert any("is not judged" in remark for remark in plain.remarks())
    assert evaluate_bolts(shaped(bolted(6)).cup, [row(0)], [4]) is None


def test_answers_of_a_design() -> None:
    names = {
        key: {name for name in known_answers(shaped(changes)) if name.startswith("bolts.")}
        for key, changes in (
            ("clamped", CLAMPED),
            ("bolts", bolted(6)),
            ("preload", bolted(6) | PRELOAD),
        )
    }
    assert not names["clamped"] and "bolts.shear_force" in names["bolts"]
    assert names["preload"] - names["bolts"] == {"bolts.sliding_safety", "bolts.gaping_safety"}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (CLAMPED | PRELOAD, 'cup.bolt_preload = 1000 .*only with cup.attachment = "bolted"'),
        (bolted(6) | {"bolt_preload": 1000.0}, "cup.joint_friction is missing"),
        (bolted(6) | {"joint_friction": 0.1}, "cup.joint_friction = 0.1 .*with cup.bolt_preload"),
        (bolted(6) | PRELOAD | {"joint_friction": 1.5}, "cup.joint_friction = 1.5"),
        (bolted(6) | PRELOAD | {"bolt_preload": 0.0}, "cup.bolt_preload = 0"),
    ],
)
def test_keys_that_do_not_fit(changes: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        shaped(changes)
