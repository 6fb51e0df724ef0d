"""One drive of the effectivity benchmark on one mesh, in a process of its own.

The argument is the case as JSON: `part`, `table` (content of the design file), `mesh`, `times`
(elements in every direction over those of the mesh; 1 for the usual run), `counts` (by section and
name, counts of the mesh that are replaced) and `samples` (angles of the period over the usual
ones). The output is JSON, by stage ("usual" and, where `times` is not 1, "reference"): by answer
the value, the error that the run states, why there is none, and the place; what the run says of
itself; elements, seconds and memory. The log of the run goes to standard error.

A reference has one window more than the usual run, with smaller elements than the last usual one.
In the wall of a cup its rings are finer by 1.5, and there is one more slice. That of a drive in
space under load starts from the state of the usual run, so that this is computed first.
"""

from __future__ import annotations

import json
import logging
import math
import resource
import sys
import time
from collections.abc import Mapping
from typing import Any

from mpi4py import MPI

import swgpar
from swgpar.analysis import drive_run
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.shortcuts import SAMPLES
from swgpar.analysis.transfer import interpolations, transfer
from swgpar.answers.answer import Answer
from swgpar.design.drive_design import DriveDesign
from swgpar.drive_results.drive_data import DriveData
from swgpar.errors import ConvergenceError, SwgparError
from swgpar.input.toml_file import validate
from swgpar.largest_stress import wall_stress, window_recipes
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe_counts import RATIO, refined, resized
from swgpar.meshing.wall_sector import WallCounts
from swgpar.model.drive_model import DriveModel

PARTS: dict[str, tuple[str, ...]] = {
    "loaded": (
        "root.s1",
        "largest.fs_s1",
        "largest.fs_vm_apart",
        "largest.rg_s1",
        "largest.rg_vm_apart",
        "contact.pressure",
        "contact.pressure_off_edges",
        "sharing.largest_force",
        "sharing.largest_force_share",
        "step3.wg_torque_Nmm",
    ),
    "period": ("rotation.transmission_error", "rotation.torque_ripple", "mean.wg_torque_Nmm"),
    "stiffness": ("stiffness.K1", "stiffness.K2", "stiffness.K3", "stiffness.lost_motion"),
}
"""Answers of a run up to the load, over a period, and of a stiffness loop at one angle of the wave
generator."""

DESIGNS: dict[str, dict[str, Any]] = {
    "loaded": {"steps.rotation": 0.0},
    "period": {},
    "stiffness": {"stiffness.positions": 1, "output.root_stress": False},
}
"""Values of the design by part."""

WITHOUT_WINDOWS = {"output.root_stress": False}
"""Values of the reference of a part in which no stress is compared. The usual run has windows: its
errors over the period come from the meshes that they need."""


FINER_RINGS = WallCounts(6, 3), WallCounts(9, 4)
FINER_SLICE = WallCounts(64, 32, 0.0625)
"""Of the wall in references."""


def found(answers: Mapping[str, Answer]) -> dict[str, dict[str, Any]]:
    """Values, errors and places of all answers."""
    return {
        name: {
            "value": one.value,
            "error": one.error,
            "no_error": one.no_error,
            "place": one.place,
        }
        for name, one in answers.items()
        if one.value is not None
    }


def reference_recipe(recipe: MeshRecipe, times: float) -> MeshRecipe:
    """The recipe of a reference: counts of a cup drive are small, and rounded up."""
    if recipe.face_width is None:
        return resized(recipe, times)
    for _ in range(round(math.log(times, RATIO))):
        recipe = refined(recipe)
    return recipe


def with_finer_windows(model: str) -> None:
    """Resolve stresses with one window more."""
    window_recipes.LEVELS[model] += 1
    window_recipes.RING_LEVELS[model] += 1
    wall_stress.RINGS = FINER_RINGS
    wall_stress.SLICES = (*wall_stress.SLICES, FINER_SLICE)


def replaced(recipe: MeshRecipe, counts: Mapping[str, Mapping[str, int]]) -> MeshRecipe:
    """The recipe with other counts."""
    content = recipe.model_dump(exclude_none=True)
    for section, values in counts.items():
        content[section] |= values
    return validate(MeshRecipe, content)


def keep_models(models: list[DriveModel]) -> None:
    """Let every further run append its model, which it does not release."""
    finish = drive_run.DriveRun.finish

    def finish_and_keep(run: drive_run.DriveRun, name: str) -> DriveData:
        models.append(run.model)
        run.model.destroy = lambda: None
        return finish(run, name)

    drive_run.DriveRun.finish = finish_and_keep


def start_from(usual: DriveModel) -> None:
    """Let every further run start from the loaded state of this model."""
    start = drive_run.start_at_load

    def start_at_load(stepper: LoadStepper, *others: Any) -> bool:
        loaded = stepper.sequence.loaded
        try:
            with stepper.model.phases("start"):
                matrices = interpolations(usual, stepper.model)
                transfer(usual, usual.problem.x, stepper.model, stepper.problem.x, matrices)
                stepper.load_state = loaded
                stepper.advance(loaded)
        except ConvergenceError:
            stepper.reset()
            return start(stepper, *others)
        return True

    drive_run.start_at_load = start_at_load


def solve(case: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The case's numbers by stage; collective."""
    part, model = case["part"], case["table"]["drive"]["model"]
    recipe, values = swgpar.load_mesh(case["mesh"]), DESIGNS[part]
    design = swgpar.load_design(case["table"])
    if part == "period":
        samples = design.kinematics.apart(case["samples"] * SAMPLES[model])
        values = {**values, "steps.samples": samples}
    design = design.with_values(values)
    if case["times"] == 1.0:
        return {"usual": run(design, replaced(recipe, case["counts"]))}
    done = {}
    if model != "plane" and part == "loaded":
        models: list[DriveModel] = []
        keep_models(models)
        done["usual"] = run(design, recipe)
        start_from(models[0])
    with_finer_windows(model)
    finer = replaced(reference_recipe(recipe, case["times"]), case["counts"])
    if part != "loaded":
        design = design.with_values(WITHOUT_WINDOWS)
    return {**done, "reference": run(design, finer)}


def run(design: DriveDesign, recipe: MeshRecipe) -> dict[str, Any]:
    """The numbers of a run; collective."""
    begin = time.perf_counter()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    summary = swgpar.run(design, recipe, progress=False).summary
    said = (summary.rotation.jammed, summary.rotation.energy)
    used = resource.getrusage(resource.RUSAGE_SELF)
    return {
        "answers": found(summary),
        "remarks": [text for text in said if text],
        "edge": bool(summary.contact and summary.contact.on_edge),
        "elements": summary.elements,
        "wall_s": time.perf_counter() - begin,
        "cpu_s": used.ru_utime - before,
        "phases_s": dict(summary.phases_s),
        "memory_GB": 1e-6 * used.ru_maxrss,
    }


def main() -> None:
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    try:
        result = solve(json.loads(sys.argv[1]))
    except SwgparError as error:
        result = {stage: {"failed": str(error)} for stage in ("usual", "reference")}
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(result))


if __name__ == "__main__":
    main()
