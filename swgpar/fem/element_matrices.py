"""Matrices of undeformed elements of a material."""

from __future__ import annotations

import numpy as np

from swgpar.kernel import ReferenceElements, reference_elements
from swgpar.materials import Material


def element_matrices(
    coords: np.ndarray, material: Material, thickness: float = 0.0, incompatible: bool = True
) -> ReferenceElements:
    """Matrices of hexahedra (n, 8, 3) mm, or of quadrilaterals (n, 4, 3) mm in plane stress.

    thickness : mm, of quadrilaterals;  incompatible : see `reference_elements`
    """
    elasticity = material.plane_stress() if coords.shape[1] == 4 else material.elasticity()
    return reference_elements(coords, elasticity, thickness, incompatible)
