"""A case of a study, the jobs that compute it, and what becomes of a job."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swgpar.errors import InputError
from swgpar.input.design import Design
from swgpar.input.quantities import show_key
from swgpar.meshing import MeshRecipe
from swgpar.results.quantity import Quantity
from swgpar.studies.spec import CaseSection, folder_name
from swgpar.systems import Measured, System


@dataclass(frozen=True)
class Outcome(Measured):
    """What became of a job; what is measured is empty and None when it has failed.

    status : "finished" or "failed";  reason : one sentence, empty when finished
    kept : whether an earlier call of the study had finished it
    """

    status: str
    reason: str = ""
    kept: bool = False


@dataclass(frozen=True)
class Case:
    """A design of the study.

    varied : value of every varied key as the study file has it
    design : None when it is refused, for the reason in `refusal`
    known : its quantities by name, empty when refused;  shown : those in tables and figures
    meshes : recipes, coarse to fine, none of a gear train
    compared : index of the one for published values
    section : its part of the study file;  system : the kind of its design
    """

    name: str
    varied: dict[str, Any]
    design: Design | None
    refusal: str
    known: Mapping[str, Quantity]
    shown: tuple[str, ...]
    meshes: tuple[Path, ...]
    compared: int
    section: CaseSection
    system: System[Any, Any]


@dataclass(frozen=True)
class Job:
    """A case, on one of its meshes if it has any. finer : number of finer meshes of the case."""

    case: Case
    mesh: Path | None
    recipe: MeshRecipe | None
    finer: int

    @property
    def mesh_name(self) -> str:
        """That of its folder; empty without a mesh."""
        return folder_name(self.mesh.stem) if self.mesh is not None else ""

    @property
    def title(self) -> str:
        """Names of case and mesh."""
        return f"{self.case.name} {self.mesh_name}".rstrip()

    @property
    def increments(self) -> int:
        """Increments of the whole run."""
        return self.case.system.increments(self.case.design) if self.case.design is not None else 0

    def folder(self, out: Path) -> Path:
        """Results folder of this job below that of the study."""
        return out / "cases" / self.case.name / self.mesh_name


def named(name: str, known: Mapping[str, Quantity]) -> list[str]:
    """Numbers that a name stands for: one, or all those of a list."""
    return [key for key in known if key == name or key.startswith(f"{name}[")]


def not_known(
    where: str, known: Mapping[str, Quantity], system: System[Any, Any], name: str
) -> InputError:
    """The refusal of a name that is no quantity. where : text in front of the name"""
    near = difflib.get_close_matches(name, known, n=1)
    hint = f"did you mean {near[0]}?" if near else f"allowed {system.describe_names(known)}"
    return InputError(f"{where}{show_key(name)} is not a quantity of a run: {hint}")
