"""Closed curves of the gears and the cam in the section of the teeth, undeformed teeth on the
neutral line that the cam gives."""

from __future__ import annotations

import numpy as np

from swgpar.geometry.arrays import Floats, as_points
from swgpar.geometry.cams import Cam, cam_outlines
from swgpar.geometry.neutral_line import NeutralLine
from swgpar.geometry.rotation import rotated
from swgpar.meshing.drive_geometry import DriveGeometry
from swgpar.profiles import ToothMotion, ToothProfile

CHORD = 0.0025
"""Distance of a flank from the chords that are drawn for it, over the module: a tenth of a pixel
where seven teeth are seen."""

PLACES = np.linspace(0.0, 1.0, 9)
"""Places of a segment between which its tangent turns one way."""


def tooth_angles(motion: ToothMotion, cam_angle: float) -> Floats:
    """Angles (n,) rad of the flexible spline's teeth from the tip of the lobe, in the undeformed
    spline; the first one is there at the cam's angle 0, rad, and the ring gear rests."""
    angle = 2.0 * np.pi / motion.teeth_fs * np.arange(motion.teeth_fs)
    # the cam passes as many pitches of the spline as of the ring gear
    return angle - cam_angle * motion.teeth_rg / motion.teeth_fs


def moved_points(line: NeutralLine, psi: Floats, points: Floats, cam_angle: float) -> Floats:
    """Points (k, 2) mm of the undeformed spline at the angle 0, after every rotation by one of the
    angles psi (n,) rad, and the deflection; (n, k, 2)."""
    place = line.position(psi)
    middle = as_points(place)
    turned = rotated((points - [0.0, line.radius])[None], (psi + line.tilt(psi)[0])[:, None])
    return rotated(middle[:, None] + turned, cam_angle)


def body_curves(
    geometry: DriveGeometry, motion: ToothMotion, cam: Cam, cam_angle: float = 0.0
) -> dict[str, list[Floats]]:
    """Closed curves (n, 2) mm of every body, by its name.

    motion : of the flexible spline's tooth in its slot of the ring gear
    cam_angle : rad, of the cam's major axis from +y, counter-clockwise; the ring gear rests
    """
    spline, ring_gear = geometry.gears["flexible_spline"], geometry.gears["ring_gear"]
    off = CHORD * geometry.module
    ring = inner_teeth(ring_gear.profile, motion.teeth_rg, geometry.module)
    outer, line, tooth = ring_gear.outer_radius, motion.line, _tooth(spline.profile, off)
    teeth = moved_points(line, tooth_angles(motion, cam_angle), tooth, cam_angle)
    around = np.linspace(0.0, 2.0 * np.pi, 721)[:-1]
    bore = np.array([[0.0, geometry.inner_radius]])
    inside = moved_points(line, around, bore, cam_angle)
    curves = {"housing": [_circle(geometry.outer_radius), _circle(outer)]}
    return (curves if geometry.housing else {}) | {
        "ring_gear": [_circle(outer), ring],
        "flexible_spline": [teeth.reshape(-1, 2), inside.reshape(-1, 2)],
        "wave_generator": [rotated(curve[:, :2], cam_angle) for curve in cam_outlines(cam, 720)],
    }


def inner_teeth(profile: ToothProfile, teeth: int, module: float) -> Floats:
    """Closed curve (n, 2) mm of the teeth of a ring gear with a slot on +y. module : mm"""
    angle = 2.0 * np.pi / teeth * (np.arange(teeth) + 0.5)
    return rotated(_tooth(profile, CHORD * module)[None], angle[:, None]).reshape(-1, 2)


def _tooth(profile: ToothProfile, off: float) -> Floats:
    """One tooth (n, 2), mm, centred on +y, from its clockwise to its counter-clockwise root.

    off : mm, of the flank from its chords
    """
    begin, length = profile.breaks[:-1], np.diff(profile.breaks)
    angle = profile.at((begin[:, None] + length[:, None] * PLACES).ravel()).angle
    turned = np.abs(np.diff(angle.reshape(len(begin), -1))).sum(axis=1)
    # an arc leaves its chord by an eighth of its length times its angle
    counts = np.maximum(np.ceil(np.sqrt(length * turned / (8.0 * off))), 1.0).astype(int)
    s = [np.linspace(a, a + b, n + 1)[:-1] for a, b, n in zip(begin, length, counts, strict=True)]
    flank = profile.point(np.append(np.concatenate(s), profile.length))[::-1]
    return np.concatenate([flank, (flank * [-1.0, 1.0])[::-1]])


def _circle(radius: float) -> Floats:
    angle = np.linspace(0.0, 2.0 * np.pi, 361)[:-1]
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])
