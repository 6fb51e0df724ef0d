"""The rigid wave generator and its pushing pins against the inner surface of the flexible spline.

The surface is exact: its level function h, gradient and Hessian come in closed form. The gap of a
quadrature point is h at the point of the facet plus the distance from the facet to the exact
cylinder there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from swgpar.contact.contact import NO_KEYS, FacePressure
from swgpar.contact.enforcement import PressedPoints
from swgpar.contact.face_quadrature import FaceQuadrature
from swgpar.fem.elements import BodyElements
from swgpar.fem.sparse import BlockRows
from swgpar.geometry.rotation import SIXTHS, sixths_of_turn, to_images, to_owners
from swgpar.kernel import add_face_blocks
from swgpar.load.load_states import LoadState


class RigidSurface(Protocol):
    """A rigid surface in the frame of the cam, major axis along +y."""

    def evaluate(self, xyz: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Level function (n,) mm, gradient (n, 3), Hessian (n, 3, 3) 1/mm at points (n, 3) mm."""


@dataclass(frozen=True)
class SurfacePose:
    """Position of the rigid surface: rotated by `angle` (rad), every gap opened by `clearance`
    (mm).

    inset : None for the cam; for the pins, the distance (mm) by which each is drawn in towards the
    axis
    shift : mm, of the surface's axis, in the cam's frame;  lean : displacement of that axis per mm
    along z
    """

    angle: float
    clearance: float = 0.0
    inset: float | None = None
    shift: tuple[float, float] = (0.0, 0.0)
    lean: tuple[float, float] = (0.0, 0.0)

    def rotation(self) -> np.ndarray:
        """Matrix (3, 3) that takes vectors from the cam's frame to the fixed one."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return turned @ _leaning(*self.lean) if any(self.lean) else turned


def _leaning(x: float, y: float) -> np.ndarray:
    """Rotation (3, 3) that takes the axis z to the direction (x, y, 1)."""
    size = np.hypot(x, y)
    u = np.array([x, y]) / size
    cosine = 1.0 / np.hypot(1.0, size)
    sine = size * cosine
    matrix = np.eye(3)
    matrix[:2, :2] += (cosine - 1.0) * np.outer(u, u)
    matrix[:2, 2], matrix[2, :2], matrix[2, 2] = sine * u, -sine * u, cosine
    return matrix


def cam_pose(state: LoadState) -> SurfacePose | None:
    """Pose of the cam; None while it is switched off."""
    return None if state.cam_clearance is None else SurfacePose(state.angle, state.cam_clearance)


def pin_pose(state: LoadState) -> SurfacePose | None:
    """Pose of the pins; None while they are out."""
    return None if state.pin_inset is None else SurfacePose(state.angle, inset=state.pin_inset)


def pin_directions(lobes: int) -> np.ndarray:
    """Outward unit vectors (lobes, 2) of the pins, in the cam's frame."""
    return SIXTHS[sixths_of_turn(lobes, np.arange(lobes)), :2, 1]


