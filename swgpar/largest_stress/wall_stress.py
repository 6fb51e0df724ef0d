"""The largest stresses of the wall behind the teeth, by rings and slices of it on finer meshes.

The whole wall is solved on two meshes that resolve its bending. Where one of its regions may have
the largest stress, slices around that place, each finer than the one before, resolve the stress at
the surface (docs/theory/windows.md).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from swgpar.fem.body import FLEXIBLE_SPLINE, STRESS_PREFIXES
from swgpar.fem.stress import principal
from swgpar.largest_stress.convergence import error_of
from swgpar.largest_stress.places import OF_REGION, Place
from swgpar.largest_stress.wall_problem import Source, WallProblem
from swgpar.largest_stress.window_regions import BEHIND, wall_start
from swgpar.load.load_states import LoadState
from swgpar.log import logger
from swgpar.meshing.sector import SectorMesh
from swgpar.meshing.trim import trimmed
from swgpar.meshing.wall_sector import WallCounts, WallSector, wall_sector
from swgpar.model.drive_model import DriveModel
from swgpar.model.regions import FILLET, WITHOUT_LIMIT, regions_of

RINGS = WallCounts(4, 2), WallCounts(6, 3, around=1.5)
"""Elements of the rings, coarse to fine."""

RING_RATIO, RING_ORDER = 1.5, 2
"""Ratio of their element sizes; order of their displacements."""

SLICES = (
    WallCounts(8, 4, 0.5, around=1.5),
    WallCounts(16, 8, 0.25, around=1.5),
    WallCounts(32, 16, 0.125, around=1.5),
)
SLICE_RATIO = 2.0
"""Elements of the slices, coarse to fine, and the ratio of their sizes."""

MARGIN, FEWEST, MOST = 3.0, 3, 9
"""Distance over the thickness from the sector in the middle of a slice, which is read, to its
sides; fewest and most sectors of a slice."""

REACH, READ, HELD = 4.0, 1.0, 0.5
"""Distances along the section from the middle of a slice over the thickness there: as far as which
it extends, as far as which it is read, and as far as which it resolves other stresses too."""

CLOSE_IN_FILLET, CLOSE, FOLLOWED = 0.6, 0.85, 0.8
"""Shares of the largest stress from which another is resolved by slices, in the fillet and
elsewhere, on the ring, and from which it is followed to the last of them. The ring shows 0.6 of the
stress in the sharpest fillets that are allowed, and 0.95 and more where the wall is smooth."""

DRIVE_ORDER = 2
"""Order of the displacements of the drive."""

LEAST = 0.005
"""Least error by the mesh of the drive that two meshes can show, as a share of the stress."""

STRESSES = {"s1": (0, 1.0), "s3": (1, -1.0), "vm": (2, 1.0)}
"""Stresses that are looked for: index in `principal`, and sign."""

LEAST_MISES = 0.5 * np.sqrt(3.0)
"""Von Mises stress at a free surface over the largest tension there, at least, where the other
principal stress is no compression."""


@dataclass(frozen=True)
class Spot:
    """A largest stress.

    value : MPa;  sector : index in the chain of the ring or slice;  point : (3,) mm, undeformed, in
    the frame of its sector
    """

    value: float
    sector: int
    point: np.ndarray

    @property
    def section(self) -> np.ndarray:
        """Radius and z (2,) mm."""
        return np.array([np.hypot(*self.point[:2]), self.point[2]])


@dataclass(frozen=True)
class CoarseWall:
    """Largest stresses (MPa) of the wall by a coarser drive, see `ring_stresses`.

    ratio : of the drives' element sizes in wall and width, the least
    """

    on_ring: Mapping[str, float]
    ratio: float


@dataclass(frozen=True)
class WallStress:
    """Largest stresses of the wall in one state.

    places : by names with `OF_REGION`, with their errors
    levels : MPa, on the slices, coarse to fine, by these names; none where the rings are enough
    on_ring : MPa, on the coarsest ring, for the error of a finer drive
    """

    places: Mapping[str, Place]
    levels: Mapping[str, tuple[float, ...]]
    on_ring: Mapping[str, float]


def ring_stresses(model: DriveModel, state: LoadState) -> dict[str, float]:
    """Largest stresses (MPa) on the coarsest ring, by names with `OF_REGION`; collective.

    Raises ConvergenceError.
    """
    ring = _solved_ring(model, state, RINGS[0]).problem
    try:
        return {name: spot.value for name, spot in _largest(ring, _regions_of_ring(ring)).items()}
    finally:
        ring.destroy()


def resolve_wall(
    model: DriveModel,
    state: LoadState,
    tension: float = 0.0,
    coarse: CoarseWall | None = None,
) -> WallStress:
    """Resolve the largest stresses of every region of the wall; collective.

    tension : MPa, the largest one at the teeth; places far below it are not resolved by slices
    coarse : what a coarser drive gives; None where there is none

    Raises ConvergenceError or InputError where a part cannot be computed.
    """
    rings: list[WallRing] = []
    try:
        for counts in RINGS:
            rings.append(_solved_ring(model, state, counts, rings[-1:]))
        first, last = (_largest(ring.problem, _regions_of_ring(ring.problem)) for ring in rings)
        on_slices = _on_slices(rings, last, tension)
        places, layout = {}, model.partition.layouts[FLEXIBLE_SPLINE]
        for name, spot in last.items():
            best, error = spot, np.inf
            if name in on_slices:
                best, error = on_slices[name].spot, on_slices[name].error
            elif name in first:  # nodal averages are of first order
                error = abs(spot.value - first[name].value) / (RING_RATIO - 1.0)
            error += spot.value * _drive_share(name, first, coarse)
            region, tooth = name.partition(OF_REGION)[2], layout.first_tooth + best.sector
            places[name] = Place.at(layout, region, best.point, tooth, best.value, error)
    finally:
        for ring in rings:
            ring.problem.destroy()
    levels = {name: tuple(one.levels) for name, one in on_slices.items()}
    for name, values in levels.items():
        logger.info("%s: %s MPa by slices", name, ", ".join(f"{value:.1f}" for value in values))
    return WallStress(places, levels, {name: spot.value for name, spot in first.items()})


def _candidates(
    spots: Mapping[str, Spot], tension: float, in_fillet: float, elsewhere: float
) -> list[str]:
    """Stresses with these shares of the largest one and more, in the fillet and elsewhere, largest
    first. Compression is read where one of the others is resolved."""
    least = {"s1": tension, "vm": LEAST_MISES * tension}
    found = []
    for stress, at_teeth in least.items():
        of_stress = {name: spot.value for name, spot in spots.items() if f"_{stress}" in name}
        top = max([at_teeth, *of_stress.values()])
        for name, value in of_stress.items():
            close = in_fillet if name.endswith(f"{OF_REGION}{FILLET}") else elsewhere
            if value > close * top:
                found.append(name)
    return sorted(found, key=lambda name: -spots[name].value)


def _drive_share(name: str, fine: Mapping[str, Spot], coarse: CoarseWall | None) -> float:
    """Error by the drive's mesh as a share of the stress; inf where it is not known."""
    if coarse is None or name not in coarse.on_ring or name not in fine:
        return np.inf
    change = abs(fine[name].value - coarse.on_ring[name]) / fine[name].value
    return max(change / (coarse.ratio**DRIVE_ORDER - 1.0), LEAST)


