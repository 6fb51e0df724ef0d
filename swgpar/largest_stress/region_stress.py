"""The largest stresses of the regions of the gears, read from windows.

A window is around one tooth. Where nodal averages have the largest stress of a region at another
one, the stress there is that of the window in proportion. Where it is far larger there, it is
loaded in another way: nodal averages stand for it, with what they may lose.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import zip_longest

import numpy as np

from swgpar.answers.answer import joined_error
from swgpar.fem.body import FLEXIBLE_SPLINE, STRESS_PREFIXES
from swgpar.fem.body_layout import BodyLayout
from swgpar.fem.stress import principal_at_nodes
from swgpar.largest_stress.convergence import HIGHEST_ORDER, LOWEST_ORDER, error_of
from swgpar.largest_stress.local_problem import WindowStress
from swgpar.largest_stress.places import (
    APART_DISTANCE,
    OF_REGION,
    Place,
    near_contact,
    pressed_nodes,
    working_flanks,
)
from swgpar.largest_stress.surface_stress import surface_mises
from swgpar.largest_stress.window_recipes import by_model
from swgpar.largest_stress.window_regions import tooth_nodes
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel
from swgpar.model.regions import (
    BACK,
    FLANK,
    RIM_INSIDE,
    TIP,
    TOOTH_END,
    TOOTH_ROOT,
    WITHOUT_LIMIT,
)

UNREFINED: dict[str, tuple[str, ...]] = by_model((), (FLANK, TIP))
"""Regions of the flexible spline whose elements are the same in all windows: no error follows from
them."""

ALIKE = 1.5
"""Ratio of the stresses of two teeth up to which the windows of one stand for those of the
other."""

BESIDE_ROOT = 0.25
"""Distance from the root over the module within which the stress of a flank is that of the end of
the root: an element along the flank of the first window."""

LEAST_STRESS = 1e-6
"""MPa: the least stress that another is divided by."""

CLOSE = 0.85
"""Share of the largest stress on the drive's own mesh from which a tooth outside of the first
window is looked at."""

CLOSE_IN_ROOT = 0.7
"""The same for the largest stress in a root where the largest one is elsewhere: nodal averages lose
up to a quarter in roots, and little inside of the rim."""

IN_TEETH = (TOOTH_ROOT, TOOTH_END, BACK)
"""Regions in which nodal averages lose as much as in roots. Beside them so they do on flanks."""


@dataclass(frozen=True)
class RegionStress:
    """Largest stress of a region.

    levels : MPa, of one tooth in windows, coarse to fine, not numbers where left out
    tops : MPa, the largest of all windows of each level
    spread : largest stress of the region over that of this tooth, at least 1
    place : with the error by the windows
    nodal : whether it is a nodal average at a tooth that is loaded in another way
    drive_error : MPa, by the mesh of the drive; None where it is not known
    """

    levels: tuple[float, ...]
    tops: tuple[float, ...]
    spread: float
    place: Place
    nodal: bool = False
    drive_error: float | None = None

    @property
    def resolved(self) -> Place:
        """The place with both errors."""
        return replace(self.place, error=joined_error(self.place.error, self.drive_error))


@dataclass
class WindowReadings:
    """Stresses that windows of a gear have given, by modelled tooth and by name.

    skipped : coarsest windows that are left out
    corners : the largest tension at the teeth where it has no limit, of the last windows, by the
    tooth in their middle
    of_window : largest stresses of the last windows and their level, by the tooth in their middle
    """

    skipped: int
    levels: dict[int, dict[str, list[WindowStress]]] = field(default_factory=dict)
    corners: dict[int, WindowStress] = field(default_factory=dict)
    of_window: dict[int, tuple[int, dict[str, WindowStress]]] = field(default_factory=dict)

    def add(
        self,
        middle: int,
        level: int,
        found: Mapping[int, Mapping[str, WindowStress]],
        at_corner: WindowStress | None = None,
    ) -> None:
        """Keep what a window around the tooth `middle`, or a narrow one in it, gives, by tooth. Of
        two windows of a level that read a tooth the larger stress counts."""
        before, largest = self.of_window.get(middle, (level, {}))
        if before != level:
            largest = {}
            self.corners.pop(middle, None)
        if at_corner is not None:
            known = self.corners.get(middle, at_corner)
            self.corners[middle] = max(known, at_corner, key=lambda one: one.value)
        for tooth, stresses in found.items():
            of_tooth = self.levels.setdefault(tooth, {})
            for name, stress in stresses.items():
                largest[name] = max(largest.get(name, stress), stress, key=lambda one: one.value)
                read = of_tooth.setdefault(name, [replace(stress, value=math.nan)] * self.skipped)
                # a region that coarser windows had not had no stress there
                read += [replace(stress, value=0.0)] * (level - len(read))
                if len(read) == level:
                    read.append(stress)
                elif stress.value > read[level].value:
                    read[level] = stress
        self.of_window[middle] = level, largest

    def window_with_largest(self, stress: str) -> tuple[int, WindowStress]:
        """Tooth around which the finest windows give the largest of a stress in teeth and rim, and
        this stress."""
        finest = max(level for level, _ in self.of_window.values())
        names = [f"{stress}{OF_REGION}{region}" for region in (*IN_TEETH, RIM_INSIDE)]
        found = [
            (middle, by[name])
            for middle, (level, by) in self.of_window.items()
            if level == finest
            for name in names
            if name in by
        ]
        return max(found, key=lambda one: one[1].value)

    def at_corner(self, model: DriveModel, s1: float) -> Place | None:
        """The largest tension at the teeth where it has no limit; None where it is not above
        another one (MPa)."""
        found = max(self.corners.values(), key=lambda one: one.value, default=None)
        if found is None or found.value <= s1:
            return None
        layout = model.partition.layouts[FLEXIBLE_SPLINE]
        place = Place.at(layout, found.region, found.position, found.tooth, found.value)
        return replace(place, warning=found.warning)

    def stresses(
        self, model: DriveModel, gear: str, nodal: Mapping[str, np.ndarray], ratio: float
    ) -> dict[str, RegionStress]:
        """The largest stress of every region.

        nodal : MPa, see `nodal_by_sector`;  ratio : of element sizes of successive windows
        """
        names = sorted({name for of_tooth in self.levels.values() for name in of_tooth})
        return {name: self._stress(model, gear, name, nodal.get(name), ratio) for name in names}

    def _stress(
        self, model: DriveModel, gear: str, name: str, nodal: np.ndarray | None, ratio: float
    ) -> RegionStress:
        known = {tooth: by[name] for tooth, by in self.levels.items() if name in by}
        main = max(known, key=lambda tooth: (len(known[tooth]), known[tooth][-1].value))
        shares = _over(known, main)
        other = max(shares, key=lambda tooth: shares[tooth])
        if shares[other] > ALIKE:
            main, shares = other, _over(known, other)
        spread = max(shares[other], 1.0)
        levels = _values(known[main])
        every = zip_longest(*map(_values, known.values()), fillvalue=0.0)
        tops = tuple(np.fmax.reduce(level) for level in every)
        of_largest, lacks = known[other][-1], 0.0
        tooth, position = of_largest.tooth, of_largest.position
        region = name.partition(OF_REGION)[2]
        unrefined = gear == FLEXIBLE_SPLINE and region in UNREFINED[model.geometry.model]
        layout = model.partition.layouts[gear]
        place = partial(Place.at, layout, region)
        error = math.inf if unrefined else self._window_error(model, layout, name, main, ratio)
        least = 0.0
        if nodal is not None:
            reads, elsewhere = _read_and_elsewhere(nodal, known)
            # nodal averages lose much beside a contact: the most alike is the one with most of them
            alike = max(reads, key=lambda tooth: reads[tooth])
            read, average = reads[alike], float(nodal[elsewhere])
            lacks, there = abs(levels[-1] - reads[main]), known[alike][-1].position
            if average > ALIKE * read:
                lost = 1.0 / (CLOSE_IN_ROOT if region in (*IN_TEETH, FLANK) else CLOSE) - 1.0
                if average > spread * levels[-1]:
                    of_average = place(
                        there, elsewhere, average, math.inf if unrefined else lost * average
                    )
                    return RegionStress(levels, tops, 1.0, of_average, nodal=True)
                least = (1.0 + lost) * average - spread * levels[-1]
            elif read > 0.0 and average / read * shares[alike] > spread:
                spread, tooth, position = average / read * shares[alike], elsewhere, there
                lacks = abs(shares[alike] * levels[-1] - read)
        error = max(spread * error + (spread - 1.0) * lacks, least)
        value = place(position, tooth, spread * levels[-1], error)
        return RegionStress(levels, tops, spread, value)

    def _window_error(
        self, model: DriveModel, layout: BodyLayout, name: str, tooth: int, ratio: float
    ) -> float:
        """Error (MPa) of the last window of a tooth.

        The stress of a flank beside its root is that of the end of the root, and at most the
        largest in the root. Coarser windows may have no node between the root and the contact.
        Where the distance from a contact ends, the tractions that nodal averages have on a free
        surface are largest, and fall in first order.
        """
        read, (stress, _, region) = self.levels[tooth][name], name.partition(OF_REGION)
        root = _values(self.levels[tooth].get(f"{stress}{OF_REGION}{TOOTH_ROOT}", ()))
        reach, levels, last = BESIDE_ROOT * model.geometry.module, _values(read), read[-1]
        highest = LOWEST_ORDER if last.beside else HIGHEST_ORDER
        if region == FLANK and root and _to_root(layout, last.position) < reach:
            below = max(root[-1] - levels[-1], 0.0)
            return min(error_of(levels, ratio, highest), error_of(root, ratio) + below)
        return error_of(levels, ratio, highest)


def _of_teeth_and_rim(stress: str) -> list[str]:
    """Names of a stress in the regions of teeth and rim."""
    return [f"{stress}{OF_REGION}{region}" for region in (*IN_TEETH, RIM_INSIDE)]


def _values(levels: Sequence[WindowStress]) -> tuple[float, ...]:
    """MPa, coarse to fine."""
    return tuple(one.value for one in levels)


def _over(known: Mapping[int, Sequence[WindowStress]], main: int) -> dict[int, float]:
    """Stresses of teeth over those of one, in the finest windows that both have.

    A tooth that finer windows do not read changes there as one that they do, whose stress was
    nearest to its place on the profile and along the face width: the ends of teeth have several
    peaks, which converge differently. The change of a far smaller stress tells nothing: where there
    is no other one, it does not change. known : coarse to fine
    """
    finest = len(known[main]) - 1
    top = max(known[main][finest].value, LEAST_STRESS)
    others = [tooth for tooth, levels in known.items() if len(levels) > finest and tooth != main]
    in_finest, shares = [known[tooth] for tooth in (main, *others)], {}
    for tooth, levels in known.items():
        last = min(len(levels) - 1, finest)
        change = 1.0 if last == finest else _change(levels[last], in_finest, last, finest)
        shares[tooth] = levels[last].value * change / top
    return shares


def _change(
    stress: WindowStress, others: Iterable[Sequence[WindowStress]], level: int, finest: int
) -> float:
    """Stress in the finest window over that in the window `level`, of the tooth that has it nearest
    to the place of another stress, and not far below it; of equally near ones the first."""
    least = max(stress.value / ALIKE, LEAST_STRESS)
    there = [levels for levels in others if levels[level].value > least]
    if not there:
        return 1.0
    alike = min(there, key=lambda of: np.linalg.norm(of[level].position - stress.position))
    return alike[finest].value / alike[level].value


def _to_root(layout: BodyLayout, position: np.ndarray) -> float:
    """Distance (mm) of a position (3,) from the end of the root on the profile of its tooth."""
    profile = layout.mesh.profile
    x, y = profile.point(np.array([profile.root_start]))[0]
    return float(np.hypot(abs(position[0]) - abs(x), position[1] - y))


def _read_and_elsewhere(nodal: np.ndarray, known: Iterable[int]) -> tuple[dict[int, float], int]:
    """Nodal averages (of (n_modelled,) MPa) at the teeth that windows have read, and the tooth with
    the largest elsewhere."""
    reads, far = {tooth: float(nodal[tooth]) for tooth in known}, nodal.copy()
    far[list(reads)] = -np.inf
    return reads, int(far.argmax())


def nodal_averages(model: DriveModel, gear: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """s1, s3 and von Mises stress (n_owned, n_node) MPa on the drive's mesh; collective."""
    body = model.elements.bodies[gear]
    return principal_at_nodes(body.layout.mesh, body.nodal_stress(model.problem.displacement()))


