"""Known displacements and forces of a part that is cut out of the drive.

Both meet the protocol `ForceTerm`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.contact.contact import NO_KEYS
from swgpar.fem.partition import Partition
from swgpar.fem.sparse import BlockRows, add_diagonal
from swgpar.load.load_states import LoadState


@dataclass(frozen=True, eq=False)
class PrescribedDisplacement:
    """Nodes that are held at given displacements by stiff springs.

    partition : ownership
    nodes : (n,) local nodes that this rank owns, each once
    displacement : (n, 3) mm
    stiffness : N/mm of each spring, far above that of the elements
    """

    partition: Partition
    nodes: np.ndarray
    displacement: np.ndarray
    stiffness: float

    def evaluate(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Add the springs' forces and stiffness; see `ForceTerm`."""
        if residual is not None:
            residual[self.nodes] += self.stiffness * (u[self.nodes] - self.displacement)
        if rows is not None:
            add_diagonal(rows, self.partition, self.nodes, self.stiffness * np.eye(3))
        return NO_KEYS


@dataclass(frozen=True, eq=False)
class DeadLoad:
    """Forces that do not depend on the displacement.

    nodes : (n,) local nodes that this rank owns, each once;  forces : (n, 3) N
    """

    nodes: np.ndarray
    forces: np.ndarray

    def evaluate(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Add the forces to the residual; see `ForceTerm`."""
        if residual is not None:
            residual[self.nodes] -= self.forces
        return NO_KEYS
