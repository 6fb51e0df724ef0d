"""Derived geometry of a design, for `swgpar check`."""

from __future__ import annotations

import numpy as np

from swgpar.checks.clearance import WORDS, Clearance, clearances
from swgpar.checks.inertia import negligible_speeds
from swgpar.checks.strain_checks import deflection_strain
from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.cams import Cam, OffsetCam, PolarCam, pin_travel, taut_length
from swgpar.geometry.paired_lines import thicknesses
from swgpar.profiles import Points
from swgpar.profiles.from_points import fitted_flank
from swgpar.profiles.rigid_teeth import RigidMesh

SAME = 1e-9
"""Share by which equal thicknesses differ."""


def _smallest(cam: Cam, lobes: int) -> dict[str, float]:
    """Smallest size of the cam: its half width, or its radius between three lobes."""
    outline = cam.outline(7200)
    if lobes == 2:
        return {"b, half width of the cam (mm)": float(outline[:, 0].max())}
    return {"b, smallest radius of the cam (mm)": float(np.hypot(*outline.T).min())}


def _deviation(cam: Cam) -> dict[str, float]:
    """Deviation of a cam from its points, or from its expression; none of other cams."""
    curve = cam.cam if isinstance(cam, OffsetCam) else cam
    if not isinstance(curve, PolarCam):
        return {}
    return {"largest deviation of the cam from what is given (mm)": curve.deviation}


def derived_geometry(design: DriveDesign) -> dict[str, float]:
    """Quantities that follow from a design: names with units, and values. `swgpar check` prints
    them."""
    spline, ring = design.profile("flexible_spline"), design.profile("ring_gear")
    cam, line, every = design.cam(), design.tooth_motion().line, clearances(design.rigid_pairs)
    lobe, valley = line.deflections
    driving = "ring gear" if design.kinematics.wave_generator_is_fixed else "wave generator"
    return {
        f"ratio ({driving} / output)": design.kinematics.input_ratio,
        "d, diametral deflection (mm)": design.deflection,
        "a, major semi-axis (mm)": design.major_semi_axis,
        **_smallest(cam, design.wave_generator.lobes),
        **_deviation(cam),
        "taut length of cam / inner perimeter - 1": taut_length(cam)
        / (2.0 * np.pi * design.inner_radius)
        - 1.0,
        "stretch of the neutral line": line.stretch,
        "largest strain of a rim without teeth": deflection_strain(design),
        "radial deflection at the major axis (mm)": lobe,
        "radial deflection at the major axis (modules)": lobe / design.drive.module,
        "travel of the pins (mm)": pin_travel(
            cam, design.inner_radius, design.wave_generator.lobes
        ),
        "r_fs, inner radius of the spline (mm)": design.inner_radius,
        "backlash at the pitch circle (mm)": design.backlash,
        "gamma, rotation that closes it (deg)": float(np.degrees(design.backlash_angle)),
        "outer diameter (mm)": 2.0 * design.geometry.largest_radius,
        **_cup(design),
        **_points(design),
        "tooth height, flexible spline (mm)": spline.r_tip_circle - spline.r_root_circle,
        "tooth height, ring gear (mm)": ring.r_root_circle - ring.r_tip_circle,
        "top land, flexible spline (mm)": spline.top_land,
        "top land, ring gear (mm)": ring.top_land,
        "root land, flexible spline (mm)": spline.root_land,
        "root land, ring gear (mm)": ring.root_land,
        "tip of spline to root of ring, major axis (mm)": ring.r_root_circle
        - spline.r_tip_circle
        - lobe,
        "tip of ring to root of spline, major axis (mm)": ring.r_tip_circle
        - spline.r_root_circle
        - lobe,
        "tips at the minor axis (mm)": ring.r_tip_circle - spline.r_tip_circle - valley,
        **_clearance(every[0]),
        **_growth(design),
        **negligible_speeds(design.rim_inertia, design.kinematics),
        **_dynamic_spline(design),
        **_clearance(*every[1:]),
        **_rigid_contact(design.rigid_teeth().mesh()),
    }


def _clearance(*every: Clearance) -> dict[str, float]:
    """Smallest clearances and where they are."""
    values = {}
    for clearance in every:
        name = WORDS[clearance.ring]
        values[name] = clearance.nearest.distance
        values[f"angle from the lobe of the {name.replace(' (mm)', ' (deg)')}"] = abs(
            clearance.angle_deg
        )
    return values


