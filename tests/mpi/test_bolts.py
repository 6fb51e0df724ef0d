"""A closed end on bolts: the period of teeth and bolts, and what is computed over it."""

from __future__ import annotations

import json

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from support.cup_shapes import ATTACHMENTS, bolted, shaped
from support.paths import RECIPE
from support.stepping import WORLD, loaded, rotate
from swgpar.analysis.deviating_drive import DeviatingDrive
from swgpar.analysis.turn_drive import turn_design
from swgpar.constraints.distributing_coupling import X, Y
from swgpar.constraints.supports import SPLINE_COUPLING
from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.bolt_loads import bolt_rows
from swgpar.evaluation.losses import hysteresis_work
from swgpar.evaluation.stress_cycle import StressCycle, sector_stress
from swgpar.fem.body import FLEXIBLE_SPLINE, RING_GEAR
from swgpar.geometry.rotation import rotated
from swgpar.load.load_sequence import load_sequence
from swgpar.meshing import load_recipe

SAMPLES = 6
BOLTS = 8
HAT_BOLTED = ATTACHMENTS["hat, ten bolts"]
TORQUE = 2000.0
"""N mm, on the output."""


@pytest.mark.parallel(1)
def test_a_sampled_period_of_teeth_and_bolts() -> None:
    """Eight bolts on 40 teeth: six angles of five pitches. The renamed stress is that of sectors
    that the wave passes in later periods, the work is that of the torque."""
    design = shaped(bolted(BOLTS), f"steps.samples={SAMPLES}", "steps.rotation=43.0")
    assert design.kinematics.pitches == 5
    stepper, row = loaded(design, MPI.COMM_SELF)
    sequence = load_sequence(design)
    angles = [state.angle for state in sequence.from_loaded]
    assert angles == pytest.approx(design.kinematics.period_angle / SAMPLES * np.arange(SAMPLES))
    cycle, body = (
        StressCycle(stepper.model, sequence),
        stepper.model.elements.bodies["flexible_spline"],
    )

    def stress() -> np.ndarray:
        return sector_stress(body, stepper.model.stresses()[1][FLEXIBLE_SPLINE])[:, cycle.nodes]

    torques = [row["wg_torque_Nmm"]]
    cycle.keep(sequence.loaded, stepper.model.stresses()[1][FLEXIBLE_SPLINE])
    for state in sequence.from_loaded[1:]:
        torques.append(rotate(stepper, state.angle)["wg_torque_Nmm"])
        cycle.keep(state, stepper.model.stresses()[1][FLEXIBLE_SPLINE])
    assert cycle.complete
    mine, renamed = cycle.history()
    n, count = len(cycle.nodes), body.layout.count
    # half of the drive: four periods of five sectors
    assert mine.tolist() == 5 * list(range(n))
    assert renamed.shape == (count // 5 * SAMPLES, 5 * n, 6)
    period = design.kinematics.period_angle
    for later in (1, 2):
        rotate(stepper, later * period)
        found = stress()[:5].reshape(5 * n, 6)
        assert np.abs(found - renamed[later * SAMPLES]).max() < 1e-6 * np.abs(renamed).max()
    # sectors beside a bolt and between bolts differ
    apart = np.ptp(renamed.reshape(len(renamed), 5, n, 6).max(axis=0), axis=0).max()
    assert apart > 1e-3 * np.abs(renamed).max()
    mean = float(np.mean(torques))
    print(f"mean input torque / (T / ratio) = {mean * 20.0 / TORQUE:.5f}")
    assert mean == pytest.approx(TORQUE / 20.0, rel=0.01)
    assert hysteresis_work(cycle) > 0.0


LOADS = ("tangential_N", "radial_N", "axial_N", "tilting_Nmm", "twisting_Nmm")


def bolt_loads(design: DriveDesign, comm: MPI.Comm) -> np.ndarray:
    """Columns (bolts, 5) of `LOADS` in the loaded state. Their moment about the axis is that of
    teeth and wave generator on the flexible spline."""
    stepper, row = loaded(design, comm)
    rows = bolt_rows(stepper.model, stepper.load_state, 1, 3)
    assert [row["bolt"] for row in rows] == list(range(design.cup.bolts))
    if design.kinematics.output_gear == FLEXIBLE_SPLINE:  # the bolts turn with it
        turned = [(row["angle_deg"] - stepper.row()["output_angle_deg"]) % 360.0 for row in rows]
        assert turned[1] == pytest.approx(360.0 / len(rows))
    stepper.model.destroy()
    loads = np.array([[row[name] for name in LOADS] for row in rows])
    carried = float(np.sum(loads[:, 0] * 0.5 * design.cup.bolt_circle + loads[:, 4]))
    print(f"{carried:.6f} N mm, {loads[:5].round(2).tolist()}")
    acting = row["wg_torque_Nmm"] + row["tooth_torque_Nmm"]
    parallel_assert(carried == pytest.approx(acting, abs=1e-6 * TORQUE))
    return loads


@pytest.mark.parallel([1, 2, 3])
def test_bolts_carry_the_torque() -> None:
    """Half of the drive gives the rows of the whole. The ranks share the whole."""
    found = bolt_loads(shaped(bolted(BOLTS)), MPI.COMM_SELF)
    whole = bolt_loads(shaped(bolted(BOLTS), "solver.symmetry=false"), WORLD)
    parallel_assert(whole == pytest.approx(found, rel=1e-5, abs=1e-5 * np.abs(found).max()))


@pytest.mark.parallel(1)
def test_bolts_of_a_flange_that_stands() -> None:
    bolt_loads(shaped(HAT_BOLTED, 'drive.layout="spline_fixed"', "load.torque=2.1"), MPI.COMM_SELF)


def _pitch_errors(teeth: int) -> list[float]:
    """Micrometres."""
    return np.random.default_rng(teeth).normal(0.0, 3.0, teeth).round(2).tolist()


DEVIATIONS = [f"deviations.{part}={json.dumps(keys)}" for part, keys in {
    "ring_gear": {"eccentricity": 0.01, "direction": 30.0, "pitch_errors": _pitch_errors(42)},
    "flexible_spline": {"pitch_errors": _pitch_errors(40)},
    "cup": {"eccentricity": 0.005, "direction": 70.0},
}.items()]  # fmt: skip


@pytest.mark.parallel(1)
def test_deviations_are_renamed_after_a_period_of_teeth_and_bolts() -> None:
    """The states after 3 and 7 of 42 pitches, of which five are a period, equal those of a drive
    whose wave generator is rotated step by step. Far teeth are modelled: that they are one element
    moves the torque by 1e-3, and which ones these are depends on the search."""
    more = ('deviations.mesh="same"', "deviations.angles_per_pitch=1")
    design = shaped(bolted(BOLTS), *DEVIATIONS, *more, 'solver.far_teeth="modelled"')
    drive = DeviatingDrive(design, load_recipe(RECIPE), MPI.COMM_SELF)
    assert (drive.per_period, drive.angles) == (5, 42)
    wanted = (3, 7)
    points = drive.points(set(range(drive.angles)).difference(wanted))
    found = {point.index: point for point in points}
    drive.destroy()
    stepper, _ = loaded(turn_design(design), MPI.COMM_SELF)
    problem, kinematics = stepper.problem, design.kinematics
    problem.flanks_of(RING_GEAR).deviate(drive.tables)
    for index in wanted:
        angle = index * kinematics.pitch_angle
        shift = rotated(design.deviations.cup.shift, angle / kinematics.ratio)
        problem.supports.offsets[SPLINE_COUPLING, [X, Y]] = shift
        row = rotate(stepper, angle)
        mine, kinematic = (
            np.degrees(found[index].output_angle),
            np.degrees(angle / kinematics.ratio),
        )
        print(index, mine - kinematic, row["output_angle_deg"] - kinematic, found[index].wg_torque)
        expected = pytest.approx(row["output_angle_deg"] - kinematic, rel=1e-7)
        assert mine - kinematic == expected
        assert found[index].wg_torque == pytest.approx(row["wg_torque_Nmm"], rel=1e-6)
    stepper.model.destroy()
