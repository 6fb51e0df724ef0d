"""One drive of the effectivity benchmark on one mesh, in a process of its own.

The argument is the case as JSON: `part`, `table` (content of the design file), `mesh`, `times`
(elements in every direction over those of the mesh; 1 for the usual run) and `samples` (angles of
the period over the usual ones). The output is JSON: by quantity the value, the error that the run
states, why there is none, and the place; what the run says of itself; elements and seconds.

A reference has one window more than the usual run, with smaller elements than the last usual one.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Mapping
from typing import Any

from mpi4py import MPI

import swgpar
from swgpar.analysis.shortcuts import SAMPLES
from swgpar.answers.answer import Answer
from swgpar.errors import SwgparError
from swgpar.largest_stress import root_stress
from swgpar.meshing.recipe_counts import resized

PARTS: dict[str, tuple[str, ...]] = {
    "loaded": (
        "root.s1",
        "largest.fs_s1",
        "largest.fs_vm_apart",
        "largest.rg_s1",
        "largest.rg_vm_apart",
        "contact.pressure",
    ),
    "period": ("rotation.transmission_error", "rotation.torque_ripple", "mean.wg_torque_Nmm"),
    "stiffness": ("stiffness.K1", "stiffness.K3", "stiffness.lost_motion"),
}
"""Answers of a run up to the load, over a period without windows, and of a stiffness loop at one
angle of the wave generator."""

DESIGNS: dict[str, dict[str, Any]] = {
    "loaded": {"steps.rotation": 0.0},
    "period": {"output.root_stress": False},
    "stiffness": {"stiffness.positions": 1, "output.root_stress": False},
}
"""Values of the design by part."""


def found(answers: Mapping[str, Answer], names: tuple[str, ...]) -> dict[str, dict[str, Any]]:
    """Values, errors and places by quantity."""
    return {
        name: {
            "value": answers[name].value,
            "error": answers[name].error,
            "no_error": answers[name].no_error,
            "place": answers[name].place,
        }
        for name in names
        if name in answers and answers[name].value is not None
    }


def solve(case: dict[str, Any]) -> dict[str, Any]:
    """The case's numbers; collective."""
    part, model = case["part"], case["table"]["drive"]["model"]
    recipe, values = swgpar.load_mesh(case["mesh"]), DESIGNS[part]
    if case["times"] != 1.0:
        recipe = resized(recipe, case["times"])
        root_stress.LEVELS[model] += 1
    if part == "period":
        values = {**values, "steps.samples": case["samples"] * SAMPLES[model]}
    design = swgpar.load_design(case["table"]).with_values(values)
    begin = time.perf_counter()
    summary = swgpar.run(design, recipe, progress=False).summary
    said = (summary.rotation.jammed, summary.rotation.energy)
    return {
        "answers": found(summary, PARTS[part]),
        "remarks": [text for text in said if text],
        "edge": bool(summary.contact and summary.contact.on_edge),
        "elements": summary.elements,
        "wall_s": time.perf_counter() - begin,
    }


def main() -> None:
    try:
        result = solve(json.loads(sys.argv[1]))
    except SwgparError as error:
        result = {"failed": str(error)}
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(result))


if __name__ == "__main__":
    main()
