"""Masses of elements and nodes."""

from __future__ import annotations

import numpy as np

from swgpar.fem.body import Body
from swgpar.meshing.quality import CORNERS, GAUSS, PLANE_CORNERS, jacobian_matrices

TONNES_PER_MM3 = 1e-12
"""One kg/m³ in t/mm³, the unit of densities with mm, N and s."""


def sector_masses(body: Body) -> np.ndarray:
    """Masses (n_node,) t of the nodes of a sector: row sums of the consistent mass matrix; nan
    without a density."""
    mesh = body.mesh
    thickness = body.thickness if mesh.plane else None
    of_element = mass_matrices(mesh.coords, mesh.elements, thickness).sum(axis=2)
    density = np.full(len(mesh.elements), np.nan)
    for part, material in zip(mesh.parts, body.materials, strict=True):
        density[part] = TONNES_PER_MM3 * (material.density or np.nan)
    return np.bincount(
        mesh.elements.ravel(), (density[:, None] * of_element).ravel(), minlength=len(mesh.coords)
    )


def mass_matrices(coords: np.ndarray, elements: np.ndarray, thickness: float | None) -> np.ndarray:
    """Integrals (m, k, k) mm³ of products of the shape functions of hexahedra (m, 8), or of
    quadrilaterals (m, 4) in the plane.

    coords : (n, 3) mm;  thickness : mm, of quadrilaterals; None for hexahedra
    """
    corners = CORNERS if thickness is None else PLANE_CORNERS
    shape = (0.5 * (1.0 + GAUSS * corners[:, None] * corners)).prod(axis=2)  # point, node
    weight = np.abs(np.linalg.det(jacobian_matrices(coords, elements, GAUSS)))
    return np.einsum("eq,qa,qb->eab", weight * (thickness or 1.0), shape, shape)
