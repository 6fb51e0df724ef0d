"""Growth of the bodies of a drive without stress: by their temperatures and by press fits.

A body of one material at one temperature grows alike everywhere. What it touches or is bonded to
makes the stress. An interference is a smaller bore: the housing, were it free, would be smaller
across the axis by the interference over the diameter of the fit.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.bearing import ball_lines
from swgpar.geometry.disc_surface import CamSurface, GrownSurface
from swgpar.materials import NO_GROWTH, Growth

BallLines = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
"""Gives centres (n, 2) mm, groove normals (n, 2) in the cam's frame and curvatures (n,) 1/mm of the
centres' curve at angles (n,) rad from the major axis."""


def temperature_rises(design: DriveDesign) -> dict[str, float]:
    """Temperatures (K) above the reference, by the name of the section that has the key."""
    sections: dict[str, Any] = {gear: getattr(design, gear) for gear in design.gears}
    sections |= {
        "ring_gear.housing": design.housing,
        "ring_gear.frame": design.ring_gear.frame,
        "wave_generator": design.wave_generator,
        "wave_generator.bearing": design.bearing,
    }
    reference = design.load.reference_temperature
    return {
        name: 0.0 if section.temperature is None else section.temperature - reference
        for name, section in sections.items()
        if section is not None
    }


def growths(design: DriveDesign) -> dict[str, Growth]:
    """Growth of the gears, of the housing and of the bearing by the names of `design.materials`.

    A check has refused temperatures of materials whose expansion is not known.
    """
    rises, every = temperature_rises(design), {}
    sections = {"housing": "ring_gear.housing", "bearing": "wave_generator.bearing"}
    for body, material in design.materials.items():
        every[body] = material.thermal_growth(rises[sections.get(body, body)]) or NO_GROWTH
    if design.housing is not None:
        every["housing"] += Growth(across=-design.housing.interference / fit_diameter(design))
    return every


def fit_diameter(design: DriveDesign) -> float:
    """Diameter (mm) of the ring gear's outer surface."""
    return 2.0 * design.geometry.gears["ring_gear"].outer_radius


def frame_growth(design: DriveDesign) -> Growth:
    """Growth of the bore of the rigid frame; an interference makes it smaller."""
    frame = design.ring_gear.frame
    thermal = (frame.expansion or 0.0) * temperature_rises(design)["ring_gear.frame"]
    fit = Growth(across=-frame.interference / (2.0 * design.geometry.outer_radius))
    return Growth(thermal, thermal) + fit


def cam_strain(design: DriveDesign) -> float:
    """Strain of the growth of the rigid cam."""
    own = design.wave_generator.expansion
    expansion = design.material.expansion if own is None else own
    return (expansion or 0.0) * temperature_rises(design)["wave_generator"]


def grown_cam_surface(design: DriveDesign) -> CamSurface | GrownSurface:
    """Surface of the cam at its temperature."""
    strain, surface = cam_strain(design), design.cam_surface()
    return GrownSurface(surface, strain) if strain else surface


def grown_ball_lines(design: DriveDesign) -> BallLines:
    """Places of the balls on the cam at its temperature."""
    lines = partial(ball_lines, design.cam(), design.bearing_sizes.centre_depth)
    factor = 1.0 + cam_strain(design)

    def grown(angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        centre, normal, curvature = lines(angle)
        return factor * centre, normal, curvature / factor

    return grown


def ball_clearance(design: DriveDesign) -> float:
    """Clearance (mm) of a ball with the outer race at its temperature.

    Half of what a ball grows by moves its centre off the inner race. `grown_ball_lines` has moved
    the centre by what half a ball would grow by as the cam.
    """
    bearing = design.bearing
    strain = growths(design)["bearing"].across - 0.5 * cam_strain(design)
    return bearing.clearance - strain * bearing.ball_diameter
