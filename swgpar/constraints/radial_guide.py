"""Rigid ring around the ring gear as output: outer nodes stay on their circle (section 5.8).

Stiff radial springs, as hard as contact. The nodes are free along the circle and the axis. Where a
bearing carries the output, the ring follows the gear: the line of the centres of its circles is the
straight one with the least energy of the springs, which then have no resultant.
"""

from __future__ import annotations

import numpy as np

from swgpar.constraints.distributing_coupling import NodeMeans
from swgpar.materials import NO_GROWTH, Growth

CENTRE_ROUNDS, CENTRE_ACCURACY = 20, 1e-14
"""Most steps of the search for the centre line, and the last one over the radius."""


class RadialGuide:
    """Radial springs on the nodes of a coupled surface.

    coupling : of the outer surface;  area : mm², of the modelled surface;  penalty : MPa / mm
    growth : of the rigid ring;  follows : whether the ring follows the gear
    """

    def __init__(
        self,
        coupling: NodeMeans,
        area: float,
        penalty: float,
        growth: Growth = NO_GROWTH,
        *,
        follows: bool = False,
    ) -> None:
        self.nodes, self.position = coupling.nodes, coupling.undeformed[:, :2]
        self.radius = (1.0 + growth.across) * np.hypot(*self.position.T)
        self.stiffness = penalty * area * coupling.weight
        self._sum = coupling.sum
        x_and_y = np.tile(np.eye(2), (len(self.nodes), 1, 1))
        along = coupling.arm[:, 2, None, None] * x_and_y
        # (n, 2, m): displacements of the circles by the parameters of the centre line
        motions = [x_and_y, along] if coupling.solid else [x_and_y]
        self._motions = np.concatenate(motions if follows else [x_and_y[:, :, :0]], axis=2)

    def _radial(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Radii (n,) mm, outward normals (n, 2) and forces along them (n,) N at u (n_local, 3)."""
        x = self.position + u[self.nodes, :2]
        if self._motions.shape[2]:
            x = x - self._motions @ self._centre_line(x)
        r = np.hypot(*x.T)
        return r, x / r[:, None], self.stiffness * (r - self.radius)

    def _centre_line(self, x: np.ndarray) -> np.ndarray:
        """Parameters (m,) of the centre line for nodes at x (n, 2) mm; collective."""
        line = np.zeros(self._motions.shape[2])
        for _ in range(CENTRE_ROUNDS):
            moved = x - self._motions @ line
            r = np.hypot(*moved.T)
            by_line = self._by_line(moved / r[:, None])
            force, radius = self.stiffness * (r - self.radius), self.stiffness * self.radius
            sums = np.column_stack([force[:, None] * by_line, radius, self.stiffness])
            *pull, radii, total = self._sum(sums)
            step = np.linalg.solve(self._hessian(by_line), np.array(pull))
            line += step
            if np.abs(step[:2]).max() <= CENTRE_ACCURACY * radii / total:
                break
        return line

    def _by_line(self, normal: np.ndarray) -> np.ndarray:
        """Motions (n, m) of the circles along normals (n, 2)."""
        return np.einsum("ni,nim->nm", normal, self._motions)

    def _hessian(self, by_line: np.ndarray) -> np.ndarray:
        """Second derivative (m, m) of the energy by the centre line; collective."""
        return self._sum(self.stiffness[:, None, None] * by_line[:, :, None] * by_line[:, None, :])

    def add_forces(self, u: np.ndarray, residual: np.ndarray) -> None:
        """Add to residual (n_local, 3) N."""
        _, normal, force = self._radial(u)
        residual[self.nodes, :2] += force[:, None] * normal

    def blocks(self, u: np.ndarray) -> np.ndarray:
        """Tangent blocks (n, 3, 3) N/mm of the nodes, without the part of `free_motions`."""
        r, normal, force = self._radial(u)
        blocks = np.zeros((len(r), 3, 3))
        nn = normal[:, :, None] * normal[:, None, :]
        bent = (force / r)[:, None, None]
        blocks[:, :2, :2] = self.stiffness[:, None, None] * nn + bent * (np.eye(2) - nn)
        return blocks

    def free_motions(self, u: np.ndarray) -> np.ndarray:
        """Vectors B (m, n, 3) of the part -B B^T of the tangent: the ring follows the gear."""
        _, normal, _ = self._radial(u)
        by_line = self._by_line(normal)
        inverse = np.linalg.inv(np.linalg.cholesky(self._hessian(by_line)))
        vectors = np.zeros((len(inverse), len(self.nodes), 3))
        shares = (self.stiffness[:, None] * by_line) @ inverse.T
        vectors[:, :, :2] = shares.T[:, :, None] * normal
        return vectors
