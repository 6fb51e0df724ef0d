"""The iterative linear solver against the factor, on the bordered system of a drive with all contacts on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from mpi4py import MPI

from swgpar.assembly import create_vector
from swgpar.design import load_design
from swgpar.incremental import DriveModel
from swgpar.linear import Bordered
from swgpar.meshing import load_recipe
from swgpar.steps import Scene

DATA = Path(__file__).parent.parent / "data"


def test_iterative_equals_direct() -> None:
    model = DriveModel(load_design(DATA / "small.toml"), load_recipe(DATA / "tiny.toml"), MPI.COMM_WORLD)
    equilibrium, partition = model.equilibrium, model.partition
    equilibrium.scene = Scene(4, "rotate", angle=0.01, cam=-0.001, teeth=-0.02, control="rotation", rotation=1e-3)
    equilibrium.search()
    equilibrium._jacobian(None, equilibrium.x, equilibrium.matrix, equilibrium.matrix)
    positions = equilibrium.positions()[: partition.n_own]
    right = create_vector(partition)
    right.array[:] = np.random.default_rng(1).standard_normal(3 * partition.n_global)[
        3 * partition.row_start : 3 * (partition.row_start + partition.n_own)
    ]
    solutions = []
    for linear in ("direct", "iterative"):
        border = Bordered(partition, linear, positions, f"test_{linear}_")
        solved = equilibrium.border
        border.set_system(equilibrium.matrix, equilibrium.ground_vectors, solved.border, solved.rows)
        pc = equilibrium.snes.getKSP().getPC()
        border.setUp(pc)
        solutions.append(create_vector(partition))
        border.apply(pc, right, solutions[-1])
    size = solutions[0].norm()
    solutions[1].axpy(-1.0, solutions[0])
    # GMRES stops at a residual of 1e-6; the condition number is about 1e8, the right side excites stiff modes too
    assert size > 0.0 and solutions[1].norm() < 1e-4 * size
