"""What a run is asked for beside its design: the same options from the command line, Python,
studies and searches."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mpi4py import MPI

from swgpar import log
from swgpar.errors import InputError
from swgpar.input.arguments import given_path, require_number
from swgpar.input.quantities import show
from swgpar.meshing import MeshRecipe


@dataclass(frozen=True)
class RunOptions:
    """Options of a run.

    Attributes
    ----------
    out : results folder; None keeps everything in memory
    recipe : mesh recipe; None is the recipe of the package for this kind of drive
    recipe_name : of the recipe in the summary
    accuracy : estimated relative error of the largest tensile stress at the teeth up to which the
    mesh is refined
    plain : compute all that the design asks for, without shortcuts
    restart : continue from the checkpoint in `out`
    overwrite : replace results that `out` already holds
    comm : communicator of the run
    terminal : whether rank 0 reports increments on its terminal
    on_increment : called after every increment
    """

    out: Path | None = None
    recipe: MeshRecipe | None = None
    recipe_name: str = ""
    accuracy: float | None = None
    plain: bool = False
    restart: bool = False
    overwrite: bool = False
    comm: MPI.Comm = field(default_factory=lambda: MPI.COMM_WORLD)
    terminal: bool = False
    on_increment: Callable[[], None] = lambda: None

    def __post_init__(self) -> None:
        if self.accuracy is not None:
            require_number("accuracy", self.accuracy)
        if not isinstance(self.comm, MPI.Comm):
            raise InputError(f"comm = {show(self.comm)} is no communicator of mpi4py")
        for name in ("plain", "restart", "overwrite"):
            value = getattr(self, name)
            if not isinstance(value, bool):
                raise InputError(f"{name} = {show(value)} is no choice: allowed true or false")

    @classmethod
    def given(cls, out: str | Path | None, progress: bool | None, **more: Any) -> RunOptions:
        """Options from arguments of the Python interface. more : further fields

        Raises InputError for an argument of another type.
        """
        folder = None if out is None else given_path("out", out)
        terminal = log.console.is_terminal if progress is None else progress
        return cls(folder, terminal=terminal, **more)

    def require_available(self, available: frozenset[str], noun: str, *, mesh: bool) -> None:
        """Refuse what a kind of systems does not have, and a restart without a folder.

        Parameters
        ----------
        available : those of "mesh", "accuracy", "plain" and "restart" that a run has
        noun : the kind of systems in the message
        mesh : whether a mesh is given, read or not yet
        """
        given = {
            "mesh": mesh,
            "accuracy": self.accuracy is not None,
            "plain": self.plain,
            "restart": self.restart,
        }
        for name, is_given in given.items():
            if is_given and name not in available:
                raise InputError(f"{name} has no meaning for {noun}: leave it out")
        if self.restart and self.out is None:
            raise InputError(
                "restart = true needs the results folder out: a run in memory leaves no checkpoint"
            )
