"""Strain wave gears on meshes.

What only runs and their results need is imported where it is used: a check needs neither PETSc nor
the evaluations.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from mpi4py import MPI

from swgpar.analysis.identity import identity
from swgpar.checks.derived_geometry import derived_geometry
from swgpar.checks.design_file import make_drive
from swgpar.checks.remarks import remarks
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.input.toml_file import Overrides, apply_overrides
from swgpar.load.load_sequence import load_sequence
from swgpar.meshing import MeshRecipe
from swgpar.results.quantity import Quantity
from swgpar.run_options import RunOptions
from swgpar.systems.protocol import Measured, System

if TYPE_CHECKING:
    from swgpar.analysis.model_sources import ModelSource
    from swgpar.presentation.drive_result import DriveResult


class Drives(System[DriveDesign, "DriveResult"]):
    """The drive's adapter to the names that all systems share.

    models : that its runs share; None where each builds its own
    """

    noun = "a drive"
    options = frozenset({"mesh", "accuracy", "restart", "plain"})

    def __init__(self, models: ModelSource | None = None) -> None:
        self.models = models

    def load(self, table: dict[str, Any], overrides: Overrides = ()) -> DriveDesign:
        return make_drive(apply_overrides(table, overrides))

    def check(self, design: DriveDesign) -> dict[str, float]:
        return derived_geometry(design)

    def remarks(self, design: DriveDesign) -> list[str]:
        return remarks(design)

    def run(self, design: DriveDesign, options: RunOptions) -> DriveResult:
        from swgpar.analysis.model_sources import NEW_MODELS
        from swgpar.analysis.run_drive import run_drive
        from swgpar.presentation.drive_result import DriveResult

        return DriveResult.of(run_drive(design, options, self.models or NEW_MODELS))

    def take_over(self, design: DriveDesign, options: RunOptions) -> None:
        from swgpar.analysis.run_drive import keep_mesh_of

        if self.models is not None:
            keep_mesh_of(design, options, self.models)

    def open(self, folder: Path, comm: MPI.Comm) -> DriveResult:
        from swgpar.drive_results.drive_data import open_data
        from swgpar.presentation.drive_result import DriveResult

        return DriveResult.of(open_data(folder, comm))

    def print(self, result: DriveResult) -> None:
        from swgpar.presentation.terminal import print_drive

        print_drive(result.history, result.summary)

    def report(self, result: DriveResult) -> bytes:
        from swgpar.presentation.drive_report import drive_report

        return drive_report(result)

    def draws_figures(self, design: DriveDesign) -> bool:
        return design.output.figures

    def without_output(self, table: dict[str, Any]) -> dict[str, Any]:
        # fields fill the disk, and windows take time that few studies need
        return apply_overrides(
            table, [f"output.{key}=false" for key in ("fields", "figures", "root_stress")]
        )

    def quantities(self, design: DriveDesign) -> dict[str, Quantity]:
        from swgpar.drive_results.summary import known_answers

        return {
            name: Quantity(kind.text, kind.unit) for name, kind in known_answers(design).items()
        }

    def main_quantities(self, known: Mapping[str, Quantity]) -> tuple[str, ...]:
        from swgpar.evaluation.rotation import MAIN_MEANS

        means = tuple(kind.name for kind in MAIN_MEANS)
        if means[0] in known:
            return means
        of_program = tuple(name for name in known if name.startswith(("stiffness.", "ratcheting.")))
        return of_program or tuple(
            name for name in known if name.endswith((".torque_Nm", ".rotation_arcmin"))
        )

    def describe_names(self, known: Mapping[str, Quantity]) -> str:
        names = [name for name in known if not name.startswith("step")]
        steps = len(names) < len(known)
        words = ", or step1. to step4. with a column of history.csv" if steps else ""
        return f"{', '.join(names)}{words}"

    def check_published(self, design: DriveDesign, names: Iterable[str]) -> None:
        for name in names:
            steps = design.steps
            if (steps.start_levels or steps.bent_start) and name.startswith(("step1.", "step2.")):
                raise InputError(
                    f"steps.start_levels = {steps.start_levels} or steps.bent_start leaves out "
                    f"{name}: allowed 0 and false with it"
                )

    def increments(self, design: DriveDesign) -> int:
        return len(load_sequence(design).states)

    def dimensions(self, design: DriveDesign) -> int:
        return 2 if design.drive.model == "plane" else 3

    def identity(self, design: DriveDesign, recipe: MeshRecipe | None) -> dict[str, Any]:
        found: dict[str, Any] = {
            "identity": identity(design.decisive_keys, recipe, None),
            "rotation": design.steps.rotation,
        }
        asked = {name: getattr(design.output, name) for name in ("root_stress", "contact_errors")}
        return found | {name: True for name, is_asked in asked.items() if is_asked}

    @contextmanager
    def shared(self) -> Iterator[Self]:
        from swgpar.analysis.model_sources import LoadedDrives

        models = LoadedDrives()
        yield type(self)(models)
        models.destroy()  # after an error of one rank the others would wait here

    def measure(self, result: DriveResult) -> Measured:
        summary = result.summary
        return Measured.of(
            summary,
            summary.wall_s,
            elements=summary.elements,
            newton_mean=summary.rotation.newton_iterations_mean,
            history=result.history,
        )


DRIVE = Drives()
