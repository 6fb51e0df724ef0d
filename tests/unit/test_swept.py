"""Conjugate teeth where the envelope is undercut: the boundary of the swept area, against an area
that the test sweeps by itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import swgpar
from support.drive_groups import PLANE
from support.paths import DRIVERS
from swgpar.checks.tooth_checks import tooth_remarks
from swgpar.errors import InputError
from swgpar.profiles.envelope import Envelope
from swgpar.profiles.swept import SweptArea

CONJUGATE = {"type": "conjugate", "r_root": 0.2}
ARCS = {"type": "quadruple_arc", "r_tip": 0.2, "r_addendum": 8.0, "r_dedendum": 8.0, "r_root": 0.2}
PRINTED = {
    "drive.teeth_fs": 40,
    "drive.teeth_rg": 42,
    "drive.module": 2.075,
    "drive.addendum_coef": 1.5 / 2.075,
    "drive.dedendum_coef": 1.0,
    "flexible_spline.rim": 1.925,
    "flexible_spline.profile": ARCS,
    "ring_gear.rim": 5.0,
    "ring_gear.profile": CONJUGATE | {"r_root": 0.3, "backlash": 0.05},
}
"""A printed drive of ratio 20."""

FLAT = {
    "drive.teeth_fs": 160,
    "drive.teeth_rg": 162,
    "drive.module": 0.375,
    "drive.pressure_angle": 10.0,
    "drive.addendum_coef": 0.65,
    "drive.dedendum_coef": 1.35,
    "flexible_spline.rim": 0.75,
    "flexible_spline.profile": {"type": "trapezoid", "r_tip": 0.05, "r_root": 0.2},
    "ring_gear.profile": CONJUGATE | {"r_root": 0.1},
}
"""Straight flanks of 10 degrees, whose tip edges alone are on the boundary."""

SHARP = {
    "drive.pressure_angle": 9.0,
    "flexible_spline.profile": {"type": "trapezoid", "r_root": 0.25},
    "ring_gear.profile": CONJUGATE,
}
LOW = {"drive.pressure_angle": 10.0}
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "printed": ("ring_gear", PRINTED),
    "straight": ("ring_gear", FLAT),
    "sharp": ("ring_gear", SHARP),
    "low angle": ("ring_gear", LOW | {"ring_gear.profile": CONJUGATE}),
    "spline": ("flexible_spline", LOW | {"flexible_spline.profile": CONJUGATE}),
}


def case(name: str) -> tuple[swgpar.DriveDesign, str]:
    gear, values = CASES[name]
    return swgpar.load_design(PLANE, values), gear


def least_angles(design: swgpar.DriveDesign, gear: str, radii: np.ndarray) -> np.ndarray:
    """Smallest angles (n,) rad from the centre line of a tooth of `gear`, at radii (n,) mm, at
    which the other gear's flank passes in one of many positions, without backlash."""
    other = "flexible_spline" if gear == "ring_gear" else "ring_gear"
    flank, motion = design.profile(other), design.tooth_motion()
    s = np.linspace(0.0, flank.length, 1501)
    # the fillet is left out, along which radii are no longer in order
    s = s[
        np.abs(np.einsum("ij,ij->i", flank.tangent(s), flank.point(s))) > 0.2 * flank.r_root_circle
    ]
    points = flank.point(s) @ (1.0, 1j)
    pitch = 2.0 * np.pi / motion.teeth_rg
    least = np.full(len(radii), np.inf)
    psi = np.linspace(-1.3, 1.3, 16001)
    pose = motion.pose(psi)
    for c, angle in zip(pose.c, pose.angle, strict=True):
        if gear == "ring_gear":
            # the ring gear's tooth is half a pitch clockwise of the slot
            moved = c + np.exp(1j * angle) * points
            polar = 0.5 * pitch + np.angle(moved / 1j)
        else:
            # the ring gear's flank that faces the slot, as seen from the moving tooth
            facing = -np.conj(points * np.exp(0.5j * pitch))
            moved = (facing - c) * np.exp(-1j * angle)
            polar = -np.angle(moved / 1j)
        order = np.argsort(np.abs(moved))
        passed = np.interp(radii, np.abs(moved)[order], polar[order], left=np.inf, right=np.inf)
        least = np.minimum(least, passed)
    return least


