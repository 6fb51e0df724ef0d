"""A solved state of a drive in a file: rows by sector, multipliers, what is modelled in full."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mpi4py import MPI

from swgpar.analysis.identity import identity
from swgpar.contact import friction
from swgpar.errors import OutputError
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.vectors import read_field, write_field
from swgpar.log import logger
from swgpar.model.drive_model import DriveModel
from swgpar.results import made_files, parallel_hdf5
from swgpar.results.atomic import agreed, on_root
from swgpar.results.checkpoint import read_checkpoint, require_undamaged, write_checkpoint
from swgpar.results.folder import START_STATES
from swgpar.results.parallel_hdf5 import Block


@dataclass(frozen=True)
class SolvedState:
    """What a state has beside its rows.

    multipliers : of the constraints
    modelled_sectors : as `ModelledSectors.chosen` gives them
    """

    multipliers: list[float]
    modelled_sectors: list[list[int]]

    @classmethod
    def of(cls, model: DriveModel) -> SolvedState:
        """Of the model's present state; collective."""
        return cls(model.problem.multipliers().tolist(), model.problem.modelled.chosen())


def _friction_row(ring: str, row: str) -> str:
    """Name in a file of a row of the tractions of a ring gear. row : one of `friction.ROWS`"""
    return f"friction/{ring}/{row}"


def state_rows(
    model: DriveModel, displacement: Mapping[str, np.ndarray] | None = None
) -> dict[str, Block]:
    """Displacements of all bodies by name, with friction the tractions of flanks too; collective.

    displacement : by body, (n_sectors, n_local, 3) mm of the owned sectors; None takes the model's
    """
    blocks, partition = {}, model.partition
    for name, layout in partition.layouts.items():
        if displacement is None:
            own = partition.owned_indices(name)
            values = read_field(partition, name, own, model.problem.x)
        else:
            values = np.ascontiguousarray(displacement[name])
        blocks[name] = Block(values, partition.owned_sectors(name)[0], layout.count)
    if model.design.contact.friction:
        first, end = partition.owned_sectors(FLEXIBLE_SPLINE)
        for flanks in model.problem.flanks:
            for row, values in flanks.traction_rows(first, end).items():
                name = _friction_row(flanks.ring.layout.name, row)
                blocks[name] = Block(values, first, partition.layouts[FLEXIBLE_SPLINE].count)
    return blocks


def restore_state(model: DriveModel, path: Path, solved: SolvedState) -> None:
    """Bring back a state from the rows in the file, on any number of ranks; collective."""
    partition, problem = model.partition, model.problem
    owned = {name: partition.owned_sectors(name) for name in partition.layouts}
    ranges = {name: (first, end - first) for name, (first, end) in owned.items()}
    arrays = parallel_hdf5.read_rows(path, model.comm, ranges)
    for name in owned:
        write_field(partition, name, arrays[name], problem.x)
    if model.comm.rank == model.comm.size - 1:
        problem.x.array[-partition.n_multipliers :] = solved.multipliers
    problem.resume_sectors(solved.modelled_sectors)
    if model.design.contact.friction:
        # a rank needs the flanks that its ring teeth face too
        every = (0, partition.layouts[FLEXIBLE_SPLINE].count)
        tractions = {}
        for ring in (flanks.ring.layout.name for flanks in problem.flanks):
            names = {row: _friction_row(ring, row) for row in friction.ROWS}
            read = parallel_hdf5.read_rows(path, model.comm, dict.fromkeys(names.values(), every))
            tractions[ring] = friction.from_rows({row: read[name] for row, name in names.items()})
        problem.resume(tractions)


class StartStates:
    """Keeps the loaded states on the meshes of a start, until the run has a checkpoint.

    A run that starts on coarser meshes, or chooses its mesh, has nothing in its checkpoint for some
    time. Every mesh that has reached the load leaves a file meanwhile. A restart goes the same way
    again and takes these states over.

    folder : results folder; None keeps nothing
    """

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder

    def _path(self, model: DriveModel) -> Path | None:
        """File of the model's loaded state; None where none is kept."""
        # a state with friction depends on the path to it
        if self.folder is None or model.design.contact.friction:
            return None
        what = identity(model.design.decisive_keys, model.recipe, None)
        return self.folder / START_STATES.replace("*", what[:12])

    def save(self, model: DriveModel) -> None:
        """Write the model's present state; collective. Raises OutputError."""
        if (path := self._path(model)) is not None:
            write_checkpoint(path, model.comm, state_rows(model), SolvedState.of(model))

    def restore(self, model: DriveModel) -> bool:
        """Set the model's x to the state on this mesh; False where there is none. Collective."""
        path = self._path(model)
        if path is None or not on_root(model.comm, path.exists):
            return False
        try:
            require_undamaged(path, model.comm)
            restore_state(model, path, read_checkpoint(path, model.comm, SolvedState))
        except OutputError as error:
            logger.info("a loaded state is computed again: %s", error)
            return False
        logger.info("the loaded state on a mesh of %d elements is taken over", model.n_elements())
        return True

    def found(self, comm: MPI.Comm) -> bool:
        """Whether there are files, of this design or of another; collective."""
        folder = self.folder
        return folder is not None and on_root(comm, lambda: any(folder.glob(START_STATES)))

    def remove(self, comm: MPI.Comm) -> None:
        """Remove the files: the checkpoint has all that a restart needs. Collective."""
        if self.folder is None:
            return
        with agreed(comm, self.folder):
            if comm.rank == 0:
                made_files.remove(self.folder, [START_STATES])
