"""The rigid wave generator and its pushing pins against the inner surface of the flexible spline.

The surface is exact: its level function h, gradient and Hessian come in closed form. The gap of a quadrature
point is h at the point of the facet plus the distance from the facet to the exact cylinder there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from swgpar.contact.enforcement import penetration, pressure
from swgpar.fem.elements import BodyElements
from swgpar.fem.sparse import BlockRows
from swgpar.geometry.rotation import HALF_TURN
from swgpar.kernel import add_face_blocks


class Surface(Protocol):
    def evaluate(self, xyz: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Level function (n,), gradient (n, 3), Hessian (n, 3, 3) in the cam's frame, major axis along +y."""


@dataclass(frozen=True)
class CamPose:
    """Where the rigid surface is: turned by `angle` (rad), every gap opened by `opening` (mm).

    inset : None for the cam; for the pins, the distance (mm) by which each is drawn in along the major axis
    """

    angle: float
    opening: float = 0.0
    inset: float | None = None


class RigidContact:
    """Face quadrature of the inner surface against a rigid surface.

    Parameters
    ----------
    body : elements of the flexible spline, bound to local nodes
    surface : rigid surface in the cam's frame
    radius : mm, exact inner radius
    half_width : mm, the surface ends at |z| = half_width
    n_quadrature : Gauss points per direction
    pin_half_angle : rad, half of the angle a pin covers
    pressure_limit : MPa, bound of the pressure in the tangent's geometric term
    """

    def __init__(
        self,
        body: BodyElements,
        surface: Surface,
        radius: float,
        half_width: float,
        n_quadrature: int,
        penalty: float,
        pin_half_angle: float,
        pressure_limit: float,
    ) -> None:
        self.surface, self.penalty, self.pressure_limit = surface, penalty, pressure_limit
        faces = body.layout.mesh.faces["inner"]
        first = body.owned.start
        sectors = np.r_[np.flatnonzero(body.preceding), np.arange(first, body.owned.stop)]
        self.conn = np.ascontiguousarray(body.local[sectors][:, faces].reshape(-1, 4))
        self.flip = np.ascontiguousarray(body.flip[sectors][:, faces].reshape(-1, 4))
        self.coords = body.positions()[sectors][:, faces].reshape(-1, 4, 3)
        self.owned = np.repeat(sectors >= first, len(faces))
        point, weight = np.polynomial.legendre.leggauss(n_quadrature)
        a, b = (v.ravel() for v in np.meshgrid(point, point, indexing="ij"))
        weight = np.outer(weight, weight).ravel()
        corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        self.shape = 0.25 * (1 + a[:, None] * corner[:, 0]) * (1 + b[:, None] * corner[:, 1])
        da = 0.25 * corner[:, 0] * (1 + b[:, None] * corner[:, 1])
        db = 0.25 * corner[:, 1] * (1 + a[:, None] * corner[:, 0])
        normal = np.cross(np.einsum("qa,fai->fqi", da, self.coords), np.einsum("qa,fai->fqi", db, self.coords))
        x = np.einsum("qa,fai->fqi", self.shape, self.coords)
        radial = np.hypot(x[..., 0], x[..., 1])
        # the exact area of the cylinder above the facet, not the facet's
        self.weight = np.linalg.norm(normal, axis=2) * weight * radius / radial
        self.offset = radius - radial
        self.inside = np.abs(x[..., 2]) <= half_width
        self.cosine = np.abs(x[..., 1]) / radial
        self.angle_limit = np.cos(pin_half_angle)
        self.reset()

    def reset(self) -> None:
        """Forget the multipliers."""
        self.multiplier = np.zeros_like(self.weight)
        self.gap = np.full_like(self.weight, np.inf)
        self.pressure = np.zeros_like(self.weight)

    def augment(self) -> None:
        """Take the pressures of the last evaluation as multipliers."""
        self.multiplier = self.pressure.copy()

    def evaluate(
        self,
        u: np.ndarray,
        pose: CamPose,
        residual: np.ndarray | None,
        rows: BlockRows | None,
        owned_only: bool = False,
    ) -> None:
        """Gaps and pressures at displacement u (n_local, 3); adds to residual (n_local, 3) and tangent rows."""
        field = np.where(self.conn[..., None] >= 0, u[self.conn], 0.0)
        field[self.flip == 1] *= HALF_TURN
        x = np.einsum("qa,fai->fqi", self.shape, self.coords + field)
        c, s = np.cos(pose.angle), np.sin(pose.angle)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        points = (x @ turn).reshape(-1, 3)
        active = self.inside
        if pose.inset is not None:
            points[:, 1] += pose.inset * np.sign(points[:, 1])
            active = active & (self.cosine >= self.angle_limit)
        level, gradient, hessian = self.surface.evaluate(points)
        shape = self.weight.shape
        self.gap = np.where(active, level.reshape(shape) + self.offset + pose.opening, np.inf)
        self.pressure = np.where(active, pressure(np.where(active, self.gap, 0.0), self.multiplier, self.penalty), 0.0)
        touching = (self.pressure > 0.0).any(axis=1)
        if owned_only:
            touching &= self.owned
        pick = np.flatnonzero(touching)
        gradient = (gradient.reshape(*shape, 3)[pick]) @ turn.T
        force = (self.pressure * self.weight)[pick]
        if residual is not None:
            nodal = -np.einsum("fq,qa,fqi->fai", force, self.shape, gradient)
            flip, conn = self.flip[pick], self.conn[pick]
            nodal[flip == 1] *= HALF_TURN
            free = conn >= 0
            for axis in range(3):
                residual[:, axis] += np.bincount(conn[free], nodal[..., axis][free], minlength=len(residual))
        if rows is not None:
            bend = turn @ hessian.reshape(*shape, 3, 3)[pick] @ turn.T
            stiff = np.where(self.pressure[pick] > 0.0, self.penalty * self.weight[pick], 0.0)
            # far from the solution the penalty's pressure is meaningless, and its geometric term would make the
            # tangent indefinite: it is bounded there
            geometric = np.minimum(force, self.pressure_limit * self.weight[pick])
            core = (
                stiff[..., None, None] * gradient[..., :, None] * gradient[..., None, :]
                - geometric[..., None, None] * bend
            )
            blocks = np.einsum("fqij,qa,qb->fabij", core, self.shape, self.shape, optimize=True)
            add_face_blocks(self.conn[pick], self.flip[pick], np.ascontiguousarray(blocks), rows)

    def penetration(self) -> float:
        """Largest penetration (mm) of the last evaluation on this rank."""
        return penetration(self.gap, self.pressure)