def _rigid_contact(rigid: RigidMesh) -> dict[str, float]:
    """Quantities of rigid teeth; none where their first contact is not defined."""
    if not np.isfinite(rigid.transmission_error):
        return {}
    return {
        "transmission error of rigid teeth (arcsec)": rigid.transmission_error,
        "share of rigid teeth within 1 µm of contact": rigid.teeth_share,
    }


def _points(design: DriveDesign) -> dict[str, float]:
    """How far flanks are from the points they are made of, and may be between them."""
    values = {}
    for gear in design.gears:
        profile, name = getattr(design, gear).profile, gear.replace("_", " ")
        if isinstance(profile, Points):
            fitted = fitted_flank(profile, design.teeth(gear), f"{gear}.profile")
            values[f"largest deviation of the {name} from its points (mm)"] = fitted.deviation
            values[f"deviation between its points, estimated, {name} (mm)"] = fitted.between
            values[f"corners of a flank, {name}"] = float(len(fitted.corners))
    return values


def _cup(design: DriveDesign) -> dict[str, float]:
    """Thicknesses of the cup and its attached area; those that equal the first one are left out."""
    if design.drive.model != "cup":
        return {}
    cup, of_cup = design.cup, design.cup_sizes
    end = "flange" if cup.shape == "hat" else "closed end"
    thinnest = min(thicknesses(of_cup.points))
    sizes = {"cup thickness (mm)": of_cup.thickness}
    if not np.isclose(thinnest, of_cup.thickness, rtol=SAME):
        sizes["thinnest place of the wall (mm)"] = thinnest
    if of_cup.end_thickness != of_cup.thickness:
        sizes[f"thickness of the {end} (mm)"] = of_cup.end_thickness
    thinnest = min(thicknesses(of_cup.wall.plate_points))
    if not np.isclose(thinnest, of_cup.end_thickness, rtol=SAME):
        sizes[f"thinnest place of the {end} (mm)"] = thinnest
    if cup.attachment == "clamped":
        sizes["attached area, one side (mm2)"] = np.pi * abs(cup.edge**2 - cup.clamping_radius**2)
    if cup.attachment == "bolted":
        sizes["attached area, one side (mm2)"] = 0.25 * np.pi * cup.washer_diameter**2 * cup.bolts
        sizes["period of teeth and bolts (pitches)"] = design.kinematics.pitches
    return sizes


def _growth(design: DriveDesign) -> dict[str, float]:
    """Radial growth of bodies, were they free; none of those that do not grow."""
    radii: dict[str, float] = {name: design.teeth(name).r_pitch for name in design.gears}
    radii |= {"housing": design.geometry.gears["ring_gear"].outer_radius}
    radii |= {"bearing": design.inner_radius}
    places = {"housing": "bore of the housing", "bearing": "outer surface of the race"}
    values = {}
    for body, growth in design.growths.items():
        place = places.get(body, f"pitch circle of the {body.replace('_', ' ')}")
        values[f"free radial growth, {place} (µm)"] = 1e3 * growth.across * radii[body]
    values["radial growth of the cam, major axis (µm)"] = (
        1e3 * design.cam_strain * design.major_semi_axis
    )
    values["radial growth of the frame (µm)"] = (
        1e3 * design.frame_growth.across * design.geometry.outer_radius
    )
    return {name: value for name, value in values.items() if value}


def _dynamic_spline(design: DriveDesign) -> dict[str, float]:
    """Quantities of the second ring gear of a pancake drive; none of other drives."""
    if design.dynamic_spline is None:
        return {}
    spline, second = design.profile("flexible_spline"), design.profile("dynamic_spline")
    lobe, _ = design.tooth_motion().line.deflections
    low, high = design.axial_range("ring_gear")
    return {
        "face width of the ring gear (mm)": high - low,
        "backlash of the dynamic spline (mm)": design.backlash_of("dynamic_spline"),
        "tip of spline to root of dynamic spline (mm)": second.r_root_circle
        - spline.r_tip_circle
        - lobe,
        "tip of dynamic spline to root of spline (mm)": second.r_tip_circle
        - spline.r_root_circle
        - lobe,
    }
