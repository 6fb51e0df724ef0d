"""One of the peer problems by this program, under mpirun: fields of every rank, its memory and
Newton's iterations.

mpirun -n 2 python scripts/bench/peer_swgpar.py "linear: pinched ring" 160 2 8 whole OUT

With `half` instead of `whole` the twofold symmetry of ring and loads is used, as a run of a drive
uses it.
"""

from __future__ import annotations

import json
import resource
import sys
from pathlib import Path

import numpy as np
from mpi4py import MPI
from peer_problems import (
    CAM,
    CAM_HALF_ANGLE,
    INNER,
    OUTER,
    PENALTY,
    PROBLEMS,
    STEEL,
    WIDTH,
    Problem,
    line,
)

from plain_ring import PlainRingDesign, RingBody, RingCounts, RingModel
from swgpar.constraints.boundary_conditions import DeadLoad
from swgpar.design.sections import ContactSection, Solver
from swgpar.fem.elements import BodyElements
from swgpar.fem.stress import body_fields
from swgpar.geometry.cams import EllipticalCam
from swgpar.load.load_states import LoadState, Stage
from swgpar.solve.line_search import LineSearch

RTOL = 1e-6
"""Newton's tolerance, that of a drive's default run in the plane. CalculiX accepts 5e-3."""


def pinched(
    design: PlainRingDesign, counts: RingCounts, force: float, copies: int
) -> tuple[BodyElements, np.ndarray, int]:
    """The ring under two forces (N): its elements, displacements (n_local, 3) mm and the iterations
    it took."""
    ring = RingBody(design, counts, MPI.COMM_WORLD, copies=copies)
    nodes, share = line(ring.mesh.coords)
    sectors = ring.body.sectors[ring.body.owned]
    local, forces = [np.zeros(0, dtype=np.int64)], [np.zeros((0, 3))]
    for sector, direction in ((0, -1.0), (counts.sectors // 2, 1.0)):
        for k in np.flatnonzero(sectors == sector):
            local.append(ring.body.local[ring.body.owned][k, nodes])
            forces.append(force * direction * share[:, None] * (0.0, 1.0, 0.0))
    # the search is made for contact: in bending without it a full step, which stretches the ring,
    # is the way out
    LineSearch.TRIALS = 0
    solver = ring.solver(load=DeadLoad(np.concatenate(local), np.concatenate(forces)))
    solved = solver.solve(
        LoadState(Stage.LOAD, 3, cam_clearance=0.0)
    )  # keeps a factor once the residual is small
    if not solved.converged:
        raise SystemExit(f"not converged: {solved}")
    return ring.body, solver.problem.displacement(), solved.iterations


def main() -> None:
    name, *numbers, part, folder = sys.argv[1:]
    copies = 2 if part == "half" else 1
    problem: Problem = PROBLEMS[name]
    counts = RingCounts(*map(int, numbers))
    contact = ContactSection(wg_penalty_coef=PENALTY, wg_quadrature=7, penetration_tolerance=1e-4)
    design = PlainRingDesign(
        2.0 * OUTER, OUTER - INNER, WIDTH, False, STEEL, contact, Solver(rtol=RTOL)
    )
    if problem.travel:
        cam = EllipticalCam(*CAM)
        model = RingModel(
            design, counts, cam, np.radians(CAM_HALF_ANGLE), MPI.COMM_WORLD, copies=copies
        )
        iterations, body = model.spread(problem.travel), model.body
        u = model.problem.displacement()
    else:
        body, u, iterations = pinched(design, counts, problem.force, copies)
    fields = body_fields(body, u)
    out, comm = Path(folder), MPI.COMM_WORLD
    np.savez(
        out / f"rank{comm.rank}.npz",
        sectors=body.sectors[body.owned],
        displacement=fields["displacement"],
        s1=fields["s1"],
    )
    memory = comm.allgather(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
    if comm.rank == 0:
        summary = {"iterations": iterations, "memory_MB": memory}
        (out / "summary.json").write_text(json.dumps(summary), encoding="utf-8")


if __name__ == "__main__":
    main()
