"""Points of load programs, their refusals, and the stiffness from given loops."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from support.bearing import BEARING
from support.stepping import small
from swgpar.analysis import stiffness_error
from swgpar.analysis.coarse_start import MeshedDrive
from swgpar.analysis.drive_mesh_error import SAFETY, coarser_recipe
from swgpar.analysis.shortcuts import with_shortcuts
from swgpar.answers.answer import NO_ESTIMATE
from swgpar.errors import InputError
from swgpar.evaluation.first_yield import yield_torque
from swgpar.evaluation.program_results import work_by_torque
from swgpar.evaluation.ratcheting import (
    AT_TEETH,
    FELL,
    IN_SPLINE,
    NOTHING,
    SUFFICIENT,
    TorquePoint,
    evaluate_ratcheting,
    overshoot,
    why_ended,
)
from swgpar.evaluation.stiffness import (
    ARC_MINUTE,
    NAMES,
    StiffnessValues,
    by_position,
    torsional_stiffness,
)
from swgpar.load.load_program import (
    NO_TORQUE,
    POSITIVE_UNLOADING,
    TRAVEL,
)
from swgpar.load.load_sequence import load_sequence, program_points, stiffness_program
from swgpar.load.load_states import Stage
from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.meshing.recipe_counts import coarsened, with_wall_rounded_up


def program(*stages: dict[str, Any]) -> dict[str, Any]:
    return {"load.program": list(stages)}


UP, OFF = {"name": "up", "torque": 0.2, "points": 2}, {"name": "off", "torque": 0.0}
DOWN = {"name": "down", "torque": -0.2}


def test_points_lie_evenly_between_the_ends_of_stages() -> None:
    design = small("plane").with_values(
        program(UP, {"name": "turn", "wave_generator": 3.0, "points": 3})
    )
    points = program_points(design)
    assert [(p.stage, p.angle, p.value) for p in points[:2]] == [("up", 0.0, 0.1), ("up", 0.0, 0.2)]
    assert [p.angle for p in points[2:]] == pytest.approx([1.0, 2.0, 3.0])
    assert {p.value for p in points[2:]} == {0.2}


def test_a_torque_of_zero_is_a_small_one_in_the_direction_before() -> None:
    stages = OFF, {**UP, "points": 1}, {**OFF, "name": "b"}, DOWN, {**OFF, "name": "c"}
    design = small("plane").with_values(program(*stages))
    assert [p.value for p in program_points(design)] == pytest.approx(
        [0.2 * NO_TORQUE, 0.2, 0.2 * NO_TORQUE, -0.2, -0.2 * NO_TORQUE]
    )


@pytest.mark.parametrize(("layout", "sign"), [("ring_fixed", 1.0), ("spline_fixed", -1.0)])
def test_load_states_of_a_program(layout: str, sign: float) -> None:
    """A positive torque acts against the output's motion; the states follow the assembly."""
    held = {"name": "held", "output_rotation": 0.5, "wave_generator": 2.0}
    design = small("plane", f"drive.layout={layout}").with_values(program(UP, held))
    sequence = load_sequence(design)
    states = sequence.states
    assert [s.stage for s in states] == [Stage.DEFLECT, Stage.ENGAGE, *[Stage.PROGRAM] * 3]
    assert [s.step for s in states] == [1, 2, 3, 4, 5] and sequence.from_loaded == states[2:]
    assert states[3].torque == pytest.approx(sign * 200.0) and states[3].control == "torque"
    assert (
        states[4].output_rotation == pytest.approx(np.radians(0.5))
        and states[4].control == "rotation"
    )
    assert states[4].angle == pytest.approx(np.radians(2.0))


