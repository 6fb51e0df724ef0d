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
from dataclasses import dataclass, field, replace

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
from swgpar.answers.missed_peaks import FEWEST, missed_above
from swgpar.design.drive_design import DriveDesign
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.largest_stress.candidate_teeth import (
    LATER,
    Followed,
    candidates,
    first_of_largest,
    followed,
    levels_of,
    narrowed,
)
from swgpar.largest_stress.convergence import error_at_ends, error_of
from swgpar.largest_stress.local_problem import WindowStress
from swgpar.largest_stress.places import OF_REGION, Place, root_nodes
from swgpar.largest_stress.region_stress import (
    RegionStress,
    WindowReadings,
    largest_by_tooth,
    largest_of_nodes,
    nodal_averages,
    nodal_by_sector,
)
from swgpar.largest_stress.ring_gear_stress import ring_gear_stresses
from swgpar.largest_stress.solved_window import States, solved_window
from swgpar.largest_stress.window_recipes import (
    LEVELS,
    NARROW_FROM,
    PERIOD_LEVEL,
    RATIO,
    window_recipe,
)
from swgpar.load.load_states import LoadState
from swgpar.log import logger
from swgpar.model.drive_model import DriveModel
from swgpar.model.regions import RIM_INSIDE, TOOTH_END, TOOTH_ROOT

PARTS = BETWEEN, ENDS = "between the ends", "ends"
"""Of teeth, in which stresses converge differently; a flag `ends` is the index."""


@dataclass(frozen=True)
class OverPeriod:
    """s1 (MPa) over the sampled period.

    mean_error : by the meshes, in proportion to that of the loaded state; None where it is not
    known
    sampling_error : change of the mean by half as many angles, None for an odd number of them
    maximum_error : by the meshes and between the angles; None where it is not known
    """

    mean: float
    mean_error: float | None
    sampling_error: float | None
    maximum: float
    maximum_error: float | None