@pytest.mark.parametrize("name", CASES)
def test_the_flank_is_the_boundary_of_the_swept_area(name: str) -> None:
    design, gear = case(name)
    flank, profile = design.profile(gear), getattr(design, gear).profile
    swept = [k for k, segment in enumerate(flank.segments) if segment.name == "swept"]
    assert swept == list(range(len(swept)))
    s = np.linspace(0.0, flank.breaks[len(swept)], 60)
    radii, angles = np.hypot(*flank.point(s).T), flank.polar_angle(s)
    turned = 0.5 * profile.backlash / design.teeth(gear).r_pitch
    left = least_angles(design, gear, radii) - turned - angles
    # positions 1.6e-4 rad apart: contacts between them are missed by the square of that times the
    # radius of curvature of the path; the path of a sharp edge by up to the way between two
    assert left.min() * radii.max() > -1e-6
    assert np.abs(left).max() * radii.max() < (3e-4 if name == "sharp" else 2e-6)
    assert design.rigid_teeth().clearance() > -1e-6 * design.drive.module
    # a corner, and only a corner, is said
    joints, h = flank.breaks[1 : len(swept)], 1e-9
    cosines = np.einsum("ij,ij->i", flank.tangent(joints - h), flank.tangent(joints + h))
    corner = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0))).max(initial=0.0)
    said = any("area that the teeth of" in sentence for sentence in tooth_remarks(design))
    assert said == (corner > 0.1)


@pytest.mark.parametrize("gear", ["ring_gear", "flexible_spline"])
def test_the_boundary_is_the_envelope_where_that_is_not_undercut(gear: str) -> None:
    design = swgpar.load_design(PLANE, {f"{gear}.profile": CONJUGATE})
    flank = design.profile(gear)
    assert "swept" not in {segment.name for segment in flank.segments}
    assert not any("swe" in sentence for sentence in tooth_remarks(design))
    other = design.profile("flexible_spline" if gear == "ring_gear" else "ring_gear")
    envelope = Envelope(other, design.tooth_motion(), 0.0)
    area = SweptArea(envelope, flank.r_tip_circle, design.drive.module, "profile")
    for curve in area.boundary():
        distance, _ = flank.distance(curve.at(np.linspace(0.0, curve.length, 40)).point)
        assert np.abs(distance).max() < 1e-10


@pytest.mark.parametrize("name", ["printed", "spline"])
def test_pieces_are_smooth_and_meet_at_corners(name: str) -> None:
    design, gear = case(name)
    flank = design.profile(gear)
    for begin, end in zip(flank.breaks[:-1], flank.breaks[1:], strict=True):
        s, h = np.linspace(begin, end, 9)[1:-1], 1e-6
        along = (flank.point(s + h) - flank.point(s - h)) / (2.0 * h)
        assert along == pytest.approx(flank.tangent(s), abs=1e-6)
        bend = (flank.tangent(s + h) - flank.tangent(s - h)) / (2.0 * h)
        curvature = np.einsum("ij,ij->i", bend, flank.normal(s))
        assert curvature == pytest.approx(flank.curvature(s), rel=1e-4, abs=1e-4)
    jumps = flank.point(flank.breaks[1:-1] - 1e-12) - flank.point(flank.breaks[1:-1])
    assert np.abs(jumps).max() < 1e-9


def test_both_ring_gears_of_a_pancake_may_be_conjugate() -> None:
    rings: dict[str, Any] = {
        f"{ring}.{key}": value
        for ring in ("ring_gear", "dynamic_spline")
        for key, value in {"profile": CONJUGATE, "c_P": 1.0, "c_l": 0.5}.items()
    }
    design = swgpar.load_design(DRIVERS / "pancake.toml", rings)
    for ring in ("ring_gear", "dynamic_spline"):
        assert abs(design.rigid_teeth(ring).clearance()) < 1e-6 * design.drive.module
        assert design.rigid_teeth(ring).mesh(phases=3).transmission_error < 0.1


def test_tips_that_reach_into_fillets_are_refused() -> None:
    """Teeth as high above the pitch circle as below: nothing is left below the tips."""
    with pytest.raises(InputError, match="these tips.*reach into the fillets.*smaller addenda"):
        swgpar.load_design(PLANE, PRINTED | {"drive.dedendum_coef": 1.5 / 2.075})


def test_a_drive_runs_on_them() -> None:
    gear = {"tip": 2, "layers": 1, "flank": 4, "root": 3, "under": 1, "rim": 1}
    values = PRINTED | {"steps.rotation": 0.0, "output.figures": False, "load.torque": 0.5}
    recipe = {"flexible_spline": gear, "ring_gear": gear}
    result = swgpar.run(swgpar.load_design(PLANE, values), mesh=recipe, progress=False)
    assert np.isfinite(result.history["fs_s1"]).all()
