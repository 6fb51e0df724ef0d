"""Gear trains in a study: no meshes, and the quantities that each train names itself."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.errors import InputError
from swgpar.gear_trains.common_sections import TrainDesign
from swgpar.gear_trains.published import current_name, meaning_and_unit, numbered
from swgpar.gear_trains.train import make_train, model_of, run_train
from swgpar.input.quantities import show
from swgpar.input.toml_file import apply_overrides
from swgpar.results.atomic import to_json
from swgpar.studies.spec import CaseSection, Study
from swgpar.studies.system import Job, Outcome, Quantity, System


class GearTrains(System):
    """Lumped models around the drive."""

    details = ()

    def base(self, table: dict[str, Any]) -> dict[str, Any]:
        # published values of the file belong to its own design, and may name what a varied one does not compute
        table = {key: value for key, value in table.items() if key != "published"}
        return apply_overrides(table, ["output.figures=false"])

    def meshes(self, study: Study, case: CaseSection) -> tuple[Path, ...]:
        for key, given in (
            ("study.meshes", study.section.meshes),
            ("study.compared", study.section.compared),
            (f"study.case {show(case.name)}: meshes", case.meshes),
        ):
            if given:
                raise InputError(f"{key} = {show(given)} has no meaning for a gear train: leave it out")
        return ()

    def make(self, table: dict[str, Any], case: CaseSection) -> TrainDesign:
        return make_train(table)

    def quantities(self, design: TrainDesign) -> dict[str, Quantity]:
        return {
            number: Quantity(*meaning_and_unit(text))
            for name, (text, count) in model_of(design).quantities(design).items()
            for number in numbered(name, count)
        }

    def shown(self, known: Mapping[str, Quantity]) -> tuple[str, ...]:
        return tuple(known)

    def naming(self, known: Mapping[str, Quantity]) -> str:
        return ", ".join(dict.fromkeys(name.partition("[")[0] for name in known))

    def current_name(self, name: str, known: Mapping[str, Quantity]) -> str | None:
        return current_name(name, {key.partition("[")[0] for key in known})

    def increments(self, design: TrainDesign) -> int:
        return 1

    def identity(self, job: Job) -> dict[str, Any]:
        content = job.case.design.model_dump(exclude={"output": True, "published": True})
        return {"identity": hashlib.sha256(to_json(content)).hexdigest()}

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
        # one that was interrupted begins anew, and may have left its first tables
        run_train(job.case.design, folder, overwrite=overwrite or restart, comm=comm)

    def read(self, job: Job, folder: Path) -> Outcome:
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        values: dict[str, float] = {}
        for name, found in summary["quantities"].items():
            numbers = np.atleast_1d(found).tolist()
            values |= {n: v for n, v in zip(numbered(name, len(numbers)), numbers) if math.isfinite(v)}
        return Outcome("finished", values=values, wall_s=summary["wall_s"])


GEAR_TRAINS = GearTrains()
