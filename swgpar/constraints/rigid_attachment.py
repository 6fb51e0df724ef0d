"""Closed end or flange on a rigid flange, which is the output or stands still.

Both faces of the attached area move as one rigid body about the drive's axis. They are bedded on it
with the stiffness of a contact, per area, no stiffer than what the elements resolve. The energy is

    E = k / 2 sum a |x - R(phi) X - offset|^2,   phi = atan2(sum a (X x x)_z, sum a (X . x)),

with the areas a of the nodes, and their places X on the flange, which grows as the body does.
Growth leaves its axis and its middle plane where they are. phi makes E the least: the bedding is
free of moment, and a torque with the potential -T phi is work-conjugate to phi. The tangent is k a
on the nodes less one rank, k |sum a R X . x| grad phi grad phi^T.

Where a bearing carries the output, the flange moves too: its offset is the one with the least E,
and the bedding has no resultant. With the motions P of the nodes by displacements and tilts of the
flange, this takes k a P (sum k a P^T P)^-1 P^T k a from the tangent.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from swgpar.constraints.distributing_coupling import (
    N_COUPLED,
    ROTATION,
    TILT_X,
    TILT_Y,
    MeanMotion,
    NodeMeans,
    Z,
)
from swgpar.contact.face_quadrature import CORNERS
from swgpar.fem.elements import BodyElements
from swgpar.fem.partition import Partition
from swgpar.geometry.rotation import rotated
from swgpar.materials import NO_GROWTH, Growth
from swgpar.meshing.sector import SectorMesh

POINTS = 16
"""Points across the attached area at which is asked whether they belong to it."""

Inside = Callable[[np.ndarray], np.ndarray]
"""Whether points (..., 2) mm of the undeformed drive belong to the attached area."""


def face_sides(mesh: SectorMesh, surface: str) -> np.ndarray:
    """Lengths (n, 4) mm of the sides of a sector's plane faces."""
    corners = mesh.coords[mesh.faces[surface]][..., :2]
    return np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)


def area_shares(
    mesh: SectorMesh, surface: str, angle: float, inside: Inside, width: float
) -> np.ndarray:
    """Areas (n_node,) mm² of the nodes on plane faces of a sector within the attached area.

    angle : rad, of the sector;  width : mm, of the attached area across its narrowest place
    """
    faces = mesh.faces[surface]
    corners = rotated(mesh.coords[faces][..., :2], angle)
    sides = face_sides(mesh, surface).max(axis=0)
    counts = (int(np.ceil(POINTS * max(sides[k], sides[k + 2]) / width)) for k in (0, 1))
    at_a, at_b = ((2.0 * np.arange(n) + 1.0) / n - 1.0 for n in counts)
    a, b = (v.ravel()[:, None] for v in np.meshgrid(at_a, at_b, indexing="ij"))
    shape = 0.25 * (1 + a * CORNERS[:, 0]) * (1 + b * CORNERS[:, 1])
    along_a = 0.25 * CORNERS[:, 0] * (1 + b * CORNERS[:, 1])
    along_b = 0.25 * CORNERS[:, 1] * (1 + a * CORNERS[:, 0])
    areas = np.zeros(len(mesh.coords))
    for face, points in zip(faces, corners, strict=True):
        within = inside(shape @ points)
        da, db = along_a[within] @ points, along_b[within] @ points
        area = np.abs(da[:, 0] * db[:, 1] - da[:, 1] * db[:, 0]) * 4.0 / len(shape)
        areas[face] += area @ shape[within]
    return areas


