"""What a study is of: how designs are made, which numbers come out of them, what a job runs and leaves behind."""

from __future__ import annotations

import difflib
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mpi4py import MPI

from swgpar.errors import InputError
from swgpar.meshing import MeshRecipe
from swgpar.studies.spec import CaseSection, Study


@dataclass(frozen=True)
class Quantity:
    """A number that a run gives. meaning : without its unit;  unit : empty for a number"""

    meaning: str
    unit: str


@dataclass(frozen=True)
class Outcome:
    """What became of a job.

    status : "finished" or "failed";  reason : one sentence, empty when finished
    values : all quantities by name, without those that the run does not have; empty when failed
    elements, newton_mean : of a drive: of its mesh, and Newton iterations of an increment
    rows : as in the history.csv of a drive
    kept : whether an earlier call of the study had finished it
    """

    status: str
    reason: str = ""
    values: dict[str, float] = field(default_factory=dict)
    elements: int | None = None
    newton_mean: float | None = None
    wall_s: float | None = None
    rows: list[dict[str, Any]] = field(default_factory=list)
    kept: bool = False


@dataclass(frozen=True)
class Case:
    """A design of the study.

    varied : value of every varied key as the study file has it
    design : None when it is refused, for the reason in `refusal`
    known : its quantities by name, empty when refused;  shown : names of those in tables and figures
    meshes : recipes, coarse to fine, none of a gear train;  compared : place of the one for published values
    """

    name: str
    varied: dict[str, Any]
    design: Any | None
    refusal: str
    known: Mapping[str, Quantity]
    shown: tuple[str, ...]
    meshes: tuple[Path, ...]
    compared: int
    section: CaseSection
    system: System


@dataclass(frozen=True)
class Job:
    """A case, on one of its meshes if it has any. finer : number of finer meshes of the case."""

    case: Case
    mesh: Path | None
    recipe: MeshRecipe | None
    finer: int

    @property
    def mesh_name(self) -> str:
        """Empty without a mesh."""
        return self.mesh.stem if self.mesh is not None else ""

    @property
    def title(self) -> str:
        return f"{self.case.name} {self.mesh_name}".rstrip()

    @property
    def increments(self) -> int:
        """Increments of the whole run."""
        return self.case.system.increments(self.case.design) if self.case.design is not None else 0

    def folder(self, out: Path) -> Path:
        """Results folder of this job below that of the study."""
        return out / "cases" / self.case.name / self.mesh_name


class System(ABC):
    """A kind of designs that studies compute."""

    details: tuple[str, ...]
    """Columns of study.csv that follow the name of the case: mesh, elements, newton_mean, or some of them."""

    @abstractmethod
    def base(self, table: dict[str, Any]) -> dict[str, Any]:
        """The content of a design file as a study starts from it: without what its many runs should not write."""

    @abstractmethod
    def meshes(self, study: Study, case: CaseSection) -> tuple[Path, ...]:
        """Recipes of a case, coarse to fine; InputError when they do not fit this kind of designs."""

    @abstractmethod
    def make(self, table: dict[str, Any], case: CaseSection) -> Any:
        """The checked design; InputError when it is refused."""

    @abstractmethod
    def quantities(self, design: Any) -> dict[str, Quantity]:
        """What a run of the design gives, by name."""

    @abstractmethod
    def shown(self, known: Mapping[str, Quantity]) -> tuple[str, ...]:
        """Names in tables and figures when the study names none."""

    @abstractmethod
    def naming(self, known: Mapping[str, Quantity]) -> str:
        """The names that are allowed, in words."""

    def current_name(self, name: str, known: Mapping[str, Quantity]) -> str | None:
        """The present name of a quantity that is known by another one, if there is any."""
        return None

    @abstractmethod
    def increments(self, design: Any) -> int:
        """Increments of the whole run."""

    @abstractmethod
    def identity(self, job: Job) -> dict[str, Any]:
        """What is computed, for restarts: "identity", and what a finished run must have in common as well."""

    @abstractmethod
    def run(
        self,
        job: Job,
        folder: Path,
        comm: MPI.Comm,
        *,
        restart: bool,
        overwrite: bool,
        on_increment: Callable[[], None],
    ) -> None:
        """Run a job and leave its results in the folder, summary.json last; collective."""

    @abstractmethod
    def read(self, job: Job, folder: Path) -> Outcome:
        """Outcome from the files of a finished run; on one rank."""


def named(name: str, known: Mapping[str, Quantity]) -> list[str]:
    """Numbers that a name stands for: one, or all those of a list."""
    return [key for key in known if key == name or key.startswith(f"{name}[")]


def not_known(where: str, known: Mapping[str, Quantity], system: System, name: str) -> InputError:
    """The refusal of a name that is no quantity, with the one most likely meant. where : what stands before the name"""
    if new_name := system.current_name(name, known):
        return InputError(f"{where}{name} is not available: this quantity is named {new_name}")
    near = difflib.get_close_matches(name, known, n=1)
    hint = f"did you mean {near[0]}?" if near else f"allowed {system.naming(known)}"
    return InputError(f"{where}{name} is not a quantity of a run: {hint}")
