"""Check of the torques of the output. Each refusal names the key, its value and what is allowed."""

from __future__ import annotations

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.cup_wall import thicknesses
from swgpar.input.require import require

LARGEST_SHEAR = 0.01
"""Nominal shear strain under the output torque; steel yields at half of it, and far above the teeth
find no contact."""


def check_torques(design: DriveDesign) -> None:
    """Raise InputError for the first torque that a cylinder like the weakest section of the cup, or
    the rim in the plane model, cannot carry."""
    material = design.materials["flexible_spline"]
    shear_modulus = 0.5 * material.modulus / (1.0 + material.poisson)
    weakest, of = design.inner_radius**2 * design.flexible_spline.rim, "rim"
    if design.has_cup:
        points = design.cup_sizes.points
        sections = (p.radius**2 * t for p, t in zip(points, thicknesses(points), strict=True))
        weakest, of = min(sections), "cup's wall"
    most = 0.001 * LARGEST_SHEAR * shear_modulus * 2.0 * np.pi * weakest
    torques = {"load.torque": design.load.torque}
    for k, stage in enumerate(design.load.program, 1):
        torques[f"load.program.{k}.torque"] = stage.torque or 0.0
    if design.stiffness is not None:
        torques["stiffness.torque"] = design.stiffness.torque or 0.0
    allowed = f"up to {most:.4g} N·m (nominal shear strain of the {of}: {LARGEST_SHEAR:g})"
    for key, torque in torques.items():
        require(abs(torque) <= most, key, torque, allowed)