class RigidContact(PressedPoints):
    """Face quadrature of the inner surface against a rigid surface; meets the protocol
    `PenaltyContact`.

    Parameters
    ----------
    body : elements of the flexible spline, bound to local nodes
    surface : rigid surface in the cam's frame
    pose : position of the surface in a load state, None while it is switched off
    radius : mm, exact inner radius
    half_width : mm, the surface ends at |z| = half_width
    n_quadrature : Gauss points per direction
    penalty : MPa / mm
    pin_half_angle : rad, half of the angle that a pin covers
    lobes : of the surface; each has a pin
    pressure_limit : MPa, bound of the pressure in the tangent's geometric term
    """

    def __init__(
        self,
        body: BodyElements,
        surface: RigidSurface,
        pose: Callable[[LoadState], SurfacePose | None],
        *,
        radius: float,
        half_width: float,
        n_quadrature: int,
        penalty: float,
        pin_half_angle: float,
        lobes: int = 2,
        pressure_limit: float,
    ) -> None:
        self.surface, self.pose = surface, pose
        self.pressure_limit = pressure_limit
        points = FaceQuadrature(body, "inner", radius, n_quadrature)
        super().__init__(points.weight.shape, penalty)
        self.conn = points.conn
        self.sixths = points.sixths
        self.coords = points.coords
        self.owned = points.owned
        self.shape, self.weight, self.offset = points.shape, points.weight, points.offset
        x = points.position
        self.inside = np.abs(x[..., 2]) <= half_width
        # of the pin nearest to a point: its outward direction, and the cosine of the angle to it
        along = x[..., :2] @ pin_directions(lobes).T
        self.pin = pin_directions(lobes)[along.argmax(axis=-1)].reshape(-1, 2)
        self.cosine = along.max(axis=-1) / np.hypot(x[..., 0], x[..., 1])
        self.angle_limit = np.cos(pin_half_angle)

    def is_active(self, state: LoadState) -> bool:
        """Whether the load state switches this contact on."""
        return self.pose(state) is not None

    def evaluate(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Compute gaps and pressures at u (n_local, 3) mm; add to residual (n_local, 3) N and to
        the tangent's rows.

        Returns no keys: a face's blocks are in the pattern of its elements.
        """
        pose = self.pose(state)
        if pose is None:
            return NO_KEYS
        gradient, hessian = self._find_gaps(u, pose)
        rotation = pose.rotation()
        touching = self.touching_faces()
        normal = gradient[touching] @ rotation.T
        if residual is not None:
            self._add_forces(normal, touching, residual)
        if rows is not None:
            self._add_blocks(normal, rotation @ hessian[touching] @ rotation.T, touching, rows)
        return NO_KEYS

    def normals(self, u: np.ndarray, state: LoadState) -> np.ndarray:
        """Set gaps and pressures at u (n_local, 3) mm in a load state with this contact; returns
        the level's gradients (n_face, n_q, 3)."""
        pose = self.pose(state)
        return self._find_gaps(u, pose)[0] @ pose.rotation().T

    def add_owned_forces(self, u: np.ndarray, state: LoadState, residual: np.ndarray) -> None:
        """Add the forces of the faces that this rank owns to residual (n_local, 3) N."""
        pose = self.pose(state)
        if pose is not None:
            gradient, _ = self._find_gaps(u, pose)
            touching = self.touching_faces()
            touching = touching[self.owned[touching]]
            self._add_forces(gradient[touching] @ pose.rotation().T, touching, residual)

    def _find_gaps(self, u: np.ndarray, pose: SurfacePose) -> tuple[np.ndarray, np.ndarray]:
        """Set gaps and pressures.

        Returns gradients (n_face, n_q, 3) and Hessians (n_face, n_q, 3, 3) of the level in the
        cam's frame.
        """
        field = np.where(self.conn[..., None] >= 0, u[self.conn], 0.0)
        x = np.einsum("qa,fai->fqi", self.shape, self.coords + to_images(field, self.sixths))
        points = (x @ pose.rotation()).reshape(-1, 3)
        if any(pose.shift):
            points[:, :2] -= pose.shift
        reachable = self.inside
        if pose.inset is not None:
            points[:, :2] += pose.inset * self.pin
            reachable = reachable & (self.cosine >= self.angle_limit)
        level, gradient, hessian = self.surface.evaluate(points)
        shape = self.weight.shape
        self.set_gap(level.reshape(shape) + self.offset + pose.clearance, reachable)
        return gradient.reshape(*shape, 3), hessian.reshape(*shape, 3, 3)

    def _add_forces(self, normal: np.ndarray, faces: np.ndarray, residual: np.ndarray) -> None:
        """Add the pressure's forces on `faces` along the level's gradients `normal` (n, n_q, 3)."""
        force = (self.pressure * self.weight)[faces]
        nodal = -np.einsum("fq,qa,fqi->fai", force, self.shape, normal)
        sixths, conn = self.sixths[faces], self.conn[faces]
        nodal = to_owners(nodal, sixths)
        free = conn >= 0
        for axis in range(3):
            residual[:, axis] += np.bincount(
                conn[free], nodal[..., axis][free], minlength=len(residual)
            )

    def _add_blocks(
        self, normal: np.ndarray, curvature: np.ndarray, faces: np.ndarray, rows: BlockRows
    ) -> None:
        """Add the tangent: penalty times normal times normal, less the pressure times the curvature
        (n, n_q, 3, 3)."""
        force = (self.pressure * self.weight)[faces]
        stiffness = np.where(self.pressure[faces] > 0.0, self.penalty * self.weight[faces], 0.0)
        # far from the solution the penalty's pressure is meaningless, and its geometric term would
        # make the tangent indefinite: it is bounded there
        geometric = np.minimum(force, self.pressure_limit * self.weight[faces])
        core = (
            stiffness[..., None, None] * normal[..., :, None] * normal[..., None, :]
            - geometric[..., None, None] * curvature
        )
        blocks = np.einsum("fqij,qa,qb->fabij", core, self.shape, self.shape, optimize=True)
        add_face_blocks(self.conn[faces], self.sixths[faces], np.ascontiguousarray(blocks), rows)

    def owned_pressure(self) -> FacePressure:
        """Pressures of the last evaluation on owned faces."""
        own = self.owned
        return FacePressure(self.conn[own], self.shape, self.weight[own], self.pressure[own])
