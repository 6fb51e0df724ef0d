"""A law with one stiffness in the plane xy and another one along z: layers of a printed part."""

from __future__ import annotations

from typing import Literal

import numpy as np

from swgpar.input.quantities import not_negative, positive, quantity
from swgpar.materials.growth import Growth
from swgpar.materials.material import Material


class TransverselyIsotropic(Material):
    """The same in all directions of the plane xy, which is that of the layers."""

    type: Literal["transversely_isotropic"] = quantity(
        "transversely_isotropic", text="law of the material"
    )
    E: float = positive("modulus of elasticity in the plane xy", "MPa")
    nu: float = quantity(text="Poisson's ratio in the plane xy", gt=-1.0, lt=1.0)
    E_z: float = positive("modulus of elasticity along z", "MPa")
    nu_z: float = quantity(
        text="contraction in the plane xy over the stretch along z, under a stress along z",
        gt=-1.0,
        lt=1.0,
    )
    G_z: float = positive("shear modulus of the planes yz and zx", "MPa")
    expansion_z: float | None = not_negative(
        "coefficient of thermal expansion along z; without it expansion", "1/K", None, le=1e-3
    )

    def thermal_growth(self, rise: float) -> Growth | None:
        """Growth of a free body by a rise of its temperature (K), which differs along z."""
        if self.expansion is None:
            return None
        along = self.expansion if self.expansion_z is None else self.expansion_z
        return Growth(self.expansion * rise, along * rise)

    def compliance(self) -> np.ndarray:
        """Strains by stresses, (6, 6) 1/MPa."""
        shear = 2.0 * (1.0 + self.nu) / self.E
        stretch = [1.0 / self.E, 1.0 / self.E, 1.0 / self.E_z]
        out = np.diag([*stretch, shear, 1.0 / self.G_z, 1.0 / self.G_z])
        out[0, 1] = out[1, 0] = -self.nu / self.E
        out[:2, 2] = out[2, :2] = -self.nu_z / self.E_z
        return out
