"""What a design may have and what deserves a word: teeth that overlap, cams that are too long,
torques that are too small to be resolved, plastics, angles that show the same state."""

from __future__ import annotations

from swgpar.checks.bearing_checks import bearing_remarks
from swgpar.checks.clearance import clearances
from swgpar.checks.growth_checks import growth_remarks
from swgpar.checks.inertia import inertia_remarks
from swgpar.checks.strain_checks import strain_remarks
from swgpar.checks.tooth_checks import tooth_remarks
from swgpar.design.drive_design import DriveDesign

STRETCH = 1e-3
"""Strain of the neutral line above which it is said: on steel a hoop stress of 200 MPa."""


def remarks(design: DriveDesign) -> list[str]:
    """Sentences about what is allowed and may not be meant."""
    sentences = [one.remark for one in clearances(design.rigid_pairs) if one.overlaps]
    stretch = design.tooth_motion().line.stretch
    if stretch > STRETCH and design.wave_generator.lobes_are_alike:
        hoop = stretch * design.materials["flexible_spline"].modulus
        sentences.append(
            f"the cam is longer than the bore: it stretches the neutral line by "
            f"{100 * stretch:.3g} %, which alone is a hoop stress of {hoop:.4g} MPa in the "
            f"flexible spline; a smaller minor axis shortens the cam"
        )
    sentences += [
        *tooth_remarks(design),
        *strain_remarks(design),
        *growth_remarks(design),
        *bearing_remarks(design),
        *inertia_remarks(design.rim_inertia, design.speeds, design.load),
    ]
    torque, negligible = design.load.torque, design.negligible_torque
    if 0.0 < 1000.0 * torque <= negligible:
        sentences.append(
            f"load.torque = {torque:g} N·m counts as none: up to {0.001 * negligible:.3g} N·m it "
            f"is too small beside the bending of the flexible spline"
        )
    samples = design.steps.samples
    repeats = design.kinematics.repeats(samples)
    shown = design.kinematics.states(samples)
    if shown < samples:
        sentences.append(
            f"steps.samples = {samples} shows {shown} different states of the drive, each at "
            f"{samples // shown} angles: numbers without a common divisor with {repeats} show as "
            "many states as angles"
        )
    plastic = [body for body, material in design.materials.items() if material.creeps]
    if plastic:
        sentences.append(
            f"plastics creep, and the model has no creep: stresses and stiffness of "
            f"{', '.join(plastic)} are those of a short load"
        )
    return sentences
