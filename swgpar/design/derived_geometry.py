"""Derived geometry of a design, for `swgpar check`."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.cams import pin_travel, taut_length
from swgpar.geometry.rotation import rotated


def flank_clearance(design: DriveDesign, n_angles: int = 721, n_points: int = 200) -> float:
    """Smallest distance (mm; negative is interference) between the undeformed flanks in the deflected position.

    Kinematics of an inextensible ring: at the mid-line of the rim radial displacement w = d/2 cos 2 psi, tangential
    v = -d/4 sin 2 psi and rotation (v - w') / r. The clockwise flank of a tooth is compared with the ring gear's flank
    it faces, and its mirror image likewise.

    n_angles : angles psi of the tooth within a quarter;  n_points : points on its flank
    """
    spline, ring = design.profile("flexible_spline"), design.profile("ring_gear")
    r = design.inner_radius + 0.5 * design.flexible_spline.rim
    psi = np.linspace(-0.25 * np.pi, 0.25 * np.pi, n_angles)
    w, v = 0.5 * design.deflection * np.cos(2.0 * psi), -0.25 * design.deflection * np.sin(2.0 * psi)
    tooth_angle = psi + (v + design.deflection * np.sin(2.0 * psi)) / r
    # the flank relative to its tooth's point on the mid-line is rotated, then moved to the deflected point
    midline = ((r + w) * np.array([-np.sin(psi + v / r), np.cos(psi + v / r)])).T
    flank = spline.point(np.linspace(0.0, spline.length, n_points))
    samples = np.linspace(0.0, ring.length, 1001)
    tree, normal = cKDTree(ring.point(samples)), ring.normal(samples)
    smallest = np.inf
    for side in (1.0, -1.0):
        x = midline[:, None] + rotated(flank * [side, 1.0] - [0.0, r], tooth_angle[:, None])
        # in the frame of the wave generator the slot of a tooth at psi is at psi N_fs / N_rg
        slot_angle = psi * design.drive.teeth_fs / design.drive.teeth_rg - side * np.pi / design.drive.teeth_rg
        in_ring = (rotated(x, -slot_angle[:, None]) * [-side, 1.0]).reshape(-1, 2)
        in_ring = in_ring[np.hypot(*in_ring.T) > ring.r_tip_circle]
        if len(in_ring):
            # distance to the nearest sample first: the exact one is computed for the nearest points only
            rough, index = tree.query(in_ring)
            rough = np.copysign(rough, np.einsum("ij,ij->i", in_ring - tree.data[index], normal[index]))
            near = rough < rough.min() + 2.0 * samples[1]
            smallest = min(smallest, float(ring.distance(in_ring[near])[0].min()))
    return smallest


def derived_geometry(design: DriveDesign) -> dict[str, float]:
    """Quantities that follow from a design: names with units, and values. `swgpar check` prints them."""
    spline, ring = design.profile("flexible_spline"), design.profile("ring_gear")
    cam, half = design.cam(), 0.5 * design.deflection
    return {
        "ratio (wave generator / output)": design.ratio,
        "d, diametral deflection (mm)": design.deflection,
        "a, major semi-axis (mm)": design.major_semi_axis,
        "b, half width of the cam (mm)": float(cam.outline(7200)[:, 0].max()),
        "taut length of cam / inner perimeter - 1": taut_length(cam) / (2.0 * np.pi * design.inner_radius) - 1.0,
        "travel of the pins (mm)": pin_travel(cam, design.inner_radius),
        "r_fs, inner radius of the spline (mm)": design.inner_radius,
        "backlash at the pitch circle (mm)": design.backlash,
        "gamma, rotation that closes it (deg)": float(np.degrees(design.backlash_angle)),
        **({"cup thickness (mm)": design.cup_thickness} if design.drive.model == "cup" else {}),
        "tooth height, flexible spline (mm)": spline.r_tip_circle - spline.r_root_circle,
        "tooth height, ring gear (mm)": ring.r_root_circle - ring.r_tip_circle,
        "top land, flexible spline (mm)": spline.top_land,
        "top land, ring gear (mm)": ring.top_land,
        "root land, flexible spline (mm)": spline.root_land,
        "root land, ring gear (mm)": ring.root_land,
        "tip of spline to root of ring, major axis (mm)": ring.r_root_circle - spline.r_tip_circle - half,
        "tip of ring to root of spline, major axis (mm)": ring.r_tip_circle - spline.r_root_circle - half,
        "tips at the minor axis (mm)": ring.r_tip_circle - spline.r_tip_circle + half,
        "smallest flank clearance, kinematic (mm)": flank_clearance(design),
    }
