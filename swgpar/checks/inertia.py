"""Input speeds up to which the inertia of the rim of the flexible spline is negligible."""

from __future__ import annotations

import numpy as np

from swgpar.design.kinematics import Kinematics
from swgpar.design.sections import Load
from swgpar.geometry.rim_inertia import RimInertia

NEGLIGIBLE = 0.01
"""Share of the bending up to which inertia is negligible."""

PER_MINUTE = np.pi / 30.0
"""A turn per minute in rad/s."""

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


def inertia_remarks(rim: RimInertia | None, kinematics: Kinematics, load: Load) -> list[str]:
    """Sentences where the input is so fast that forces of inertia count."""
    if rim is None or "input_speed" not in load.model_fields_set:
        return []
    spline, wave = (PER_MINUTE * load.input_speed * one for one in kinematics.speeds_in_space)
    share, stress = rim.share_of_bending(spline, wave), rim.hoop_stress(spline)
    sentences = []
    if abs(share) > NEGLIGIBLE:
        sentences.append(
            f"load.input_speed = {load.input_speed:g} 1/min: the inertia of the deflected rim is "
            f"{100.0 * share:.3g} % of the forces that bend it as a ring alone, and takes them "
            "from the cam; the model leaves it out"
        )
    if stress > NEGLIGIBLE * rim.bending_stress:
        sentences.append(
            f"load.input_speed = {load.input_speed:g} 1/min rotates the flexible spline so fast "
            f"that its rim has a further hoop stress of {stress:.3g} MPa: the model leaves it out"
        )
    return sentences
