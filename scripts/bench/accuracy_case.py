"""One case of the accuracy benchmark. It runs in a process of its own, so that its peak memory is
measured alone.

The argument is the case as JSON: its `kind` and the parameters of that kind. The output is JSON:
unknowns, values and closed forms by quantity, wall seconds from the mesh to the numbers (the
fastest of three runs when these are short), and the peak resident memory of all ranks.
"""

from __future__ import annotations

import json
import resource
import sys
import time
from collections.abc import Callable
from typing import Any

from mpi4py import MPI

from swgpar.log import PhaseTimes  # noqa: F401  (PETSc is initialised by what is imported here, outside the clock)

Solved = tuple[int, dict[str, float], dict[str, float]]
"""Unknowns, values, closed forms."""


def element(case: dict[str, Any]) -> Callable[[], Solved]:
    from support.element_problems import ELEMENTS, PROBLEMS

    plane, incompatible = ELEMENTS[case["element"]]

    def run() -> Solved:
        problem = PROBLEMS[case["problem"]].make(case["level"], plane)
        return problem.unknowns, problem.solve(incompatible, case["linear"]), problem.exact

    return run


def hertz(case: dict[str, Any]) -> Callable[[], Solved]:
    from support.hertz import STEEL, centre_yields
    from support.hertz import hertz as solve

    centre_yields(STEEL)  # the reference is outside the clock

    def run() -> Solved:
        # elements from twelve half widths on
        found = solve(12.0 / 2 ** case["level"], 0.25, incompatible=case["incompatible"])
        # relative to the answers for the load that was found
        values = {
            "half width": found.found_half_width / found.half_width,
            "pressure": 1.0 + found.deviation,
            "approach": found.approach / found.exact_approach,
        }
        return found.unknowns, values, dict.fromkeys(values, 1.0)

    return run


def ring_on_cam(case: dict[str, Any]) -> Callable[[], Solved]:
    from support.cam_ring import ring_on_cam as solve

    keys = ("level", "plane", "incompatible", "quadrature", "linear")
    return lambda: (*solve(**{key: case[key] for key in keys}, comm=MPI.COMM_WORLD), {})


KINDS = {"element": element, "hertz": hertz, "ring on cam": ring_on_cam}


def main() -> None:
    case = json.loads(sys.argv[1])
    run, seconds = KINDS[case["kind"]](case), []
    while not seconds or (len(seconds) < 3 and sum(seconds) < 1.0):
        begin = time.perf_counter()
        unknowns, values, exact = run()
        seconds.append(time.perf_counter() - begin)
    memory = MPI.COMM_WORLD.allreduce(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
    if MPI.COMM_WORLD.rank == 0:
        result = {
            "unknowns": unknowns,
            "values": values,
            "exact": exact,
            "seconds": min(seconds),
            "memory_MB": memory,
        }
        print(json.dumps(result))


if __name__ == "__main__":
    main()
