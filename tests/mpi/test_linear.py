"""The bordered system of a drive with all contacts on: the iterative solver against the factor, the bounded border."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from support.messages import Messages
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from support.stiffness import without_grounding
from swgpar.checks.design_file import load_design
from swgpar.fem.vectors import create_vector
from swgpar.load.load_states import LoadState, Stage
from swgpar.meshing import load_recipe
from swgpar.model.drive_model import DriveModel, build_drive_model
from swgpar.petsc import PETSc
from swgpar.solve.bordered_system import BorderedSystem, mumps_defaults


def system(overrides: tuple[str, ...], control: str) -> tuple[DriveModel, PETSc.Vec]:
    """A drive with its tangent set up, and a random right side."""
    model = build_drive_model(load_design(DESIGN, overrides), load_recipe(RECIPE), comm=MPI.COMM_WORLD)
    problem, partition = model.problem, model.partition
    state = LoadState(
        Stage.ROTATE, 4, angle=0.01, cam_clearance=-0.001, flank_clearance=-0.02, control=control, output_rotation=1e-3
    )
    problem.search(state)
    # without the geometric terms the undeformed drive's stiffness is positive: overlaps here are beyond real pressures
    for contact in problem.contacts:
        contact.pressure_limit = 0.0
    u = problem.displacement()
    problem.residual(problem.x, create_vector(partition), state)
    problem.tangent(u, state)
    border, rows = problem.supports.border(u, state)
    bound = problem.output_step_bound(state)
    model.solver.system.set_system(
        problem.matrix, problem.matrix_rows.active, problem.supports.grounding(u), border, rows, bound
    )
    right, size = create_vector(partition), (partition.n_global, 3)
    values = np.random.default_rng(1).standard_normal(size)
    values[: partition.multiplier_nodes[0], partition.dims :] = 0.0
    rows = problem.matrix_rows.active
    right.array.reshape(-1, 3)[rows] = values[partition.row_start + rows]
    return model, right


@pytest.mark.parametrize(
    "overrides",
    [pytest.param((), marks=pytest.mark.parallel(2)), PLANE, pytest.param(PLANE, marks=pytest.mark.parallel(3))],
)
def test_iterative_equals_direct(overrides: tuple[str, ...]) -> None:
    model, right = system(overrides, "rotation")
    solver, problem, partition = model.solver, model.problem, model.partition
    positions = problem.positions()[: partition.n_own]
    solutions = []
    for linear in ("direct", "iterative"):
        border = BorderedSystem(partition, linear, positions, f"test_{linear}_")
        solved = solver.system
        border.set_system(problem.matrix, problem.matrix_rows.active, solved.grounding, solved.border, solved.rows)
        pc = solver.snes.getKSP().getPC()
        border.setUp(pc)
        solutions.append(create_vector(partition))
        border.apply(pc, right, solutions[-1])
    size = solutions[0].norm()
    solutions[1].axpy(-1.0, solutions[0])
    # GMRES stops at a residual of 1e-6; the condition number is about 1e8, the right side excites stiff modes too
    assert size > 0.0 and solutions[1].norm() < 1e-4 * size


@pytest.mark.parametrize(("option", "value", "word"), [("14", -99, "more memory"), ("23", 1, "cannot factorise")])
@pytest.mark.parallel([1, 2])
def test_mumps_out_of_memory(option: str, value: int, word: str) -> None:
    """An estimate that is too small is raised; what is forbidden gives a step that is not finite, and is named."""
    model, right = system(PLANE, "rotation")
    solver, problem, partition = model.solver, model.problem, model.partition
    PETSc.Options()[f"short_{option}_mat_mumps_icntl_{option}"] = value
    border = BorderedSystem(partition, "direct", problem.positions()[: partition.n_own], f"short_{option}_")
    solved, pc = solver.system, solver.snes.getKSP().getPC()
    border.set_system(problem.matrix, problem.matrix_rows.active, solved.grounding, solved.border, solved.rows)
    x = create_vector(partition)
    with Messages() as said:
        border.setUp(pc)
        border.apply(pc, right, x)
    assert np.isfinite(x.norm()) == (option == "14")
    parallel_assert(len(said.texts) == 1 and word in said.texts[0], str(said.texts))


def test_options_of_one_model_are_not_those_of_the_next() -> None:
    """PETSc keeps options by prefix; what the user has set stays."""
    options = PETSc.Options("both_")
    options["mat_mumps_icntl_13"] = 0
    for overrides, dims in ((PLANE, 2), ((), 3), (PLANE, 2)):
        model, _ = system(overrides, "rotation")
        place = model.problem.positions()[: model.partition.n_own]
        BorderedSystem(model.partition, "direct", place, "both_")
        assert options.getInt("mat_mumps_icntl_7") == mumps_defaults(dims)["mat_mumps_icntl_7"]
        assert options.getInt("mat_mumps_icntl_13") == 0


@pytest.mark.parametrize("overrides", [(), ("drive.layout=spline_fixed",), PLANE])
@pytest.mark.parallel([1, 2, 3])
def test_the_loaded_motion_is_bounded(overrides: tuple[str, ...]) -> None:
    """Without a bound that matters the step is that of a system without the loaded border; with one it ends there."""
    model, right = system(overrides, "torque")
    solver, problem, partition = model.solver, model.problem, model.partition
    pc, solved = solver.snes.getKSP().getPC(), solver.system
    output = solved.border[-1]

    def step(border: list[PETSc.Vec], rows: list[int], bound: float | None) -> PETSc.Vec:
        test = BorderedSystem(partition, "direct", problem.positions()[: partition.n_own], "test_")
        test.set_system(problem.matrix, problem.matrix_rows.active, solved.grounding, border, rows, bound)
        test.setUp(pc)
        x = create_vector(partition)
        test.apply(pc, right, x)
        return x

    free = step(solved.border[:-1], solved.rows[:-1], None)
    wide = step(solved.border, solved.rows, 1e300)
    motion = output.dot(free)
    assert output.dot(wide) == pytest.approx(motion, rel=1e-6)
    wide.axpy(-1.0, free)
    # the unused multiplier is zero in one and what the unit block of the matrix makes of it in the other
    if partition.comm.rank == partition.comm.size - 1:
        wide.array[-partition.n_multipliers :][solved.rows[-1]] = 0.0
    assert wide.norm() < 1e-6 * free.norm()
    for share in (0.5, 1e-3):
        bound = share * abs(motion)
        held = step(solved.border, solved.rows, bound)
        assert output.dot(held) == pytest.approx(np.sign(motion) * bound, rel=1e-6)
        # the rest of the drive follows: what is left of its equations points along the output's motion
        left = without_grounding(problem, held)
        left.aypx(-1.0, right)
        for k, row in enumerate(solved.rows[:-1]):
            left.axpy(-float(problem.multipliers(held)[row]), solved.border[k])
        if partition.comm.rank == partition.comm.size - 1:
            left.array[-partition.n_multipliers :] = 0.0
        along = output.dot(left) / output.dot(output)
        left.axpy(-along, output)
        assert left.norm() < 1e-6 * right.norm() and abs(along) * output.norm() > 1e-3 * left.norm()
