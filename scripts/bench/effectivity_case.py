"""One drive of the effectivity benchmark in its loaded state, in a process of its own.

The argument is the case as JSON: `design` and `overrides`, `mesh`, `times` (elements in every
direction over those of the mesh), `further` (windows beyond the usual ones; None for a usual run,
whose errors are estimated). The output is JSON: largest tension at the teeth, its errors by the
windows and by the mesh of the drive, the stress on every window, largest nodal averages by column
of the history and their errors by a coarser mesh, pressure of the flanks, elements and seconds.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

from mpi4py import MPI

import swgpar
from swgpar.analysis.coarse_start import solve_to_load
from swgpar.analysis.mesh_refinement import Refinement
from swgpar.analysis.shortcuts import with_shortcuts
from swgpar.evaluation.place_errors import with_errors
from swgpar.evaluation.places import find_places
from swgpar.evaluation.windows.root_stress import LEVELS, resolve_root_stress
from swgpar.half_space.pair_contact import pair_contacts
from swgpar.load.load_sequence import load_sequence
from swgpar.meshing.recipe_counts import resized

LARGEST = 10_000_000


def solve(case: dict[str, Any]) -> dict[str, Any]:
    """The case's numbers; collective."""
    begin = time.perf_counter()
    recipe = resized(swgpar.load_mesh(case["mesh"]), case["times"])
    design = with_shortcuts(
        swgpar.load_design(case["design"], case["overrides"]), recipe, levels=False
    ).design
    loaded = load_sequence(design).loaded
    coarse = None
    if case["further"] is None:
        usual = Refinement(design, recipe, MPI.COMM_WORLD, LARGEST)
        model, found, coarse = usual.model, usual.found, usual.compared
    else:
        model = solve_to_load(design, recipe, MPI.COMM_WORLD)
        found = resolve_root_stress(model, loaded, LEVELS[design.drive.model] + case["further"])
    pairs = pair_contacts(model, loaded)
    edge = any(pair.edge for pair in pairs)
    places = find_places(model, loaded, model.stresses()[1], on_edge=edge)
    if coarse is not None:
        places = with_errors(places, coarse.errors(places), found)
    result = {
        "s1": found.s1,
        "error": found.error,
        "drive_error": found.drive_error,
        "levels": found.levels,
        "by_part": found.by_part,
        "region": found.region,
        "pressure": max((pair.pressure_MPa for pair in pairs if not pair.edge), default=0.0),
        "edge": edge,
        "nodal": {name: place.value for name, place in places.items() if not place.warning},
        "nodal_errors": {
            name: place.error for name, place in places.items() if place.error is not None
        },
        "regions": {name: place.region for name, place in places.items()},
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
