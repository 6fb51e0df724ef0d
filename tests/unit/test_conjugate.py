"""Conjugate teeth: the exact motion of a tooth, the envelope of the other flank, and what is
refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import swgpar
from support.drive_groups import PLANE
from support.paths import REFERENCE
from swgpar.checks.derived_geometry import derived_geometry
from swgpar.errors import InputError

RING = {"type": "conjugate", "r_root": 0.2}


def design(
    gear: str = "ring_gear", profile: dict[str, Any] = RING, **values: Any
) -> swgpar.DriveDesign:
    changed = {
        f"{gear}.profile": profile,
        **{key.replace("__", "."): value for key, value in values.items()},
    }
    return swgpar.load_design(PLANE, changed)


def test_the_neutral_line_is_closed_and_keeps_its_length() -> None:
    line = swgpar.load_design(PLANE).tooth_motion().line
    theta = np.linspace(0.0, 2.0 * np.pi, 4001)
    points = line.position(theta)
    assert abs(points[-1] - points[0]) < 1e-12 * line.radius
    step = theta[1]
    # the chord of an arc of this curvature, about 1 / r
    lengths = np.abs(np.diff(points)) / (2.0 * line.stretched * np.sin(0.5 * step))
    assert lengths == pytest.approx(1.0, abs=1e-6)
    # its tangent turns by the tilt that the motion uses
    tilt = line.tilt(theta[:-1] + 0.5 * step)[0]
    assert np.angle(
        np.diff(points) / (-np.exp(1j * (theta[:-1] + 0.5 * step + tilt)))
    ) == pytest.approx(0.0, abs=1e-7)


def test_the_motion_has_its_derivatives_and_its_inverse() -> None:
    motion, psi, h = swgpar.load_design(PLANE).tooth_motion(), np.linspace(-1.0, 1.0, 41), 1e-5
    for choose in (lambda pose: pose, lambda pose: pose.inverse()):
        low, here, high = (choose(motion.pose(psi + step)) for step in (-h, 0.0, h))
        assert here.c1 == pytest.approx((high.c - low.c) / (2.0 * h), abs=1e-6)
        assert here.c2 == pytest.approx((high.c1 - low.c1) / (2.0 * h), abs=1e-6)
        assert here.angle1 == pytest.approx((high.angle - low.angle) / (2.0 * h), abs=1e-8)
        assert here.angle2 == pytest.approx((high.angle1 - low.angle1) / (2.0 * h), abs=1e-6)
    pose, point = motion.pose(psi), np.full(41, 0.5 + 60.0j)
    assert pose.inverse().moved(pose.moved(point)) == pytest.approx(point, abs=1e-12)


@pytest.mark.parametrize("gear", ["ring_gear", "flexible_spline"])
def test_rigid_teeth_transmit_without_error(gear: str) -> None:
    drive = design(gear)
    assert drive.rigid_teeth().mesh(phases=5).transmission_error < 0.1
    assert abs(drive.rigid_teeth().clearance()) < 1e-6


def test_the_quadruple_arc_has_a_transmission_error() -> None:
    """The same measure sees the error of teeth that are not conjugate."""
    assert swgpar.load_design(PLANE).rigid_teeth().mesh(phases=5).transmission_error > 0.3


def test_teeth_that_overlap_at_every_rotation_have_no_transmission_error() -> None:
    """Rollers press the rigid teeth 0.3 mm into each other; `check` then leaves its lines out."""
    rollers = {"type": "four_roller", "beta": 25.0, "r_4": 15.0, "face_width": 10.0}
    drive = swgpar.load_design(PLANE, {"wave_generator": rollers})
    assert drive.rigid_teeth().clearance() < -0.1
    assert drive.rigid_teeth().mesh(phases=5).transmission_error == np.inf
    values = derived_geometry(drive)
    assert np.isfinite(list(values.values())).all() and not any("rigid" in name for name in values)
    assert any("rigid" in name for name in derived_geometry(swgpar.load_design(PLANE)))


def test_the_curvature_is_that_of_the_tangents() -> None:
    flank = design(profile={**RING, "r_tip": 0.1}, ring_gear__tip_relief=0.02).profile("ring_gear")
    assert [segment.name for segment in flank.segments][:2] == ["tip", "relief"]
    for begin, end in zip(flank.breaks[:-1], flank.breaks[1:]):
        s, h = np.linspace(begin, end, 9)[1:-1], 1e-6
        change = (flank.tangent(s + h) - flank.tangent(s - h)) / (2.0 * h)
        assert np.einsum("ij,ij->i", change, flank.normal(s)) == pytest.approx(
            flank.curvature(s), abs=1e-4
        )
        along = (flank.point(s + h) - flank.point(s - h)) / (2.0 * h)
        assert along == pytest.approx(flank.tangent(s), abs=1e-6)


def test_backlash_and_relief_are_taken_from_the_teeth() -> None:
    plain = design()
    loose = design(profile={**RING, "backlash": 0.02}, ring_gear__tip_relief=0.01)
    assert loose.backlash - plain.backlash == pytest.approx(0.02, abs=1e-6)
    lands = [each.profile("ring_gear").top_land for each in (plain, loose)]
    # both flanks give the relief and half of the backlash, at the addendum circle
    scale = plain.profile("ring_gear").r_tip_circle / plain.teeth("ring_gear").r_pitch
    assert lands[0] - lands[1] == pytest.approx(0.02 * scale + 0.02, rel=1e-6)


@pytest.mark.parametrize(
    ("profile", "values", "words"),
    [
        (RING, {"ring_gear__c_P": 0.9}, "ring_gear.profile.backlash"),
        ({**RING, "r_root": 0.9}, {}, "ring_gear.profile"),
        ({**RING, "r_tip": 2.0}, {}, "r_tip"),
        (RING, {"ring_gear__tip_relief": 0.5}, "ring_gear.tip_relief = 0.5"),
        ({**RING, "section": 1.0}, {}, "ring_gear.profile.section"),
        (RING, {"flexible_spline__profile": RING}, "one of flexible_spline and ring_gear only"),
    ],
)
def test_what_gives_no_teeth_is_refused(
    profile: dict[str, Any], values: dict[str, Any], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        design(profile=profile, **values)


@pytest.mark.parametrize("r_root", [0.02, 1.0])
def test_without_a_land_the_refusal_names_the_backlash(r_root: float) -> None:
    """On the reference cup no radius of the root mends it."""
    profile = {"type": "conjugate", "r_root": r_root}
    changes = {"ring_gear.c_P": 1.0, "ring_gear.profile": profile}
    words = r"make ring_gear\.profile\.backlash larger, which makes its teeth thinner"
    with pytest.raises(InputError, match=words):
        swgpar.load_design(REFERENCE, changes)
    mended = {"ring_gear.profile.backlash": 0.6, "ring_gear.profile.r_root": 0.1}
    swgpar.load_design(REFERENCE, {**changes, **mended})
