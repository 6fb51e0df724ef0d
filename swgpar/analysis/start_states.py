"""Loaded states on the meshes of a start, in files of the results folder until the run has a checkpoint.

A run that starts on coarser meshes, or chooses its mesh, has nothing in its checkpoint for some time. Every mesh that
has reached the load leaves a file meanwhile. A restart goes the same way again and takes these states over.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from mpi4py import MPI

from swgpar.analysis.identity import identity
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import OutputError
from swgpar.fem.vectors import read_field, write_field
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.model.drive_model import DriveModel
from swgpar.results.atomic import agreed
from swgpar.results.checkpoint import read_checkpoint, require_undamaged, write_checkpoint
from swgpar.results.folder import START_STATES


class StartStates:
    """Keeps loaded states in a folder.

    Parameters
    ----------
    folder : results folder; None keeps nothing
    design : of the run
    """

    def __init__(self, folder: Path | None, design: DriveDesign) -> None:
        self.folder, self.design = folder, design

    def _name(self, recipe: MeshRecipe) -> str:
        return START_STATES.replace("*", identity(self.design, recipe, None)[:12])

    def save(self, model: DriveModel, recipe: MeshRecipe) -> None:
        """Write the model's present state; collective. Raises OutputError."""
        if self.folder is None or self.design.contact.friction:
            return
        blocks, problem = {}, model.problem
        for k, layout in enumerate(model.partition.layouts):
            first, end = model.partition.owned_sectors(k)
            field = read_field(model.partition, k, np.arange(first, end), problem.x)
            blocks[layout.name] = field, first, layout.count
        state = {"multipliers": problem.multipliers().tolist(), "modelled_sectors": problem.modelled_sectors()}
        write_checkpoint(self.folder, model.comm, blocks, state, name=self._name(recipe))

    def restore(self, model: DriveModel, recipe: MeshRecipe) -> bool:
        """Set the model's x to the state on this mesh; False where there is none. Collective."""
        if self.folder is None or self.design.contact.friction:  # the state is more than the displacements
            return False
        path = self.folder / self._name(recipe)
        if not model.comm.bcast(path.exists() if model.comm.rank == 0 else None):
            return False
        partition, x = model.partition, model.problem.x
        owned = [partition.owned_sectors(k) for k in range(len(partition.layouts))]
        ranges = {layout.name: (a, b - a) for layout, (a, b) in zip(partition.layouts, owned)}
        try:
            require_undamaged(path, model.comm)
            arrays, state = read_checkpoint(path, model.comm, ranges)
        except OutputError as error:
            logger.info("a loaded state is computed again: %s", error)
            return False
        for k, layout in enumerate(partition.layouts):
            write_field(partition, k, np.arange(*owned[k]), arrays[layout.name], x)
        if model.comm.rank == model.comm.size - 1:
            x.array[-partition.n_multipliers :] = state["multipliers"]
        model.problem.resume_sectors(state["modelled_sectors"])
        logger.info("the loaded state on a mesh of %d elements is taken over", model.n_elements())
        return True

    def found(self, comm: MPI.Comm) -> bool:
        """Whether there are files, of this design or of another; collective."""
        here = comm.rank == 0 and self.folder is not None and any(self.folder.glob(START_STATES))
        return bool(comm.bcast(here))

    def remove(self, comm: MPI.Comm) -> None:
        """Remove the files: the checkpoint has all that a restart needs. Collective."""
        if self.folder is None:
            return
        with agreed(comm, self.folder):
            if comm.rank == 0:
                for path in self.folder.glob(START_STATES):
                    path.unlink()
