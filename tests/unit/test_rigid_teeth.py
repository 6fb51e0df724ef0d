"""Clearance of rigid teeth against polygons: own points, own distances."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import swgpar
from support.drive_groups import PLANE
from support.paths import DATA, DRIVERS
from swgpar.design.sections import GEARS, GearName
from swgpar.profiles import ToothProfile
from swgpar.profiles.mesh_gap import OutlinePair, outline

INVOLUTES: dict[str, Any] = {
    "drive.teeth_fs": 160,
    "drive.teeth_rg": 162,
    "drive.module": 0.4,
    "drive.addendum_coef": 0.9,
    "drive.dedendum_coef": 1.2,
    "flexible_spline.rim": 1.1,
    "flexible_spline.c_P": 1.0,
    "flexible_spline.profile": {"type": "involute", "cutter_radius": 0.08},
    "ring_gear.c_P": 1.0,
    "ring_gear.profile": {"type": "involute", "cutter_radius": 0.08, "cutter_teeth": 120},
    "wave_generator": {"type": "harmonic", "face_width": 10.0},
}


ASYMMETRIC: dict[str, Any] = {
    "type": "asymmetric_parabolic",
    "C": 1.0,
    "rotational_angle": 0.5,
    "right": {"a_p": 0.0097, "C_p": 0.45, "r_c": 10.0},
    "left": {"a_p": 0.0097, "C_p": 0.55, "r_c": 10.0},
    "face_width": 10.0,
}


def half_pitch(profile: ToothProfile) -> np.ndarray:
    """Points (n,) complex from the middle of the tooth to that of the space."""
    flank = profile.point(np.linspace(0.0, profile.length, 300)) @ (1.0, 1j)
    lands = (
        (profile.r_tip_circle, 0.0, profile.polar_angle(0.0)[0]),
        (profile.r_root_circle, profile.polar_angle(profile.length)[0], np.pi / profile.n_teeth),
    )
    top, bottom = (
        1j * radius * np.exp(-1j * np.linspace(low, high, 40)) for radius, low, high in lands
    )
    return np.concatenate([top, flank, bottom])


def whole(half: np.ndarray) -> np.ndarray:
    """The outline of a whole pitch from its half, from the left to the right."""
    return np.concatenate([-np.conj(half[::-1]), half])


def to_polygon(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Distances (n,) from a line of many pieces."""
    begin, along = line[:-1], np.diff(line)
    begin, along = begin[along != 0.0], along[along != 0.0]
    share = np.clip(((points[:, None] - begin) / along).real, 0.0, 1.0)
    return np.abs(points[:, None] - begin - share * along).min(axis=1)


def smallest(design: swgpar.DriveDesign, ring: GearName, psi: np.ndarray) -> np.ndarray:
    """Smallest distances (n,) mm at the angles psi (n,); where points are in the ring gear, the
    deepest."""
    spline, internal = design.profile("flexible_spline"), design.profile(ring)
    motion, pitch = design.tooth_motion(ring=ring), 2.0 * np.pi / internal.n_teeth
    tooth, pieces = whole(half_pitch(spline)), whole(half_pitch(internal))
    line = np.concatenate([pieces * np.exp(1j * pitch * (k + 0.5)) for k in range(3, -5, -1)])
    # the radius of the ring gear's outline is a function of the angle
    polar = -np.angle(-1j * line)
    least = []
    for angle in psi:
        points = motion.pose(np.array([angle])).moved(tooth)
        points = points[np.abs(points) > internal.r_tip_circle - design.drive.module]
        wall = np.interp(-np.angle(-1j * points), polar, np.abs(line))
        distance = to_polygon(points, line[np.abs(polar) < 3.0 * pitch])
        least.append(np.where(np.abs(points) > wall, -distance, distance).min(initial=np.inf))
    return np.array(least)


@pytest.mark.parametrize(
    ("path", "values", "ring"),
    [
        (DATA / "public" / "tip_clash.toml", {}, "ring_gear"),
        (PLANE, INVOLUTES, "ring_gear"),
        (DRIVERS / "three_lobes.toml", {"ring_gear.c_P": 1.02}, "ring_gear"),
        (DRIVERS / "pancake.toml", {}, "dynamic_spline"),
        (PLANE, {"wave_generator": ASYMMETRIC}, "ring_gear"),
    ],
)
def test_no_place_is_nearer(path: Path, values: dict[str, Any], ring: GearName) -> None:
    """At the angle that is found polygons have the same distance, at others none that is
    smaller."""
    design = swgpar.load_design(path, values)
    nearest = design.rigid_teeth(ring).nearest_place()
    allowed = 2e-4 * design.drive.module
    assert smallest(design, ring, np.array([nearest.psi]))[0] == pytest.approx(
        nearest.distance, abs=allowed
    )
    every = np.linspace(-1.0, 1.0, 61) * np.pi / design.kinematics.lobes
    assert smallest(design, ring, every).min() > nearest.distance - allowed


@pytest.mark.parametrize("path", [DRIVERS / "three_lobes.toml", DATA / "public" / "tip_clash.toml"])
def test_a_place_below_a_limit_is_the_nearest_one(path: Path) -> None:
    """Above it, some place that is no nearer than the limit."""
    design = swgpar.load_design(path)
    outlines = (outline(design.profile(gear)) for gear in GEARS)
    pair = OutlinePair(*outlines, design.tooth_motion())
    known = pair.nearest_place()
    assert pair.nearest_place(below=known.distance + 1e-3) == known
    for limit in (known.distance, known.distance - 1e-3):
        assert pair.nearest_place(below=limit).distance >= limit
