"""Strain wave gears on meshes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.analysis.drive_result import DriveResult, open_drive
from swgpar.analysis.restart import identity
from swgpar.analysis.run_drive import run_drive
from swgpar.analysis.shortcuts import MESHES
from swgpar.analysis.summary import MEANS
from swgpar.analysis.terminal import print_drive
from swgpar.design.derived_geometry import derived_geometry
from swgpar.design.drive_design import DriveDesign
from swgpar.design.load_states import Stage, load_sequence
from swgpar.design.remarks import remarks
from swgpar.errors import InputError
from swgpar.input.toml_file import apply_overrides
from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.results.history import UNITS
from swgpar.systems.protocol import Measured, Quantity, System

MAIN = ("fs_s1", "fs_s3", "fs_vm", "rg_vm", "wg_torque_Nmm")
"""Columns whose means over the rotation tables and figures show."""

MEANINGS = {
    "fs_s1": "flexible spline, tensile s1",
    "fs_s3": "flexible spline, compressive |s3|",
    "fs_vm": "flexible spline, von Mises",
    "rg_s1": "ring gear, tensile s1",
    "rg_s3": "ring gear, compressive |s3|",
    "rg_vm": "ring gear, von Mises",
    "wg_torque_Nmm": "torque of the wave generator",
}
"""Of columns of the history; the names of the others say it themselves."""

COLUMNS = tuple(name for name in UNITS if name not in ("step", "wall_s"))
"""Columns of the history that are quantities."""

GROUPS = range(Stage.DEFLECT, Stage.ROTATE + 1)
"""Steps with quantities of their own; all increments of the rotation count as the last one."""


RESOLVED = {
    "root.s1": Quantity("largest tension at the teeth under load, by windows", "MPa"),
    "root.s1_error": Quantity("its error by the windows and by the mesh of the drive", "MPa"),
    "root.mean_s1": Quantity("the same over one period, mean", "MPa"),
    "contact.pressure": Quantity("largest pressure of the flanks under load, off edges", "MPa"),
    "contact.on_edge": Quantity("whether a contact under load lies on an edge: 1 or 0", ""),
}
"""Quantities of runs with `output.root_stress`, which a study has to set."""


class Drives(System[DriveDesign, DriveResult]):
    """The drive's adapter: analysis, results and quantities under the names that all systems share."""

    noun = "a drive"
    options = frozenset({"mesh", "accuracy", "restart", "plain"})

    def load(self, table: dict[str, Any]) -> DriveDesign:
        return DriveDesign.from_table(table)

    def check(self, design: DriveDesign) -> dict[str, float]:
        return derived_geometry(design)

    def remarks(self, design: DriveDesign, derived: dict[str, float]) -> list[str]:
        return remarks(design, derived)

    def run(
        self,
        design: DriveDesign,
        recipe: MeshRecipe | None,
        out: Path | None,
        *,
        recipe_name: str,
        accuracy: float | None,
        plain: bool,
        restart: bool,
        overwrite: bool,
        comm: MPI.Comm,
        terminal: bool,
        on_increment: Callable[[], None],
    ) -> DriveResult:
        if recipe is None:
            recipe_name = MESHES[design.drive.model]
            recipe = load_recipe(recipe_name)
        return run_drive(
            design,
            recipe,
            out,
            recipe_name=recipe_name,
            accuracy=accuracy,
            plain=plain,
            restart=restart,
            overwrite=overwrite,
            comm=comm,
            terminal=terminal,
            on_increment=on_increment,
        )

    def open(self, folder: Path, comm: MPI.Comm) -> DriveResult:
        return open_drive(folder, comm)

    def print(self, result: DriveResult) -> None:
        print_drive(result.history, result.summary)

    def without_output(self, table: dict[str, Any]) -> dict[str, Any]:
        # fields fill the disk, and windows take time that few studies need
        return apply_overrides(table, [f"output.{key}=false" for key in ("fields", "figures", "root_stress")])

    def quantities(self, design: DriveDesign) -> dict[str, Quantity]:
        """ "mean.fs_s1" over the rotation and so on, "step1.fs_s1" at the last increment of a step."""

        def quantity(column: str, when: str) -> Quantity:
            return Quantity(f"{MEANINGS.get(column, column)}, {when}", UNITS[column])

        known = {f"mean.{name}": quantity(name, "mean over the rotation") for name in MEANS}
        if design.output.root_stress:
            known |= RESOLVED
        return known | {f"step{k}.{name}": quantity(name, f"end of step {k}") for k in GROUPS for name in COLUMNS}

    def main_quantities(self, known: Mapping[str, Quantity]) -> tuple[str, ...]:
        return tuple(f"mean.{name}" for name in MAIN)

    def describe_names(self, known: Mapping[str, Quantity]) -> str:
        names = f"mean. with {', '.join(MEANS)}, or step1. to step{GROUPS[-1]}. with a column of history.csv"
        return f"{names}; with output.root_stress = true {', '.join(RESOLVED)}"

    def check_published(self, design: DriveDesign, names: Iterable[str]) -> None:
        for name in names:
            steps = design.steps
            if (steps.start_levels or steps.bent_start) and name.startswith(("step1.", "step2.")):
                raise InputError(
                    f"steps.start_levels = {steps.start_levels} or steps.bent_start leaves out {name}: allowed 0 and "
                    "false with it"
                )

    def increments(self, design: DriveDesign) -> int:
        return sum(1 for _ in load_sequence(design))

    def dimensions(self, design: DriveDesign) -> int:
        return 2 if design.drive.model == "plane" else 3

    def identity(self, design: DriveDesign, recipe: MeshRecipe | None) -> dict[str, Any]:
        found: dict[str, Any] = {"identity": identity(design, recipe, None), "rotation": design.steps.rotation}
        return found | ({"root_stress": True} if design.output.root_stress else {})

    def measure(self, result: DriveResult) -> Measured:
        summary = result.summary
        return Measured(
            values=values(summary["means"], result.history) | resolved(summary, result.pairs),
            wall_s=summary["wall_s"],
            elements=summary["elements"],
            newton_mean=summary["newton_iterations_mean"],
            history=result.history,
        )


def resolved(summary: Mapping[str, Any], pairs: Mapping[str, np.ndarray]) -> dict[str, float]:
    """The quantities of `RESOLVED`, without those that the run does not have."""
    root, contact, found = summary["root_stress"], summary["contact"], {}
    if root:
        found |= {"root.s1": root["s1"], "root.s1_error": root["total_error"]}
        if root["over_period"]:
            found["root.mean_s1"] = root["over_period"]["mean"]
    if contact:
        found["contact.on_edge"] = float(np.any(pairs["edge"]))
        if not contact["edge"]:
            found["contact.pressure"] = contact["pressure_MPa"]
    return found


def values(means: Mapping[str, float], history: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Quantities of a run from its means and its history, without those of steps that it does not have."""
    found = {f"mean.{name}": value for name, value in means.items()}
    group = np.minimum(history["step"], GROUPS[-1])
    for k in GROUPS:
        for last in np.flatnonzero(group == k)[-1:]:
            found |= {f"step{k}.{name}": float(history[name][last]) for name in COLUMNS if name in history}
    return found


DRIVE = Drives()