REFUSED = [
    (
        program({"name": "a", "torqe": 1.0}),
        "load.program.1.torqe = 1 is not a key .* mean load.program.1.torque",
    ),
    (program(UP, {"torque": 1.0}), "load.program.2.name is missing"),
    (program(UP, {"name": "a", "torque": "x"}), 'load.program.2.torque = "x" is not a number'),
    (program(UP, UP), "load.program.2.name = 'up' is not available"),
    (program({"name": "a.b"}), "load.program.1.name = 'a.b' is not available: allowed a name"),
    (
        program({"name": "a", "torque": 1.0, "output_rotation": 1.0}),
        "are both given: allowed one of them",
    ),
    (
        program({"name": "a", "output_rotation": 1.0}, {**UP, "points": 2}),
        "points = 2 is out of range: allowed 1",
    ),
    (
        program({"name": "a", "output_rotation": 180.0}),
        "load.program.1.output_rotation = 180 is out of range",
    ),
    (
        program({"name": "a", "torque": 0.0}),
        "load.program.1.torque = 0 is out of range: allowed beside a stage",
    ),
    ({"load.program": 3}, r"load.program = 3 is not a section: write \[\[load.program\]\]"),
    ({**program(UP), "stiffness.positions": 2}, r"load.program and \[stiffness\] are both given"),
    (
        {**program(UP), "steps.samples": 4, "steps.rotation": 20.0},
        "steps.samples = 4 .* only 0 with load.program",
    ),
    (
        {"stiffness.break_points": [0.7, 0.2]},
        r"stiffness.break_points = \[0.7, 0.2\] is out of range: allowed two",
    ),
    ({"stiffness.break_points": [0.3, 0.300001]}, "stiffness.break_points .* 0.01 apart"),
    ({"stiffness.break_points": [0.01, 0.2]}, "stiffness.break_points .* above 0.04"),
    (
        {"stiffness.lost_motion_share": 0.0005},
        "stiffness.lost_motion_share = 0.0005 is out of range",
    ),
    ({"stiffness.positions": 2, "load.torque": 0.0}, "stiffness.torque is missing"),
    (
        {"stiffness.loop": False, "contact.friction": 0.1},
        "stiffness.loop = false .* allowed true with friction",
    ),
    ({"ratcheting.limit": 0.001}, "ratcheting.limit = 0.001 is out of range: allowed 0.02 pitches"),
    (
        {
            **program(UP, {"name": "turn", "output_rotation": 1.0}),
            "drive.layout": "wave_generator_fixed",
        },
        "load.program.2.torque is missing: allowed only stages with a torque with drive.layout = "
        '"wave_generator_f',
    ),
    ({"ratcheting.limit": 20.0}, "ratcheting.limit = 20 is out of range: allowed up to"),
]


