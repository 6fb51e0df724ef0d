"""Quality of hexahedra, and of quadrilaterals in the plane: Jacobians and aspect ratios."""

from __future__ import annotations

import numpy as np

from swgpar.geometry.arrays import Floats, Ints

PLANE_CORNERS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
"""Natural coordinates (4, 2) of the nodes of a quadrilateral."""

CORNERS = np.column_stack((np.tile(PLANE_CORNERS, (2, 1)), np.repeat((-1.0, 1.0), 4)))
"""Natural coordinates (8, 3) of the nodes of a hexahedron, in VTK order."""

GAUSS = 1.0 / np.sqrt(3.0)
"""Natural coordinates of the 2x2x2, or 2x2, Gauss points over those of the corners."""


def shape_gradients(corners: Floats, points: Floats) -> Floats:
    """Return dN / d xi, (n_point, n_node, dims), at natural coordinates (n_point, dims).

    corners : (n_node, dims), `CORNERS` or `PLANE_CORNERS`
    """
    factor = 0.5 * (1.0 + corners * points[:, None])
    gradient = np.empty_like(factor)
    for axis in range(corners.shape[1]):
        others = np.delete(factor, axis, axis=2).prod(axis=2)
        gradient[..., axis] = 0.5 * corners[:, axis] * others
    return gradient


def jacobian_matrices(coords: Floats, elements: Ints, scale: float) -> Floats:
    """Return d X / d xi, (n_elem, n_node, dims, dims) in mm, at `scale` times the natural
    coordinates of the corners of hexahedra (n_elem, 8) or quadrilaterals (n_elem, 4)."""
    corners = CORNERS if elements.shape[1] == 8 else PLANE_CORNERS
    gradient = shape_gradients(corners, scale * corners)
    x = coords[elements][..., : corners.shape[1]]
    return np.einsum("eai,qak->eqik", x, gradient)


def hex_volumes(coords: Floats, hexes: Ints) -> Floats:
    """Return the volumes (n_elem,), mm³; exact for trilinear hexahedra."""
    return np.linalg.det(jacobian_matrices(coords, hexes, GAUSS)).sum(axis=1)


def aspect_ratios(coords: Floats, elements: Ints) -> Floats:
    """Return the longest over the shortest edge of each element (n_elem,)."""
    corners = CORNERS if elements.shape[1] == 8 else PLANE_CORNERS
    apart = np.abs(corners[:, None] - corners).sum(axis=2)
    first, second = np.nonzero(np.triu(apart == 2.0))
    x = coords[elements][..., : corners.shape[1]]
    lengths = np.linalg.norm(x[:, first] - x[:, second], axis=-1)
    return lengths.max(axis=1) / lengths.min(axis=1)


def element_quality(coords: Floats, elements: Ints) -> dict[str, float]:
    """Return the worst quality of a mesh.

    coords : (n_node, 3) mm;  elements : (n_elem, 8), or (n_elem, 4) in the plane, counter-clockwise

    ``min_scaled_jacobian``, at the corners, 1 for a box; ``min_jacobian`` and ``max_jacobian``, mm³
    or mm², determinants at the 2x2x2 or 2x2 Gauss points; ``max_aspect_ratio``, longest over
    shortest edge.
    """
    gauss = np.linalg.det(jacobian_matrices(coords, elements, GAUSS))
    corner = jacobian_matrices(coords, elements, 1.0)
    scaled = np.linalg.det(corner) / np.linalg.norm(corner, axis=-2).prod(axis=-1)
    return {
        "min_scaled_jacobian": float(scaled.min()),
        "min_jacobian": float(gauss.min()),
        "max_jacobian": float(gauss.max()),
        "max_aspect_ratio": float(aspect_ratios(coords, elements).max()),
    }
