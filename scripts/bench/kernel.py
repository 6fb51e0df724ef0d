"""Time of residual and tangent of all elements, and of their insertion into a PETSc matrix, without
contact."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
from mpi4py import MPI

from swgpar import load_design
from swgpar.fem.sparse import fill_matrix
from swgpar.meshing import load_recipe
from swgpar.model.drive_model import build_drive_model


def fastest(repeat: int, action: Callable[[], None]) -> float:
    """Seconds of the fastest of `repeat` runs."""
    seconds = []
    for _ in range(repeat):
        begin = time.perf_counter()
        action()
        seconds.append(time.perf_counter() - begin)
    return min(seconds)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--design", default="drivers/cup_45deg.toml")
    options.add_argument("--mesh", default="full")
    options.add_argument("--repeat", type=int, default=3)
    arguments = options.parse_args()
    design = load_design(arguments.design, ["solver.symmetry=false"])
    model = build_drive_model(design, load_recipe(arguments.mesh), comm=MPI.COMM_SELF)
    problem, local, elements = model.problem, model.problem.local_nodes, model.elements
    problem.set_pattern(np.zeros(0, dtype=np.int64))
    rows, blocks, matrix = problem.blocks.rows, problem.blocks.block_indices, problem.blocks.matrix

    def insert() -> None:
        fill_matrix(matrix, rows, problem.blocks.matrix_rows)

    # every element turned and strained a little, so that none takes a short way
    u = np.random.default_rng(1).uniform(-1e-3, 1e-3, (len(local), 3))
    residual = np.zeros_like(u)

    def both() -> None:
        rows.values[:] = 0.0
        elements.assemble(u, residual, rows, blocks)

    insert()  # the first insertion is not the one that repeats
    count = sum(b["elements"] for b in model.counts().values())
    kernel, insertion = fastest(arguments.repeat, both), fastest(arguments.repeat, insert)
    force = fastest(arguments.repeat, lambda: elements.assemble(u, residual, None, None))
    print(
        f"{count} elements, {3 * model.partition.n_global} unknowns, one core; fastest of "
        f"{arguments.repeat}"
    )
    print(
        f"residual and tangent {kernel:7.2f} s   {1e6 * kernel / count:6.2f} microseconds per "
        f"element"
    )
    print(f"insertion into PETSc {insertion:7.2f} s   {1e6 * insertion / count:6.2f}")
    print(
        f"together             {kernel + insertion:7.2f} s   "
        f"{1e6 * (kernel + insertion) / count:6.2f}"
    )
    print(f"residual alone       {force:7.2f} s   {1e6 * force / count:6.2f}")


if __name__ == "__main__":
    main()
