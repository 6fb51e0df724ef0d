"""Strains that a design has before it is computed: of the rim by its deflection, of rim and wall by
the torque. The law of the elements is linear, which holds for small ones alone."""

from __future__ import annotations

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.bracketed_root import root_between
from swgpar.geometry.paired_lines import thicknesses
from swgpar.input.require import require

LARGEST_STRAIN = 0.1
"""Strain above which the linear law is no law of a material: here laws that agree at small strains
are 15 % apart (docs/verification/strains.md)."""

LAW_SPREAD = 1.5
"""By how much of themselves stresses under laws with the same E and nu are apart, over the strain:
Hooke's law between true stress and true strain, and between those of Green, in a stretched bar
(docs/verification/strains.md)."""

LARGEST_NOMINAL = 0.5 * LARGEST_STRAIN
"""Of a nominal strain by the torque: at the roots of the teeth it is larger by their notch, and
that by the deflection comes on top."""

SAID = 0.01
"""Strain from which it is said, where that is 1.5 %."""

POINTS = 1024
"""Around the neutral line, for the largest change of its curvature."""


def deflection_strain(design: DriveDesign) -> float:
    """Largest strain of a rim without teeth by the cam: bending and stretch of its neutral line."""
    line, rim = design.tooth_motion().line, design.flexible_spline.rim
    theta = np.linspace(0.0, 2.0 * np.pi / line.lobes, POINTS, endpoint=False)
    bending = 0.5 * rim * float(np.abs(line.tilt(theta)[1]).max()) / line.radius
    return bending + line.stretch


def torque_strain(design: DriveDesign) -> tuple[float, str]:
    """Nominal strain under 1 N·m, and of what: shear of the weakest section of the cup's wall, or
    strain of a rim that leads the force of the teeth of one lobe on."""
    material, radius = design.materials["flexible_spline"], design.inner_radius
    section = design.flexible_spline.rim * design.drive.face_width
    force = 1000.0 / (design.wave_generator.lobes * radius)
    found = [(force / (section * material.modulus), "rim")]
    if design.has_cup:
        points = design.cup_sizes.points
        weakest = min(p.radius**2 * t for p, t in zip(points, thicknesses(points), strict=True))
        shear = 0.5 * material.modulus / (1.0 + material.poisson)
        found.append((1000.0 / (2.0 * np.pi * weakest * shear), "cup's wall"))
    return max(found)


def check_strains(design: DriveDesign) -> None:
    """Raise InputError for a rim that the cam strains too much, and for the first torque that does
    so with rim or wall."""
    strain, rim = deflection_strain(design), design.flexible_spline.rim
    if strain > LARGEST_STRAIN:
        allowed = (
            f"{_thickest(design)} a strain by the cam of up to {100 * LARGEST_STRAIN:g} %, up to "
            f"which the linear law of the material holds; here it is {100 * strain:.3g} %"
        )
        require(False, "flexible_spline.rim", rim, allowed)
    per_torque, of = torque_strain(design)
    torques = {"load.torque": design.load.torque}
    for k, stage in enumerate(design.load.program, 1):
        torques[f"load.program.{k}.torque"] = stage.torque or 0.0
    if design.stiffness is not None:
        torques["stiffness.torque"] = design.stiffness.torque or 0.0
    allowed = (
        f"up to {LARGEST_NOMINAL / per_torque:.4g} N·m, a nominal strain of the {of} of "
        f"{100 * LARGEST_NOMINAL:g} % (the linear law holds up to {100 * LARGEST_STRAIN:g} %, and "
        "roots have more than the nominal strain)"
    )
    for key, torque in torques.items():
        require(abs(torque) * per_torque <= LARGEST_NOMINAL, key, torque, allowed)


def _thickest(design: DriveDesign) -> str:
    """Words for the thickest rim that the cam may deflect; it has the same outer circles."""
    section = design.flexible_spline

    def excess(rim: float) -> float:
        changed = section.model_copy(update={"rim": rim})
        sections = {name: getattr(design, name) for name in type(design).model_fields}
        other = type(design).model_construct(**sections | {"flexible_spline": changed})
        return deflection_strain(other) - LARGEST_STRAIN

    thin = 1e-3 * section.rim
    if excess(thin) > 0.0:
        return "a cam with less deflection, and"
    return f"up to {root_between(excess, thin, section.rim):.4g} mm,"


def spread_text(strain: float) -> str:
    """Words for what the law leaves open at a strain."""
    return f"laws with the same E and nu are up to {100 * LAW_SPREAD * strain:.2g} % apart there"


def strain_remarks(design: DriveDesign) -> list[str]:
    """A sentence where the deflection or the torque strains the spline by more than `SAID`."""
    sentences = []
    bent, (per_torque, of) = deflection_strain(design), torque_strain(design)
    loaded = abs(design.load.torque) * per_torque
    if bent >= SAID:
        sentences.append(
            f"the cam strains the rim by {100 * bent:.2g} %, more at the roots of the teeth: "
            f"stresses are those of a linear law; {spread_text(bent)}"
        )
    if loaded >= SAID:
        sentences.append(
            f"load.torque = {design.load.torque:g} N·m strains the {of} by {100 * loaded:.2g} % "
            "(nominal), more at the roots of the teeth: stresses are those of a linear law; "
            f"{spread_text(loaded)}"
        )
    return sentences
