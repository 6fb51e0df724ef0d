"""Gear trains: lumped models without meshes, each with quantities of its own."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from mpi4py import MPI

from swgpar.gear_trains.common_sections import TrainDesign
from swgpar.gear_trains.published import SECTIONS, made_of_changed, numbered
from swgpar.gear_trains.result import TrainResult
from swgpar.gear_trains.train import (
    make_train,
    model_of,
    open_train,
    reported_arithmetic,
    require_finite,
    run_train,
)
from swgpar.input.require import require
from swgpar.input.toml_file import Overrides, apply_overrides
from swgpar.meshing import MeshRecipe
from swgpar.results.atomic import to_json
from swgpar.results.quantity import Quantity
from swgpar.run_options import RunOptions
from swgpar.systems.protocol import Measured, System


class GearTrains(System[TrainDesign, TrainResult]):
    """The gear trains' adapter to the names that all systems share."""

    noun = "a gear train"
    options = frozenset()

    def load(self, table: dict[str, Any], overrides: Overrides = ()) -> TrainDesign:
        return made_of_changed(make_train, table, apply_overrides(table, overrides))

    def starter(
        self, model: str, sizes: tuple[float, float, float], name: str
    ) -> tuple[TrainDesign, str]:
        """A design to start from and its file. sizes : ratio, diameter (mm), torque (N·m)"""
        from swgpar.gear_trains.planetary_stage.starter import starter  # only where one is made

        allowed = '"planetary_stage"'
        require(model == "planetary_stage", "train", model, allowed)
        return starter(*sizes, name)

    def check(self, design: TrainDesign) -> dict[str, float]:
        with reported_arithmetic():
            found = model_of(design).derived(design)
        require_finite(found)
        return found

    def remarks(self, design: TrainDesign) -> list[str]:
        return design.remarks()

    def run(self, design: TrainDesign, options: RunOptions) -> TrainResult:
        return run_train(design, options)

    def open(self, folder: Path, comm: MPI.Comm) -> TrainResult:
        return open_train(folder, comm)

    def print(self, result: TrainResult) -> None:
        from swgpar.gear_trains.report import print_train  # loads what pages need

        print_train(result)

    def report(self, result: TrainResult) -> bytes:
        from swgpar.gear_trains.report import train_report  # only where a report is written

        return train_report(result)

    def draws_figures(self, design: TrainDesign) -> bool:
        return design.output.figures

    def without_output(self, table: dict[str, Any]) -> dict[str, Any]:
        # values to compare of the file belong to its own design, and may name what a varied one
        # does not compute
        table = {key: value for key, value in table.items() if key not in SECTIONS}
        return apply_overrides(table, ["output.figures=false"])

    def quantities(self, design: TrainDesign) -> dict[str, Quantity]:
        return {
            number: replace(quantity, count=1)
            for name, quantity in model_of(design).quantities(design).items()
            for number in numbered(name, quantity.count)
        }

    def main_quantities(self, known: Mapping[str, Quantity]) -> tuple[str, ...]:
        return tuple(name for name, quantity in known.items() if not quantity.detail)

    def describe_names(self, known: Mapping[str, Quantity]) -> str:
        return ", ".join(dict.fromkeys(name.partition("[")[0] for name in known))

    def identity(self, design: TrainDesign, recipe: MeshRecipe | None) -> dict[str, Any]:
        content = design.model_dump(exclude={"output": True, **dict.fromkeys(SECTIONS, True)})
        return {"identity": hashlib.sha256(to_json(content)).hexdigest()}

    def measure(self, result: TrainResult) -> Measured:
        return Measured.of(result.summary, result.summary.wall_s)


GEAR_TRAIN = GearTrains()
