"""The output on a bearing of given stiffness under radial and axial forces and tilting moments."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from support.cup_shapes import CLAMPED, shaped
from support.stepping import Row, assert_agree, load_stepper, loaded, small
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.constraints.boundary_conditions import PrescribedDisplacement
from swgpar.constraints.distributing_coupling import (
    ROTATION,
    TILT_X,
    TILT_Y,
    DistributingCoupling,
    X,
    Y,
    Z,
)
from swgpar.constraints.output_springs import OutputSprings
from swgpar.constraints.supports import Supports
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import ContactSection, Solver
from swgpar.evaluation.output_bearing_loads import output_bearing_loads
from swgpar.fem.body import FLEXIBLE_SPLINE, RING_GEAR, Body
from swgpar.fem.elements import Elements
from swgpar.fem.partition import Partition
from swgpar.load.load_states import LoadState, Stage
from swgpar.log import PhaseTimes
from swgpar.materials import Isotropic
from swgpar.meshing.race_sector import annular_sector
from swgpar.model.drive_model import newton_settings
from swgpar.model.layouts import build_layout
from swgpar.results.history import OUTPUT_COLUMNS
from swgpar.solve.discrete_problem import DiscreteProblem
from swgpar.solve.newton import NewtonSolver

SOFT = {"radial_stiffness": 2e4, "axial_stiffness": 1e4, "tilting_stiffness": 2e3}
"""Little stiffer than the teeth, N/mm and N·m/rad."""

STIFF = dict.fromkeys(SOFT, 1e9)
FORCES = {
    "radial_force": 60.0,
    "radial_direction": 30.0,
    "axial_force": 20.0,
    "tilting_moment": 1.0,
    "tilting_direction": 70.0,
}
RADIAL = {"radial_force": 20.0, "radial_direction": 30.0}

PHYSICAL = ("fs_s1", "fs_vm", "wg_torque_Nmm", "tooth_torque_Nmm", "output_angle_deg")


def on_bearing(kind: str, *overrides: str, **keys: float) -> DriveDesign:
    """A small drive of a kind, with these keys of [output_bearing]; without any, without one."""
    changes = CLAMPED if kind == "clamped" else {}
    of_bearing = tuple(f"output_bearing.{key}={value}" for key, value in keys.items())
    if kind.startswith("plane"):
        layout = ("drive.layout=spline_fixed",) if kind == "plane ring" else ()
        return small("plane", *layout, *of_bearing, *overrides)
    layout = ('drive.layout="spline_fixed"',) if kind == "ring" else ()
    return shaped(changes, *layout, *of_bearing, *overrides)


SOLID, PLANE = ("clamped", "ring"), ("plane", "plane ring")

kinds = pytest.mark.parametrize("kind", SOLID + PLANE)


@lru_cache
def under_forces(kind: str) -> tuple[LoadStepper, Row]:
    return loaded(on_bearing(kind, **SOFT, **(RADIAL if kind in PLANE else FORCES)))


@pytest.mark.parametrize("kind", ["clamped", "plane ring"])
def test_a_stiff_bearing_holds_the_output(kind: str) -> None:
    _, held = loaded(on_bearing(kind))
    stepper, carried = loaded(on_bearing(kind, "solver.symmetry=false", **STIFF))
    assert stepper.model.copies == 1
    assert_agree(carried, held, PHYSICAL, 1e-6)


def test_half_the_drive_carries_an_axial_force() -> None:
    keys = {**SOFT, "axial_force": 20.0}
    (stepper, half), (whole, full) = (
        loaded(on_bearing("edge", f"solver.symmetry={symmetry}", **keys))
        for symmetry in ("true", "false")
    )
    assert (stepper.model.copies, whole.model.copies) == (2, 1)
    assert_agree(half, full, (*PHYSICAL, "output_z_mm"), 1e-6)


def contact_resultant(stepper: LoadStepper, body: str) -> np.ndarray:
    """Force (3,) N and moment (3,) N mm about the origin of all contacts on a body."""
    problem = stepper.problem
    u, residual = problem.displacement(), np.zeros((len(problem.local_nodes), 3))
    for contact in problem.contacts:
        contact.add_owned_forces(u, stepper.load_state, residual)
    local = problem.elements.bodies[body].local
    nodes = np.unique(local[local >= 0])
    forces, place = -residual[nodes], (problem.positions() + u)[nodes]
    resultant = np.concatenate([forces.sum(axis=0), np.cross(place, forces).sum(axis=0)])
    return problem.partition.comm.allreduce(resultant, op=MPI.SUM)


@kinds
def test_reactions_balance_forces_and_contacts(kind: str) -> None:
    stepper, row = under_forces(kind)
    supports, bearing = stepper.problem.supports, stepper.design.output_bearing
    body = RING_GEAR if kind in ("ring", "plane ring") else FLEXIBLE_SPLINE
    contacts = contact_resultant(stepper, body)
    motion = supports.output.evaluate(stepper.problem.displacement())
    reaction = -bearing.stiffness * supports.bearing.displacement(motion)
    left = reaction[:3] + bearing.load[:3] + contacts[:3]
    print(f"{kind}: left {np.abs(left).max():.1e} N, of contacts {contacts[:3]}")
    force = stepper.solver.last_residual.contact_force
    # round-off of the guide is 1e-8 of it, that of all else less
    within = 1e-7 if body == RING_GEAR else 1e-8
    assert np.abs(left[: 2 if kind in PLANE else 3]).max() < within * force
    assert row["torque_balance_Nmm"] < 1e-6 * abs(row["output_torque_Nmm"])
    if kind in SOLID:
        # places of the nodes have the strains, which the moment by small tilts has not
        middle = supports.output.center[2]
        moment = contacts[3:5] + middle * np.array([contacts[1], -contacts[0]])
        left = reaction[3:] + bearing.load[3:] + moment
        assert np.abs(left).max() < 2e-3 * np.linalg.norm(bearing.load[3:])


def supported(stepper: LoadStepper, u: np.ndarray) -> np.ndarray:
    """Residual of the supports at u (n_local, 3) mm without the torque, N."""
    problem, residual = stepper.problem, np.zeros_like(u)
    state = replace(stepper.load_state, torque=0.0)
    problem.supports.add_forces(u, state, problem.multipliers(), residual)
    return residual


@kinds
def test_the_tangent_is_the_derivative_of_the_forces(kind: str) -> None:
    stepper, _ = under_forces(kind)
    problem, supports = stepper.problem, stepper.problem.supports
    u, random = problem.displacement(), np.random.default_rng(1)
    direction = random.standard_normal(u.shape) * (1.0, 1.0, 0.0 if kind in PLANE else 1.0)
    change, step = np.zeros_like(u), 1e-5
    parts = [part for _, part in supports._attached]
    for part in parts:
        change[part.nodes] += np.einsum("nij,nj->ni", part.blocks(), direction[part.nodes])
    if supports.guide is not None:
        nodes = supports.guide.nodes
        change[nodes] += np.einsum("nij,nj->ni", supports.guide.blocks(u), direction[nodes])
        parts.append(supports.guide)
    for part in parts:
        for vector in part.free_motions(u):
            change[part.nodes] -= vector * np.sum(vector * direction[part.nodes])
    for vector in supports.bearing.spring_vectors(supports.output.evaluate(u)):
        nodes = supports.output.nodes
        change[nodes] += vector * np.sum(vector * direction[nodes])
    difference = supported(stepper, u + step * direction) - supported(stepper, u - step * direction)
    # what the tangent lacks are second variations, which forces multiply
    left = difference / (2.0 * step) - change
    print(f"{kind}: {np.linalg.norm(left) / np.linalg.norm(change):.1e}")
    assert np.linalg.norm(left) < 1e-5 * np.linalg.norm(change)


@pytest.mark.parametrize("kind", ["edge", "clamped"])
def test_forces_alone_move_a_free_output_by_the_springs(kind: str) -> None:
    """Neither cam nor teeth act: a cup that is rotated moves as a rigid body on its bearing, which
    is 7 mm behind its end. The forces keep their directions."""
    middle = load_stepper(on_bearing(kind, **SOFT)).problem.supports.output.center[2]
    design = on_bearing(kind, **SOFT, **FORCES, position=round(float(middle) + 7.0, 6))
    stepper, bearing = load_stepper(design), design.output_bearing
    state = LoadState(Stage.DEFLECT, 1, output_rotation=float(np.radians(3.0)))
    assert stepper.solver.solve(state).converged
    row = stepper.row()
    moved = np.array([row[name] for name in OUTPUT_COLUMNS])
    print(f"{kind}: {moved / (bearing.load / bearing.stiffness) - 1.0}")
    # a rigid flange that tilts by a small angle strains the end in the second order of it
    assert moved == pytest.approx(bearing.load / bearing.stiffness, rel=1e-5)
    motion = stepper.problem.supports.output.evaluate(stepper.problem.displacement())
    assert motion.value[X] == pytest.approx(moved[0] - 7.0 * moved[TILT_Y], rel=1e-6)
    assert motion.value[Y] == pytest.approx(moved[1] + 7.0 * moved[TILT_X], rel=1e-6)
    found = output_bearing_loads(bearing, design.drive.module, [row])
    assert found.radial_force_N == pytest.approx(60.0, rel=1e-5)
    assert found.axial_force_N == pytest.approx(20.0, rel=1e-5)
    assert found.tilting_moment_Nm == pytest.approx(1.0, rel=1e-5)
    assert found.tilt_mrad == pytest.approx(1e3 / SOFT["tilting_stiffness"], rel=1e-5)


def test_a_clamped_tube_on_a_bearing_is_a_beam() -> None:
    """Force and moment at the end of a tube, whose other end is clamped: Timoshenko's beam with
    springs."""
    inner, outer, length, sectors = 19.0, 21.0, 160.0, 24
    steel = Isotropic(E=210e3, nu=0.3)
    angle, z = np.pi / sectors * np.linspace(-1.0, 1.0, 3), np.linspace(0.0, length, 41)
    mesh = annular_sector("ring_gear", np.array([inner, outer]), angle, z, sectors, False)
    ends = {
        name: np.flatnonzero(mesh.coords[:, 2] == at).astype(np.int32)
        for name, at in (("start", 0.0), ("end", length))
    }
    mesh = replace(mesh, node_sets={**mesh.node_sets, **ends})
    partition = Partition([build_layout(Body(mesh, (steel,), length, ()), copies=1)], MPI.COMM_SELF)
    elements = Elements(partition)
    body = elements.bodies["ring_gear"]
    end = DistributingCoupling(partition, body, "end", False)
    area, second = np.pi * (outer**2 - inner**2), np.pi / 4.0 * (outer**4 - inner**4)
    bending = steel.E * second
    shear = (
        steel.E / (2.0 + 2.0 * steel.nu) * area * (2.0 + 2.0 * steel.nu) / (4.0 + 3.0 * steel.nu)
    )
    springs = np.array([1e4, 1e4, 1e6, bending / length, bending / length])
    load, lever = np.array([300.0, 0.0, 0.0, 4e4, 7e4]), 15.0
    held = np.unique(body.local[body.owned][:, mesh.node_sets["start"]])
    held = held[(held >= 0) & (held < partition.n_own)]
    problem = DiscreteProblem(
        partition=partition,
        elements=elements,
        supports=Supports(
            partition,
            [end],
            scale=1e5,
            share=1.0,
            bearing=OutputSprings(springs, load, lever, end.movable, 1.0),
        ),
        boundary_terms=[PrescribedDisplacement(partition, held, np.zeros((len(held), 3)), 1e11)],
        module=1.0,
        phases=PhaseTimes(),
    )
    solver = NewtonSolver(problem, newton_settings(Solver(rtol=1e-9), ContactSection(), 1.0))
    assert solver.solve(LoadState(Stage.ROTATE, 4)).converged
    supports = problem.supports
    found = supports.bearing.displacement(supports.output.evaluate(problem.displacement()))
    # stiffness at the end, for x with the tilt about y and for y with that about x
    by_end = np.array(
        [
            [length**3 / (3.0 * bending) + length / shear, length**2 / (2.0 * bending)],
            [length**2 / (2.0 * bending), length / bending],
        ]
    )
    exact = np.zeros(ROTATION)
    for shift, tilt, sign in ((X, TILT_Y, 1.0), (Y, TILT_X, -1.0)):
        to_bearing = np.array([[1.0, sign * lever], [0.0, 1.0]])
        flexibility = by_end * np.array([[1.0, sign], [sign, 1.0]])
        flexibility = to_bearing @ flexibility @ to_bearing.T
        both = [shift, tilt]
        stiffness = np.linalg.inv(flexibility) + np.diag(springs[both])
        exact[both] = np.linalg.solve(stiffness, load[both])
    print(f"found over beam {found[[X, Y, TILT_X, TILT_Y]] / exact[[X, Y, TILT_X, TILT_Y]]}")
    assert found[[X, TILT_Y]] == pytest.approx(exact[[X, TILT_Y]], rel=0.01)
    assert found[[Y, TILT_X]] == pytest.approx(exact[[Y, TILT_X]], rel=0.01)
    assert abs(found[Z]) < 1e-4 * found[X]  # a bent beam is shorter
    solver.destroy()


@pytest.mark.parallel([2, 3])
@pytest.mark.parametrize("kind", ["clamped", "plane", "plane ring"])
def test_any_number_of_ranks_gives_the_same(kind: str) -> None:
    design = on_bearing(kind, **SOFT, **(RADIAL if kind in PLANE else FORCES))
    (_, several), (_, alone) = loaded(design), loaded(design, MPI.COMM_SELF)
    assert_agree(several, alone, PHYSICAL, 1e-7)
    for name in OUTPUT_COLUMNS:
        close = abs(several[name] - alone[name]) <= 1e-9
        parallel_assert(close, f"{name}: {several[name]} and {alone[name]}")
