"""Checks of the strengths of [fatigue].

Each refusal names the key, its value and what is allowed.
"""

from __future__ import annotations

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import Fatigue
from swgpar.errors import InputError
from swgpar.input.require import require
from swgpar.materials.pitting import STEEL_MODULUS

OF_STEEL = (
    "tensile_strength",
    "yield_strength",
    "fatigue_limit",
    "shear_fatigue_limit",
    "basquin_coefficient",
    "basquin_exponent",
)
"""Keys of [fatigue] whose defaults are those of a steel."""


def check_fatigue(design: DriveDesign, fatigue: Fatigue) -> None:
    """Raise InputError where a default of a steel stands for another material, or where strengths
    are not in their order.

    Crossland's criterion needs a shear fatigue limit above that of von Mises.
    """
    modulus, (low, high) = design.materials["flexible_spline"].modulus, STEEL_MODULUS
    if not low <= modulus <= high:
        for key in OF_STEEL:
            if key not in fatigue.model_fields_set:
                raise InputError(
                    f"fatigue.{key} is missing: the default is that of a steel, and the flexible "
                    f"spline has a modulus of elasticity of {modulus:g} MPa: allowed without it "
                    f"only from {low:g} to {high:g} MPa"
                )
    limit, shear = fatigue.fatigue_limit, fatigue.shear_fatigue_limit
    for key, larger in (
        ("yield_strength", "tensile_strength"),
        ("fatigue_limit", "tensile_strength"),
        ("shear_fatigue_limit", "fatigue_limit"),
    ):
        value, most = getattr(fatigue, key), getattr(fatigue, larger)
        require(
            value <= most, f"fatigue.{key}", value, f"above 0 to {most:g} MPa (fatigue.{larger})"
        )
    least = limit / np.sqrt(3.0)
    allowed = f"{least:.4g} (fatigue.fatigue_limit over the root of 3) to {limit:g} MPa"
    require(shear >= least, "fatigue.shear_fatigue_limit", shear, allowed)
