"""Input speeds up to which the inertia of the rim of the flexible spline is negligible, and where
its forces are a part of the model."""

from __future__ import annotations

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.kinematics import Kinematics
from swgpar.design.sections import PER_MINUTE, Load
from swgpar.errors import InputError
from swgpar.geometry.rim_inertia import RimInertia
from swgpar.input.require import require, require_available

NEGLIGIBLE = 0.01
"""Share of the bending up to which inertia is negligible."""

LARGEST = 1.0
"""Share of the bending up to which forces of inertia are a part of the model: there the wave is as
fast as a natural one of the rim alone. The tangent does not have them."""

INERTIA = "load.inertia = true"

ROUND_OFF = 1e-12
"""Share, at 1 rad/s, below which inertia is none."""


def negligible_speeds(rim: RimInertia | None, kinematics: Kinematics) -> dict[str, float]:
    """Input speeds (1/min) up to which inertia is negligible, by their meaning; none without a
    density. Speeds that nothing depends on are left out."""
    spline, wave = kinematics.speeds_in_space
    if rim is None:
        return {}
    shares = {
        "inertia of the deflected rim, a ring alone, is 1 % of the forces that bend it": abs(
            rim.share_of_bending(spline, wave)
        ),
        "rotation stretches the rim by 1 % of its bending stress": rim.hoop_stress(spline)
        / rim.bending_stress,
    }
    return {
        f"input speed at which {name} (1/min)": float(np.sqrt(NEGLIGIBLE / share)) / PER_MINUTE
        for name, share in shares.items()
        if share > ROUND_OFF
    }


def inertia_remarks(rim: RimInertia | None, speeds: tuple[float, float], load: Load) -> list[str]:
    """Sentences where the input is so fast that forces of inertia count. speeds : rad/s, of
    flexible spline and wave generator in space"""
    if rim is None or load.inertia or "input_speed" not in load.model_fields_set:
        return []
    share, stress = rim.share_of_bending(*speeds), rim.hoop_stress(speeds[0])
    sentences = []
    if abs(share) > NEGLIGIBLE:
        sentences.append(
            f"load.input_speed = {load.input_speed:g} 1/min: the inertia of the deflected rim is "
            f"{100.0 * share:.3g} % of the forces that bend it as a ring alone, and takes them "
            "from the cam; the model leaves it out without load.inertia"
        )
    if stress > NEGLIGIBLE * rim.bending_stress:
        sentences.append(
            f"load.input_speed = {load.input_speed:g} 1/min rotates the flexible spline so fast "
            f"that its rim has a further hoop stress of {stress:.3g} MPa: the model leaves it out "
            "without load.inertia"
        )
    return sentences


def require_density(design: DriveDesign, body: str, what: str) -> None:
    """Raise InputError where a body has no density, which `what` needs."""
    if design.materials[body].density is None:
        raise InputError(
            f"the density of {body} is missing: {what} needs it, as material.density or by "
            "material.name"
        )


def check_inertia(design: DriveDesign) -> None:
    """Raise InputError where the wave does not pass all sectors alike, a mass is missing, or the
    input is too fast for forces of inertia."""
    carried = design.output_bearing is not None and design.output_bearing.is_loaded_sideways
    for given, beside, allowed in (
        (design.has_program, "a load program, [stiffness] or [ratcheting]", "under one torque"),
        (design.deviations is not None, "[deviations]", "without them"),
        (design.is_bolted, 'cup.attachment = "bolted"', '"edge" or "clamped": sectors are alike'),
        (carried, "a radial force or a tilting moment in [output_bearing]", "without them"),
    ):
        require_available(not given, INERTIA, beside, allowed)
    condensed = design.solver.condensed_sectors
    require(not condensed, "solver.condensed_sectors", condensed, f"only false with {INERTIA}")
    bodies = ["flexible_spline", *(["bearing"] if design.bearing is not None else [])]
    for body in bodies:
        require_density(design, body, INERTIA)
    speed, rim, (spline, wave) = design.load.input_speed, design.rim_inertia, design.speeds
    share = max(
        abs(rim.share_of_bending(spline, wave)), rim.hoop_stress(spline) / rim.bending_stress
    )
    most = speed * float(np.sqrt(LARGEST / max(share, ROUND_OFF)))
    allowed = (
        f"above 0 to {most:.4g} 1/min with {INERTIA}: there inertia is as large as the forces that "
        "bend the rim, a ring alone"
    )
    require(share <= LARGEST, "load.input_speed", speed, allowed)
