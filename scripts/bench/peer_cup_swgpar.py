"""The flexible spline of the cup drive with prescribed displacements by this program, under mpirun.

mpirun -n 2 python scripts/bench/peer_cup_swgpar.py MESH HELD OUT

HELD is an NPZ file of `nodes` (n,), numbers in the whole spline, and `displacement` (n, 3) mm. The
fields of every rank are written to the folder OUT.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from mpi4py import MPI

from swgpar import load_design
from swgpar.constraints.boundary_conditions import PrescribedDisplacement
from swgpar.constraints.supports import Supports
from swgpar.fem.elements import Elements
from swgpar.fem.partition import Partition
from swgpar.fem.stress import body_fields
from swgpar.load.load_states import LoadState, Stage
from swgpar.log import PhaseTimes
from swgpar.meshing import load_recipe
from swgpar.meshing.export import sector_numbers
from swgpar.meshing.tooth_sector import build_sector
from swgpar.model.drive_model import newton_settings
from swgpar.model.layouts import build_gear, build_layout
from swgpar.solve.discrete_problem import DiscreteProblem
from swgpar.solve.line_search import LineSearch
from swgpar.solve.newton import NewtonSolver

DESIGN, BODY = "drivers/cup_45deg.toml", "flexible_spline"

STIFFNESS = 1e3
"""Springs of the prescribed nodes, over E times the module."""


def main() -> None:
    name, held, out = sys.argv[1:]
    comm, design = MPI.COMM_WORLD, load_design(Path(DESIGN), ["solver.rtol=1e-5"])
    mesh, material = (
        build_sector(design.geometry, load_recipe(name), BODY),
        design.materials[BODY],
    )
    gear = build_gear(mesh, design.materials, design.drive.face_width)
    layout = build_layout(gear, copies=design.copies, condensed_teeth=design.condenses_teeth)
    partition = Partition([layout], comm)
    elements = Elements(partition)
    body = elements.bodies[BODY]
    with np.load(held) as file:
        known = np.full((int(sector_numbers(mesh).max()) + 1, 3), np.nan)
        known[file["nodes"]] = file["displacement"]
    sectors = body.sectors[body.owned]
    local, values = body.local[body.owned], known[sector_numbers(mesh)[sectors % mesh.n_sectors]]
    mine = (
        (local >= 0)
        & (local < partition.n_own)
        & (body.sixths[body.owned] == 0)
        & ~np.isnan(values[..., 0])
    )
    nodes, first = np.unique(local[mine], return_index=True)
    stiffness = STIFFNESS * material.modulus * design.drive.module
    scale = material.modulus * design.drive.module
    problem = DiscreteProblem(
        partition=partition,
        elements=elements,
        supports=Supports(partition, [], scale=scale, share=1.0 / layout.copies),
        boundary_terms=[PrescribedDisplacement(partition, nodes, values[mine][first], stiffness)],
        module=design.drive.module,
        phases=PhaseTimes(),
    )
    LineSearch.TRIALS = 0  # the search is made for contact
    solver = NewtonSolver(
        problem, newton_settings(design.solver, design.contact, design.drive.module)
    )
    solved = solver.solve(
        LoadState(Stage.ROTATE, 4, cam_clearance=0.0)
    )  # a stage that keeps a factor
    if not solved.converged:
        raise SystemExit(f"not converged: {solved}")
    fields = body_fields(body, problem.displacement())
    path = Path(out) / f"spline{comm.rank}.npz"
    np.savez(path, sectors=sectors, displacement=fields["displacement"], s1=fields["s1"])
    if comm.rank == 0:
        (Path(out) / "spline.json").write_text(
            json.dumps({"iterations": solved.iterations}), encoding="utf-8"
        )


if __name__ == "__main__":
    main()
