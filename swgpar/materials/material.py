"""What a law of a material gives the bodies that are made of it."""

from __future__ import annotations

from abc import abstractmethod
from typing import Self

import numpy as np
from pydantic import model_validator
from pydantic_core import PydanticCustomError

from swgpar.input.quantities import WHOLE_SECTION, Section, not_negative, quantity
from swgpar.materials.growth import Growth

IN_PLANE = [0, 1, 3]
"""Components xx, yy and xy among xx, yy, zz, xy, yz, zx."""


class Material(Section):
    """A linear elastic law. Its fields are the keys of the section, its one method is `compliance`.

    The law holds in the axes of a tooth sector, and rotates with it: y is radial at the middle of
    the sector, x is tangential there, and z is the axis of the drive. Components are xx, yy, zz,
    xy, yz, zx, with engineering shear strains.
    """

    density: float | None = quantity(None, unit="kg/m³", text="density", ge=100.0, le=30e3)
    expansion: float | None = not_negative("coefficient of thermal expansion", "1/K", None, le=1e-3)

    @model_validator(mode="after")
    def _is_stable(self) -> Self:
        if np.linalg.eigvalsh(self.compliance()).min() <= 0.0:
            raise PydanticCustomError(
                WHOLE_SECTION,
                "is a material that yields energy: allowed a compliance that is positive definite",
            )
        return self

    @abstractmethod
    def compliance(self) -> np.ndarray:
        """Strains by stresses, (6, 6) 1/MPa: symmetric and positive definite."""

    def elasticity(self) -> np.ndarray:
        """Stresses by strains, (6, 6) MPa."""
        return _inverse(self.compliance())

    def plane_stress(self) -> np.ndarray:
        """Stresses xx, yy, xy by these strains where zz, yz and zx are free of stress, (3, 3)
        MPa."""
        return _inverse(self.compliance()[np.ix_(IN_PLANE, IN_PLANE)])

    def thermal_growth(self, rise: float) -> Growth | None:
        """Growth of a free body by a rise of its temperature (K); None where `expansion` is not
        known."""
        return None if self.expansion is None else Growth(*2 * (self.expansion * rise,))

    @property
    def creeps(self) -> bool:
        """Whether it is known to creep: then a state of a run is that of a short load."""
        return False

    @property
    def modulus(self) -> float:
        """Modulus of elasticity along x, MPa: E of formulas for isotropic bodies, and scale of
        penalties."""
        return float(1.0 / self.compliance()[0, 0])

    @property
    def poisson(self) -> float:
        """Poisson's ratio in the plane xy: nu of formulas for isotropic bodies."""
        compliance = self.compliance()
        return float(-compliance[0, 1] / compliance[0, 0])

    def contact_compliance(self, *, plane_stress: bool = False) -> float:
        """Share of a half space in 1 / E* of a contact along z, 1/MPa; of a half plane in plane
        stress.

        It is (1 - nu²) / E of an isotropic body, 1 / E in plane stress. The plane xy is taken as
        isotropic.
        """
        s = self.compliance()
        return float(s[0, 0] if plane_stress else s[0, 0] - s[0, 2] ** 2 / s[2, 2])


def contact_modulus(first: Material, second: Material, *, plane_stress: bool = False) -> float:
    """E* (MPa) of two half spaces, or of half planes in plane stress: 1 / E* is the sum of their
    shares."""
    return 1.0 / sum(
        material.contact_compliance(plane_stress=plane_stress) for material in (first, second)
    )


def _inverse(matrix: np.ndarray) -> np.ndarray:
    inverse = np.linalg.inv(matrix)
    return 0.5 * (inverse + inverse.T)
