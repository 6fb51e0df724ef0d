"""One drive of the effectivity benchmark, in its loaded state on one mesh, in a process of its own.

The argument is the case as JSON: `design` and `overrides`, `mesh`, `times` (how many times the mesh is finer), `further`
(windows beyond the usual ones). The output is JSON: largest tension at the teeth, its error, the stress on every window,
forces of the pairs, elements and seconds.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

from mpi4py import MPI

import swgpar
from swgpar.analysis.coarse_start import solve_to_load
from swgpar.analysis.root_stress import LEVELS, RATIO, error_of, resolve_root_stress
from swgpar.analysis.shortcuts import with_shortcuts
from swgpar.design.load_states import from_loaded, load_sequence
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe_counts import with_counts


def finer(recipe: MeshRecipe, times: float) -> MeshRecipe:
    """The recipe with so many times the elements in every direction."""
    return with_counts(recipe, lambda section, name, count: round(times * count))


def solve(case: dict[str, Any]) -> dict[str, Any]:
    """The case's numbers; collective."""
    begin = time.perf_counter()
    recipe = finer(swgpar.load_mesh(case["mesh"]), case["times"])
    design = with_shortcuts(swgpar.load_design(case["design"], case["overrides"]), recipe).design
    usual = LEVELS[design.drive.model]
    states = list(load_sequence(design))
    model = solve_to_load(design, recipe, states, MPI.COMM_WORLD)
    found = resolve_root_stress(model, from_loaded(states)[0], recipe, usual + case["further"])
    result = {
        "s1": found.levels[usual - 1],
        "error": error_of(list(found.levels[:usual]), RATIO[design.drive.model]),
        "levels": found.levels,
        "region": found.region,
        "warning": found.warning,
        "elements": model.n_elements(),
        "wall_s": time.perf_counter() - begin,
    }
    model.destroy()
    return result


def main() -> None:
    found = solve(json.loads(sys.argv[1]))
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