@dataclass(frozen=True)
class WallRing:
    """A ring in equilibrium, and the grid of its sector."""

    problem: WallProblem
    grid: WallSector

    def displacements(self) -> Source:
        """Its displacements."""
        return self.problem.displacements(self.grid)


def _solved_ring(
    model: DriveModel, state: LoadState, counts: WallCounts, coarser: Sequence[WallRing] = ()
) -> WallRing:
    """coarser : a ring whose displacements to begin with, if there is one"""
    grid = wall_sector(model.geometry, counts, wall_start(model.geometry, model.geometry.cup))
    begin = coarser[0].displacements() if coarser else None
    problem = WallProblem.ring(model, state, grid.mesh, begin)
    try:
        problem.solve()
    except BaseException:
        problem.destroy()
        raise
    return WallRing(problem, grid)


def _regions_of_ring(ring: WallProblem) -> np.ndarray:
    """Regions (n_node,) of a ring's sector; none near the cut, and where a stress has no limit."""
    return _regions_read(ring, np.ones(len(ring.layout.mesh.coords), dtype=bool))


def _first_z(model: DriveModel) -> float:
    """z (mm) from which stresses are read: away from the cut."""
    geometry = model.geometry
    return (
        geometry.cup.wall.back
        + wall_start(geometry, geometry.cup)
        + BEHIND * geometry.cup_thickness
    )


def _largest(
    part: WallProblem, regions: np.ndarray, sectors: slice = slice(None)
) -> dict[str, Spot]:
    """Largest stresses of every region by names with `OF_REGION`; collective.

    regions : (n_node,), empty where nothing is read;  sectors : that are read, of the chain
    """
    wanted = np.isin(part.sectors, np.arange(part.layout.count)[sectors])
    kinds = principal(part.stress()[wanted])
    own, mesh = part.sectors[wanted], part.layout.mesh
    prefix = STRESS_PREFIXES[FLEXIBLE_SPLINE][0]
    found = {}
    for region in sorted(set(regions) - {""}):
        nodes = np.flatnonzero(regions == region)
        for stress, (index, sign) in STRESSES.items():
            best: tuple[float, int, int] = (-np.inf, 0, 0)
            if len(own):
                values = sign * kinds[index][:, nodes]
                k, i = np.unravel_index(values.argmax(), values.shape)
                best = (float(values[k, i]), int(own[k]), int(nodes[i]))
            value, sector, node = max(part.model.comm.allgather(best), key=lambda one: one[0])
            if value > 0.0:
                name = f"{prefix}_{stress}{OF_REGION}{region}"
                found[name] = Spot(value, sector, mesh.coords[node])
    return found


