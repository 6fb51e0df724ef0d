"""Gap between the flank of a moving tooth and the flank of the ring gear that it faces, both
rigid."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from swgpar.geometry.arrays import Floats
from swgpar.geometry.profiles.flank import ToothProfile
from swgpar.geometry.profiles.tooth_motion import ToothMotion

SAMPLES = 1001
"""Points of the ring gear's flank among which the neighbours of a point are found first."""


def smallest_gaps(
    spline: ToothProfile,
    ring: ToothProfile,
    motion: ToothMotion,
    psi: Floats,
    n_points: int = 200,
    rotation: Floats | float = 0.0,
    exact_below: float = np.inf,
) -> Floats:
    """Smallest signed distance (n,) mm of the flexible spline's flank from the ring gear's, below 0
    where they overlap.

    The flank is the one at x > 0 of the spline's tooth. inf where it is not in the slot.

    psi : (n,) rad, material angles of the tooth
    n_points : points on its flank
    rotation : rad, of the spline's material beyond its place in the slot; scalar or (n,)
    exact_below : mm; wider gaps are those to the nearest of `SAMPLES` points, which are no smaller
    """
    x, y = spline.point(np.linspace(0.0, spline.length, n_points)).T
    rotation = np.broadcast_to(rotation, psi.shape)
    pose = motion.pose(psi + rotation)
    slip = np.exp(1j * motion.teeth_fs / motion.teeth_rg * rotation)
    z = slip[:, None] * (pose.c[:, None] + np.exp(1j * pose.angle)[:, None] * (x + 1j * y))
    w = motion.mirrored(z)
    points = np.stack((w.real, w.imag), axis=-1)
    samples = np.linspace(0.0, ring.length, SAMPLES)
    tree, normal = cKDTree(ring.point(samples)), ring.normal(samples)
    rough, index = tree.query(points)
    offset = points - tree.data[index]
    rough = np.copysign(rough, np.einsum("ijk,ijk->ij", offset, normal[index]))
    rough[np.abs(w) <= ring.r_tip_circle] = np.inf
    # the exact distance is computed for the nearest points only
    lowest = rough.min(axis=1)
    near = (
        (rough < lowest[:, None] + 2.0 * samples[1])
        & (lowest < exact_below)[:, None]
        & np.isfinite(rough)
    )
    gaps = np.where((lowest < exact_below)[:, None], np.inf, rough)
    if near.any():
        gaps[near] = ring.distance(points[near])[0]
    return gaps.min(axis=1)
