"""Quadrature of a cylindrical surface of a body, on the faces that a rank evaluates."""

from __future__ import annotations

import numpy as np

from swgpar.fem.elements import BodyElements

CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
"""Parameters of the nodes of a face."""


class FaceQuadrature:
    """Gauss points on the faces of a surface.

    Parameters
    ----------
    body : elements of the body, bound to local nodes;  surface : name of its faces
    radius : mm, exact radius of the surface
    order : Gauss points per direction
    sectors : indices among those of the body; without it the owned ones and the one before them
    that another rank owns

    Attributes
    ----------
    faces : (n_sector_face, 4) nodes of a sector;  sectors : indices of the sectors among those of
    the body
    conn, sixths : (n_face, 4) local nodes and image flags, sector by sector;  coords : (n_face, 4,
    3) mm, undeformed
    owned : (n_face,) bool, faces that this rank owns
    shape : (n_q, 4) shape functions;  position : (n_face, n_q, 3) mm, undeformed, on the facets
    weight : (n_face, n_q) mm², exact area of the cylinder above the facet, not the facet's
    offset : (n_face, n_q) mm, from the facet outward to the cylinder
    """

    def __init__(
        self,
        body: BodyElements,
        surface: str,
        radius: float,
        order: int,
        sectors: np.ndarray | None = None,
    ) -> None:
        self.faces = body.layout.mesh.faces[surface]
        first = body.owned.start
        if sectors is None:
            sectors = np.r_[np.flatnonzero(body.preceding), np.arange(first, body.owned.stop)]
        self.sectors = sectors
        self.conn = np.ascontiguousarray(body.local[self.sectors][:, self.faces].reshape(-1, 4))
        self.sixths = np.ascontiguousarray(body.sixths[self.sectors][:, self.faces].reshape(-1, 4))
        self.coords = body.positions()[self.sectors][:, self.faces].reshape(-1, 4, 3)
        self.owned = np.repeat(self.sectors >= first, len(self.faces))
        counts = [order, order]
        if (
            body.layout.mesh.plane
        ):  # nothing changes along z, in which one of the two directions of a face runs
            along = np.ptp(body.layout.mesh.coords[self.faces[0, :2], 2]) == 0.0
            counts[int(along)] = 1
        (point_a, weight_a), (point_b, weight_b) = (
            np.polynomial.legendre.leggauss(n) for n in counts
        )
        a, b = (v.ravel() for v in np.meshgrid(point_a, point_b, indexing="ij"))
        weight = np.outer(weight_a, weight_b).ravel()
        self.shape = 0.25 * (1 + a[:, None] * CORNERS[:, 0]) * (1 + b[:, None] * CORNERS[:, 1])
        da = 0.25 * CORNERS[:, 0] * (1 + b[:, None] * CORNERS[:, 1])
        db = 0.25 * CORNERS[:, 1] * (1 + a[:, None] * CORNERS[:, 0])
        normal = np.cross(
            np.einsum("qa,fai->fqi", da, self.coords), np.einsum("qa,fai->fqi", db, self.coords)
        )
        self.position = np.einsum("qa,fai->fqi", self.shape, self.coords)
        radial = np.hypot(self.position[..., 0], self.position[..., 1])
        self.weight = np.linalg.norm(normal, axis=2) * weight * radius / radial
        self.offset = body.layout.body.stretch * (radius - radial)
