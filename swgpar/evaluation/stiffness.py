"""Torsional stiffness from the points of the stiffness loops (docs/theory/stiffness.md)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, fields, replace
from typing import Any

import numpy as np

from swgpar.answers.answer import (
    Answer,
    AnswerGroup,
    AnswerKind,
    answer,
    evaluation,
    part_answers,
    with_error,
)
from swgpar.evaluation.program_results import PointRow, work_by_torque
from swgpar.load.load_program import (
    BRANCHES,
    FIRST_LOADING,
    NEGATIVE_LOADING,
    NEGATIVE_UNLOADING,
    POSITIVE_LOADING,
    POSITIVE_UNLOADING,
    TRAVEL,
    StiffnessProgram,
)

ARC_MINUTE = np.pi / 10800.0
"""rad"""

SAME_ANGLE = 1e-6
"""Difference (deg) below which two angles of the wave generator are the same."""

POSITIVE = (POSITIVE_UNLOADING, POSITIVE_LOADING)
"""Branches with a positive torque."""

WAY_BACK = {
    POSITIVE_UNLOADING: POSITIVE_LOADING,
    POSITIVE_LOADING: POSITIVE_UNLOADING,
    NEGATIVE_UNLOADING: NEGATIVE_LOADING,
    NEGATIVE_LOADING: NEGATIVE_UNLOADING,
}
"""The branch that is the same without friction."""


CHORDS = {
    name: AnswerKind(f"stiffness.{name}", f"torsional stiffness {where}", "N·m/rad")
    for name, where in (
        ("K1", "up to the first break point"),
        ("K2", "between the break points"),
        ("K3", "above the second break point"),
    )
}
LOST_MOTION = AnswerKind("stiffness.lost_motion", "lost motion", "arc minutes")
HYSTERESIS = AnswerKind("stiffness.hysteresis", "width of the loop at zero torque", "arc minutes")

PASSES_BACKLASH = 3.0
"""Compliance between two torques, over the least of a branch, above which the output passes a
backlash there: teeth that meet one by one make a drive up to twice as soft."""


@evaluation
class StiffnessValues:
    """Torsional stiffness at one angle of the wave generator, or its mean, spread or error over
    several.

    K1, K2, K3 : chords of the middle line up to the first break point, to the second and to the
    top; None over a torque that is no load
    lost_motion : between the middles of both branches at plus and minus a share of the rated torque
    backlash : where the torque changes its sign

    All that needs a torque against which the wave generator holds the spline is None: the load does
    not decide there on which flanks the teeth rest.
    """

    K1: float | None = part_answers(CHORDS["K1"])
    K2: float | None = part_answers(CHORDS["K2"])
    K3: float | None = part_answers(CHORDS["K3"])
    lost_motion: float | None = part_answers(LOST_MOTION)
    hysteresis: float | None = part_answers(HYSTERESIS)
    backlash: float | None = answer(
        "stiffness.backlash", "rotation without torque between the flanks", "arc minutes"
    )
    loop_work: float = answer("stiffness.loop_work", "area of the loop", "N·mm")


NAMES = tuple(field.name for field in fields(StiffnessValues))


@evaluation
class StiffnessAtAngle(StiffnessValues):
    """The stiffness at an angle (degrees) of the wave generator."""

    wg_angle_deg: float


@evaluation
class TorsionalStiffness(StiffnessValues, AnswerGroup):
    """Means of the torsional stiffness over angles of the wave generator.

    torque_Nm, rated_torque_Nm : largest torque of the loop, and the rated one;  break_points :
    shares of the largest
    spread : largest less smallest over the positions
    mesh_error : of each value by the mesh, None where it is not known
    positions : the stiffness at every angle of the wave generator
    """

    torque_Nm: float
    rated_torque_Nm: float
    break_points: tuple[float, ...]
    spread: StiffnessValues
    mesh_error: Mapping[str, float] | None
    positions: tuple[StiffnessAtAngle, ...]

    TITLE = "torsional stiffness, lost motion, hysteresis"
    ASKED_BY = "[stiffness]"
    SECTION = "stiffness"

    def answers(self) -> Iterator[Answer]:
        for one in super().answers():
            name = one.name.partition(".")[2]
            if one.value is not None:
                size = float(f"{getattr(self.spread, name):.2g}")  # shown without a power of ten
                spread = f"spread over the positions {size:g}"
                one = with_error(replace(one, remark=spread), (self.mesh_error or {}).get(name))
            yield one

    def reasons(self) -> Mapping[str, str]:
        reason = "its torques are too small beside those by which the bent spline is held"
        names = [*CHORDS, "lost_motion", "hysteresis", "backlash"]
        return {f"stiffness.{name}": reason for name in names if getattr(self, name) is None}

    def remarks(self) -> Iterator[str]:
        yield (
            f"means over {len(self.positions)} positions of the wave generator, up to "
            f"{self.torque_Nm:g} N·m"
        )


class Branch:
    """Rotation over torque of one branch, both made positive for the negative side.

    rows : points of the branch, in any order
    """

    def __init__(self, rows: Sequence[PointRow], sign: float) -> None:
        torque = sign * np.array([row["torque_Nm"] for row in rows])
        order = np.argsort(torque)
        self.torque = torque[order]
        self.rotation = (
            sign * ARC_MINUTE * np.array([row["rotation_arcmin"] for row in rows])[order]
        )
        moment = 1e-3 * np.array([row["wg_torque_Nmm"] for row in rows])
        self.wave_generator_torque = sign * moment[order]

    def at(self, torque: float) -> float:
        """Rotation (rad) at a torque of the program (N·m); without torque on the line through the
        first points."""
        if torque == 0.0:
            (a, b), (u, v) = self.torque[:2], self.rotation[:2]
            return float(u - a * (v - u) / (b - a))
        return float(np.interp(torque, self.torque, self.rotation))

    def held_up_to(self, direction: float) -> float:
        """Torque (N·m) up to which the wave generator holds the spline, so that teeth rest on the
        flanks of the other side, across a backlash; 0 where it does not.

        direction : see `StiffnessProgram`
        """
        on_teeth = self.torque + direction * self.wave_generator_torque
        moved = np.abs(np.diff(self.rotation) / np.diff(self.torque))
        passes = (on_teeth[:-1] <= 0.0) & (moved > PASSES_BACKLASH * moved.min())
        return float(self.torque[:-1][passes].max(initial=0.0))


class Loop:
    """The loop at one angle of the wave generator; what the program has left out is made of its
    image.

    Attributes
    ----------
    unloading, loading : branches with positive and with negative torques
    work : N mm, area of the loop; 0 where one way of it stands for both
    """

    def __init__(self, rows: Sequence[PointRow]) -> None:
        """rows : at that angle, in the order of the program"""
        found: dict[str, list[PointRow]] = {name: [] for name in (FIRST_LOADING, *BRANCHES)}
        before: list[PointRow] = []
        for row in rows:
            branch = found.get(row["stage"], [])
            if not branch and row["stage"] in (POSITIVE_UNLOADING, NEGATIVE_UNLOADING):
                branch += before  # it begins where the one before has ended
            branch.append(row)
            before = [row]
        branches = {
            name: Branch(found[name] or found[WAY_BACK[name]], 1.0 if name in POSITIVE else -1.0)
            for name in BRANCHES
            if found[name] or found[WAY_BACK[name]]
        }
        # a side that is left out is the image of the other one
        one = next(iter(branches.values()))
        self.unloading = [
            branches.get(name, one) for name in (POSITIVE_UNLOADING, NEGATIVE_UNLOADING)
        ]
        self.loading = [branches.get(name, one) for name in (POSITIVE_LOADING, NEGATIVE_LOADING)]
        self.work = _loop_work([found[name] for name in BRANCHES])

    def falling(self, torque: float) -> float:
        """Rotation (rad) at a torque (N·m, not 0) on the way from the largest to the least."""
        return self.unloading[0].at(torque) if torque > 0.0 else -self.loading[1].at(-torque)

    def rising(self, torque: float) -> float:
        """Rotation (rad) at a torque (N·m, not 0) on the way back."""
        return self.loading[0].at(torque) if torque > 0.0 else -self.unloading[1].at(-torque)


def at_position(program: StiffnessProgram, rows: Sequence[PointRow]) -> StiffnessValues:
    """The stiffness from the rows of the loop at one angle of the wave generator, in the order of
    the program."""
    loop, held = Loop(rows), 0.0
    unloading, loading = loop.unloading, loop.loading
    if program.direction is not None:
        held = max(one.held_up_to(program.direction) for one in (*unloading, *loading))

    def middle(side: int, torque: float) -> float:
        return 0.5 * (unloading[side].at(torque) + loading[side].at(torque))

    def carried(torque: float) -> bool:
        return torque > held or held == 0.0

    top, share = program.torque, program.lost_motion_torque
    ends = [0.0, *(b * top for b in program.section.break_points), top]
    line = [0.5 * (middle(0, torque) + middle(1, torque)) for torque in ends]
    steps = ends[:-1], np.diff(ends), np.diff(line)
    chords = {
        name: float(torque / rotation)
        if carried(start) and torque > program.negligible and rotation
        else None
        for name, start, torque, rotation in zip(CHORDS, *steps, strict=True)
    }
    width = unloading[0].at(0.0) + unloading[1].at(0.0)
    backlash = 0.5 * sum(a.at(0.0) + b.at(0.0) for a, b in zip(loading, unloading[::-1]))
    return StiffnessValues(
        **chords,
        lost_motion=(middle(0, share) + middle(1, share)) / ARC_MINUTE if carried(share) else None,
        hysteresis=None if held else width / ARC_MINUTE,
        backlash=None if held else backlash / ARC_MINUTE,
        loop_work=loop.work,
    )


def loop_rows(rows: Sequence[PointRow]) -> list[dict[str, Any]]:
    """Rows of stiffness.csv from those of program.csv: the branches of the loops."""
    return [
        {
            "position_deg": row["wg_angle_deg"],
            "branch": row["stage"],
            "torque_Nm": row["torque_Nm"],
            "rotation_arcmin": row["rotation_arcmin"],
        }
        for row in rows
        if row["stage"] != TRAVEL
    ]


def _loop_work(branches: Sequence[Sequence[PointRow]]) -> float:
    """Area of the loop; 0 where one way of it stands for both."""
    if not all(branches):
        return 0.0
    return work_by_torque([row for rows in branches for row in rows])


def by_position(
    program: StiffnessProgram, rows: Sequence[PointRow]
) -> dict[float, StiffnessValues]:
    """The stiffness at every angle (deg) of the wave generator, from all rows of program.csv."""
    return {
        angle: at_position(program, here) for angle, here in rows_by_position(program, rows).items()
    }


def rows_by_position(
    program: StiffnessProgram, rows: Sequence[PointRow]
) -> dict[float, list[PointRow]]:
    """Rows of the loop that stands for every angle (deg) of the wave generator, from all rows of
    program.csv."""
    by_angle = {}
    for k, angle in enumerate(program.angles):
        computed = program.angles[program.computed(k)]
        by_angle[angle] = [row for row in rows if abs(row["wg_angle_deg"] - computed) < SAME_ANGLE]
    return by_angle


def _over(
    positions: Mapping[float, StiffnessValues], reduced: Callable[[list[float]], float]
) -> dict[str, Any]:
    """A number for the values of all positions, by field of `StiffnessValues`; None where one
    lacks."""
    table = {name: [getattr(one, name) for one in positions.values()] for name in NAMES}
    return {
        name: None if None in values else float(reduced(values)) for name, values in table.items()
    }


def torsional_stiffness(
    program: StiffnessProgram, rows: Sequence[PointRow], error: Mapping[str, float] | None
) -> TorsionalStiffness:
    """The stiffness from all rows of program.csv.

    error : of every value by the mesh, None where it is not known
    """
    positions = by_position(program, rows)
    return TorsionalStiffness(
        **_over(positions, np.mean),
        torque_Nm=program.torque,
        rated_torque_Nm=program.rated_torque,
        break_points=tuple(program.section.break_points),
        spread=StiffnessValues(**_over(positions, np.ptp)),
        mesh_error=error,
        positions=tuple(
            StiffnessAtAngle(**asdict(one), wg_angle_deg=angle) for angle, one in positions.items()
        ),
    )