@evaluation
class RootStress(AnswerGroup):
    """Largest tensile stress at the teeth where it has a limit.

    at_corner : a larger one where it has none
    error : MPa, estimated, of the window's mesh; None where it is not known
    region : as of a `Place`
    tooth : number, counter-clockwise from +y in the undeformed drive
    radius, z : mm;  angle_deg : from +y, counter-clockwise
    part : of the tooth;  elements : of the finest window
    by_part : largest s1 (MPa) of every part on the windows, coarse to fine, while followed
    drive_error : MPa, estimated, of the drive's mesh; None where it is not known
    regions : largest stresses of the regions of both gears that windows resolve, by names with
    `OF_REGION`
    period : angles of the wave generator (degrees) and s1 (MPa) there, of one sampled period
    """

    s1: float = part_answers(
        AnswerKind(
            "root.s1",
            "largest tension at the teeth under load, by windows",
            "MPa",
            "largest",
            error="total_error",
            place="place_of_largest",
            remark="warning",
        ),
        AnswerKind(
            "root.s1_off_corners",
            "the same off corners without a radius and off edges of the cam",
            "MPa",
            "s1",
            detail=True,
            error="total_error",
            place="place",
        ),
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
    tooth: int
    radius: float
    z: float
    angle_deg: float
    part: str
    by_part: Mapping[str, Sequence[float]]
    elements: int
    drive_error: float | None = None
    regions: Mapping[str, RegionStress] = field(default_factory=dict)
    at_corner: Place | None = None
    period: tuple[tuple[float, float], ...] = part_answers(
        AnswerKind(
            "root.mean_s1",
            "the same over one period, mean",
            "MPa",
            "over_period.mean",
            error="over_period.mean_error",
        ),
        AnswerKind(
            "root.maximum_s1",
            "the same over one period, largest",
            "MPa",
            "over_period.maximum",
            error="over_period.maximum_error",
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
            if self.at_corner is None:
                yield one
            elif one.name == "root.s1":
                yield with_no_limit(one)
            else:
                yield replace(one, detail=one.detail and one.name != "root.s1_off_corners")

    def remarks(self) -> Iterator[str]:
        if (over := self.over_period) is not None:
            half = over.sampling_error
            change = "" if half is None else f": half as many change the mean by {half:.1f} MPa"
            yield f"{len(self.period)} angles of the period, one window at each further one{change}"

    @property
    def largest(self) -> float:
        """s1 (MPa), or a larger one at a corner."""
        return self.s1 if self.at_corner is None else self.at_corner.value

    @property
    def place_of_largest(self) -> str:
        """Words for the place of `largest`."""
        return self.place if self.at_corner is None else self.at_corner.text

    @property
    def warning(self) -> str:
        """Why `largest` has no limit; empty where it has one."""
        return "" if self.at_corner is None else self.at_corner.warning

    @property
    def place(self) -> str:
        """Words for the place of `s1`."""
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
    def over_period(self) -> OverPeriod | None:
        """Mean and maximum of s1 over the sampled period; None where it is not sampled."""
        if len(self.period) < 2:
            return None
        values = np.array([value for _, value in self.period])
        half = abs(float(values.mean() - values[::2].mean())) if len(values) % 2 == 0 else None
        mean, maximum, error = float(values.mean()), float(values.max()), self.total_error
        share = None if error is None else error / self.s1
        by_mesh = None if share is None else share * maximum
        missed = missed_above(values) if len(values) >= FEWEST else None
        return OverPeriod(
            mean=mean,
            mean_error=None if share is None else share * mean,
            sampling_error=half,
            maximum=maximum,
            maximum_error=joined_error(by_mesh, missed),
        )


def resolve_root_stress(
    model: DriveModel,
    state: LoadState,
    levels: int | None = None,
    skipped: int = 0,
    *,
    ring: bool = True,
) -> RootStress:
    """Resolve the largest tensile stress at the teeth in the model's equilibrium under `state`, and
    read the other stresses of the gears; collective.

    levels : windows, each finer than the one before; None for those of `LEVELS`
    skipped : coarsest of these windows that are left out; their stresses are not numbers
    ring : whether ring gears have windows

    Raises ConvergenceError or InputError where a window cannot be computed.
    """
    kind = model.geometry.model
    parts = _parts(model)
    averages = nodal_averages(model, FLEXIBLE_SPLINE)
    on_mesh = [largest_by_tooth(model, averages[0], ends) for ends in parts]
    layout = model.partition.layouts[FLEXIBLE_SPLINE]
    in_root = largest_of_nodes(model, averages[0], root_nodes(model.geometry, layout.mesh))
    nodal = nodal_by_sector(model, state, FLEXIBLE_SPLINE, averages)
    parts_of_teeth = [f"fs_vm{OF_REGION}{part}" for part in (TOOTH_ROOT, TOOTH_END, RIM_INSIDE)]
    mises = np.max([nodal[name] for name in parts_of_teeth if name in nodal], axis=0)
    teeth = candidates(*on_mesh, in_root=in_root, mises=mises)
    places = [(tooth, ends) for tooth in teeth for ends in parts]
    read: dict[Followed, list[dict[int, float]]] = {}
    values: dict[Followed, list[float]] = {}
    readings, states = WindowReadings(skipped), States()
    count, narrow = levels or LEVELS[kind], dict[Followed, list[int]]()
    for level in range(skipped, count):
        by_tooth = _solve(model, state, places, level, readings, states, narrow)
        found = {place: of_teeth[0] for place, of_teeth in by_tooth.items()}
        for place, of_teeth in by_tooth.items():
            read.setdefault(place, []).append({one.tooth: one.value for one in of_teeth})
            values[place] = [math.nan] * skipped + levels_of(read[place], place in places)
        best = max(found, key=lambda place: found[place].value)
        places = followed(found, level, LATER[kind])
        at = {place: by_tooth[place] for place in places}
        further, mises_there = readings.window_with_largest("fs_vm")
        if level + 2 < count and all(tooth != further for tooth, _ in places):
            places.append((further, False))  # as far as the last window but one
            at[further, False] = [mises_there]
        if level + 1 >= NARROW_FROM:
            narrow = narrowed(at, layout.first_tooth, layout.count, LATER[kind])
            places = [place for place in places if place in narrow]
        _release(model)
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
            error_at_ends(by_part[ENDS], by_part[BETWEEN], RATIO[kind])
            if len(values[best]) >= LEVELS[kind]
            else math.inf
        )
    known = _place(model, found[best], PARTS[best[1]], by_part, error, float(np.max(on_mesh)))
    regions = readings.stresses(model, FLEXIBLE_SPLINE, nodal, RATIO[kind])
    for gear in model.geometry.gears:
        if ring and gear != FLEXIBLE_SPLINE:
            regions |= ring_gear_stresses(model, state, gear, count, skipped)
            _release(model)
    return replace(known, regions=regions, at_corner=readings.at_corner(model, known.s1))


def _release(model: DriveModel) -> None:
    """Release the factors of windows, but not of those that further angles need; collective."""
    kind = model.geometry.model
    model.release_windows(kept=window_recipe(kind, PERIOD_LEVEL[kind]))


def _parts(model: DriveModel) -> tuple[bool, ...]:
    """Flags `ends` of the parts of teeth; in the plane they have no ends."""
    return (False,) if model.geometry.model == "plane" else (False, True)


def _reached(levels: list[float]) -> tuple[int, float]:
    """Number of windows, and s1 on the finest one."""
    return len(levels), levels[-1]


def with_angle(known: RootStress, model: DriveModel, state: LoadState) -> RootStress:
    """`known`, of the loaded state, with s1 at a further angle of the period; collective.

    One window, not the finest, is computed there. Its error is taken to be that of the same window
    in the loaded state, so that the ends of the teeth count only if they do there. Raises like
    `resolve_root_stress`.
    """
    level = PERIOD_LEVEL[model.geometry.model]
    ends = known.part == ENDS
    s1, _, _ = nodal_averages(model, FLEXIBLE_SPLINE)
    tooth = first_of_largest(largest_by_tooth(model, s1, ends))
    found = _solve(model, state, [(tooth, ends)], level)[tooth, ends][0]
    value = found.value * known.s1 / known.levels[level]
    period = known.period or ((0.0, known.s1),)
    return replace(known, period=(*period, (float(np.degrees(state.angle)), value)))


def _solve(
    model: DriveModel,
    state: LoadState,
    places: Sequence[Followed],
    level: int,
    readings: WindowReadings | None = None,
    states: States | None = None,
    narrow: Mapping[Followed, Sequence[int]] | None = None,
) -> dict[Followed, list[WindowStress]]:
    """Largest stresses of the teeth in the windows of places, the largest first: at the ends of
    teeth and between them, whichever the windows are there for.

    level : of the windows;  readings : takes the stresses of all regions
    states : equilibria of coarser windows, to which those of these windows are added
    narrow : teeth with the largest stresses of coarser windows, by place, around which windows are
    narrow
    """
    layout = model.partition.layouts[FLEXIBLE_SPLINE]
    recipe = window_recipe(model.geometry.model, level)
    states, narrow = {} if states is None else states, narrow or {}
    windows = dict.fromkeys(
        (place[0], middle) for place in places for middle in narrow.get(place, [None])
    )
    found: dict[Followed, list[WindowStress]] = {}
    for tooth, middle in windows:
        with solved_window(model, state, tooth, recipe, states, middle=middle) as window:
            for ends in _parts(model):
                found.setdefault((tooth, ends), []).extend(window.by_tooth(ends))
            if readings is not None:
                by_tooth = window.by_region().items()
                read = {(one - layout.first_tooth) % layout.count: by for one, by in by_tooth}
                readings.add(tooth, level, read, window.largest_at_corners())
    return {place: sorted(of, key=lambda one: -one.value) for place, of in found.items()}


def _place(
    model: DriveModel,
    found: WindowStress,
    part: str,
    by_part: Mapping[str, Sequence[float]],
    error: float,
    on_mesh: float,
) -> RootStress:
    layout = model.partition.layouts[FLEXIBLE_SPLINE]
    place = Place.at(layout, found.region, found.position, found.tooth, found.value, error)
    return RootStress(
        s1=place.value,
        error=place.error,
        on_mesh=on_mesh,
        region=found.region,
        tooth=place.tooth,
        radius=place.radius,
        z=place.z,
        angle_deg=place.angle_deg,
        part=part,
        by_part=by_part,
        elements=found.elements,
    )
