"""The bordered system of a drive with all contacts on: the iterative solver against the factor, the
bounded border."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from support.messages import Messages
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from support.stiffness import without_grounding
from swgpar import load_design
from swgpar.errors import InputError
from swgpar.fem.sparse import fill_matrix
from swgpar.fem.vectors import create_vector
from swgpar.load.load_states import LoadState, Stage
from swgpar.meshing import load_recipe
from swgpar.model.drive_model import DriveModel, build_drive_model
from swgpar.petsc import PETSc
from swgpar.solve.bordered_system import BorderedSystem
from swgpar.solve.factors import FEW_UNKNOWNS, MINIMUM_DEGREE, NESTED_DISSECTION
from swgpar.solve.linear_solver import MatrixKind
from swgpar.solve.linear_solvers import make_linear_solver


def system(overrides: tuple[str, ...], control: str) -> tuple[DriveModel, PETSc.Vec]:
    """A drive with its tangent set up, and a random right side."""
    model = build_drive_model(
        load_design(DESIGN, overrides), load_recipe(RECIPE), comm=MPI.COMM_WORLD
    )
    problem, partition = model.problem, model.partition
    state = LoadState(
        Stage.ROTATE,
        4,
        angle=0.01,
        cam_clearance=-0.001,
        flank_clearance=-0.02,
        control=control,
        output_rotation=1e-3,
    )
    problem.search(state)
    # without the geometric terms the undeformed drive's stiffness is positive: overlaps here are
    # beyond real pressures
    for contact in problem.wave_generator.all:
        contact.pressure_limit = 0.0
    for flanks in problem.flanks:
        flanks.kernel.pressure_limit = 0.0
    u = problem.displacement()
    problem.residual(problem.x, create_vector(partition), state)
    problem.tangent(u, state)
    border, rows = problem.supports.border(u, state)
    bound = problem.torque_control.output_step_bound(state)
    model.solver.system.set_system(
        problem.blocks.matrix,
        problem.blocks.matrix_rows.active,
        problem.supports.grounding(u),
        border,
        rows,
        bound,
    )
    right, size = create_vector(partition), (partition.n_global, 3)
    values = np.random.default_rng(1).standard_normal(size)
    values[: partition.multiplier_nodes[0], partition.dims :] = 0.0
    rows = problem.blocks.matrix_rows.active
    right.array.reshape(-1, 3)[rows] = values[partition.row_start + rows]
    return model, right


def bordered(model: DriveModel, linear: str, prefix: str) -> BorderedSystem:
    """A bordered system of the model with a linear solver of its own."""
    partition = model.partition
    positions = model.problem.positions()[: partition.n_own, : partition.dims]
    kind = MatrixKind(partition.comm, positions, symmetric=True)
    return BorderedSystem(partition, make_linear_solver(linear, kind, prefix))


@pytest.mark.parametrize(
    "overrides",
    [
        pytest.param((), marks=pytest.mark.parallel(2)),
        PLANE,
        pytest.param(PLANE, marks=pytest.mark.parallel(3)),
    ],
)
def test_iterative_equals_direct(overrides: tuple[str, ...]) -> None:
    model, right = system(overrides, "rotation")
    solver, problem, partition = model.solver, model.problem, model.partition
    solutions = []
    for linear in ("direct", "iterative"):
        border = bordered(model, linear, f"test_{linear}_")
        solved = solver.system
        border.set_system(
            problem.blocks.matrix,
            problem.blocks.matrix_rows.active,
            solved.grounding,
            solved.border,
            solved.rows,
        )
        pc = solver.snes.getKSP().getPC()
        border.setUp(pc)
        solutions.append(create_vector(partition))
        border.apply(pc, right, solutions[-1])
    size = solutions[0].norm()
    solutions[1].axpy(-1.0, solutions[0])
    # GMRES stops at a residual of 1e-6; the condition number is about 1e8, the right side excites
    # stiff modes too
    assert size > 0.0 and solutions[1].norm() < 1e-4 * size


@pytest.mark.parametrize(
    ("option", "value", "word"), [("14", -99, "more memory"), ("23", 1, "cannot factorise")]
)
@pytest.mark.parallel([1, 2])
def test_mumps_out_of_memory(option: str, value: int, word: str) -> None:
    """An estimate that is too small is raised; what is forbidden gives a step that is not finite,
    and is named."""
    model, right = system(PLANE, "rotation")
    solver, problem, partition = model.solver, model.problem, model.partition
    PETSc.Options()[f"short_{option}_mat_mumps_icntl_{option}"] = value
    border = bordered(model, "direct", f"short_{option}_")
    solved, pc = solver.system, solver.snes.getKSP().getPC()
    border.set_system(
        problem.blocks.matrix,
        problem.blocks.matrix_rows.active,
        solved.grounding,
        solved.border,
        solved.rows,
    )
    x = create_vector(partition)
    with Messages() as said:
        border.setUp(pc)
        border.apply(pc, right, x)
    assert np.isfinite(x.norm()) == (option == "14")
    parallel_assert(len(said.texts) == 1 and word in said.texts[0], str(said.texts))


@pytest.mark.parallel([1, 2])
def test_a_factor_that_is_singular_twice() -> None:
    """Every failure gives a step that is not finite; the next matrix that has a factor is
    solved."""
    model, right = system(PLANE, "rotation")
    problem, solved = model.problem, model.solver.system
    border, x = bordered(model, "direct", "singular_"), create_vector(model.partition)
    border.set_system(
        problem.blocks.matrix,
        problem.blocks.matrix_rows.active,
        solved.grounding,
        solved.border,
        solved.rows,
    )
    values, norms = problem.blocks.rows.values.copy(), []
    for share in (1.0, 0.0, 0.0, 1.0):
        problem.blocks.rows.values[:] = share * values
        fill_matrix(problem.blocks.matrix, problem.blocks.rows, problem.blocks.matrix_rows)
        border.setUp(None)
        border.apply(None, right, x)
        norms.append(x.norm())
        parallel_assert((share == 0.0) == bool(border.solver.failure))
    assert np.isfinite(norms).tolist() == [True, False, False, True] and norms[3] == pytest.approx(
        norms[0], rel=1e-9
    )


SOLVED = (
    {"pc_type": "bjacobi"},
    {"pc_type": "gamg"},
    {"pc_type": "lu"},
    {"pc_type": "asm"},
    {"pc_type": "redundant"},
    {"pc_type": "redundant", "ksp_type": "preonly"},
    {"pc_type": "gamg", "ksp_type": "cg"},
    {"pc_type": "bjacobi", "ksp_type": "cg"},
    {"ksp_type": "gmres"},
    {"ksp_type": "cg"},
    {"ksp_type": "minres"},
)
"""Options with which every PETSc solves on any number of ranks."""

SOLVED_OR_SAID = (
    {"pc_type": "jacobi"},
    {"pc_type": "none"},
    {"pc_type": "sor"},
    {"pc_type": "icc"},
    {"pc_type": "ilu"},
    {"pc_type": "hypre"},
    {"pc_type": "ml"},
    {"pc_type": "python"},
    {"pc_type": "jacobi", "ksp_type": "preonly"},
    {"pc_type": "jacobi", "ksp_type": "chebyshev"},
    {"pc_type": "jacobi", "ksp_type": "minres"},
    {"pc_type": "cholesky", "pc_factor_mat_solver_type": "petsc"},
    {"pc_type": "cholesky", "pc_factor_mat_solver_type": "superlu_dist"},
    *(
        {"pc_factor_mat_solver_type": name}
        for name in ("petsc", "superlu_dist", "superlu", "umfpack", "nonsense")
    ),
)
"""Options that a build of PETSc, a number of ranks or the matrix may be unfit for."""


@pytest.mark.parametrize(
    "linear", ["direct", "iterative", pytest.param("direct", marks=pytest.mark.parallel(2))]
)
def test_options_of_petsc_solve_or_end_in_a_sentence(linear: str) -> None:
    """Any preconditioner and Krylov method: the step of MUMPS, one that is not finite with a
    reason, or InputError."""
    model, right = system(PLANE, "rotation")
    problem, solved, comm = model.problem, model.solver.system, model.partition.comm
    reference = create_vector(model.partition)
    arguments = (
        problem.blocks.matrix,
        problem.blocks.matrix_rows.active,
        solved.grounding,
        solved.border,
        solved.rows,
    )
    exact = bordered(model, "direct", "exact_")
    exact.set_system(*arguments)
    exact.setUp(None)
    exact.apply(None, right, reference)
    for k, chosen in enumerate((*SOLVED, *SOLVED_OR_SAID)):
        options, x = PETSc.Options(f"{linear}{k}_"), create_vector(model.partition)
        limit = {} if chosen in SOLVED else {"ksp_max_it": 300}
        for name, value in {**chosen, **limit}.items():
            options[name] = value
        try:
            border = bordered(model, linear, f"{linear}{k}_")
            border.set_system(*arguments)
            border.setUp(None)
            border.apply(None, right, x)
        except InputError as error:
            ends, said = "refused", str(error)
        else:
            ends, said = "failed" if border.solver.failure else "solved", border.solver.failure
            border.destroy()
            border.solver.destroy()
        parallel_assert(len(set(comm.allgather((ends, said)))) == 1, f"{chosen}: {ends} {said}")
        if ends == "solved":
            x.axpy(-1.0, reference)
            # GMRES stops at a residual of 1e-6, minres at a preconditioned one
            assert x.norm() < 1e-2 * reference.norm(), chosen
        else:
            assert chosen in SOLVED_OR_SAID and said, (chosen, said)
            assert ends == "refused" or not np.isfinite(x.norm())


def test_symmetric_methods_are_refused_with_friction() -> None:
    kind = MatrixKind(MPI.COMM_SELF, np.zeros((1, 2)), symmetric=False)
    for k, (name, value) in enumerate((("pc_type", "cholesky"), ("ksp_type", "cg"))):
        PETSc.Options(f"unsymmetric{k}_")[name] = value
        with pytest.raises(InputError, match=f"{value} needs a symmetric tangent"):
            make_linear_solver("direct", kind, f"unsymmetric{k}_")


def test_options_of_one_model_are_not_those_of_the_next() -> None:
    """PETSc keeps options by prefix; what the user has set stays."""
    options = PETSc.Options("both_")
    options["mat_mumps_icntl_13"] = 0
    for overrides, dims in ((PLANE, 2), ((), 3), (PLANE, 2)):
        model, _ = system(overrides, "rotation")
        bordered(model, "direct", "both_")
        assert options.getInt("mat_mumps_icntl_7") == (
            MINIMUM_DEGREE if dims == 2 else NESTED_DISSECTION
        )
        assert options.getInt("mat_mumps_icntl_13") == 0


@pytest.mark.parallel([1, 2])
def test_unknowns_of_coarse_meshes_of_drives_are_ordered_by_minimum_degree() -> None:
    """Those of fine meshes and of parts that are cut out by nested dissection."""
    coarse, fine = np.zeros((10, 3)), np.zeros((FEW_UNKNOWNS // 3, 3))
    for positions, thin, expected in (
        (coarse, True, MINIMUM_DEGREE),
        (coarse, False, NESTED_DISSECTION),
        (fine, True, NESTED_DISSECTION),
    ):
        kind = MatrixKind(MPI.COMM_WORLD, positions, symmetric=True, thin=thin)
        make_linear_solver("direct", kind, "ordered_").destroy()
        assert PETSc.Options("ordered_").getInt("mat_mumps_icntl_7") == expected


@pytest.mark.parametrize("overrides", [(), ("drive.layout=spline_fixed",), PLANE])
@pytest.mark.parallel([1, 2, 3])
def test_the_loaded_motion_is_bounded(overrides: tuple[str, ...]) -> None:
    """Without a bound that matters the step is that of a system without the loaded border; with one
    it ends there."""
    model, right = system(overrides, "torque")
    solver, problem, partition = model.solver, model.problem, model.partition
    pc, solved = solver.snes.getKSP().getPC(), solver.system
    output = solved.border[-1]

    def step(border: list[PETSc.Vec], rows: list[int], bound: float | None) -> PETSc.Vec:
        test = bordered(model, "direct", "test_")
        test.set_system(
            problem.blocks.matrix,
            problem.blocks.matrix_rows.active,
            solved.grounding,
            border,
            rows,
            bound,
        )
        test.setUp(pc)
        x = create_vector(partition)
        test.apply(pc, right, x)
        return x

    free = step(solved.border[:-1], solved.rows[:-1], None)
    wide = step(solved.border, solved.rows, 1e300)
    motion = output.dot(free)
    assert output.dot(wide) == pytest.approx(motion, rel=1e-6)
    wide.axpy(-1.0, free)
    # the unused multiplier is zero in one and what the unit block of the matrix makes of it in the
    # other
    if partition.comm.rank == partition.comm.size - 1:
        wide.array[-partition.n_multipliers :][solved.rows[-1]] = 0.0
    assert wide.norm() < 1e-6 * free.norm()
    for share in (0.5, 1e-3):
        bound = share * abs(motion)
        held = step(solved.border, solved.rows, bound)
        assert output.dot(held) == pytest.approx(np.sign(motion) * bound, rel=1e-6)
        # the rest of the drive follows: what is left of its equations points along the output's
        # motion
        left = without_grounding(problem, held)
        left.aypx(-1.0, right)
        for k, row in enumerate(solved.rows[:-1]):
            left.axpy(-float(problem.multipliers(held)[row]), solved.border[k])
        if partition.comm.rank == partition.comm.size - 1:
            left.array[-partition.n_multipliers :] = 0.0
        along = output.dot(left) / output.dot(output)
        left.axpy(-along, output)
        assert left.norm() < 1e-6 * right.norm() and abs(along) * output.norm() > 1e-3 * left.norm()
