"""From a study file to its cases: every one a checked design, or the reason why it is none."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swgpar.design import DriveDesign, make_design
from swgpar.design_file import apply_overrides, read_toml, with_value
from swgpar.errors import InputError
from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.quantities import show
from swgpar.steps import sequence
from swgpar.study.spec import CaseSection, Study

OUTPUT = ("output.fields=false", "output.figures=false")
"""What a study changes in every design: fields of many runs fill the disk. Its own `set` comes later."""


@dataclass(frozen=True)
class Case:
    """A design of the study.

    varied : value of every varied key as the study file has it
    design : None when it is refused, for the reason in `refusal`
    meshes : recipes, coarse to fine;  compared : place of the one that published values are compared on
    """

    name: str
    varied: dict[str, Any]
    design: DriveDesign | None
    refusal: str
    meshes: tuple[Path, ...]
    compared: int
    section: CaseSection


@dataclass(frozen=True)
class Job:
    """A case on one of its meshes. finer : number of finer meshes of the case."""

    case: Case
    mesh: Path
    recipe: MeshRecipe
    finer: int

    @property
    def title(self) -> str:
        return f"{self.case.name} {self.mesh.stem}"

    @property
    def increments(self) -> int:
        """Increments of the whole run."""
        return sum(1 for _ in sequence(self.case.design)) if self.case.design is not None else 0

    def folder(self, out: Path) -> Path:
        """Results folder of this job below that of the study."""
        return out / "cases" / self.case.name / self.mesh.stem


def expand(study: Study) -> list[Job]:
    """All jobs of a study in the order of its tables.

    Raises InputError when the study file cannot be used; a refused design is a case with a `refusal`, and only when
    there is no other case a reason to raise.
    """
    try:
        jobs = _expand(study)
    except InputError as error:
        raise InputError(f"{study.path}: {error}") from None
    if all(job.case.design is None for job in jobs):
        raise InputError(f"{study.path}: every case is refused: {jobs[0].case.refusal}")
    return jobs


def _expand(study: Study) -> list[Job]:
    folder, section = study.path.parent, study.section
    base = read_toml(folder / section.design)
    if "gear_train" in base:
        raise InputError(
            f"study.design = {show(section.design)} is a gear train: allowed is a drive, as studies go over meshes; "
            "vary a gear train by swgpar run with --set"
        )
    base = apply_overrides(base, [*OUTPUT, *section.set])
    recipes: dict[Path, MeshRecipe] = {}
    cases: list[Case] = []
    for entry in study.cases:
        meshes = tuple(folder / mesh for mesh in entry.meshes or section.meshes)
        stems = [mesh.stem for mesh in meshes]
        wanted = Path(section.compared).stem
        compared = stems.index(wanted) if wanted in stems else len(stems) - 1
        if len(set(stems)) < len(stems):
            raise InputError(f"meshes = {show(stems)} have a name twice: allowed are recipes of different names")
        recipes.update({mesh: load_recipe(mesh) for mesh in meshes if mesh not in recipes})
        for varied, suffix in combinations(section.vary, section.mode):
            name = "_".join(part for part in (entry.name, suffix) if part) or Path(section.design).stem
            design, refusal = None, ""
            try:
                table = {**base, **entry.section}
                table = apply_overrides(table, entry.set)
                for key, value in varied.items():
                    table = with_value(table, key, value)
                design = make_design(table)
                _check_steps(design, entry)
            except InputError as error:
                refusal = str(error)
            cases.append(Case(name, varied, design, refusal, meshes, compared, entry))
    twice = [name for name, count in Counter(case.name for case in cases).items() if count > 1]
    if twice:
        raise InputError(f"{show(twice[0])} is the name of two cases: allowed are different names and values")
    return [
        Job(case, mesh, recipes[mesh], len(case.meshes) - 1 - place)
        for case in cases
        for place, mesh in enumerate(case.meshes)
    ]


def _check_steps(design: DriveDesign, case: CaseSection) -> None:
    """Refuse published values of steps that a start on coarser meshes leaves out."""
    for name in case.published:
        if design.steps.start_levels and name.startswith(("step1.", "step2.")):
            raise InputError(f"steps.start_levels = {design.steps.start_levels} leaves out {name}: allowed 0 with it")


def combinations(vary: dict[str, list[Any]], mode: str) -> list[tuple[dict[str, Any], str]]:
    """Values by key, and the name they give a case, for all combinations ("grid") or in step ("sweep")."""
    if not vary:
        return [({}, "")]
    last = Counter(key.rpartition(".")[2] for key in vary)
    columns = []
    for key, values in vary.items():
        short = key.rpartition(".")[2]
        title = short if last[short] == 1 else key
        columns.append([(key, value, f"{title}={label}") for value, label in zip(values, labels(values))])
    chosen = itertools.product(*columns) if mode == "grid" else zip(*columns)
    return [({key: value for key, value, _ in row}, "_".join(text for *_, text in row)) for row in chosen]


def labels(values: list[Any]) -> list[str]:
    """A short text for every value, fit for the name of a folder; tables by type, or by their place in the list."""
    texts = []
    for place, value in enumerate(values, start=1):
        text = value.get("type", str(place)) if isinstance(value, dict) else value
        texts.append(re.sub(r"[^A-Za-z0-9_.,+=-]", "-", text if isinstance(text, str) else show(text)))
    count = Counter(texts)
    of_tables = [isinstance(value, dict) for value in values]
    return [
        f"{text}-{place}" if count[text] > 1 and table else text
        for place, (text, table) in enumerate(zip(texts, of_tables), start=1)
    ]
