"""The isotropic law."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from pydantic import model_validator

from swgpar.input.quantities import not_negative, positive, quantity
from swgpar.materials.library import LIBRARY
from swgpar.materials.material import Material


class Isotropic(Material):
    """Hooke's law with two constants."""

    type: Literal["isotropic"] = quantity("isotropic", text="law of the material")
    name: Literal[tuple(LIBRARY)] | None = quantity(  # type: ignore[valid-type]
        None,
        text="material of the library, which gives E, nu, density and expansion where they are "
        "missing",
    )
    E: float = positive("modulus of elasticity", "MPa")
    nu: float = not_negative("Poisson's ratio", le=0.499)

    @model_validator(mode="before")
    @classmethod
    def _take_from_the_library(cls, keys: Any) -> Any:
        named = LIBRARY.get(str(keys.get("name"))) if isinstance(keys, dict) else None
        if named is None:
            return keys
        of_library = {key: getattr(named, key) for key in ("E", "nu", "density", "expansion")}
        return {**of_library, **keys}

    @property
    def creeps(self) -> bool:
        """Whether the library knows it as a plastic."""
        return self.name is not None and LIBRARY[self.name].creeps

    @property
    def modulus(self) -> float:
        """Modulus of elasticity, MPa."""
        return self.E

    def compliance(self) -> np.ndarray:
        """Strains by stresses, (6, 6) 1/MPa."""
        out = np.diag([1.0, 1.0, 1.0, *[2.0 * (1.0 + self.nu)] * 3])
        out[:3, :3] -= self.nu * (1.0 - np.eye(3))
        return out / self.E

    def elasticity(self) -> np.ndarray:
        """Stresses by strains, (6, 6) MPa: exact near nu = 0.5 too."""
        shear = self.E / (2.0 * (1.0 + self.nu))
        out = shear * np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])
        out[:3, :3] += self.E * self.nu / ((1.0 + self.nu) * (1.0 - 2.0 * self.nu))
        return out
