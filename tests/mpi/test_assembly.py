"""The assembled tangent against differences of the residual, with all contacts on; on any number of
ranks."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from support.stiffness import without_grounding
from swgpar import load_design
from swgpar.fem.body import RING_GEAR
from swgpar.fem.vectors import create_vector
from swgpar.load.load_states import LoadState, Stage
from swgpar.meshing import load_recipe
from swgpar.model.drive_model import build_drive_model

CONDENSE = "solver.condensed_sectors=true"
CONDENSED = (*PLANE, CONDENSE)


@pytest.mark.parametrize(
    "overrides",
    [
        (),
        ("solver.symmetry=false",),
        ("drive.layout=spline_fixed",),
        PLANE,
        (*PLANE, "solver.symmetry=false"),
        (*PLANE, "drive.layout=spline_fixed"),
        ("contact.friction=0.2",),
        CONDENSED,
        (*CONDENSED, "drive.layout=spline_fixed"),
        (*PLANE, "contact.friction=0.2"),
        (*CONDENSED, "contact.friction=0.2"),
    ],
)
@pytest.mark.parallel([1, 2, 3])
def test_tangent_is_the_derivative_of_the_residual(overrides: tuple[str, ...]) -> None:
    design = load_design(DESIGN, [key for key in overrides if key != CONDENSE])
    # unchecked: condensed sectors of 40 teeth leave out too much for a result, which is of no
    # account here
    solver = design.solver.model_copy(update={"condensed_sectors": CONDENSE in overrides})
    design = design.model_copy(update={"solver": solver})
    model = build_drive_model(design, load_recipe(RECIPE), comm=MPI.COMM_WORLD)
    problem, partition, dims = model.problem, model.partition, model.partition.dims
    # undeformed, the cam overlaps at the major axis; shrunk teeth overlap slightly at the minor
    # axis
    state = LoadState(
        Stage.ROTATE,
        4,
        angle=0.01,
        cam_clearance=-0.001,
        flank_clearance=-0.02,
        control="torque",
        torque=2000.0,
    )
    rng = np.random.default_rng(3)
    own = slice(partition.row_start, partition.row_start + partition.n_own)
    # with friction: points of the flanks have come from here, most of them slip
    before = 1e-2 * rng.standard_normal((partition.n_global, 3))
    before[:, dims:] = 0.0
    problem.accepted.array[:] = before[own].ravel()
    problem.search(state)
    # the overlaps here are far beyond any real pressure: the bound of the geometric terms must not
    # act
    for bounded in (*problem.penalty_contacts, *(flanks.kernel for flanks in problem.flanks)):
        bounded.pressure_limit = np.inf
    base = 1e-5 * rng.standard_normal((partition.n_global, 3))
    direction = rng.standard_normal((partition.n_global, 3))
    for vectors in (direction, base):
        vectors[partition.multiplier_nodes] = vectors[:, dims:] = 0.0
    x, d = problem.x, create_vector(partition)
    x.array[:], d.array[:] = base[own].ravel(), direction[own].ravel()
    problem.residual(x, create_vector(partition), state)
    problem.cells.freeze()  # the tangent does not contain the motion of the cells' edges
    # faces that touch with a part of them have no room in the first pattern
    problem.complete_tangent(problem.displacement(x), state)
    product = without_grounding(problem, d)
    step, sides = 1e-8, []
    for sign in (1.0, -1.0):
        trial, force = x.copy(), create_vector(partition)
        trial.axpy(sign * step, d)
        problem.residual(trial, force, state)
        sides.append(force)
    sides[0].axpy(-1.0, sides[1])
    sides[0].scale(0.5 / step)
    difference = sides[0].copy()
    difference.axpy(-1.0, product)
    if partition.comm.rank == partition.comm.size - 1:
        difference.array[-partition.n_multipliers :] = (
            0.0  # the couplings' rows are in the border, not in the matrix
        )
    assert problem.penetration() > 0.0
    if design.contact.friction:
        active = problem.flanks_of(RING_GEAR).cells.active
        slipping = (
            0
            if active is None
            else np.count_nonzero(np.linalg.norm(active.friction.current, axis=2))
        )
        assert partition.comm.allreduce(slipping) > 0
    print(f"relative difference {difference.norm() / sides[0].norm():.1e}")
    # left out of the tangent: the second derivative of the coupling's rotation, and that flanks
    # turn with a ring gear that is the output, their height over the chord (0.01 of the radius
    # here) times the slope of normals to it
    tolerance = 1e-6 if design.drive.layout == "ring_fixed" else 1e-5
    assert difference.norm() < tolerance * sides[0].norm()
