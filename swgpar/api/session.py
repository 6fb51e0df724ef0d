"""Runs of drives that follow each other in one process and share what does not change."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

from mpi4py import MPI

from swgpar.api.runs import DesignLike, MeshLike, run_with
from swgpar.errors import SwgparError
from swgpar.input.arguments import require_number
from swgpar.input.require import require
from swgpar.run_options import RunOptions

if TYPE_CHECKING:
    from swgpar.analysis.model_sources import LoadedDrives
    from swgpar.systems import Result


MOST_MODELS = 100
"""Models that a session may keep."""


class Session:
    """Runs that share meshes, contacts, factors and loaded states; collective, as `run`.

    For an application or a loop in which one key changes at a time. Under another load a drive is
    not meshed again, and without friction the iteration begins with the loaded state of the nearest
    torque. An equilibrium does not depend on the path to it, so the answers are those of separate
    runs to the tolerances of the solvers. With friction, with another geometry or mesh and with
    other keys that change the model a run builds its own, which is kept for the next ones.

    Parameters
    ----------
    models : int
        Models that are kept, those that were used last: a drive on one mesh each. A run with
        windows has two meshes of the drive, in the plane three.
    starts_near : bool
        Whether a drive whose numbers differ by up to 2 % from those of one that is kept begins with
        its loaded state, without friction. Where more than one equilibrium exists, as with teeth
        that may engage otherwise, it finds that next to the other drive's.
    stop : callable, optional
        Called on rank 0 after every Newton iteration. Where it returns True the run ends with
        `TimeLimitError`, and the session goes on.

    Raises
    ------
    InputError
        `models` is out of range.

    Examples
    --------
    >>> with swgpar.Session() as session:
    ...     for torque in (2.0, 2.5, 3.0):
    ...         design = swgpar.load_design("drive.toml", {"load.torque": torque})
    ...         print(session.run(design).summary["root.s1"].value)
    """

    def __init__(
        self,
        models: int = 6,
        comm: MPI.Comm = MPI.COMM_WORLD,
        *,
        starts_near: bool = False,
        stop: Callable[[], bool] | None = None,
    ) -> None:
        require_number("models", models)
        require(1 <= models <= MOST_MODELS, "models", models, f"1 to {MOST_MODELS}")
        self.models, self.comm, self.starts_near = int(models), comm, starts_near
        self.stop = stop
        self._drives: LoadedDrives | None = None

    def run(
        self,
        design: DesignLike,
        mesh: MeshLike | None = None,
        out: str | Path | None = None,
        *,
        accuracy: float | None = None,
        plain: bool = False,
        overwrite: bool = False,
        progress: bool | None = None,
    ) -> Result:
        """Run a design; collective. Arguments, result and errors are those of `swgpar.run`."""
        from swgpar.analysis.model_sources import LoadedDrives  # starts PETSc
        from swgpar.solve.time_limit import stopped_by
        from swgpar.systems.drive import Drives

        if self._drives is None:
            self._drives = LoadedDrives(
                self.models, keeps_windows=True, starts_near=self.starts_near
            )
        given = RunOptions.given(
            out, progress, accuracy=accuracy, plain=plain, overwrite=overwrite, comm=self.comm
        )
        try:
            with stopped_by(self.stop):
                return run_with(given, design, mesh, Drives(self._drives))
        except SwgparError:
            raise
        except BaseException:  # a model that was interrupted in a solve is of no use
            self._drives = None
            raise

    def close(self) -> None:
        """Release all models; collective. The next run begins anew."""
        if self._drives is not None:
            self._drives.destroy()
            self._drives = None

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