@pytest.mark.parametrize(("values", "words"), REFUSED)
def test_refusals(values: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        small("plane").with_values(values)
    assert "\n" not in str(caught.value)


def test_entries_are_changed_by_their_number() -> None:
    design = small("plane").with_values(program(UP, DOWN))
    changed = design.with_values({"load.program.2.torque": -0.1})
    assert [stage.torque for stage in changed.load.program] == [0.2, -0.1]
    assert [stage.torque for stage in design.load.program] == [0.2, -0.2]
    for key in ("load.program.3.torque", "load.program.up.torque", "load.program.0.torque"):
        with pytest.raises(InputError, match="is no entry, allowed 1 to 2"):
            design.with_values({key: 1.0})
    with pytest.raises(InputError, match="write a key of the entry"):
        design.with_values({"load.program.1": 1.0})


def test_shortcuts_of_programs() -> None:
    recipe = load_recipe("plane_coarse")
    found = with_shortcuts(small("plane").with_values({"stiffness.positions": 6}), recipe).design
    assert found.steps.bent_start and not found.steps.samples and not found.stiffness.loop
    # of six positions two mirror others, and at the first and the fourth one side mirrors the other
    points = program_points(found)
    period, half = 360.0 / 42.0, len(stiffness_program(found).torques)
    counts = [sum(p.angle == pytest.approx(period * k / 6.0) for p in points) for k in range(6)]
    assert counts == [half + 1, 2 * half, 2 * half, half, 0, 0]
    # the wave generator turns under the torque in which the position before has ended
    for a, b in itertools.pairwise(points):
        assert a.angle == b.angle or a.value == b.value
    turned = program({"name": "turn", "wave_generator": 1.0, "torque": 0.2})
    assert not with_shortcuts(small("plane").with_values(turned), recipe).design.steps.bent_start
    friction = small("plane", "contact.friction=0.1").with_values({"stiffness.positions": 4})
    assert with_shortcuts(friction, recipe).design == friction


# -- results from given loops ----------------------------------------------------------------------

CHORDS, SHARES = (4.0e3, 6.0e3, 8.0e3), (0.0, 0.2, 0.65, 1.0)
TORQUE, BACKLASH, WIDTH = 10.0, 1.0, 0.4
"""N·m; arc minutes of backlash, and of what friction adds to the width of the loop."""


def rotation(torque: np.ndarray) -> np.ndarray:
    """Rotation (arc minutes) by three straight lines with the stiffness `CHORDS` (N·m/rad)."""
    ends = TORQUE * np.array(SHARES)
    line = np.append(0.0, np.cumsum(np.diff(ends) / CHORDS)) / ARC_MINUTE
    return np.sign(torque) * np.interp(np.abs(torque), ends, line)


def rows_of(design: Any) -> list[dict[str, Any]]:
    rows = []
    for point in program_points(design):
        unloading = 1.0 if "unloading" in point.stage else -1.0
        # both branches meet at the largest torque
        width = unloading * np.sign(point.value) * 0.5 * WIDTH * (1.0 - abs(point.value) / TORQUE)
        turned = (
            float(rotation(np.array(point.value))) + np.sign(point.value) * 0.5 * BACKLASH + width
        )
        if point.stage != TRAVEL:
            row = {"stage": point.stage, "wg_angle_deg": point.angle, "torque_Nm": point.value}
            rows.append({**row, "rotation_arcmin": float(turned), "wg_torque_Nmm": 0.0})
    return rows


@pytest.mark.parametrize("points", [1, 7])
def test_stiffness_of_a_given_loop(points: int) -> None:
    values = {"stiffness.torque": TORQUE, "stiffness.positions": 2, "stiffness.points": points}
    design = small("plane", "contact.friction=0.1").with_values(values)
    rows = rows_of(design)
    found = by_position(stiffness_program(design), rows)
    assert list(found) == pytest.approx([0.0, 180.0 / 42.0])
    for one in found.values():
        assert (one.K1, one.K2, one.K3) == pytest.approx(CHORDS, rel=1e-9)
        assert one.lost_motion == pytest.approx(
            BACKLASH + 2.0 * float(rotation(np.array(0.4))), rel=1e-9
        )
        assert one.hysteresis == pytest.approx(BACKLASH + WIDTH, rel=1e-9)
        assert one.backlash == pytest.approx(BACKLASH, rel=1e-9)
        # two triangles; the torque that stands for zero cuts off their last corners
        assert one.loop_work == pytest.approx(
            1000.0 * TORQUE * WIDTH * ARC_MINUTE, rel=2.5 * NO_TORQUE
        )
    summary = torsional_stiffness(stiffness_program(design), rows, None)
    assert summary.K1 == pytest.approx(CHORDS[0]) and summary.spread.K1 == pytest.approx(
        0.0, abs=1e-6
    )
    assert summary.mesh_error is None and len(summary.positions) == 2


@pytest.mark.parametrize(
    ("held", "lacking"),
    [
        (0.02, {"K1", "backlash", "hysteresis"}),
        (0.5, {"K1", "backlash", "hysteresis", "lost_motion"}),
        (4.0, {"K1", "K2", "backlash", "hysteresis", "lost_motion"}),
    ],
)
def test_what_needs_torques_against_which_the_output_is_held_is_not_stated(
    held: float, lacking: set[str]
) -> None:
    """Under smaller torques the teeth rest on the flanks of the other side."""
    values = {"stiffness.torque": TORQUE, "stiffness.positions": 1, "stiffness.loop": True}
    design = small("plane").with_values(values)
    rows = [
        {
            **row,
            "wg_torque_Nmm": -1001.0 * row["torque_Nm"],
            "rotation_arcmin": row["rotation_arcmin"] - 4.0 * BACKLASH,
        }
        if 0.0 < row["torque_Nm"] < held
        else row
        for row in rows_of(design)
    ]
    summary = torsional_stiffness(stiffness_program(design), rows, None)
    assert {name for name in NAMES if getattr(summary, name) is None} == lacking
    reasons = {one.name: one.remark for one in summary.answers() if one.value is None}
    assert set(reasons) == {f"stiffness.{name}" for name in lacking} and all(reasons.values())


def test_the_coarser_mesh_for_the_stiffness_of_a_cup_keeps_most_of_its_wall(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two elements along the cylinder make a drive up to 3 % stiffer than three."""
    design = small("cup").with_values({"stiffness.torque": TORQUE, "stiffness.positions": 1})
    rows, recipe, meshes = rows_of(design), load_recipe("forces"), list[MeshRecipe]()
    fine = by_position(stiffness_program(design), rows)[0.0]
    assert fine.K1 is not None and fine.K2 is not None

    def on_coarser(_: MeshedDrive, coarse: MeshRecipe) -> StiffnessValues:
        meshes.append(coarse)
        return replace(fine, K1=1.05 * fine.K1)

    monkeypatch.setattr(stiffness_error, "_stiffness_on", on_coarser)
    drive = MeshedDrive(design, MPI.COMM_SELF)
    found = stiffness_error.stiffness_error(drive, recipe, rows)
    (coarse,) = meshes
    assert recipe.cup.cylinder == 4 and coarse.cup.cylinder == 3
    compared = coarser_recipe(recipe)
    assert compared is not None and coarse.flexible_spline == compared.flexible_spline
    assert found is not None
    assert found["K1"] == pytest.approx(SAFETY * 0.05 * fine.K1 / ((4 / 3) ** 2 - 1.0))
    assert found["K2"] == pytest.approx(stiffness_error.LEAST * fine.K2)
    plane = load_recipe("plane_coarse")
    assert with_wall_rounded_up(coarsened(plane), plane) == coarsened(plane)


def test_one_way_of_the_loop_stands_for_both() -> None:
    values = {"stiffness.torque": TORQUE, "stiffness.positions": 3, "stiffness.loop": False}
    design = small("plane").with_values(values)
    found = by_position(
        stiffness_program(design),
        [{**row, "rotation_arcmin": row["torque_Nm"]} for row in rows_of(design)],
    )
    assert len(found) == 3
    for one in found.values():
        assert (one.K1, one.K2) == pytest.approx((1.0 / ARC_MINUTE, 1.0 / ARC_MINUTE))
        assert one.hysteresis == pytest.approx(0.0, abs=1e-12) and one.loop_work == 0.0


@pytest.mark.parametrize(
    ("bearing", "ways"),
    [((), 1), (("first_ball=0",), 1), (("first_ball=9",), 1), (("first_ball=4",), 2)],
)
def test_one_side_of_the_loop_suffices_where_the_balls_are_mirrored(
    bearing: tuple[str, ...], ways: int
) -> None:
    """20 balls: at 0 one is on the major axis, at 9 degrees the axis is midway between two."""
    keys = [*BEARING, *(f"wave_generator.bearing.{key}" for key in bearing)] if bearing else []
    values = {"stiffness.torque": TORQUE, "stiffness.positions": 1, "stiffness.loop": False}
    program = stiffness_program(small("plane", *keys).with_values(values))
    assert len(program.points()) == ways * len(program.torques)


def test_work_is_the_area_below_the_torque() -> None:
    rows = [{"torque_Nm": torque, "rotation_arcmin": 2.0 * torque} for torque in (0.0, 1.0, 3.0)]
    assert work_by_torque(rows) == pytest.approx(1000.0 * 3.0**2 * ARC_MINUTE)
    assert work_by_torque([*rows, *rows[::-1]]) == pytest.approx(0.0, abs=1e-15)


def points_of(torques: Sequence[float], teeth: Sequence[float]) -> list[TorquePoint]:
    """States at whole degrees of the output."""
    return [TorquePoint(3 + k, float(k), torque, teeth[k]) for k, torque in enumerate(torques)]


@pytest.mark.parametrize(("teeth", "gave_way"), [(1.0, AT_TEETH), (-0.2, IN_SPLINE)])
def test_what_gives_way_is_where_the_rotation_goes(teeth: float, gave_way: str) -> None:
    """Behind the peak the teeth move on with the output, or they turn back while the spline
    yields."""
    design = small("plane").with_values({"ratcheting.increment": 0.1})
    moved = [0.0, 0.5, 0.5, 0.5 + teeth, 0.5 + 2.0 * teeth]
    points = points_of([1.0, 2.5, 3.0, 2.9, 1.0], moved)
    section = design.ratcheting
    assert not why_ended(section, points[:4], 1e-9) and why_ended(section, points, 1e-9) == FELL
    found = evaluate_ratcheting(
        design.kinematics, design.ratcheting, points, 1e-9, ended_early=False
    )
    assert found.gave_way == gave_way and found.ended == "torque fell"
    # straight on from the first two states to the third
    assert (found.peak_torque_Nm, found.peak_step, found.peak_error_Nm) == (3.0, 5, 0.5)
    assert found.peak_rotation_pitches == pytest.approx(2.0 / design.kinematics.output_pitch)
    (answer,) = (one for one in found.answers() if one.name == "ratcheting.peak_torque_Nm")
    assert answer.no_error == NO_ESTIMATE and "by the steps ± 0.5 N·m" in answer.remark


@pytest.mark.parametrize(
    "torques",
    [[1.0, 3.0], [0.0, 1.0, 3.0, 2.999], [3e-15, 2e-15, 0.0]],
    ids=["rises", "rises but for less than the error", "round-off"],
)
def test_a_torque_that_has_not_fallen_has_no_peak(torques: list[float]) -> None:
    design = small("plane").with_values({"ratcheting.increment": 0.1})
    points = points_of(torques, [0.0, 0.5, 1.0, 1.5])
    found = evaluate_ratcheting(
        design.kinematics, design.ratcheting, points, 1e-9, ended_early=True
    )
    assert not found.is_peak and found.gave_way == NOTHING and found.peak_error_Nm is None
    assert found.ended == "no equilibrium found"
    assert not why_ended(design.ratcheting, points, 1e-9)
    (answer,) = (one for one in found.answers() if one.name == "ratcheting.peak_torque_Nm")
    assert answer.no_error == NO_ESTIMATE and "no peak" in answer.remark


def test_a_sufficient_torque_is_no_peak() -> None:
    design = small("plane").with_values(
        {"ratcheting.increment": 0.1, "ratcheting.sufficient_torque": 2.0}
    )
    points = points_of([0.0, 1.0, 2.5], [0.0, 0.5, 1.0])
    section = design.ratcheting
    assert not why_ended(section, points[:2], 1e-9)
    assert why_ended(section, points, 1e-9) == SUFFICIENT
    found = evaluate_ratcheting(design.kinematics, section, points, 1e-9, ended_early=False)
    assert not found.is_peak and found.ended == SUFFICIENT and found.peak_torque_Nm == 2.5


def test_the_torque_of_the_first_yield_lies_between_two_rows() -> None:
    """Stress and torque are linear between rows; the stress without a torque is that of the cam."""

    def row(step: int, torque: float, spline: float, ring: float) -> dict[str, float]:
        return {"step": step, "output_torque_Nmm": -1e3 * torque, "fs_vm": spline, "rg_vm": ring}

    rows = [row(1, 0.0, 300.0, 0.0), row(2, 0.0, 400.0, 5.0)]
    rows += [row(3, 2.0, 500.0, 100.0), row(4, 4.0, 600.0, 900.0)]
    assert yield_torque(rows, -1.0, 450.0) == pytest.approx(1.0)
    # the ring gear
    assert yield_torque(rows, -1.0, 800.0) == pytest.approx(2.0 + 2.0 * 300.0 / 400.0)
    assert yield_torque(rows, -1.0, 350.0) == 0.0
    assert yield_torque(rows, -1.0, 901.0) is None
    # a history that begins under a torque does not show what was before
    assert yield_torque(rows[2:], -1.0, 450.0) is None
    assert yield_torque(rows[2:], -1.0, 800.0) == yield_torque(rows, -1.0, 800.0)


def test_a_rotation_is_followed_from_the_assembled_drive_or_from_a_torque() -> None:
    keys = {"ratcheting.increment": 0.1, "ratcheting.sufficient_torque": 2.0}
    assembled = load_sequence(small("plane").with_values(keys))
    assert assembled.loaded.stage == Stage.ENGAGE and assembled.loaded.flank_clearance == 0.0
    assert assembled.from_loaded[1].stage == Stage.PROGRAM
    loaded = small("plane").with_values({**keys, "ratcheting.start_torque": 1.0})
    assert load_sequence(loaded).loaded.control == "torque"
    with pytest.raises(InputError, match="start_torque = 3 .* below 2 N·m .ratcheting.suff"):
        loaded.with_values({"ratcheting.start_torque": 3.0})


@pytest.mark.parametrize("turn", [0.35, 0.5, 0.62])
def test_the_peak_between_states_is_within_the_overshoot(turn: float) -> None:
    """Of a curve that bends down, and of one that falls at once."""
    x = np.linspace(0.0, 1.0, 12)
    for torque in (
        lambda at: 5.0 - 20.0 * (at - turn) ** 2,
        lambda at: np.where(at < turn, 5.0 * np.sin(at), 0.1),
    ):
        y, fine = torque(x), torque(np.linspace(0.0, 1.0, 100001))
        missed = fine.max() - y.max()
        assert 0.0 < missed <= overshoot(x, y) <= 1.01 * np.diff(y).max()
    assert overshoot([0.0, 1.0], [1.0, 2.0]) == 0.0 and overshoot([0.0, 1.0], [2.0, 1.0]) == np.inf


def test_first_branch_begins_where_the_one_before_ended() -> None:
    design = small("plane", "contact.friction=0.1").with_values({"stiffness.torque": TORQUE})
    stages = [point.stage for point in program_points(design)]
    first = stages.index(POSITIVE_UNLOADING)
    assert program_points(design)[first - 1].value == TORQUE > program_points(design)[first].value
