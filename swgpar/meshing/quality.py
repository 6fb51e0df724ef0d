"""Quality of hexahedra, and of quadrilaterals in the plane: Jacobians and aspect ratios."""

from __future__ import annotations

import numpy as np

from swgpar.geometry.arrays import Floats, Ints

CORNERS = np.array(
    [
        (-1, -1, -1),
        (1, -1, -1),
        (1, 1, -1),
        (-1, 1, -1),
        (-1, -1, 1),
        (1, -1, 1),
        (1, 1, 1),
        (-1, 1, 1),
    ],
    dtype=float,
)
"""Natural coordinates (8, 3) of the nodes of a hexahedron, in VTK order."""

PLANE_CORNERS = CORNERS[:4, :2]
"""Natural coordinates (4, 2) of the nodes of a quadrilateral."""

GAUSS = CORNERS / np.sqrt(3.0)
"""Natural coordinates (8, 3) of the 2x2x2 Gauss points."""


def jacobian_matrices(coords: Floats, hexes: Ints, points: Floats) -> Floats:
    """Return d X / d xi, (n_elem, n_point, 3, 3) in mm, at the natural coordinates `points`
    (n_point, 3)."""
    factor = 1.0 + CORNERS * points[:, None, :]
    gradient = np.empty((len(points), 8, 3))
    for k in range(3):
        others = [axis for axis in range(3) if axis != k]
        gradient[:, :, k] = (
            0.125 * CORNERS[:, k] * factor[:, :, others[0]] * factor[:, :, others[1]]
        )
    return np.einsum("eai,qak->eqik", coords[hexes], gradient, optimize=True)


def determinants(matrices: Floats) -> Floats:
    """Return the determinants of the 3 x 3 `matrices` (..., 3, 3)."""
    columns = np.moveaxis(matrices, -1, 0)
    return np.einsum("...i,...i->...", columns[0], np.cross(columns[1], columns[2]))


def hex_volumes(coords: Floats, hexes: Ints) -> Floats:
    """Return the volumes (n_elem,), mm³; exact for trilinear hexahedra."""
    return determinants(jacobian_matrices(coords, hexes, GAUSS)).sum(axis=1)


def scaled_jacobians(coords: Floats, hexes: Ints) -> Floats:
    """Return the smallest scaled Jacobian of each element (n_elem,), 1 for a box."""
    corner = jacobian_matrices(coords, hexes, CORNERS)
    lengths = np.sqrt(np.einsum("eqik,eqik->eqk", corner, corner))
    return (determinants(corner) / lengths.prod(axis=-1)).min(axis=1)


def aspect_ratios(coords: Floats, hexes: Ints) -> Floats:
    """Return the longest over the shortest edge of each element (n_elem,)."""
    x = coords[hexes]
    pairs = np.array(
        [
            (0, 1),
            (1, 2),
            (2, 3),
            (3, 0),
            (4, 5),
            (5, 6),
            (6, 7),
            (7, 4),
            (0, 4),
            (1, 5),
            (2, 6),
            (3, 7),
        ]
    )
    lengths = np.linalg.norm(x[:, pairs[:, 0]] - x[:, pairs[:, 1]], axis=-1)
    return lengths.max(axis=1) / lengths.min(axis=1)


def hex_quality(coords: Floats, hexes: Ints) -> dict[str, float]:
    """Return the worst quality of a mesh.

    Parameters
    ----------
    coords : (n_node, 3) float64, mm
    hexes : (n_elem, 8) int32

    Returns
    -------
    dict
        ``min_scaled_jacobian``; ``min_jacobian`` and ``max_jacobian``, mm³, determinants at the
        2x2x2 Gauss points; ``max_aspect_ratio``, longest over shortest edge.
    """
    gauss = determinants(jacobian_matrices(coords, hexes, GAUSS))
    return {
        "min_scaled_jacobian": float(scaled_jacobians(coords, hexes).min()),
        "min_jacobian": float(gauss.min()),
        "max_jacobian": float(gauss.max()),
        "max_aspect_ratio": float(aspect_ratios(coords, hexes).max()),
    }


def plane_jacobian_matrices(coords: Floats, quads: Ints, points: Floats) -> Floats:
    """Return d X / d xi, (n_elem, n_point, 2, 2) in mm, at the natural coordinates `points`
    (n_point, 2)."""
    factor = 1.0 + PLANE_CORNERS * points[:, None, :]
    gradient = 0.25 * PLANE_CORNERS * factor[:, :, ::-1]
    return np.einsum("eai,qak->eqik", coords[quads][..., :2], gradient, optimize=True)


def quad_quality(coords: Floats, quads: Ints) -> dict[str, float]:
    """Return the worst quality of a plane mesh; quads : (n_elem, 4) int32, counter-clockwise.

    Keys as those of `hex_quality`; the Jacobian determinants, mm², are those at the 2x2 Gauss
    points.
    """
    gauss = np.linalg.det(plane_jacobian_matrices(coords, quads, PLANE_CORNERS / np.sqrt(3.0)))
    corner = plane_jacobian_matrices(coords, quads, PLANE_CORNERS)
    scaled = np.linalg.det(corner) / np.linalg.norm(corner, axis=-2).prod(axis=-1)
    x = coords[quads][..., :2]
    lengths = np.linalg.norm(x - np.roll(x, -1, axis=1), axis=-1)
    return {
        "min_scaled_jacobian": float(scaled.min()),
        "min_jacobian": float(gauss.min()),
        "max_jacobian": float(gauss.max()),
        "max_aspect_ratio": float((lengths.max(axis=1) / lengths.min(axis=1)).max()),
    }
