"""The largest tensile stress at the teeth of the loaded flexible spline, resolved by windows, with
its error.

The mesh of a drive is too coarse for the gradient in the tooth root. Windows (`local_problem`),
each on a finer mesh than the one before, give the stress, the order at which it converges, and from
both the error that the last mesh leaves. The error of the drive's displacements and forces is
another part (docs/theory/windows.md).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from swgpar.answers.answer import (
    Answer,
    AnswerGroup,
    AnswerKind,
    answer,
    evaluation,
    joined_error,
    part_answers,
    place_text,
    with_no_limit,
)
from swgpar.design.drive_design import DriveDesign
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.stress import principal
from swgpar.largest_stress.convergence import error_of
from swgpar.largest_stress.local_problem import SECTORS, LocalProblem, WindowStress, tooth_nodes
from swgpar.largest_stress.places import root_nodes
from swgpar.load.load_states import LoadState
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe import make_recipe
from swgpar.model.drive_model import DriveModel
from swgpar.model.regions import AT_ENDS as END_REGIONS
from swgpar.model.regions import TOOTH_END, TOOTH_ROOT

RATIO = {"plane": 2.0, "cup": 1.5}
"""Ratio of element sizes of successive windows."""

COUNTS: dict[str, dict[str, dict[str, tuple[int, ...]]]] = {
    "plane": {
        "flexible_spline": {
            "root": (4, 8, 16, 32, 64),
            "under": (3, 6, 12, 24, 48),
            "rim": (4, 8, 16, 32, 64),
            "layers": (1, 2, 4, 8, 16),
            "tip": (2, 4, 8, 16, 32),
            "flank": (8, 16, 32, 64, 128),
        }
    },
    "cup": {
        "flexible_spline": {
            "root": (4, 6, 9, 13),
            "under": (2, 3, 4, 6),
            "rim": (2, 3, 4, 6),
            "layers": (1, 1, 2, 3),
            "tip": (2, 2, 2, 2),  # the flanks are far from the root
            "flank": (8, 8, 8, 8),
        },
        "face_width": {"elements": (8, 12, 18, 26)},  # even: a crowned cam touches along the middle
        "cup": {"cylinder": (6, 9, 13, 20), "fillet": (1, 1, 1, 1), "closed_end": (1, 1, 1, 1)},
    },
}
"""Counts of the windows, coarse to fine. That of the cylinder is along all of it; fillet and closed
end are outside."""

MOST_LEVELS = {"plane": 5, "cup": 4}
"""Windows that there are; the last one has some 200,000 and 60,000 elements."""

END_RATIO = 3.0
"""Middle elements along the face width over those at both ends."""

LEVELS = {"plane": 4, "cup": 3}
"""Windows in the loaded state."""

FEWEST_LEVELS = {"plane": 4, "cup": 2}
"""The same for a rough answer."""

PERIOD_LEVEL = {"plane": 1, "cup": 1}
"""Index of the window with which the further angles of a period are computed."""

CLOSE = 0.85
"""Share of the largest stress on the drive's own mesh from which a tooth outside of the first
window is looked at."""

CLOSE_IN_ROOT = 0.7
"""The same for the largest stress in a root where the largest one is elsewhere: nodal averages lose
up to a quarter in roots, and little inside of the rim."""

IN_ROOT = (0.82, 0.92, 0.97)
"""Shares of the largest stress, which is not in a root, from which one in a root is followed after
the first windows: there up to 15, 8 and 2 % are still to come."""

SAME_REGION, AT_ENDS, BETWEEN_ENDS = 0.995, (0.9, 1.0), 0.88
"""Shares of the largest stress from which another is followed on finer windows: in the same region;
at the ends of teeth after the first window, and after later ones; between them while an end has the
largest. At the ends the second window gives the most, up to 12 % too much."""

PARTS = BETWEEN, ENDS = "between the ends", "ends"
"""Of teeth, in which stresses converge differently; a flag `ends` is the index."""


@dataclass(frozen=True)
class OverPeriod:
    """s1 (MPa) over the sampled period.

    mean_error : by the meshes, in proportion to that of the loaded state; None where it is not
    known
    sampling_error : change of the mean by half as many angles, None for an odd number of them
    """

    mean: float
    mean_error: float | None
    sampling_error: float | None
    maximum: float


@evaluation
class RootStress(AnswerGroup):
    """Largest tensile stress at the teeth.

    error : MPa, estimated, of the window's mesh; None where it is not known
    region : as of a `Place`;  warning : why there is no limit to converge to; empty where there is
    one
    tooth : number, counter-clockwise from +y in the undeformed drive
    radius, z : mm;  angle_deg : from +y, counter-clockwise
    part : of the tooth;  by_part : largest s1 (MPa) of every part on the windows, coarse to fine,
    while it was followed
    elements : of the finest window
    in_root : MPa, largest nodal average in the roots on the drive's mesh, between the ends of the
    teeth
    drive_error : MPa, estimated, of the drive's mesh; None where it is not known
    period : angles of the wave generator (degrees) and s1 (MPa) there, of one sampled period
    """

    s1: float = answer(
        "root.s1",
        "largest tension at the teeth under load, by windows",
        "MPa",
        error="total_error",
        place="place",
        remark="warning",
    )
    error: float | None = answer(
        "root.s1_error",
        "its error by the windows and by the mesh of the drive",
        "MPa",
        "total_error",
        exact=True,
    )
    on_mesh: float = answer(
        "root.s1_on_mesh", "the same by nodal averages of the drive's mesh", "MPa"
    )
    region: str
    warning: str
    tooth: int
    radius: float
    z: float
    angle_deg: float
    part: str
    by_part: Mapping[str, Sequence[float]]
    elements: int
    in_root: float = 0.0
    drive_error: float | None = None
    period: tuple[tuple[float, float], ...] = part_answers(
        AnswerKind(
            "root.mean_s1",
            "the same over one period, mean",
            "MPa",
            "over_period.mean",
            error="over_period.mean_error",
        ),
        AnswerKind(
            "root.maximum_s1", "the same over one period, largest", "MPa", "over_period.maximum"
        ),
        default=(),
    )

    TITLE = "tension at the teeth, by windows"
    ASKED_BY = "output.root_stress"

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        return super().kinds(design) if design.resolves_root_stress else ()

    def answers(self) -> Iterator[Answer]:
        for one in super().answers():
            yield with_no_limit(one) if one.name == "root.s1" and self.warning else one

    def remarks(self) -> Iterator[str]:
        if (over := self.over_period) is not None:
            half = over.sampling_error
            change = "" if half is None else f": half as many change the mean by {half:.1f} MPa"
            yield f"{len(self.period)} angles of the period, one window at each further one{change}"

    @property
    def place(self) -> str:
        """Words for the place."""
        return place_text(self.region, self.tooth, self.radius, self.z, self.angle_deg)

    @property
    def levels(self) -> Sequence[float]:
        """s1 (MPa) on the windows, coarse to fine."""
        return self.by_part[self.part]

    @property
    def total_error(self) -> float | None:
        """Error (MPa) of the window's and of the drive's mesh; None where one is not known."""
        return joined_error(self.error, self.drive_error)

    @property
    def lost_in_root(self) -> float | None:
        """Share of the root's tension that nodal averages on the drive's mesh lose, with its error;
        None if unknown."""
        if (
            self.in_root <= 0.0
            or self.region not in (TOOTH_ROOT, TOOTH_END)
            or self.total_error is None
        ):
            return None
        s1 = self.s1 if self.region == TOOTH_ROOT else self.by_part[BETWEEN][-1]
        return (abs(s1 - self.in_root) + self.total_error) / self.in_root

    @property
    def over_period(self) -> OverPeriod | None:
        """Mean and maximum of s1 over the sampled period; None where it is not sampled."""
        if len(self.period) < 2:
            return None
        values = np.array([value for _, value in self.period])
        half = abs(float(values.mean() - values[::2].mean())) if len(values) % 2 == 0 else None
        mean, error = float(values.mean()), self.total_error
        share = None if error is None else error / self.s1
        return OverPeriod(mean, None if share is None else share * mean, half, float(values.max()))


def window_recipe(model: str, level: int) -> MeshRecipe:
    """Recipe of the window `level`, from 0 on, of the "plane" or "cup" model."""
    content: dict[str, Any] = {
        section: {name: values[level] for name, values in counts.items()}
        for section, counts in COUNTS[model].items()
    }
    if "face_width" in content:
        content["face_width"]["end_ratio"] = END_RATIO
    content["ring_gear"] = content["flexible_spline"]  # not meshed
    return make_recipe(content)


def resolve_root_stress(
    model: DriveModel, state: LoadState, levels: int | None = None, skipped: int = 0
) -> RootStress:
    """Resolve the largest tensile stress at the teeth in the model's equilibrium under `state`;
    collective.

    levels : windows, each finer than the one before; None for those of `LEVELS`
    skipped : coarsest of these windows that are left out; their stresses are not numbers

    Raises ConvergenceError or InputError where a window cannot be computed.
    """
    kind = model.geometry.model
    parts = (
        (False,) if kind == "plane" else (False, True)
    )  # between the ends of the teeth, and at them
    on_mesh = [_largest_by_tooth(model, ends) for ends in parts]
    in_root = _largest_nodal(
        model, root_nodes(model.geometry, model.partition.layouts[FLEXIBLE_SPLINE].mesh)
    )
    teeth = candidates(*on_mesh, in_root=in_root)
    places = [(tooth, ends) for tooth in teeth for ends in parts]
    values: dict[tuple[int, bool], list[float]] = {place: [math.nan] * skipped for place in places}
    for level in range(skipped, levels or LEVELS[kind]):
        found = _solve(model, state, places, window_recipe(kind, level))
        for place, stress in found.items():
            values[place].append(stress.value)
        best = max(places, key=lambda place: found[place].value)
        places = followed(found, level)
    stresses = ", ".join(f"{value:.1f}" for value in values[best][skipped:])
    logger.info(
        "windows around tooth %d, drive of %d elements: s1 %s MPa",
        best[0],
        model.n_elements(),
        stresses,
    )
    by_part = {
        PARTS[ends]: max((v for at, v in values.items() if at[1] == ends), key=_reached)
        for ends in parts
    }
    error = error_of(values[best], RATIO[kind])
    if best[1]:
        error = (
            error_at_ends(by_part, RATIO[kind]) if len(values[best]) >= LEVELS[kind] else math.inf
        )
    known = _place(model, found[best], PARTS[best[1]], by_part, error, float(np.max(on_mesh)))
    return replace(known, in_root=float(in_root.max()))


def _reached(levels: list[float]) -> tuple[int, float]:
    """Number of windows, and s1 on the finest one."""
    return len(levels), levels[-1]


def candidates(
    between: np.ndarray, at_ends: np.ndarray | None = None, *, in_root: np.ndarray
) -> list[int]:
    """Teeth whose stresses are looked at: the one with the largest between its ends, and others
    that are close to it.

    between, at_ends, in_root : (n_modelled,) largest nodal s1, MPa, of the teeth between their
    ends, in the cup at them, and in their roots
    """
    first = int(between.argmax())
    teeth = [first]
    shares = [(between, CLOSE)]
    if in_root[first] < between[first]:
        shares.append((in_root, CLOSE_IN_ROOT))
    if at_ends is not None:
        shares.append((at_ends, CLOSE))
    for stresses, share in shares:
        far = stresses.copy()
        far[_near(first, len(far))] = -np.inf
        other = int(far.argmax())
        if far[other] > share * between[first] and other not in teeth:
            teeth.append(other)
    return teeth


def may_be_largest(one: WindowStress, best: WindowStress, level: int) -> bool:
    """Whether a stress may overtake the largest one on windows finer than `level`; one region
    converges alike."""
    share = SAME_REGION
    if one.region != best.region:
        share = BETWEEN_ENDS if best.region in END_REGIONS else AT_ENDS[min(level, 1)]
        if one.region == TOOTH_ROOT and best.region not in END_REGIONS:
            share = IN_ROOT[min(level, len(IN_ROOT) - 1)]
    return one is best or one.value > share * best.value


def followed(found: Mapping[tuple[int, bool], WindowStress], level: int) -> list[tuple[int, bool]]:
    """Places that may have the largest stress on windows finer than `level`: each may overtake the
    first of both parts.

    found : by tooth and whether at its ends
    """
    firsts: dict[bool, WindowStress] = {}
    for (_, ends), stress in found.items():
        firsts[ends] = max(firsts.get(ends, stress), stress, key=lambda s: s.value)
    return [
        place
        for place, stress in found.items()
        if all(may_be_largest(stress, f, level) for f in firsts.values())
    ]


def with_angle(known: RootStress, model: DriveModel, state: LoadState) -> RootStress:
    """`known`, of the loaded state, with s1 at a further angle of the period; collective.

    One window, not the finest, is computed there. Its error is taken to be that of the same window
    in the loaded state, so that the ends of the teeth count only if they do there. Raises like
    `resolve_root_stress`.
    """
    kind = model.geometry.model
    level = PERIOD_LEVEL[kind]
    ends = known.part == ENDS
    tooth = int(_largest_by_tooth(model, ends).argmax())
    found = _solve(model, state, [(tooth, ends)], window_recipe(kind, level))[tooth, ends]
    value = found.value * known.s1 / known.levels[level]
    period = known.period or ((0.0, known.s1),)
    return replace(known, period=(*period, (float(np.degrees(state.angle)), value)))


def error_at_ends(by_part: Mapping[str, Sequence[float]], ratio: float) -> float:
    """Error of the last value of `by_part` at the ends of the teeth, which is the largest one.

    Where it falls from window to window, the largest stress is not above it, and not below the one
    between the ends.
    """
    ends, between = by_part[ENDS], by_part[BETWEEN]
    error = error_of(ends, ratio)
    if len(between) == len(ends) > 1 and ends[-1] < ends[-2]:
        error = min(error, ends[-1] - between[-1] + error_of(between, ratio))
    return error


def _near(tooth: int, count: int) -> np.ndarray:
    """Modelled teeth (n,) whose stresses the window of a tooth resolves."""
    inside = SECTORS // 2 - 1
    return (tooth + np.arange(-inside, inside + 1)) % count


def _largest_by_tooth(model: DriveModel, ends: bool) -> np.ndarray:
    """Largest s1 (n_modelled,) MPa of the teeth of all modelled sectors, at their ends or between
    them; collective."""
    return _largest_nodal(
        model, tooth_nodes(model.partition.layouts[FLEXIBLE_SPLINE].mesh, model.geometry, ends)
    )


def _largest_nodal(model: DriveModel, nodes: np.ndarray) -> np.ndarray:
    """Largest s1 (n_modelled,) MPa at these nodes (n,) of all modelled sectors of the flexible
    spline; collective."""
    body = model.elements.bodies[FLEXIBLE_SPLINE]
    stress = body.nodal_stress(model.problem.displacement())
    mine = principal(stress[:, nodes])[0].max(axis=1) if len(stress) else np.zeros(0)
    return np.concatenate(model.comm.allgather(mine))


def _solve(
    model: DriveModel, state: LoadState, places: list[tuple[int, bool]], recipe: MeshRecipe
) -> dict[tuple[int, bool], WindowStress]:
    """Largest stresses at the ends of teeth or between them, by tooth and whether at the ends: a
    window per tooth."""
    first = model.partition.layouts[FLEXIBLE_SPLINE].first_tooth
    found: dict[tuple[int, bool], WindowStress] = {}
    for tooth in dict.fromkeys(tooth for tooth, _ in places):
        window = LocalProblem(model, state, first + tooth, recipe)
        try:
            window.solve()
            found |= {place: window.largest(place[1]) for place in places if place[0] == tooth}
        finally:
            window.destroy()
    return found


def _place(
    model: DriveModel,
    found: WindowStress,
    part: str,
    by_part: Mapping[str, Sequence[float]],
    error: float,
    on_mesh: float,
) -> RootStress:
    x, y, z = found.position
    layout = model.partition.layouts[FLEXIBLE_SPLINE]
    angle = float(layout.sector_angle(np.array(found.tooth)) - np.arctan2(x, y))
    return RootStress(
        s1=found.value,
        error=error if math.isfinite(error) else None,
        on_mesh=on_mesh,
        region=found.region,
        warning=found.warning,
        tooth=found.tooth % layout.mesh.n_sectors,
        radius=float(np.hypot(x, y)),
        z=0.0 if layout.mesh.plane else float(z),
        angle_deg=float(np.degrees(angle)) % 360.0,
        part=part,
        by_part=by_part,
        elements=found.elements,
    )