class RigidAttachment(NodeMeans):
    """The attached area of a body as a coupling: only its rotation is prescribed or loaded.

    partition : ownership
    body : elements of the body on this rank;  surface : name of its plane faces
    inside : which points of them are attached;  width : mm, of the attached area across its
    narrowest place
    penalty : MPa / mm;  images : the model holds half a turn;  growth : of the flange
    moves : whether a bearing carries the flange, which then follows the body
    """

    def __init__(
        self,
        partition: Partition,
        body: BodyElements,
        surface: str,
        inside: Inside,
        width: float,
        *,
        penalty: float,
        images: bool,
        growth: Growth = NO_GROWTH,
        moves: bool = False,
    ) -> None:
        layout, mesh = body.layout, body.layout.mesh
        angles = layout.chain_angle(body.sectors[body.owned])
        around = [
            area_shares(mesh, surface, angle, inside, width)
            for angle in (*(angles[:1] - mesh.pitch), *angles)
        ]
        areas = np.array(around[1:]).reshape(len(angles), len(mesh.coords))
        for row, before in zip(areas, around[:-1], strict=False):
            # nodes between two sectors belong to the second one, with the shares of both
            row[mesh.cw_nodes] += before[mesh.ccw_nodes]
        areas[:, mesh.ccw_nodes] = 0.0
        used = areas > 0.0
        super().__init__(
            partition,
            body.local[body.owned][used],
            body.positions()[body.owned][used],
            areas[used],
            images=images,
            fixed_axis=images or not moves,
        )
        self.stiffness, self.moves = penalty * self.total * self.weight, moves
        self.on_flange = self.arm + growth.of(self.arm)
        self.active = np.arange(N_COUPLED) == ROTATION
        # of a part of the drive by symmetry only the displacement along z is not zero
        self.movable = np.full(ROTATION, not images) | (np.arange(ROTATION) == Z)

    def supports(self) -> np.ndarray:
        """None: the bedding supports the body."""
        return np.zeros((0, len(self.nodes), 3))

    def evaluate(self, u: np.ndarray) -> MeanMotion:
        """Coupled quantities; of a flange that moves its displacements and tilts."""
        motion = super().evaluate(u)
        if not self.moves:
            return motion
        rotation, by_flange = motion.value[ROTATION], self._by_flange(motion.value[ROTATION])
        weighted = self.weight[:, None, None] * by_flange
        inverse = np.linalg.inv(self.sum(np.einsum("nik,nil->nkl", weighted, by_flange)))
        shift = self.arm + u[self.nodes] - self._turned(rotation)
        value, movable = motion.value, np.flatnonzero(self.movable)
        value[movable] = inverse @ self.sum(np.einsum("nik,ni->nk", weighted, shift))
        gradient = np.zeros_like(motion.gradient)
        gradient[ROTATION] = motion.gradient[ROTATION]
        # the axes of the tilts stand in space, while the flange rotates
        gradient[TILT_X] = -value[TILT_Y] * gradient[ROTATION]
        gradient[TILT_Y] = value[TILT_X] * gradient[ROTATION]
        gradient[movable] += np.einsum("kl,nil->kni", inverse, weighted)
        return MeanMotion(value, gradient)

    def _turned(self, rotation: float) -> np.ndarray:
        """Places (n, 3) mm of the nodes on the rotated flange, from its middle."""
        turned = self.on_flange.copy()
        turned[:, :2] = rotated(turned[:, :2], rotation)
        return turned

    def _by_flange(self, rotation: float) -> np.ndarray:
        """Displacements (n, 3, m) of the nodes by those and by the tilts of the rotated flange that
        are movable."""
        motions, (x, y, z) = np.zeros((len(self.nodes), 3, ROTATION)), self._turned(rotation).T
        motions[:, :, :TILT_X] = np.eye(3)
        motions[:, 1, TILT_X], motions[:, 2, TILT_X] = -z, y
        motions[:, 0, TILT_Y], motions[:, 2, TILT_Y] = z, -x
        return motions[:, :, self.movable]

    def _stretch(self, u: np.ndarray, offset: np.ndarray) -> np.ndarray:
        """Displacements (n, 3) mm of the nodes from the rigid flange.

        offset : (6,) mm and rad, displacements and tilts of a flange that does not follow the body
        """
        value = self.evaluate(u).value
        offset = value if self.moves else offset
        shift = self.arm + u[self.nodes] - self._turned(value[ROTATION])
        return shift - self._by_flange(value[ROTATION]) @ offset[:ROTATION][self.movable]

    def add_forces(self, u: np.ndarray, offset: np.ndarray, residual: np.ndarray) -> None:
        """Add the forces of the bedding to residual (n_local, 3) N. offset : see `_stretch`"""
        forces = self.stiffness[:, None] * self._stretch(u, offset)
        residual[self.nodes] += forces
        if self.moves:
            # the axes of the tilts stand in space, so that E of a tilted flange depends on phi
            motion = self.evaluate(u)
            tilted = self._turned(motion.value[ROTATION])[:, :2] @ motion.value[[TILT_X, TILT_Y]]
            moment = float(self.sum(forces[:, 2] * tilted))
            residual[self.nodes] -= moment * motion.gradient[ROTATION]

    def blocks(self) -> np.ndarray:
        """Tangent blocks (n, 3, 3) N/mm of the nodes, without the part of `free_motions`."""
        return self.stiffness[:, None, None] * np.eye(3)

    def free_motions(self, u: np.ndarray) -> np.ndarray:
        """Vectors B (m, n, 3) of the part -B B^T of the tangent: the flange rotates freely, and
        where a bearing carries it, moves."""
        motion = self.evaluate(u)
        moved = self.arm[:, :2] + u[self.nodes, :2]
        x, y = self.on_flange[:, :2].T
        parts = np.column_stack(
            [x * moved[:, 1] - y * moved[:, 0], x * moved[:, 0] + y * moved[:, 1]]
        )
        reach = np.hypot(*self.sum(self.stiffness[:, None] * parts))
        rotates = np.sqrt(reach) * motion.gradient[ROTATION]
        if not self.moves:
            return rotates[None]
        by_flange = self._by_flange(motion.value[ROTATION])
        weighted = self.stiffness[:, None, None] * by_flange
        hessian = self.sum(np.einsum("nik,nil->nkl", weighted, by_flange))
        inverse = np.linalg.inv(np.linalg.cholesky(hessian))
        return np.concatenate([rotates[None], np.einsum("kl,nil->kni", inverse, weighted)])
