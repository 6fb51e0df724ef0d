"""What holds the drive and loads its output: couplings, housing, and the grounding that a factorisation needs."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from swgpar.constraints.distributing_coupling import ROTATION, DistributingCoupling, Housing
from swgpar.design.load_states import LoadState
from swgpar.fem.partition import Partition
from swgpar.fem.sparse import BlockRows
from swgpar.fem.vectors import create_vector

GROUNDING = 0.1
"""Stiffness of the grounding over E times the module."""


class Supports:
    """The couplings of all bodies that float, the output's last.

    Parameters
    ----------
    partition : ownership
    couplings : six multipliers each, in this order at the end of the vector;  housing : around the ring gear, or None
    scale : unit of the multipliers and of the grounding: E times the module, N/mm
    share : of the drive that is modelled
    """

    def __init__(
        self,
        partition: Partition,
        couplings: list[DistributingCoupling],
        housing: Housing | None,
        scale: float,
        share: float,
    ) -> None:
        self.partition, self.couplings, self.housing = partition, couplings, housing
        self.scale, self.share = scale, share
        self.ground_vectors: list[PETSc.Vec] = []
        self.grounded: list[tuple[int, np.ndarray]] = []
        for coupling in couplings:
            for support in coupling.supports():
                vector = create_vector(partition)
                array = vector.array.reshape(-1, 3)
                for i in np.flatnonzero(np.abs(support).sum(axis=1)):
                    direction = np.sqrt(GROUNDING * scale) * support[i]
                    array[coupling.nodes[i]] += direction
                    self.grounded.append((int(coupling.nodes[i]), direction))
                self.ground_vectors.append(vector)

    def controls(self, scene: LoadState) -> list[tuple[int, int]]:
        """Coupling and quantity that are prescribed, in pairs."""
        active = [(i, int(k)) for i, c in enumerate(self.couplings) for k in np.flatnonzero(c.active)]
        if scene.control == "torque":
            active.remove((len(self.couplings) - 1, ROTATION))
        return active

    def unused(self, scene: LoadState) -> np.ndarray:
        """Which multipliers the scene does not use; bool, one entry each."""
        unused = np.ones(self.partition.n_multipliers, dtype=bool)
        unused[[6 * i + k for i, k in self.controls(scene)]] = False
        return unused

    def turn(self, u: np.ndarray) -> float:
        """Turn (rad) of the output at displacement u (n_local, 3)."""
        return float(self.couplings[-1].evaluate(u).value[ROTATION])

    def ring_turn(self, u: np.ndarray) -> float:
        """Turn (rad) of the ring gear, zero when that is fixed."""
        return self.turn(u) if len(self.couplings) > 1 else 0.0

    def add_ring_moment(self, u: np.ndarray, moment: float, residual: np.ndarray) -> None:
        """Add to residual (n_local, 3) N this rank's share of a moment (N mm) on a ring gear that is not fixed."""
        if len(self.couplings) > 1:
            ring, moment = self.couplings[-1], self.partition.comm.allreduce(moment, op=MPI.SUM)
            residual[ring.nodes] += moment * ring.evaluate(u).gradient[ROTATION]

    def add_forces(self, u: np.ndarray, scene: LoadState, multiplier: np.ndarray, residual: np.ndarray) -> np.ndarray:
        """Add forces of multipliers, load and housing to residual (n_local, 3) N; returns the multipliers' rows."""
        if self.housing is not None:
            self.housing.add_forces(u, residual)
        motion = [coupling.evaluate(u) for coupling in self.couplings]
        target = np.zeros((len(motion), 6))
        target[-1, ROTATION] = scene.rotation
        tail = self.scale * multiplier  # unused ones are zero; used ones are overwritten below
        for i, k in self.controls(scene):
            gradient = motion[i].gradient[k]
            residual[self.couplings[i].nodes] += self.scale * multiplier[6 * i + k] * gradient
            tail[6 * i + k] = self.scale * (motion[i].value[k] - target[i, k])
        if scene.control == "torque":
            residual[self.couplings[-1].nodes] -= self.share * scene.torque * motion[-1].gradient[ROTATION]
        return tail

    def add_blocks(self, u: np.ndarray, rows: BlockRows) -> None:
        """Add the grounding and the housing's stiffness to the tangent's diagonal."""
        for node, direction in self.grounded:
            self._add_diagonal(rows, np.array([node]), np.outer(direction, direction))
        if self.housing is not None:
            self._add_diagonal(rows, self.housing.nodes, self.housing.blocks(u))

    def _add_diagonal(self, rows: BlockRows, nodes: np.ndarray, blocks: np.ndarray) -> None:
        keys = (self.partition.row_start + nodes.astype(np.int64)) * (self.partition.n_global + 1)
        rows.values[np.searchsorted(rows.keys, keys)] += blocks

    def border(self, u: np.ndarray, scene: LoadState) -> tuple[list[PETSc.Vec], list[int]]:
        """Gradients of all quantities that are prescribed, the output's turn last in any case, and their rows."""
        controls = self.controls(scene)
        if scene.control == "torque":
            controls.append((len(self.couplings) - 1, ROTATION))
        motion, border = [coupling.evaluate(u) for coupling in self.couplings], []
        for i, k in controls:
            vector = create_vector(self.partition)
            vector.array.reshape(-1, 3)[self.couplings[i].nodes] = self.scale * motion[i].gradient[k]
            border.append(vector)
        return border, [6 * i + k for i, k in controls]

    def reactions(self, multiplier: np.ndarray) -> np.ndarray:
        """Torques (N mm) about z of the whole drive that hold the floating bodies, from the multipliers."""
        return -self.scale * multiplier[ROTATION::6] / self.share
