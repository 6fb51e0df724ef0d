"""What the discrete problem asks of its parts: force terms, contacts, contacts with a penalty.

Only flanks search for pairs and freeze cells; see `swgpar.contact.flanks.FlankContact`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from mpi4py import MPI

from swgpar.fem.sparse import BlockRows
from swgpar.load.load_states import LoadState

NO_KEYS = np.zeros(0, dtype=np.int64)
"""No blocks of the tangent."""


@dataclass(frozen=True)
class FacePressure:
    """Pressures of the last evaluation on faces that this rank owns.

    conn : (n_face, 4) local nodes, -1 without unknowns
    shape : (n_q, 4) or (n_face, n_q, 4) shape functions;  weight : (n_face, n_q) mm²;  pressure :
    (n_face, n_q) MPa
    """

    conn: np.ndarray
    shape: np.ndarray
    weight: np.ndarray
    pressure: np.ndarray


class ForceTerm(Protocol):
    """What adds forces to the residual and blocks to the tangent."""

    def evaluate(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Add to residual (n_local, 3) N and to the tangent's rows at u (n_local, 3) mm.

        All ranks call it together: an implementation may communicate. Returns keys (n,) of blocks
        that the pattern of `rows` lacks.
        """


class Contact(ForceTerm, Protocol):
    """A force term of two surfaces that touch or do not: cam, pins, race, balls and flanks.

    `evaluate` also computes gaps and pressures. All ranks call `add_owned_forces` together.
    """

    def is_active(self, state: LoadState) -> bool:
        """Whether the load state switches this contact on."""

    def add_owned_forces(self, u: np.ndarray, state: LoadState, residual: np.ndarray) -> None:
        """Add the forces of the faces that this rank owns, each face once over all ranks."""

    def active_sets(self) -> list[np.ndarray]:
        """Arrays that tell which points or faces touch, and which slip, in the last evaluation on
        this rank."""


class PressureContact(Contact, Protocol):
    """A contact of faces: all but the balls, whose approach is elastic.

    `reset` begins it anew at every contact search; all other methods may follow in any order.
    """

    def reset(self) -> None:
        """Forget gaps and pressures."""

    def scale_penalty(self, share: float) -> None:
        """Use this share of the full stiffness."""

    def owned_pressure(self) -> FacePressure | None:
        """Pressures of the last evaluation on owned faces; None without faces."""


class PenaltyContact(PressureContact, Protocol):
    """A contact with a rigid surface, enforced by a penalty and multipliers.

    multiplier : (n_face, n_q) MPa, of the augmented Lagrangian
    """

    multiplier: np.ndarray

    def augment(self) -> None:
        """Take the pressures of the last evaluation as multipliers."""

    def penetration(self) -> float:
        """Largest penetration (mm) of the last evaluation on this rank."""


def largest(comm: MPI.Comm, value: float) -> float:
    """Maximum over all ranks; collective."""
    return float(comm.allreduce(value, op=MPI.MAX))
