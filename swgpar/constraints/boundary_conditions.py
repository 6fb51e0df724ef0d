"""Boundary conditions of a part that is cut out of the drive: displacements and forces that are known.

Both meet the protocol `Contact`, so that a discrete problem takes them as it takes contacts.
"""

from __future__ import annotations

import numpy as np

from swgpar.contact.contact import NO_KEYS
from swgpar.fem.partition import Partition
from swgpar.fem.sparse import BlockRows, add_diagonal
from swgpar.load.load_states import LoadState


class BoundaryCondition:
    """What both have in common: always on, without gaps or pressures."""

    def __init__(self) -> None:
        self.multiplier = np.zeros((0, 1))

    def is_active(self, state: LoadState) -> bool:
        """Always."""
        return True

    def reset(self) -> None:
        """Nothing is to be forgotten."""

    def scale_penalty(self, share: float) -> None:
        """Nothing is to be softened."""

    def augment(self) -> None:
        """There are no multipliers."""

    def penetration(self) -> float:
        """Zero."""
        return 0.0

    def active_sets(self) -> list[np.ndarray]:
        """None."""
        return []

    def owned_pressure(self) -> None:
        """None."""


class PrescribedDisplacement(BoundaryCondition):
    """Nodes that are held at given displacements by stiff springs.

    Parameters
    ----------
    partition : ownership
    nodes : (n,) local nodes that this rank owns, each once
    displacement : (n, 3) mm
    stiffness : N/mm of each spring, far above that of the elements
    """

    def __init__(self, partition: Partition, nodes: np.ndarray, displacement: np.ndarray, stiffness: float) -> None:
        super().__init__()
        self.partition, self.nodes = partition, nodes
        self.displacement, self.stiffness = displacement, stiffness

    def evaluate(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Add the springs' forces and stiffness; see `Contact`."""
        self.add_owned_forces(u, state, residual)
        if rows is not None:
            add_diagonal(rows, self.partition, self.nodes, self.stiffness * np.eye(3))
        return NO_KEYS

    def add_owned_forces(self, u: np.ndarray, state: LoadState, residual: np.ndarray | None) -> None:
        """Add the springs' forces to residual (n_local, 3) N."""
        if residual is not None:
            residual[self.nodes] += self.stiffness * (u[self.nodes] - self.displacement)


class DeadLoad(BoundaryCondition):
    """Forces that do not depend on the displacement.

    Parameters
    ----------
    nodes : (n,) local nodes that this rank owns, each once;  forces : (n, 3) N
    """

    def __init__(self, nodes: np.ndarray, forces: np.ndarray) -> None:
        super().__init__()
        self.nodes, self.forces = nodes, forces

    def evaluate(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Add the forces to the residual; see `Contact`."""
        self.add_owned_forces(u, state, residual)
        return NO_KEYS

    def add_owned_forces(self, u: np.ndarray, state: LoadState, residual: np.ndarray | None) -> None:
        """Add the forces to residual (n_local, 3) N."""
        if residual is not None:
            residual[self.nodes] -= self.forces
