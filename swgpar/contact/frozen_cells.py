"""Freezing of the cells of all flanks: near the solution, and while a cycle of the contacts is
broken."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

from swgpar.contact.active_cells import ActiveCells
from swgpar.contact.contact import largest
from swgpar.contact.flanks import FlankContact


class FrozenCells:
    """Freezes and releases the cells of several contacts of flanks together.

    flanks : the contacts;  comm : communicator
    """

    def __init__(self, flanks: Sequence[FlankContact], comm: MPI.Comm) -> None:
        self.flanks, self.comm = flanks, comm

    def freeze(self) -> None:
        """Freeze the cells."""
        for flanks in self.flanks:
            flanks.cells.freeze()

    def release(self) -> None:
        """Place the cells anew in every evaluation."""
        for flanks in self.flanks:
            flanks.cells.release()

    def are_frozen(self) -> bool:
        """Whether cells are frozen on any rank: many ranks have no flanks in reach.
        Collective."""
        frozen = any(flanks.cells.frozen for flanks in self.flanks)
        return bool(self.comm.allreduce(int(frozen), op=MPI.MAX))

    def freeze_friction_bounds(self) -> tuple[float, float]:
        """Let the present pressures bound the friction on frozen cells.

        Returns the largest change of these pressures and the largest of them, MPa, over all ranks;
        0 without friction.
        """
        values = [(0.0, 0.0), *(flanks.cells.freeze_friction_bound() for flanks in self.flanks)]
        change, top = (largest(self.comm, max(of_all)) for of_all in zip(*values))
        return change, top

    def saved(self) -> list[ActiveCells | None]:
        """The present cells, for `restore`."""
        return [flanks.cells.active for flanks in self.flanks]

    def restore(self, saved: Sequence[ActiveCells | None]) -> None:
        """Freeze the cells that were saved."""
        for flanks, cells in zip(self.flanks, saved):
            flanks.cells.restore(cells)
