"""Cost of one Newton iteration of the cup drive over mesh sizes, solvers and numbers of ranks.

Every case is a process group of its own. It measures the first system of the undeformed drive:
seconds of residual and tangent, of a product with the tangent, of the factorisation or the set-up
of the multigrid and of one solve, iterations of GMRES to 1e-6, and peak memory.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

MESHES = ("tests/data/tiny.toml", "coarse", "medium", "full")


def measure(mesh: str, linear: str) -> None:
    """Print the numbers of one case; run under mpirun."""
    from mpi4py import MPI

    from swgpar import load_design
    from swgpar.fem.vectors import create_vector
    from swgpar.load.load_sequence import load_sequence
    from swgpar.meshing import load_recipe
    from swgpar.model.drive_model import build_drive_model

    comm = MPI.COMM_WORLD
    design = load_design("drivers/cup_45deg.toml", [f"solver.linear={linear}"])
    model = build_drive_model(design, load_recipe(mesh), comm=comm)
    problem, system, state = model.problem, model.solver.system, load_sequence(design).states[0]
    problem.search(state)
    right, x, product = (create_vector(model.partition) for _ in range(3))

    def timed(call) -> float:
        comm.Barrier()
        begin = time.perf_counter()
        call()
        comm.Barrier()
        return time.perf_counter() - begin

    residual = timed(lambda: problem.residual(problem.x, right, state))
    u = problem.displacement()
    tangent = timed(lambda: problem.tangent(u, state))
    border, rows = problem.supports.border(u, state)
    system.set_system(
        problem.blocks.matrix,
        problem.blocks.matrix_rows.active,
        problem.supports.grounding(u),
        border,
        rows,
    )
    row = {
        "mesh": mesh,
        "solver": linear,
        "ranks": comm.size,
        "unknowns": sum(b["dofs"] for b in model.counts().values()),
    }
    solver, active = system.solver, problem.blocks.matrix_rows.active

    def prepare() -> None:
        solver.prepare(problem.blocks.matrix, active)

    row |= {"assembly_s": residual + tangent, "setup_s": timed(prepare)}
    if linear == "direct":  # without the analysis of the pattern, which is done once
        problem.blocks.matrix.stateIncrease()
        row["factor_s"] = timed(prepare)
    row["solve_s"] = timed(lambda: system.solve_grounded(right, x))
    row["product_s"] = timed(lambda: system.multiply(x, product))
    row["iterations"] = solver.ksp.getIterationNumber() if linear == "iterative" else 1
    if linear == "direct":
        counts = solver.counts()
        row |= {"factor_entries": round(counts.entries), "factor_Gflop": 1e-9 * counts.operations}
    memory = comm.allgather(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
    row["memory_MB_per_rank"] = round(max(memory))
    if comm.rank == 0:
        print(json.dumps({k: round(v, 4) if isinstance(v, float) else v for k, v in row.items()}))


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--meshes", nargs="+", default=list(MESHES))
    options.add_argument(
        "--solvers", nargs="+", default=["direct", "iterative"], choices=["direct", "iterative"]
    )
    options.add_argument("--ranks", nargs="+", type=int, default=[1, 2])
    options.add_argument(
        "--largest-iterative", type=int, default=3, help="number of meshes GAMG is tried on"
    )
    options.add_argument("--table", default="docs/verification/data/scaling.csv")
    options.add_argument("--case", nargs=2, metavar=("MESH", "SOLVER"), help=argparse.SUPPRESS)
    arguments = options.parse_args()
    if arguments.case:
        measure(*arguments.case)
        return
    columns = (
        "mesh",
        "solver",
        "ranks",
        "unknowns",
        "assembly_s",
        "product_s",
        "setup_s",
        "solve_s",
        "iterations",
    )
    columns += ("factor_s", "factor_entries", "factor_Gflop", "memory_MB_per_rank")
    table = Path(arguments.table)
    table.parent.mkdir(parents=True, exist_ok=True)
    with table.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n", restval="")
        writer.writeheader()
        for solver in arguments.solvers:
            meshes = (
                arguments.meshes
                if solver == "direct"
                else arguments.meshes[: arguments.largest_iterative]
            )
            for mesh in meshes:
                for ranks in arguments.ranks:
                    # oversubscribed ranks yield the core when they wait, which costs time where
                    # each has its own
                    crowded = ["--oversubscribe"] if ranks > (os.cpu_count() or 1) else []
                    command = ["mpirun", *crowded, "-n", str(ranks), sys.executable, __file__]
                    done = subprocess.run(
                        [*command, "--case", mesh, solver],
                        check=True,
                        capture_output=True,
                        text=True,
                    )
                    row = json.loads(done.stdout.splitlines()[-1])
                    print(row, flush=True)
                    writer.writerow(row)
                    file.flush()


if __name__ == "__main__":
    main()
