"""Distributing coupling on the bore (in the plane the inner surface) or the ring's outer surface.

The coupling ties six quantities of a surface to a reference point without stiffening it: the mean
displacement, the mean tilts and the mean rotation about z of its nodes, weighted by their area. The
rotation

    phi = atan2(sum w (X x dx)_z, sum w (X . dx)),   X, dx taken from the weighted means,

is the best-fitting rigid rotation in the plane; the torque T enters through its potential -T phi,
so that it is work-conjugate to phi at any rotation (section 3.4.5, "Load application").
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from mpi4py import MPI

from swgpar.fem.elements import BodyElements
from swgpar.fem.partition import Partition
from swgpar.geometry.rotation import rotated

X, Y, Z, TILT_X, TILT_Y, ROTATION = range(6)
"""Coupled quantities: displacements along x, y and z, tilts about x and y, rotation about z."""

N_COUPLED = 6
"""Coupled quantities of a surface."""


@dataclass
class MeanMotion:
    """Values (6,) and gradients (6, n_local, 3) of the coupled quantities."""

    value: np.ndarray
    gradient: np.ndarray


class Coupling(Protocol):
    """Quantities of nodes that may be prescribed.

    nodes : (n,) local nodes;  active : (6,) bool, quantities that are prescribed
    """

    nodes: np.ndarray
    active: np.ndarray

    def evaluate(self, u: np.ndarray) -> MeanMotion:
        """Coupled quantities and their gradients at displacement u (n_local, 3); collective."""

    def supports(self) -> np.ndarray:
        """Directions (m, n, 3) on single nodes that support the body rigidly; collective."""


def node_weights(coords: np.ndarray, nodes: np.ndarray, ccw: np.ndarray) -> np.ndarray:
    """Area of a sector's surface nodes (arc length times axial share), closed over the sector.

    coords : (n, 3) mm, sector 0;  nodes : (k,) local;  ccw : local nodes that the next sector owns
    """
    x, y, z = coords[nodes].T
    angle = np.round(np.arctan2(-x, y), 9)
    z = np.round((z - z.min()) / (np.ptp(z) or 1.0), 9)

    def share(values: np.ndarray, closed: bool) -> np.ndarray:
        level, inverse = np.unique(values, return_inverse=True)
        if len(level) == 1:
            return np.ones(len(values))
        gap = np.diff(level)
        left = np.concatenate([[gap[-1] if closed else 0.0], gap])
        right = np.concatenate([gap, [gap[0] if closed else 0.0]])
        return (0.5 * (left + right))[inverse]

    weight = share(angle, True) * share(z, False)
    return np.where(np.isin(nodes, ccw), 0.0, weight)


class NodeMeans(ABC):
    """Mean motions of nodes of a body; meets the protocol `Coupling`.

    partition : ownership
    nodes : (n,) local nodes that this rank owns, each once;  undeformed : (n, 3) mm, their places
    weight : (n,) of the nodes in the means, of any sum
    images : the model is a part of the drive; then only z and the rotation can be non-zero
    fixed_axis : the rotation is about the drive's axis, not about the mean place of the nodes

    Attributes:
    total : sum of the weights of all ranks;  weight : (n,) over that sum
    center : (3,) mm;  arm : (n, 3) mm, places from there
    movable : (5,) bool, displacements and tilts that a bearing of the body may leave free
    rotation_norm : 1/mm, norm of the undeformed gradient of the rotation over all nodes
    """

    active: np.ndarray
    movable: np.ndarray

    def __init__(
        self,
        partition: Partition,
        nodes: np.ndarray,
        undeformed: np.ndarray,
        weight: np.ndarray,
        *,
        images: bool,
        fixed_axis: bool,
    ) -> None:
        self.comm = partition.comm
        self.images, self.fixed_axis = images, fixed_axis
        self.nodes, self.undeformed = nodes, undeformed
        self.total = float(self.sum(weight))
        self.weight = weight / self.total
        center = np.zeros(3) if fixed_axis else self.sum(self.weight[:, None] * self.undeformed)
        center[2] = self.sum(self.weight * self.undeformed[:, 2])
        self.center, self.arm = center, self.undeformed - center
        squares = self.arm[:, 0] ** 2 + self.arm[:, 1] ** 2
        self.radius2 = float(self.sum(self.weight * squares))
        self.rotation_norm = float(np.sqrt(self.sum(self.weight**2 * squares)) / self.radius2)
        self.solid = partition.dims == 3

    def sum(self, value: np.ndarray) -> np.ndarray:
        """Sum over all nodes of the surface, on all ranks."""
        local = np.sum(np.asarray(value, dtype=float), axis=0)
        return self.comm.allreduce(local, op=MPI.SUM)

    def evaluate(self, u: np.ndarray) -> MeanMotion:
        """Coupled quantities (mm and rad) and their gradients at displacement u (n_local, 3) mm."""
        v, w, arm = u[self.nodes], self.weight, self.arm
        mean = self.sum(w[:, None] * v)
        if self.fixed_axis:
            mean[:2] = 0.0
        x, y = arm[:, 0] + v[:, 0] - mean[0], arm[:, 1] + v[:, 1] - mean[1]
        across, along = arm[:, 0] * y - arm[:, 1] * x, arm[:, 0] * x + arm[:, 1] * y
        sine, cosine = self.sum(np.column_stack([w * across, w * along]))
        rotation = float(np.arctan2(sine, cosine))
        turned = rotated(arm[:, :2], rotation)
        tilts = self.sum(np.column_stack([w * turned[:, 1] * v[:, 2], -w * turned[:, 0] * v[:, 2]]))
        tilt_x, tilt_y = tilts * 2.0 / self.radius2
        value = np.array([*mean, tilt_x, tilt_y, rotation])
        gradient = np.zeros((N_COUPLED, len(w), 3))
        for k in (X, Y, Z):
            gradient[k, :, k] = w
        norm = cosine * cosine + sine * sine
        gradient[ROTATION, :, 0] = w * (-cosine * arm[:, 1] - sine * arm[:, 0]) / norm
        gradient[ROTATION, :, 1] = w * (cosine * arm[:, 0] - sine * arm[:, 1]) / norm
        # the axes of the tilts stand in space, while the arms rotate
        gradient[TILT_X] = -tilt_y * gradient[ROTATION]
        gradient[TILT_Y] = tilt_x * gradient[ROTATION]
        gradient[TILT_X, :, 2] += 2.0 / self.radius2 * w * turned[:, 1]
        gradient[TILT_Y, :, 2] -= 2.0 / self.radius2 * w * turned[:, 0]
        return MeanMotion(value, gradient)

    @abstractmethod
    def supports(self) -> np.ndarray:
        """Directions (m, n, 3) on single nodes that support the body rigidly; collective."""


class DistributingCoupling(NodeMeans):
    """Mean motions of a surface of a body.

    partition : ownership
    body : elements of the body on this rank (bound to local nodes);  surface : name of its node set
    images : the model holds half a turn; then only z and the rotation can be non-zero
    centred : whether the mean displacement along x and y is coupled
    """

    def __init__(
        self,
        partition: Partition,
        body: BodyElements,
        surface: str,
        images: bool,
        centred: bool = True,
    ) -> None:
        mesh = body.layout.mesh
        nodes = mesh.node_sets[surface]
        weight = node_weights(mesh.coords, nodes, mesh.ccw_nodes)
        weighted = weight > 0
        nodes, weight = nodes[weighted], weight[weighted]
        own, undeformed = body.local[body.owned, nodes], body.positions()[body.owned, nodes]
        super().__init__(
            partition,
            own.ravel(),
            undeformed.reshape(-1, 3),
            np.tile(weight, len(own)),
            images=images,
            fixed_axis=images,
        )
        whole = not images
        held = whole and centred
        self.active = np.array(
            [held, held, self.solid, whole and self.solid, whole and self.solid, True]
        )
        self.movable = self.active[:ROTATION]

    def supports(self) -> np.ndarray:
        """Unit directions (n, n_local, 3) on single nodes that support the body rigidly.

        They ground the structure inside a factorisation and are taken out again exactly; see
        `BorderedSystem`. A solid body needs six of them, axial and tangential at three nodes. A
        plane body needs the tangential ones only. The model of a part of the drive needs those of
        one node.
        """
        wanted_angles = (0.0,) if self.images else (0.0, 2.0 * np.pi / 3.0, 4.0 * np.pi / 3.0)
        angle = np.mod(np.arctan2(-self.arm[:, 0], self.arm[:, 1]), 2.0 * np.pi)
        directions = []
        for wanted in wanted_angles:
            # the first node at the smallest angular distance, by rank: exactly one node in the
            # whole model
            distance = np.abs(np.mod(angle - wanted + np.pi, 2.0 * np.pi) - np.pi)
            best = (9.0, self.comm.rank, 0)
            if len(distance):
                least = float(np.round(distance.min(), 9))
                best = (least, self.comm.rank, int(distance.argmin()))
            winner = min(self.comm.allgather(best))
            axial, tangential = np.zeros((2, len(self.nodes), 3))
            if winner[1] == self.comm.rank:
                node = winner[2]
                a = self.arm[node]
                axial[node, 2] = 1.0
                tangential[node, :2] = np.array([-a[1], a[0]]) / np.hypot(a[0], a[1])
            directions += [axial, tangential] if self.solid else [tangential]
        return np.array(directions)
