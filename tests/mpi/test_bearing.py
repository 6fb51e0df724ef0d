"""The small plane drive with a flexible bearing: balance, limits, ranks, shares of the
compliance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

import swgpar
from support.bearing import BEARING
from support.paths import RECIPE
from support.stepping import WORLD, assert_agree, load_stepper, loaded, row, small
from swgpar.analysis.bent_start import bend
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.evaluation.bearing_loads import ball_rows
from swgpar.evaluation.compliance import bearing_shares
from swgpar.fem.body import FLEXIBLE_SPLINE, OUTER_RACE
from swgpar.load.load_sequence import load_sequence

NAMES = ("fs_s1", "fs_s3", "fs_vm", "output_angle_deg")


def jumped(*overrides: str, model: str = "plane", comm: MPI.Comm = WORLD) -> LoadStepper:
    """The loaded small drive, from the bent shape at once."""
    design = small(model, *overrides)
    stepper = load_stepper(design, comm)
    bend(stepper.model)
    stepper.jump(load_sequence(design).loaded)
    return stepper


def loads(stepper: LoadStepper) -> np.ndarray:
    """Loads (n,) N of all balls."""
    return np.array([ball["load_N"] for ball in ball_rows(stepper.model, stepper.load_state, 1, 3)])


@pytest.mark.parallel([1, 2])
def test_same_on_any_ranks() -> None:
    """Loads and stresses do not depend on the ranks, nor on modelling half of the drive."""
    stepper = jumped(*BEARING, "wave_generator.bearing.first_ball=4.0")
    found, values = loads(stepper), row(stepper)
    stepper.model.destroy()
    alone = jumped(
        *BEARING,
        "wave_generator.bearing.first_ball=4.0",
        "solver.symmetry=false",
        comm=MPI.COMM_SELF,
    )
    parallel_assert(np.abs(found - loads(alone)).max() < 1e-6 * found.max())
    assert_agree(values, row(alone), [*NAMES, "wg_torque_Nmm"], rel=1e-6)
    parallel_assert(values["torque_balance_Nmm"] < 1e-6 * 200.0)
    alone.model.destroy()


@pytest.mark.parallel([1, 2])
def test_cup() -> None:
    """The small cup on a bearing: torques balance, all balls carry, those near the major axis
    most."""
    stepper = jumped(*BEARING, "micro_geometry.wg_slope=0", model="cup")
    found, values = loads(stepper), row(stepper)
    parallel_assert(found.min() > 0.0 and found.argmax() % 10 in (9, 0, 1))
    parallel_assert(values["torque_balance_Nmm"] < 1e-6 * 2000.0)
    stepper.model.destroy()


@pytest.mark.parallel([1, 2])
def test_a_taper_of_the_race_moves_its_load_to_the_open_end() -> None:
    """The race presses on the bore of a cup, which is a cone at the lobes: without a taper its edge
    at the closed end carries there. A taper that follows the cone spreads the load."""
    places, largest = [], []
    for taper in (0.0, 0.02):
        stepper = jumped(
            *BEARING,
            "micro_geometry.wg_slope=0",
            "micro_geometry.wg_crowning=0",
            f"wave_generator.bearing.race_taper={taper}",
            model="cup",
        )
        model, values = stepper.model, row(stepper)
        pressed, u = model.problem.wave_generator.race.owned_pressure(), model.problem.positions()
        z = np.einsum("qa,fa->fq", pressed.shape, u[pressed.conn, 2])
        force = pressed.weight * pressed.pressure
        total = WORLD.allreduce(np.array([force.sum(), (force * z).sum()]))
        places.append(total[1] / total[0])
        largest.append(WORLD.allreduce(float(pressed.pressure.max(initial=0.0)), op=MPI.MAX))
        parallel_assert(values["torque_balance_Nmm"] < 1e-6 * 2000.0)
        model.destroy()
    print(f"middle of the load at z = {places} mm, largest pressure {largest} MPa")
    parallel_assert(places[0] > 0.1 and places[1] < 0.8 * places[0])
    parallel_assert(largest[1] < largest[0])


@pytest.mark.parallel([1, 2])
def test_balls_balance_the_force_on_the_spline() -> None:
    """Forces and moments of the balls are those on the spline. All of the drive is modelled: their
    number is odd."""
    stepper = jumped(
        *BEARING, "wave_generator.bearing.balls=19", "wave_generator.bearing.first_ball=3.0"
    )
    problem, state = stepper.problem, stepper.load_state
    u = problem.displacement()
    place = problem.positions() + u
    forces = {}
    for name, contact in zip(("race", "balls"), problem.contacts):
        nodal = np.zeros_like(u)
        contact.add_owned_forces(u, state, nodal)
        forces[name] = nodal

    def resultant(name: str, body: int) -> np.ndarray:
        nodes = np.zeros(len(u), dtype=bool)
        local = stepper.model.elements.bodies[body].local
        nodes[local[local >= 0]] = True
        f, x = forces[name][nodes], place[nodes]
        moment = np.sum(x[:, 0] * f[:, 1] - x[:, 1] * f[:, 0])
        return WORLD.allreduce(np.array([*f[:, :2].sum(axis=0), moment]), op=MPI.SUM)

    on_spline, on_race, of_balls = (
        resultant("race", FLEXIBLE_SPLINE),
        resultant("race", OUTER_RACE),
        resultant("balls", OUTER_RACE),
    )
    total = loads(stepper).sum()
    parallel_assert(total > 100.0)
    parallel_assert(np.abs(on_spline + on_race)[:2].max() < 1e-9 * total)
    parallel_assert(np.abs(of_balls + on_race)[:2].max() < 1e-7 * total)
    # the race's support carries no torque but for the mesh: a hundred-thousandth of the forces
    # times the radius
    parallel_assert(abs(of_balls[2] + on_race[2]) < 1e-5 * total * 18.6)
    stepper.model.destroy()


@pytest.mark.parallel(1)
def test_rigid_limit() -> None:
    """Rigid balls close to each other and a thin race: the stresses and the rotation of the rigid
    cam to 0.5 %."""
    limit = ("balls=360", "ball_diameter=0.3", "race_thickness=0.05", "stiffness_factor=1e3")
    stepper = jumped(*(f"wave_generator.bearing.{key}" for key in limit))
    rigid, expected = loaded(small("plane"))
    assert_agree(row(stepper), expected, NAMES, rel=5e-3)
    assert_agree(row(stepper), expected, ["tooth_torque_Nmm"], rel=5e-3)
    for one in (stepper, rigid):
        one.model.destroy()


@pytest.mark.parallel([1, 2])
def test_shares_of_compliance() -> None:
    """The balls' share is their work sum dF ddelta over dT dphi, from two torques."""
    stepper = jumped(*BEARING)
    shares = bearing_shares(stepper.model, stepper.load_state)
    middle, states = stepper.load_state, []
    for torque in (0.999 * middle.torque, 1.001 * middle.torque):
        stepper.advance(replace(middle, torque=torque))
        rows = ball_rows(stepper.model, stepper.load_state, 1, 3)
        rotation = np.radians(row(stepper)["output_angle_deg"])
        states.append(
            (
                torque,
                rotation,
                *(np.array([ball[key] for ball in rows]) for key in ("load_N", "approach_um")),
            )
        )
    change = [after - before for before, after in zip(*states)]
    work = np.sum(change[2] * 1e-3 * change[3]) / (change[0] * change[1])
    # the forces on the race turn with its normals, which the work of the loads does not see: 1.2 %
    # here, the same with loads that differ by 0.1, 1 and 10 %
    parallel_assert(shares["torsional"].balls == pytest.approx(work, rel=0.015))
    for share in shares.values():
        parallel_assert(
            0.0 < share.balls < 1.0 and 0.0 < share.race < 1.0 and share.balls + share.race < 1.0
        )
    stepper.model.destroy()


