"""What the command line, the Python API and studies need of a kind of systems."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, Protocol, Self, TypeVar

import numpy as np
from mpi4py import MPI

from swgpar.answers.answer import NO_LIMIT, Answer
from swgpar.input.design import Design
from swgpar.input.toml_file import Overrides
from swgpar.meshing import MeshRecipe
from swgpar.results.figure_set import FigureSet
from swgpar.results.quantity import Quantity
from swgpar.run_options import RunOptions


class Result(Protocol):
    """Result of a run, the same on every rank; `DriveResult` and `TrainResult` are results."""

    @property
    def history(self) -> Mapping[str, np.ndarray]:
        """Columns of history.csv, each (n,)."""

    @property
    def summary(self) -> Mapping[str, Answer]:
        """The answers of the run, by name."""

    @property
    def design_table(self) -> Mapping[str, Any]:
        """The whole design, defaults included."""

    @property
    def folder(self) -> Path | None:
        """The results folder; None when the run was in memory."""

    @property
    def plot(self) -> FigureSet:
        """The figures."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """Numbers that a study takes from a run.

    values : all quantities by name, without those that the run does not have
    unbounded : names of those that grow with every finer mesh
    answers : of the run, with errors and places, by name
    wall_s : seconds, None where they are not known
    elements, newton_mean : of the mesh, and Newton iterations of an increment; None without a mesh
    history : columns of the history that are drawn against the angle of the wave generator; empty
    without one
    """

    values: dict[str, float] = field(default_factory=dict)
    wall_s: float | None = None
    unbounded: frozenset[str] = frozenset()
    answers: Mapping[str, Answer] = field(default_factory=dict)
    elements: int | None = None
    newton_mean: float | None = None
    history: Mapping[str, np.ndarray] = field(default_factory=dict)

    @classmethod
    def of(cls, answers: Mapping[str, Answer], wall_s: float, **more: Any) -> Measured:
        """The answers that have a value. more : further fields"""
        values = {n: answer.value for n, answer in answers.items() if answer.value is not None}
        unbounded = frozenset(n for n, answer in answers.items() if answer.no_error == NO_LIMIT)
        return cls(values=values, wall_s=wall_s, unbounded=unbounded, answers=answers, **more)


D = TypeVar("D", bound=Design)
R = TypeVar("R", bound=Result)


class System(ABC, Generic[D, R]):
    """A kind of systems: its design files, runs and results, of classes D and R.

    noun : what one is called in messages, with its article
    options : which of the options "mesh", "accuracy", "plain" and "restart" a run has
    """

    noun: str
    options: frozenset[str]

    @abstractmethod
    def load(self, table: dict[str, Any], overrides: Overrides = ()) -> D:
        """A checked design from the content of its file and overrides; problems are InputErrors."""

    @abstractmethod
    def check(self, design: D) -> dict[str, float]:
        """What follows from a design at once; the names have units."""

    def remarks(self, design: D) -> list[str]:
        """Sentences about what is allowed and may not be meant."""
        return []

    @abstractmethod
    def run(self, design: D, options: RunOptions) -> R:
        """Run a design; collective. Options have values as far as `options` names them."""

    def take_over(self, design: D, options: RunOptions) -> None:
        """A run of an earlier call is kept: later runs that share something with it begin as after
        it; collective. By default nothing is shared."""

    @abstractmethod
    def open(self, folder: Path, comm: MPI.Comm) -> R:
        """Result of a finished run from its folder; collective, every rank reads the files."""

    @abstractmethod
    def print(self, result: R) -> None:
        """Show a result on the terminal; call it on one rank."""

    @abstractmethod
    def report(self, result: R) -> bytes:
        """The page report.html of a result that has a folder; call it on one rank."""

    @abstractmethod
    def draws_figures(self, design: D) -> bool:
        """Whether a run with a results folder draws its figures."""

    # what studies need

    @abstractmethod
    def without_output(self, table: dict[str, Any]) -> dict[str, Any]:
        """The content of a design file without what the many runs of a study should not write."""

    @abstractmethod
    def quantities(self, design: D) -> dict[str, Quantity]:
        """What a run of the design gives, by name."""

    @abstractmethod
    def main_quantities(self, known: Mapping[str, Quantity]) -> tuple[str, ...]:
        """Names of the quantities in tables and figures when the study names none."""

    @abstractmethod
    def describe_names(self, known: Mapping[str, Quantity]) -> str:
        """The names of quantities that are allowed, in words."""

    def check_published(self, design: D, names: Iterable[str]) -> None:
        """Refuse published quantities that a run of this design leaves out, with an InputError."""

    def increments(self, design: D) -> int:
        """Increments of the whole run."""
        return 1

    def dimensions(self, design: D) -> int:
        """Dimensions of the mesh: 2 or 3; 0 without one."""
        return 0

    @abstractmethod
    def identity(self, design: D, recipe: MeshRecipe | None) -> dict[str, Any]:
        """What is computed, for restarts: "identity", and what finished runs must share besides."""

    @contextmanager
    def shared(self) -> Iterator[Self]:
        """The system for runs of one design under several loads: they share what they can inside of
        the `with` block. Collective over the ranks of the runs."""
        yield self

    @abstractmethod
    def measure(self, result: R) -> Measured:
        """The numbers that a study takes from a result."""