def nodal_by_sector(
    model: DriveModel,
    state: LoadState,
    gear: str,
    averages: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> dict[str, np.ndarray]:
    """Largest nodal averages (n_modelled,) MPa apart from the contact of flanks, by sector and by
    names with `OF_REGION`; collective.

    Of a ring gear any flank may be touched. averages : `nodal_averages` of the gear
    """
    mesh, regions = model.elements.bodies[gear].layout.mesh, model.regions[gear][False]
    s1, s3, mises = averages
    distance = APART_DISTANCE * model.geometry.module
    if gear == FLEXIBLE_SPLINE:
        near = near_contact(mesh, pressed_nodes(model, state), distance)
    else:
        near = near_contact(mesh, working_flanks(mesh)[None], distance)
        near = np.broadcast_to(near, s1.shape)
    if mesh.plane:
        # that near the contact is left out
        surface = np.isin(mesh.lower_nodes, mesh.surface_edges)
        mises = surface_mises(s1, s3, mises, surface)
    found = {}
    prefix = STRESS_PREFIXES[gear][0]
    for region in np.unique(regions):
        nodes = np.flatnonzero(regions == region)
        for stress, values in (("s1", s1), ("s3", -s3), ("vm", mises)):
            read = np.where(near[:, nodes], 0.0, values[:, nodes]).max(axis=1, initial=0.0)
            gathered = np.concatenate(model.comm.allgather(read))
            found[f"{prefix}_{stress}{OF_REGION}{region}"] = gathered
    return found


def largest_by_tooth(model: DriveModel, s1: np.ndarray, ends: bool) -> np.ndarray:
    """Largest s1 (n_modelled,) MPa of the teeth of all modelled sectors, at their ends or between
    them, where it has a limit; collective. s1 : (n_owned, n_node) MPa, nodal averages"""
    mesh = model.partition.layouts[FLEXIBLE_SPLINE].mesh
    nodes = tooth_nodes(mesh, model.geometry, ends)
    limited = ~np.isin(model.regions[FLEXIBLE_SPLINE][False][nodes], WITHOUT_LIMIT)
    return largest_of_nodes(model, s1, nodes[limited])


def largest_of_nodes(model: DriveModel, s1: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """Largest s1 (n_modelled,) MPa at these nodes (n,) of all modelled sectors of the flexible
    spline; collective. s1 : (n_owned, n_node) MPa, nodal averages"""
    mine = s1[:, nodes].max(axis=1) if len(s1) else np.zeros(0)
    return np.concatenate(model.comm.allgather(mine))
