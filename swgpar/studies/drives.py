"""Drives in a study: every case on one mesh or more, stresses and torques as quantities."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from mpi4py import MPI

from swgpar.analysis.restart import identity
from swgpar.analysis.run_drive import run_drive
from swgpar.analysis.summary import MEANS
from swgpar.design.design_file import make_design
from swgpar.design.drive_design import DriveDesign
from swgpar.design.load_states import load_sequence
from swgpar.errors import InputError
from swgpar.input.quantities import show
from swgpar.input.toml_file import apply_overrides
from swgpar.meshing.recipe import is_recipe_name
from swgpar.results import history
from swgpar.results.history import UNITS
from swgpar.studies.spec import CaseSection, Study
from swgpar.studies.system import Job, Outcome, Quantity, System

STEPS = 4
"""Steps 1 to 4: deflection, engagement, load, and the rotation, whose increments go on counting in the history."""

SHOWN = ("fs_s1", "fs_s3", "fs_vm", "rg_vm", "wg_torque_Nmm")
"""Means over the rotation that tables and figures show."""

MEANINGS = {
    "fs_s1": "flexible spline, tensile s1",
    "fs_s3": "flexible spline, compressive |s3|",
    "fs_vm": "flexible spline, von Mises",
    "rg_s1": "ring gear, tensile s1",
    "rg_s3": "ring gear, compressive |s3|",
    "rg_vm": "ring gear, von Mises",
    "wg_torque_Nmm": "torque of the wave generator",
}
"""Of columns of the history; the others say it themselves."""


def quantities() -> dict[str, Quantity]:
    """ "mean.fs_s1" of the rotation and so on, "step1.fs_s1" of the last increment of a step."""

    def of(column: str, when: str) -> Quantity:
        return Quantity(f"{MEANINGS.get(column, column)}, {when}", UNITS[column])

    known = {f"mean.{name}": of(name, "mean over the rotation") for name in MEANS}
    columns = [name for name in UNITS if name not in ("step", "wall_s")]
    return known | {f"step{k}.{c}": of(c, f"end of step {k}") for k in range(1, STEPS + 1) for c in columns}


def values(means: Mapping[str, float], rows: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """Quantities of a run from its summary's means and its history; none of steps that it does not have."""
    found = {f"mean.{name}": value for name, value in means.items()}
    for row in rows:  # the last one of a step stays
        group = f"step{min(int(row['step']), STEPS)}"
        found |= {f"{group}.{name}": float(row[name]) for name in row if name not in ("step", "wall_s")}
    return found


class Drives(System):
    """Strain wave gears on meshes."""

    details = ("mesh", "elements", "newton_mean")

    def base(self, table: dict[str, Any]) -> dict[str, Any]:
        return apply_overrides(table, ["output.fields=false", "output.figures=false"])  # fields fill the disk

    def meshes(self, study: Study, case: CaseSection) -> tuple[Path, ...]:
        section = study.section
        if not section.meshes:
            given = " = [] is empty" if "meshes" in section.model_fields_set else " is missing"
            raise InputError(f"study.meshes{given}: give a list of texts, one mesh recipe or more, coarse to fine")
        if section.compared and section.compared not in section.meshes:
            raise InputError(
                f"study.compared = {show(section.compared)} is none of study.meshes = {show(section.meshes)}"
            )
        meshes = tuple(_recipe(study, mesh) for mesh in case.meshes or section.meshes)
        stems = [mesh.stem for mesh in meshes]
        if len(set(stems)) < len(stems):
            raise InputError(f"meshes = {show(stems)} have a name twice: allowed are recipes of different names")
        return meshes

    def make(self, table: dict[str, Any], case: CaseSection) -> DriveDesign:
        design = make_design(table)
        for name in case.published:
            if design.steps.start_levels and name.startswith(("step1.", "step2.")):
                raise InputError(
                    f"steps.start_levels = {design.steps.start_levels} leaves out {name}: allowed 0 with it"
                )
        return design

    def quantities(self, design: DriveDesign) -> dict[str, Quantity]:
        return quantities()

    def shown(self, known: Mapping[str, Quantity]) -> tuple[str, ...]:
        return tuple(f"mean.{name}" for name in SHOWN)

    def naming(self, known: Mapping[str, Quantity]) -> str:
        return f"mean. with {', '.join(MEANS)}, or step1. to step{STEPS}. with a column of history.csv"

    def increments(self, design: DriveDesign) -> int:
        return sum(1 for _ in load_sequence(design))

    def identity(self, job: Job) -> dict[str, Any]:
        design = job.case.design
        return {"identity": identity(design, job.recipe, None), "rotation": design.steps.rotation}

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
        run_drive(
            job.case.design,
            job.recipe,
            folder,
            restart=restart,
            overwrite=overwrite,
            comm=comm,
            recipe_name=str(job.mesh),
            on_increment=on_increment,
        )

    def read(self, job: Job, folder: Path) -> Outcome:
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        rows = history.read_history(folder / history.NAME)
        return Outcome(
            "finished",
            values=values(summary["means"], rows),
            elements=summary["elements"],
            newton_mean=summary["newton_iterations_mean"],
            wall_s=summary["wall_s"],
            rows=rows,
        )


def _recipe(study: Study, mesh: str) -> Path:
    """The name of a recipe of the package, or the path of one, which the study file gives relative to itself."""
    return Path(mesh) if is_recipe_name(mesh) else study.path.parent / mesh


DRIVES = Drives()