@dataclass
class OnSlices:
    """A stress on slices.

    levels : MPa, coarse to fine;  spot : on the finest
    by_ring : error by the ring as a share of the stress
    """

    levels: list[float]
    spot: Spot
    by_ring: float

    @property
    def error(self) -> float:
        """Error (MPa) by slices and ring. Two levels are taken to be of first order."""
        if len(self.levels) == 1:
            return np.inf
        if len(self.levels) < len(SLICES):
            change = abs(self.levels[-1] - self.levels[-2])
        else:
            change = error_of(self.levels, SLICE_RATIO)
        return change + self.by_ring * self.spot.value


def _on_slices(
    rings: Sequence[WallRing], spots: Mapping[str, Spot], tension: float
) -> dict[str, OnSlices]:
    """The stresses of the finer ring that may be the largest of their kind, on slices; collective.

    spots : on the finer ring;  tension : see `resolve_wall`
    """
    groups: list[tuple[Spot, list[str]]] = []
    for name in _candidates(spots, tension, CLOSE_IN_FILLET, CLOSE):
        if not any(name in names for _, names in groups):
            middle = spots[name]
            taken = [other for _, names in groups for other in names]
            held = [o for o in spots if o not in taken and _is_held(spots[o], middle, rings[0])]
            groups.append((middle, held))
    found: dict[str, OnSlices] = {}
    for level, counts in enumerate(SLICES):
        if level == len(SLICES) - 1:
            known = {name: one.spot for name, one in found.items()}
            followed = set(_candidates(known, tension, FOLLOWED, FOLLOWED))
            groups = [group for group in groups if followed & set(group[1])]
        for middle, names in groups:
            read = _read(rings[-1], counts, middle)
            coarse = _read(rings[0], counts, middle) if level == 0 else {}
            for name in names:
                if name not in read:
                    continue
                spot = replace(read[name], sector=middle.sector)
                if level == 0:
                    change = abs(spot.value - coarse[name].value) / spot.value
                    found[name] = OnSlices([], spot, change / (RING_RATIO**RING_ORDER - 1.0))
                if name in found:
                    found[name].levels.append(spot.value)
                    found[name].spot = spot
    return found


def _is_held(spot: Spot, middle: Spot, ring: WallRing) -> bool:
    """Whether a slice around `middle` resolves another stress too."""
    return spot.sector == middle.sector and bool(
        np.linalg.norm(spot.section - middle.section)
        <= HELD * _thickness(ring.problem.model, middle)
    )


def _thickness(model: DriveModel, spot: Spot) -> float:
    """Thickness (mm) of the wall at its fillet, or of closed end or flange at a spot if that is
    more; beside the fillet where the spot is not there."""
    wall = model.geometry.cup.wall
    return max(wall.thickness, wall.thickness_at(float(spot.section[0])))


def _read(ring: WallRing, counts: WallCounts, middle: Spot) -> dict[str, Spot]:
    """Largest stresses in the middle of a slice around a stress of a ring; collective."""
    model = ring.problem.model
    thickness, pitch = _thickness(model, middle), ring.grid.mesh.pitch
    beside = int(np.ceil(MARGIN * thickness / (pitch * middle.section[0])))
    count = min(max(1 + 2 * beside, FEWEST), MOST)
    mesh, distance = _slice_mesh(ring, counts, middle, REACH * thickness)
    part = ring.problem.slice(ring.displacements(), mesh, middle.sector, count)
    try:
        part.solve()
        sectors = slice(count // 2, count // 2 + 1)
        return _largest(part, _regions_read(part, distance <= READ * thickness), sectors)
    finally:
        part.destroy()


def _slice_mesh(
    ring: WallRing, counts: WallCounts, middle: Spot, reach: float
) -> tuple[SectorMesh, np.ndarray]:
    """Mesh within `reach` (mm) along the section of a stress, and distances (n_node,) mm from it"""
    model = ring.problem.model
    mesh = wall_sector(model.geometry, counts, wall_start(model.geometry, model.geometry.cup)).mesh

    def distance(points: np.ndarray) -> np.ndarray:
        section = np.column_stack([np.hypot(*points[:, :2].T), points[:, 2]])
        return np.linalg.norm(section - middle.section, axis=1)

    mesh = trimmed(mesh, distance(mesh.coords[mesh.hexes].mean(axis=1)) < reach)
    return mesh, distance(mesh.coords)


def _regions_read(part: WallProblem, near: np.ndarray) -> np.ndarray:
    """Regions (n_node,) of a slice, empty where it is not read. near : (n_node,) bool"""
    geometry, mesh = part.model.geometry, part.layout.mesh
    regions = np.full(len(near), "", dtype=object)
    nodes = np.flatnonzero(near & (mesh.coords[:, 2] >= _first_z(part.model)))
    found = regions_of(geometry, mesh, nodes, False)
    limited = ~np.isin(found, WITHOUT_LIMIT)
    regions[nodes[limited]] = found[limited]
    return regions
