"""Derived geometry of a design, for `swgpar check`."""

from __future__ import annotations

import numpy as np

from swgpar.design import DriveDesign
from swgpar.profiles import make_profile


def flank_clearance(design: DriveDesign, n_angles: int = 721, n_points: int = 200) -> float:
    """Smallest distance (mm; negative is interference) between the undeformed flanks in the deflected position.

    Kinematics of an inextensible ring: radial w = d/2 cos 2 psi, tangential v = -d/4 sin 2 psi, tilt (v - w') / r at
    the mid-line of the rim; clockwise flank of the tooth against the ring gear's flank it faces.
    """
    spline, ring = make_profile(design, "flexible_spline"), make_profile(design, "ring_gear")
    r = design.r_fs + 0.5 * design.flexible_spline.rim
    s = np.linspace(0.0, spline.length, n_points)
    smallest = np.inf
    for psi in np.linspace(-0.25 * np.pi, 0.25 * np.pi, n_angles):
        w, v = 0.5 * design.d * np.cos(2.0 * psi), -0.25 * design.d * np.sin(2.0 * psi)
        tilt = (v + design.d * np.sin(2.0 * psi)) / r
        # flank relative to its tooth's place on the mid-line, turned, then set down at the deflected place
        place = (r + w) * np.array([-np.sin(psi + v / r), np.cos(psi + v / r)])
        turn = psi + tilt
        for side in (1.0, -1.0):
            local = spline.point(s) * [side, 1.0] - [0.0, r]
            x = place + np.column_stack(
                [
                    np.cos(turn) * local[:, 0] - np.sin(turn) * local[:, 1],
                    np.sin(turn) * local[:, 0] + np.cos(turn) * local[:, 1],
                ]
            )
            # in the frame of the wave generator the slot that goes with a tooth at psi is at psi N_fs / N_rg
            angle = psi * design.drive.teeth_fs / design.drive.teeth_rg - side * np.pi / design.drive.teeth_rg
            c, sn = np.cos(angle), np.sin(angle)
            local_ring = np.column_stack([c * x[:, 0] + sn * x[:, 1], -sn * x[:, 0] + c * x[:, 1]]) * [-side, 1.0]
            inside = np.hypot(*local_ring.T) > ring.r_tip_circle
            if inside.any():
                smallest = min(smallest, float(ring.distance(local_ring[inside])[0].min()))
    return smallest


def derived_geometry(design: DriveDesign) -> dict[str, float]:
    """Names with units, and values."""
    spline, ring = make_profile(design, "flexible_spline"), make_profile(design, "ring_gear")
    m = design.drive.module
    return {
        "ratio (wave generator / output)": design.ratio,
        "d, diametral deflection (mm)": design.d,
        "a, major semi-axis (mm)": design.a,
        "b, minor semi-axis (mm)": design.b,
        "r_fs, inner radius of the spline (mm)": design.r_fs,
        "backlash at the pitch circle (mm)": 0.5
        * np.pi
        * m
        * (2.0 - design.ring_gear.c_P - design.flexible_spline.c_P),
        "gamma, turn that closes it (deg)": float(np.degrees(design.gamma)),
        "cup thickness (mm)": design.cup_thickness,
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