@pytest.mark.parallel(1)
def test_stiff_balls_take_no_share() -> None:
    """Balls a thousand times as stiff yield a hundredth at the same force, but for the turn of the
    forces with the race."""
    soft, stiff = jumped(*BEARING), jumped(*BEARING, "wave_generator.bearing.stiffness_factor=1e3")
    shares = [bearing_shares(one.model, one.load_state)["torsional"].balls for one in (soft, stiff)]
    assert abs(shares[1]) < 0.015 * shares[0]
    stiffness = [
        stepper.problem.wave_generator.balls.balls.spring.stiffness for stepper in (stiff, soft)
    ]
    ratio = stiffness[0] / stiffness[1]
    assert ratio == pytest.approx(1e3)
    for one in (soft, stiff):
        one.model.destroy()


@pytest.mark.parallel(1)
def test_tangent() -> None:
    """The tangent of balls and race is the derivative of their forces."""
    stepper = jumped(*BEARING, "wave_generator.bearing.first_ball=2.0", "solver.symmetry=false")
    problem, state = stepper.problem, stepper.load_state
    u, step = problem.displacement(), 1e-9
    along = np.random.default_rng(0).normal(size=u.shape) * (1.0, 1.0, 0.0)
    race = problem.wave_generator.race
    race.multiplier = race.multiplier + 1.0  # all touch
    for contact in (race, problem.wave_generator.balls):
        contact.evaluate(u, state, None, None)
        problem.blocks.rows.values[:] = 0.0
        contact.evaluate(u, state, None, problem.blocks.rows)
        rows = np.repeat(np.arange(problem.blocks.rows.n_own), np.diff(problem.blocks.rows.start))
        columns, blocks = problem.blocks.rows.column, problem.blocks.rows.values
        product = np.zeros_like(u)
        np.add.at(product, rows, np.einsum("plk,pl->pk", blocks, along[columns]))
        below = rows != columns
        np.add.at(
            product, columns[below], np.einsum("plk,pk->pl", blocks[below], along[rows[below]])
        )
        ahead, behind = np.zeros_like(u), np.zeros_like(u)
        contact.evaluate(u + step * along, state, ahead, None)
        contact.evaluate(u - step * along, state, behind, None)
        difference = (ahead - behind) / (2.0 * step)
        assert np.linalg.norm(product - difference) < 1e-4 * np.linalg.norm(difference)
    stepper.model.destroy()


