"""Loaded states on the meshes of a start, in files of the results folder until the run has a
checkpoint.

A run that starts on coarser meshes, or chooses its mesh, has nothing in its checkpoint for some
time. Every mesh that has reached the load leaves a file meanwhile. A restart goes the same way
again and takes these states over.
"""

from __future__ import annotations

from pathlib import Path

from mpi4py import MPI

from swgpar.analysis.identity import identity
from swgpar.analysis.saved_state import SolvedState, restore_state, state_rows
from swgpar.errors import OutputError
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
    """

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder

    def _path(self, model: DriveModel, recipe: MeshRecipe) -> Path | None:
        """File of the model's loaded state on the mesh of this recipe; None where none is kept."""
        if (
            self.folder is None or model.design.contact.friction
        ):  # a state with friction depends on the path to it
            return None
        return self.folder / START_STATES.replace("*", identity(model.design, recipe, None)[:12])

    def save(self, model: DriveModel, recipe: MeshRecipe) -> None:
        """Write the model's present state; collective. Raises OutputError."""
        if (path := self._path(model, recipe)) is not None:
            write_checkpoint(path, model.comm, state_rows(model), SolvedState.of(model))

    def restore(self, model: DriveModel, recipe: MeshRecipe) -> bool:
        """Set the model's x to the state on this mesh; False where there is none. Collective."""
        path = self._path(model, recipe)
        if path is None:
            return False
        if not model.comm.bcast(path.exists() if model.comm.rank == 0 else None):
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
