"""The distributing coupling on the bore.

The coupling ties six quantities of the bore to a reference point without stiffening the bore: the mean
displacement, the mean tilts and the mean rotation about z of its nodes, weighted by their area. The rotation

    phi = atan2(sum w (X x dx)_z, sum w (X . dx)),   X, dx taken from the weighted means,

is the best-fitting rigid rotation in the plane; the torque T enters through its potential -T phi, so that
it is work-conjugate to phi at any rotation (section 3.4.5, "Load application").
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.assembly import BodyElements
from swgpar.partition import Partition

ROTATION = 5
"""Coupled quantities: displacement x, y, z, tilts about x and y, rotation about z."""


@dataclass
class BoreState:
    """Values (6,) and gradients (6, n_local_bore, 3) of the coupled quantities."""

    value: np.ndarray
    gradient: np.ndarray


def node_weights(coords: np.ndarray, nodes: np.ndarray, ccw: np.ndarray) -> np.ndarray:
    """Tributary area of bore nodes of one sector (arc length times axial share), closed over the sector.

    coords : (n, 3) mm, sector 0;  nodes : (k,) local;  ccw : local nodes that the next sector owns
    """
    x, y, z = coords[nodes].T
    angle = np.round(np.arctan2(-x, y), 9)
    z = np.round(z / max(np.ptp(z), 1e-300), 9)

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


class BoreCoupling:
    """Mean motions of the bore of the flexible spline's cup.

    Parameters
    ----------
    partition : ownership
    body : elements of the flexible spline on this rank (bound to local nodes)
    images : the model holds half a turn; then only z and the rotation can be non-zero
    """

    def __init__(self, partition: Partition, body: BodyElements, images: bool) -> None:
        self.comm = partition.comm
        self.images = images
        mesh = body.layout.mesh
        nodes = mesh.node_sets["bore"]
        weight = node_weights(mesh.coords, nodes, mesh.ccw_nodes)
        keep = weight > 0
        nodes, weight = nodes[keep], weight[keep]
        sectors = np.arange(len(body.sectors))[body.owned]
        self.nodes = body.local[np.ix_(sectors, nodes)].ravel()
        self.reference = body.positions()[np.ix_(sectors, nodes)].reshape(-1, 3)
        self.weight = np.tile(weight, len(sectors))
        total = self.sum(self.weight)
        self.weight = self.weight / total
        center = np.zeros(3) if images else self.sum(self.weight[:, None] * self.reference)
        center[2] = self.sum(self.weight * self.reference[:, 2])
        self.arm = self.reference - center
        self.radius2 = float(self.sum(self.weight * (self.arm[:, 0] ** 2 + self.arm[:, 1] ** 2)))
        self.active = np.array([not images, not images, True, not images, not images, True])

    def sum(self, value: np.ndarray) -> np.ndarray:
        """Sum over all nodes of the bore, on all ranks."""
        local = np.sum(np.asarray(value, dtype=float), axis=0)
        return self.comm.allreduce(local, op=MPI.SUM)

    def evaluate(self, u: np.ndarray) -> BoreState:
        """Coupled quantities (mm, mm, mm, rad, rad, rad) and their gradients at displacement u (n_local, 3)."""
        v, w, arm = u[self.nodes], self.weight, self.arm
        mean = self.sum(w[:, None] * v)
        if self.images:
            mean[:2] = 0.0
        x, y = arm[:, 0] + v[:, 0] - mean[0], arm[:, 1] + v[:, 1] - mean[1]
        sine, cosine = self.sum(
            np.column_stack([w * (arm[:, 0] * y - arm[:, 1] * x), w * (arm[:, 0] * x + arm[:, 1] * y)])
        )
        tilt_x, tilt_y = (
            self.sum(np.column_stack([w * arm[:, 1] * v[:, 2], -w * arm[:, 0] * v[:, 2]])) * 2.0 / self.radius2
        )
        value = np.array([*mean, tilt_x, tilt_y, np.arctan2(sine, cosine)])
        gradient = np.zeros((6, len(w), 3))
        for k in range(3):
            gradient[k, :, k] = w
        gradient[3, :, 2] = 2.0 / self.radius2 * w * arm[:, 1]
        gradient[4, :, 2] = -2.0 / self.radius2 * w * arm[:, 0]
        norm = cosine * cosine + sine * sine
        gradient[5, :, 0] = w * (-cosine * arm[:, 1] - sine * arm[:, 0]) / norm
        gradient[5, :, 1] = w * (cosine * arm[:, 0] - sine * arm[:, 1]) / norm
        return BoreState(value, gradient)

    def supports(self) -> np.ndarray:
        """Six unit directions (6, n_local_bore, 3) on single nodes that hold the bore as a rigid body.

        They ground the structure inside a factorisation and are taken out again exactly; see `Bordered`.
        Half a model needs two of them only: axial and tangential at one node.
        """
        pick = np.zeros((6, len(self.nodes), 3))
        angle = np.mod(np.arctan2(-self.arm[:, 0], self.arm[:, 1]), 2.0 * np.pi)
        places = (0.0,) if self.images else (0.0, 2.0 * np.pi / 3.0, 4.0 * np.pi / 3.0)
        for k, place in enumerate(places):
            # the first node at the smallest angular distance, by rank: exactly one node in the whole model
            distance = np.abs(np.mod(angle - place + np.pi, 2.0 * np.pi) - np.pi)
            best = (
                (float(np.round(distance.min(), 9)), self.comm.rank, int(distance.argmin()))
                if len(distance)
                else (9.0, self.comm.rank, 0)
            )
            winner = min(self.comm.allgather(best))
            if winner[1] == self.comm.rank:
                node = winner[2]
                a = self.arm[node]
                pick[2 * k, node, 2] = 1.0
                pick[2 * k + 1, node, :2] = np.array([-a[1], a[0]]) / np.hypot(a[0], a[1])
        return pick