@pytest.mark.parallel(1)
def test_run_and_restart(tmp_path) -> None:
    """balls.csv, summary, figure, field of the race; a run that was continued has the same rows."""
    design = small("plane", *BEARING, "output.fields=true")
    whole = swgpar.run(design, mesh=str(RECIPE), out=tmp_path / "whole")
    part = tmp_path / "part"
    swgpar.run(design.with_values({"steps.rotation": 3.0}), mesh=str(RECIPE), out=part)
    continued = swgpar.run(design, mesh=str(RECIPE), out=part, restart=True)
    for name, values in whole.balls.items():
        assert continued.balls[name] == pytest.approx(values, rel=1e-4, abs=1e-6)
    bearing = whole.summary.bearing
    assert bearing.largest_load_N == whole.balls["load_N"].max() > 0.0
    assert len(whole.balls["ball"]) == 20 * len(whole.history["step"])
    assert continued.summary.bearing.torsional_share == bearing.torsional_share
    assert {"ball_loads"} <= set(whole.plot.names)
    assert len(whole.plot.ball_loads().axes) == 2
    assert whole.field("vm", body="outer_race").max() > 0.0
    assert (tmp_path / "whole" / "balls.csv").exists()
    asked = {"steps.rotation": 0.0, "output.bearing_shares": False}
    alone = swgpar.run(design.with_values(asked), mesh=str(RECIPE)).summary.bearing
    assert alone.largest_load_N > 0.0
    assert alone.torsional_share is None and alone.radial_share is None
