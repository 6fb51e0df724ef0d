"""Identities of load programs on the small plane drive: stiffness loops, clearance, ratcheting,
restart, ranks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

import swgpar
from support.bearing import BEARING
from support.friction_work import FrictionWork
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from support.stepping import load_stepper, small
from swgpar.analysis.run_drive import run_drive
from swgpar.contact.clearance import LOADED_SIDE
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.evaluation.program_results import PointRow, point_rows, work_by_torque
from swgpar.evaluation.ratcheting import AT_TEETH, SUFFICIENT
from swgpar.load.load_program import FIRST_LOADING, NO_TORQUE
from swgpar.load.load_sequence import load_sequence
from swgpar.load.load_states import Stage
from swgpar.meshing import load_recipe
from swgpar.presentation.drive_result import DriveResult
from swgpar.run_options import RunOptions

TORQUE = 0.2
"""N·m"""

YIELD_STRENGTH = 4000.0
"""MPa, of a steel that does not exist: the cam alone gives 2,000."""

LOW_TEETH = {
    "drive.addendum_coef": 0.1,
    **{
        f"{gear}.profile": {
            "type": "quadruple_arc",
            "r_tip": 0.1,
            "r_addendum": 1.0,
            "straight_l": 0.05,
            "r_dedendum": 2.0,
            "r_root": 0.3,
        }
        for gear in ("flexible_spline", "ring_gear")
    },
}
"""Teeth that overlap by 0.2 mm and jump over while strains are small."""


def run(design: DriveDesign, **options: Any) -> DriveResult:
    return run_drive(design, RunOptions(recipe=load_recipe(RECIPE), **options))


def branches(result: DriveResult, *stages: str) -> tuple[np.ndarray, np.ndarray]:
    """Torque and rotation of branches of a loop."""
    here = np.isin(result.program["stage"], stages)
    return result.program["torque_Nm"][here], result.program["rotation_arcmin"][here]


@pytest.mark.parametrize("bearing", [(), BEARING], ids=["cam", "bearing"])
def test_a_loop_without_friction(bearing: tuple[str, ...]) -> None:
    """With the major axis on a tooth and a slot: theta(-T) = -theta(T), no area, and the way back
    is the same. With a bearing a ball is on the major axis."""
    design = small("plane", *bearing).with_values({"stiffness.positions": 1})
    result = run(design, plain=True)
    found = result.summary.stiffness
    unloading, loading = (
        branches(result, "positive unloading"),
        branches(result, "positive loading"),
    )
    down, back = branches(result, "negative loading"), branches(result, "negative unloading")
    assert np.allclose(unloading[1], loading[1][:-1][::-1], rtol=1e-7)
    assert np.allclose(-down[0][:-1], unloading[0][::-1]) and np.allclose(
        -down[1][:-1], unloading[1][::-1], rtol=1e-7
    )
    assert np.allclose(back[1], down[1][:-1][::-1], rtol=1e-7)
    span = 1000.0 * TORQUE * np.radians(found.lost_motion / 60.0)
    assert abs(found.loop_work) < 1e-6 * span
    assert found.hysteresis == pytest.approx(found.backlash, rel=1e-7)
    # the shortcuts go one way, and find the same to their tolerance: the elastic rotation is a
    # thousandth of all
    short = run(design).summary.stiffness
    for name, rel in (
        ("K1", 2e-3),
        ("K2", 2e-3),
        ("K3", 2e-3),
        ("lost_motion", 1e-5),
        ("backlash", 1e-5),
    ):
        assert getattr(short, name) == pytest.approx(getattr(found, name), rel=rel), name


@pytest.mark.parametrize("layout", ["ring_fixed", "spline_fixed"])
def test_torque_turns_the_output_in_its_direction(layout: str) -> None:
    values = {"stiffness.positions": 2, "stiffness.mesh_error": False}
    found = run(small("plane", f"drive.layout={layout}").with_values(values)).summary.stiffness
    assert found.K1 > 0.0 and found.lost_motion > 0.0 and len(found.positions) == 2


def test_the_loop_with_friction_is_the_work_of_friction() -> None:
    """Both by the trapezoidal rule: they differ by 5.4 % with 6 points on a branch, 0.3 % with
    12."""
    values = {"stiffness.torque": 5.0, "stiffness.positions": 1, "stiffness.points": 12}
    design = small("plane", "contact.friction=0.1").with_values(values)
    stepper = load_stepper(design)
    work, rows, done = None, [], []
    for state in load_sequence(design).states:
        if state.stage == Stage.PROGRAM and work is None:
            work = FrictionWork(stepper)
        stepper.advance(state)
        rows.append(stepper.row())
        done.append(work.total if work else 0.0)
    points = point_rows(stepper.sequence, rows)
    first = max(k for k, point in enumerate(points) if point["stage"] == FIRST_LOADING)
    dissipated = done[-1] - done[-len(points) + first]
    area = work_by_torque(points[first:])
    print(f"area of the loop {area:.3e}, work of friction {dissipated:.3e} N mm")
    assert area > 0.0
    assert dissipated == pytest.approx(area, rel=0.01)


def test_the_cup_with_friction() -> None:
    """The loop of the small cup with friction has an area, and is wider at zero torque than its
    backlash."""
    values = {
        "stiffness.torque": 10.0,
        "stiffness.positions": 1,
        "stiffness.points": 1,
        "stiffness.mesh_error": False,
    }
    found = run(small("cup", "contact.friction=0.2").with_values(values)).summary.stiffness
    span = 2e4 * np.radians((found.lost_motion - found.backlash) / 60.0)
    print(found, span)
    assert found.loop_work > 1e-3 * span > 0.0
    assert found.hysteresis > found.backlash > 0.0
    assert found.K1 > 0.0 and found.K3 > 0.0


def test_lost_motion_of_a_stiff_drive_is_its_clearance() -> None:
    """The output is turned without torque until the flanks, a gap apart so far, would meet on
    either side.

    The drive is stiff for its torque: the rotation by it is a 20,000th of the clearance. The gap is
    that of a parabola through three of nine places on a facet, here 0.3 % more than the least one;
    on 33 places it is 0.01 % less.
    """
    stiff = small("plane")
    found = run(
        stiff.with_values({"stiffness.positions": 1, "stiffness.mesh_error": False})
    ).summary.stiffness
    half = 0.5 * found.lost_motion / 60.0
    turned = [
        {"name": "turn", "output_rotation": 0.98 * half},
        {"name": "on", "output_rotation": 0.99 * half},
    ]
    design = stiff.with_values({"load.program": turned})
    stepper, gap = load_stepper(design), []
    for state in load_sequence(design).states:
        stepper.advance(state)
        gap.append(stepper.problem.torque_control.clearances[0].gap(LOADED_SIDE))
        assert stepper.row()["pairs_in_contact"] == 0
    closed = 0.99 * half + 0.01 * half * gap[-1] / (gap[-2] - gap[-1])
    print(f"clearance {2.0 * closed * 60.0:.5f}, lost motion {2.0 * half * 60.0:.5f} arc minutes")
    assert half == pytest.approx(closed, rel=5e-3)


def test_a_first_rotation_of_flanks_that_press_follows_the_tangent() -> None:
    """Teeth that fill their slots press without a torque. A cup that is rotated as a whole at first
    presses all of them in by the rotation, and takes 16 iterations back."""
    on = {"name": "on", "output_rotation": 0.02 * 360.0 / 42.0}
    design = small("cup").with_values({**LOW_TEETH, "ring_gear.c_P": 1.0, "load.program": [on]})
    stepper = load_stepper(design.with_values({"steps.subdivide": False}))
    *states, rotated = load_sequence(design).states
    for state in states:
        stepper.advance(state)
    assert stepper.row()["pairs_in_contact"] > 0
    stepper.advance(rotated)
    assert stepper.iterations <= 10


def follow(design: DriveDesign) -> list[PointRow]:
    stepper, rows = load_stepper(design), []
    for state in load_sequence(design).states:
        stepper.advance(state)
        rows.append(stepper.row())
    return point_rows(stepper.sequence, rows)


def test_a_program_changes_between_torque_and_rotation() -> None:
    """Held where the torque has brought it, the output needs that torque, and keeps it when it is
    let go."""
    up = {"name": "up", "torque": TORQUE}
    rows = follow(small("plane").with_values({"load.program": [up]}))
    angle = rows[0]["rotation_arcmin"] / 60.0
    held, let_go = {"name": "held", "output_rotation": angle}, {"name": "let go", "torque": TORQUE}
    back = {"name": "back", "torque": 0.0}
    rows = follow(small("plane").with_values({"load.program": [up, held, let_go, back]}))
    # the drive is stiff: 1e-9 degrees of the rotation are 1e-6 of the torque
    assert [row["torque_Nm"] for row in rows[:3]] == pytest.approx([TORQUE] * 3, rel=1e-4)
    assert rows[2]["rotation_arcmin"] == pytest.approx(rows[0]["rotation_arcmin"], rel=1e-8)
    assert rows[3]["torque_Nm"] == pytest.approx(NO_TORQUE * TORQUE)


def test_the_wave_generator_turns_within_a_program() -> None:
    """After a pitch of the ring gear under torque the output has turned by pitch / ratio."""
    pitch = 360.0 / 42.0
    turn = {"name": "turn", "wave_generator": pitch, "points": 4}
    rows = follow(
        small("plane").with_values({"load.program": [{"name": "up", "torque": TORQUE}, turn]})
    )
    assert rows[-1]["wg_angle_deg"] == pytest.approx(pitch)
    assert rows[-1]["rotation_arcmin"] == pytest.approx(rows[0]["rotation_arcmin"], rel=1e-6)
    assert rows[-1]["wg_torque_Nmm"] == pytest.approx(rows[0]["wg_torque_Nmm"], rel=1e-5)


def jumped_over(increment: float) -> DriveResult:
    """With records at this share of a pitch."""
    keys = {**LOW_TEETH, "ratcheting.yield_strength": YIELD_STRENGTH}
    return run(small("plane").with_values({**keys, "ratcheting.increment": increment}))


@pytest.fixture(scope="module")
def ratcheting() -> DriveResult:
    return jumped_over(0.01)


def test_ratcheting_ends_where_the_torque_is_sufficient(ratcheting: DriveResult) -> None:
    """Before the peak, with a lower bound of it. It may begin under a torque: the states are those
    of the rotation from the assembled drive on."""
    peak = ratcheting.summary.ratcheting.peak_torque_Nm
    start, enough = 0.1 * peak, 0.25 * peak
    keys = {"ratcheting.increment": 0.01, "ratcheting.sufficient_torque": enough}
    keys["ratcheting.start_torque"] = start
    result = run(small("plane").with_values({**LOW_TEETH, **keys}))
    found, torque = result.summary.ratcheting, result.program["torque_Nm"]
    assert found.ended == SUFFICIENT and not found.is_peak
    assert torque[0] == pytest.approx(start) and torque[-2] < enough
    assert enough <= found.peak_torque_Nm == pytest.approx(torque[-1])
    whole = ratcheting.program
    same = np.isin(whole["step"] + 1, result.program["step"][1:-1])  # the start is a point too
    assert whole["torque_Nm"][same].min() > start
    assert torque[1:-1] == pytest.approx(whole["torque_Nm"][same], rel=1e-6, abs=1e-6)
    rotation = result.program["rotation_arcmin"]
    assert rotation[1:-1] == pytest.approx(whole["rotation_arcmin"][same])


def test_ratcheting_ends_by_itself(ratcheting: DriveResult) -> None:
    found, torque = ratcheting.summary.ratcheting, ratcheting.program["torque_Nm"]
    # behind the peak the teeth jump: a state there may have no equilibrium
    assert found.ended in ("torque fell", "no equilibrium found")
    assert found.gave_way == AT_TEETH and found.is_peak
    # the record behind the peak is the state in which the torque has fallen
    assert found.peak_torque_Nm >= torque.max() > 0.0 and torque[-1] < 0.9 * found.peak_torque_Nm
    assert np.all(torque[:-1] >= 0.9 * np.maximum.accumulate(torque)[:-1])
    assert found.peak_step == found.last_step == ratcheting.program["step"][-1]
    assert 0.0 < found.peak_rotation_pitches < 0.2


def test_gears_yield_where_their_stress_reaches_the_strength(
    ratcheting: DriveResult,
) -> None:
    stress = np.maximum(ratcheting.history["fs_vm"], ratcheting.history["rg_vm"])
    torque = abs(ratcheting.history["output_torque_Nmm"]) / 1000.0
    above = int(np.argmax(stress >= YIELD_STRENGTH))
    found = ratcheting.summary.ratcheting
    assert ratcheting.history["step"][above] > 3
    assert torque[above - 1] <= found.yield_torque_Nm <= torque[above] < found.peak_torque_Nm


def test_the_peak_does_not_depend_on_the_records(ratcheting: DriveResult) -> None:
    """Half a pitch leads behind the peak, where no flanks touch."""
    rough, fine = jumped_over(0.5).summary.ratcheting, ratcheting.summary.ratcheting
    assert rough.is_peak and rough.ended == "torque fell" and rough.states > 10
    assert rough.peak_torque_Nm == pytest.approx(
        fine.peak_torque_Nm, abs=max(rough.peak_error_Nm, fine.peak_error_Nm)
    )
    assert rough.peak_error_Nm < 0.02 * rough.peak_torque_Nm
    assert rough.gave_way == fine.gave_way


def test_a_prescribed_rotation_passes_no_tooth_unseen() -> None:
    """One stage over a twelfth of a pitch meets the flanks that eight stages meet."""
    design = small("plane").with_values(LOW_TEETH)
    end = 0.08 * design.kinematics.output_pitch
    parts = [{"name": f"to {k}", "output_rotation": end * k / 8} for k in range(1, 9)]
    whole = [{"name": "whole", "output_rotation": end}]
    fine, rough = (
        run(design.with_values({"load.program": stages})).program["torque_Nm"][-1]
        for stages in (parts, whole)
    )
    assert rough == pytest.approx(fine, rel=1e-3)


def test_the_torque_repeats_after_a_pitch_at_once() -> None:
    """Turned by one pitch with the wave generator locked, the output is where its neighbouring
    teeth were."""
    design = small("plane", "steps.subdivide=false").with_values(LOW_TEETH)
    pitch = design.kinematics.output_pitch
    angles = [0.05 * pitch, 0.5 * pitch, 1.05 * pitch]
    stages = [{"name": f"to {k}", "output_rotation": angle} for k, angle in enumerate(angles)]
    rows = follow(design.with_values({"load.program": stages}))
    assert rows[0]["torque_Nm"] > 1.0
    assert rows[2]["torque_Nm"] == pytest.approx(rows[0]["torque_Nm"], rel=1e-6)


class Stopped(Exception):
    """The run is interrupted."""


@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_restart(tmp_path: Path, friction: float) -> None:
    values = {
        "stiffness.positions": 1 if friction else 2,
        "stiffness.points": 1,
        "contact.friction": friction,
    }
    values["solver.rtol"] = (
        1e-9  # chords of small rotations: the state is predicted anew after a restart
    )
    design = small("plane").with_values(values)
    whole = run(design, out=tmp_path / "whole")
    count = 0

    def stop() -> None:
        nonlocal count
        count += 1
        if count == 9:
            raise Stopped

    with pytest.raises(Stopped):
        run(design, out=tmp_path / "parts", on_increment=stop)
    rest = run(design, out=tmp_path / "parts", restart=True)
    for name in ("torque_Nm", "rotation_arcmin"):
        assert np.allclose(rest.program[name], whole.program[name], rtol=1e-6)
    assert rest.summary.stiffness.K1 == pytest.approx(whole.summary.stiffness.K1, rel=1e-6)
    header = (tmp_path / "parts" / "stiffness.csv").read_text().partition("\n")[0]
    assert header == "position_deg,branch,torque_Nm,rotation_arcmin"
    opened = swgpar.open_result(tmp_path / "parts")
    assert opened.summary.stiffness == rest.summary.stiffness
    assert np.array_equal(opened.program["stage"], rest.program["stage"])
    assert "torque_against_rotation" in opened.plot.names
    opened.plot.torque_against_rotation()


def test_restart_of_ratcheting(tmp_path: Path) -> None:
    design = small("plane").with_values({**LOW_TEETH, "ratcheting.increment": 0.01})
    whole, count = run(design), 0

    def stop() -> None:
        nonlocal count
        count += 1
        if count == 3:
            raise Stopped

    with pytest.raises(Stopped):
        run(design, out=tmp_path, on_increment=stop)
    rest = run(design, out=tmp_path, restart=True)
    assert rest.summary.ratcheting.gave_way == whole.summary.ratcheting.gave_way
    assert rest.summary.ratcheting.peak_torque_Nm == pytest.approx(
        whole.summary.ratcheting.peak_torque_Nm, rel=1e-6
    )
    # a finished run has nothing left to compute
    assert run(design, out=tmp_path, restart=True).summary.increments == rest.summary.increments


@pytest.mark.parallel([2])
def test_ranks() -> None:
    design = small("plane").with_values({"stiffness.positions": 2, "stiffness.points": 1})
    several, one = run(design), run(design, comm=MPI.COMM_SELF)
    for name in ("K1", "K3", "lost_motion"):
        a, b = (getattr(run.summary.stiffness, name) for run in (several, one))
        parallel_assert(a == pytest.approx(b, rel=1e-6), f"{name}: {a} and {b}")


def test_studies_vary_programs_and_take_their_results(tmp_path: Path) -> None:
    """Twice the torque turns the output, flanks closed, twice as far; names that do not exist are
    refused."""
    stages = [{"name": "off", "torque": 0.0}, {"name": "up", "torque": TORQUE}]
    lines = [
        "[study]",
        f'design = "{DESIGN}"',
        f'meshes = ["{RECIPE}"]',
        "vary = { load.program.2.torque = [0.2, 0.4] }",
    ]
    quantities = [f"program.{name}.rotation_arcmin" for name in ("off", "up")]
    plane = ", ".join(f"'{item}'" for item in PLANE)
    written = ", ".join(
        f'{{ name = "{stage["name"]}", torque = {stage["torque"]} }}' for stage in stages
    )
    lines += [f"set = [{plane}, 'load.program=[{written}]']", f"quantities = {quantities}"]
    (tmp_path / "study.toml").write_text("\n".join(lines), encoding="utf-8")
    table = swgpar.study(tmp_path / "study.toml").table
    off, up = (table[name] for name in quantities)
    assert (up[1] - off[1]) == pytest.approx(2.0 * (up[0] - off[0]), rel=0.02)
    lines[-1] = 'quantities = ["program.down.rotation_arcmin"]'
    (tmp_path / "study.toml").write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(InputError, match="program.down.rotation_arcmin"):
        swgpar.study(tmp_path / "study.toml")


def test_no_accuracy_with_a_program() -> None:
    with pytest.raises(InputError, match="--accuracy 0.02 is not available with a load program"):
        run(small("plane").with_values({"stiffness.positions": 1}), accuracy=0.02)
