"""Derived geometry of a design, for `swgpar check`."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.cams import pin_travel, taut_length
from swgpar.geometry.rotation import rotated


def flank_clearance(design: DriveDesign, n_angles: int = 721, n_points: int = 200) -> float:
    """Smallest distance (mm; negative is interference) between the undeformed flanks in the deflected position.

    Kinematics of an inextensible ring: radial w = d/2 cos 2 psi, tangential v = -d/4 sin 2 psi, tilt (v - w') / r at
    the mid-line of the rim; clockwise flank of the tooth against the ring gear's flank it faces.
    """
    spline, ring = design.profile("flexible_spline"), design.profile("ring_gear")
    r = design.r_fs + 0.5 * design.flexible_spline.rim
    psi = np.linspace(-0.25 * np.pi, 0.25 * np.pi, n_angles)
    w, v = 0.5 * design.d * np.cos(2.0 * psi), -0.25 * design.d * np.sin(2.0 * psi)
    turn = psi + (v + design.d * np.sin(2.0 * psi)) / r
    # flank relative to its tooth's place on the mid-line, turned, then set down at the deflected place
    place = ((r + w) * np.array([-np.sin(psi + v / r), np.cos(psi + v / r)])).T
    flank = spline.point(np.linspace(0.0, spline.length, n_points))
    samples = np.linspace(0.0, ring.length, 1001)
    tree, normal = cKDTree(ring.point(samples)), ring.normal(samples)
    smallest = np.inf
    for side in (1.0, -1.0):
        x = place[:, None] + rotated(flank * [side, 1.0] - [0.0, r], turn[:, None])
        # in the frame of the wave generator the slot that goes with a tooth at psi is at psi N_fs / N_rg
        angle = psi * design.drive.teeth_fs / design.drive.teeth_rg - side * np.pi / design.drive.teeth_rg
        in_ring = (rotated(x, -angle[:, None]) * [-side, 1.0]).reshape(-1, 2)
        in_ring = in_ring[np.hypot(*in_ring.T) > ring.r_tip_circle]
        if len(in_ring):
            # to the nearest sample first, so that the exact distance is needed for the nearest points only
            rough, index = tree.query(in_ring)
            rough = np.copysign(rough, np.einsum("ij,ij->i", in_ring - tree.data[index], normal[index]))
            near = rough < rough.min() + 2.0 * samples[1]
            smallest = min(smallest, float(ring.distance(in_ring[near])[0].min()))
    return smallest


def derived_geometry(design: DriveDesign) -> dict[str, float]:
    """Names with units, and values."""
    spline, ring = design.profile("flexible_spline"), design.profile("ring_gear")
    cam = design.cam()
    return {
        "ratio (wave generator / output)": design.ratio,
        "d, diametral deflection (mm)": design.d,
        "a, major semi-axis (mm)": design.a,
        "b, half width of the cam (mm)": float(cam.outline(7200)[:, 0].max()),
        "taut length of cam / inner perimeter - 1": taut_length(cam) / (2.0 * np.pi * design.r_fs) - 1.0,
        "travel of the pins (mm)": pin_travel(cam, design.r_fs),
        "r_fs, inner radius of the spline (mm)": design.r_fs,
        "backlash at the pitch circle (mm)": design.backlash,
        "gamma, turn that closes it (deg)": float(np.degrees(design.gamma)),
        **({"cup thickness (mm)": design.cup_thickness} if design.drive.model == "cup" else {}),
        "tooth height, flexible spline (mm)": spline.r_tip_circle - spline.r_root_circle,
        "tooth height, ring gear (mm)": ring.r_root_circle - ring.r_tip_circle,
        "top land, flexible spline (mm)": spline.top_land,
        "top land, ring gear (mm)": ring.top_land,
        "root land, flexible spline (mm)": spline.root_land,
        "root land, ring gear (mm)": ring.root_land,
        "tip of spline to root of ring, major axis (mm)": ring.r_root_circle - spline.r_tip_circle - 0.5 * design.d,
        "tip of ring to root of spline, major axis (mm)": ring.r_tip_circle - spline.r_root_circle - 0.5 * design.d,
        "tips at the minor axis (mm)": ring.r_tip_circle - spline.r_tip_circle + 0.5 * design.d,
        "smallest flank clearance, kinematic (mm)": flank_clearance(design),
    }
