"""The wall of the cup behind the teeth as a sector of its own: fine along its section, coarse
around.

The wall is a body of revolution. Its mesh does not continue that of the teeth: elements are graded
along the section towards the fillet and the edges of the flat part, and through the thickness
towards both surfaces.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from swgpar.geometry.arrays import Floats, Ints
from swgpar.geometry.cup_wall import CupWall, decay_length
from swgpar.geometry.paired_lines import PairedLines, thicknesses
from swgpar.meshing.cup import Meridian, section_lines
from swgpar.meshing.drive_geometry import CupGeometry, DriveGeometry
from swgpar.meshing.quality import element_quality
from swgpar.meshing.sector import SectorMesh
from swgpar.meshing.spacing import polar
from swgpar.meshing.sweep import grid_quads, sweep_quads, symmetric_steps

GROWTH = 1.35
"""Ratio of the lengths of successive elements along the section."""

LONGEST = 0.35
"""Length of the longest elements along the section over the decay length: a disturbance of the
wall's edge decays by e within about 0.8 of that."""

LAYER_RATIO = 2.0
"""Thickness of the layers in the middle of the wall over that of the outermost."""

AROUND = 90
"""Fewest elements around the whole wall. 200 instead of 100 change the stress in the fillet of a
silk hat by 0.15 % (docs/verification/largest_stress.md)."""


CLOSE = 0.25
"""Share of an element within which stations become one."""

SAMPLES = 101
"""Places between two fixed stations at which the length of the elements is known."""

ROUND_OFF = 1e-9
"""Elements along an arc that are none."""

PER_WASHER = 3
"""Fewest elements around on the width of a washer."""


@dataclass(frozen=True)
class WallCounts:
    """Elements of the wall.

    fillet : along its fillet;  layers : through its thickness
    longest : length of the longest along the section over the thickness; None for `LONGEST`
    around : factor on the elements around a wall on bolts, which bends from bolt to bolt
    """

    fillet: int
    layers: int
    longest: float | None = None
    around: float = 1.0

    def limit(self, radius: float, thickness: float) -> float:
        """Length (mm) of the longest elements where the wall has a radius and a thickness (mm)."""
        if self.longest is None:
            return LONGEST * decay_length(radius, thickness)
        return self.longest * thickness


def graded_line(length: float, first: float, last: float, longest: float) -> Floats:
    """Distances (n,) mm from 0 to `length`. Steps grow by `GROWTH` from `first` and `last` (mm) at
    the ends to at most `longest`."""
    steps, ends = [min(first, longest), min(last, longest)], ([0.0], [length])
    while ends[1][-1] - ends[0][-1] > sum(steps):
        side = int(steps[1] < steps[0])
        ends[side].append(ends[side][-1] + (steps[0], -steps[1])[side])
        steps[side] = min(GROWTH * steps[side], longest)
    gap = ends[1][-1] - ends[0][-1]
    if gap > 0.7 * sum(steps):
        ends[0].append(ends[0][-1] + gap * steps[0] / sum(steps))
    return np.array([*ends[0], *ends[1][::-1]])


def plate_ways(cup: CupGeometry, counts: WallCounts, first: float) -> Floats:
    """Ways (n,) mm from the fillet of the stations on closed end or flange, without that at 0.

    first : mm, length of the element at the fillet and at the edges of what is attached
    """
    wall, (begin, _) = cup.wall, cup.wall.center
    thinnest = min(thicknesses(wall.plate_points))
    width, longest = cup.plate_length, counts.limit(begin, thinnest)
    if cup.has_washers:
        along = _with_washers(cup, first, longest)
        return refined(wall.plate, cup.plate_stations(along), cup.ring_ways, counts)[1:]
    free = width
    if cup.clamping_radius is not None:
        free = float(cup.plate_length_at(np.array(cup.clamping_radius)))
    last = 0.5 * wall.plate.thickness if cup.clamping_radius is None else first
    along = graded_line(free, first, last, longest) if free > first else np.array([0.0, free])
    if free < width:
        along = np.append(along, free + graded_line(width - free, first, longest, longest)[1:])
    return refined(wall.plate, cup.plate_stations(along), cup.ring_ways, counts)[1:]


def refined(lines: PairedLines, usual: Floats, fixed: Floats, counts: WallCounts) -> Floats:
    """Places (n,) mm of stations on lines whose arcs have as many elements, for their angle, as the
    fillet; the others grow away from them.

    usual : (m,) mm, stations without that;  fixed : (k,) mm, those that stay beside corners
    """
    corners, arcs = lines.corners(), lines.arcs()
    if not arcs.size:
        return usual
    known = lines.along(usual)
    (begin, end), angle = lines.along(arcs[:, :2]).T, arcs[:, 2]
    step = (end - begin) / np.ceil(counts.fillet * angle / (0.5 * np.pi) - ROUND_OFF)
    places = np.concatenate([usual[[0, -1]], corners[corners > usual[0]], fixed])
    marks = np.unique(lines.along(places))
    for at, near in zip(np.append(begin, end), np.tile(step, 2), strict=True):
        if at > known[0] and np.abs(marks - at).min() > CLOSE * near:
            marks = np.sort(np.append(marks, at))
    stations = [marks[0]]
    for low, high in pairwise(marks):
        way = np.linspace(low, high, SAMPLES)
        beyond = np.maximum(np.maximum(begin - way[:, None], way[:, None] - end), 0.0)
        size = np.column_stack([_spacing(known, way), step + (GROWTH - 1.0) * beyond]).min(axis=1)
        number = scipy.integrate.cumulative_trapezoid(1.0 / size, way, initial=0.0)
        count = max(1, int(np.ceil(number[-1] - CLOSE)))
        stations += np.interp(np.arange(1, count + 1) * number[-1] / count, number, way).tolist()
    return lines.at_length(np.array(stations))


def _spacing(stations: Floats, at: Floats) -> Floats:
    """Lengths (n,) mm of the elements between stations in which places (n,) mm are."""
    k = np.clip(np.searchsorted(stations, at, side="right") - 1, 0, len(stations) - 2)
    lengths: Floats = np.diff(stations)[k]
    return lengths


def _with_washers(cup: CupGeometry, first: float, longest: float) -> Floats:
    """Distances (n,) mm of stations from the fillet, with those of both edges of the washers.

    first : mm, length of elements at fillet and washers;  longest : mm, of any
    """
    wall, width = cup.wall, cup.plate_length
    near, far = sorted(cup.plate_length_at(np.array(cup.attached_ring)))
    across = 0.5 * (far - near)
    along = np.zeros(1)
    for end, last, limit in (
        (near, first, longest),
        (far, first, min(longest, across)),
        (width, 0.5 * wall.plate.thickness, longest),
    ):
        length = end - along[-1]
        if length > 0.1 * first:  # washers may begin at the fillet, or end at the edge
            part = graded_line(length, min(first, length), min(last, length), limit)
            along = np.append(along, along[-1] + part[1:])
    return along


def _columns(geometry: DriveGeometry, counts: WallCounts) -> int:
    """Elements around in a sector."""
    cup, teeth = geometry.cup, geometry.gears["flexible_spline"].profile.n_teeth
    if not cup.has_washers:
        return -(-AROUND // teeth)
    low, high = cup.attached_ring
    around = max(AROUND, PER_WASHER * np.pi * (low + high) / (high - low))
    return int(np.ceil(counts.around * np.ceil(around / teeth)))


def graded_section(geometry: DriveGeometry, counts: WallCounts, start: float) -> Meridian:
    """Stations of the wall, graded towards the fillet and the edges of the flat part.

    start : mm, distance from the back of the teeth at which it begins
    """
    wall: CupWall = geometry.cup.wall
    arc = 0.5 * np.pi * wall.arm / counts.fillet
    longest = counts.limit(geometry.inner_radius, wall.thickness)
    first, length = wall.along(np.array([start, wall.length]))
    usual = wall.at_length(length - graded_line(length - first, arc, longest, longest)[::-1])
    usual[0] = start
    angle = wall.turn_angles(counts.fillet)[1:]
    stations = wall.stations(usual, usual[usual <= start])
    return section_lines(
        geometry.cup,
        refined(wall, stations, stations[:1], counts),
        angle,
        plate_ways(geometry.cup, counts, arc),
    )


def section_parameters(cup: CupGeometry, points: Floats) -> tuple[Floats, Floats]:
    """Distance (n,) mm along the section, in the fillet along its middle, and depth (n,) over the
    thickness, 0 inside, of points (n, 3) mm of the wall."""
    wall = cup.wall
    r, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
    r_center, z_center = wall.center
    x, y = np.abs(r - r_center), np.maximum(z - z_center, 0.0)
    along, depth = wall.parameters(r, z - wall.back)
    flat = wall.is_on_plate(r, z)
    way, height = wall.on_plate(r[flat], z[flat])
    way, of_far = wall.plate.parameters(height, way)
    depth[flat] = of_far if wall.outwards else 1.0 - of_far
    along[flat] = wall.length + 0.5 * np.pi * wall.arm + way
    turn = (z > z_center) & ~flat
    angle = np.arctan2(y[turn], x[turn])
    begin, end = (line.distance(angle) for line in wall.turns)
    depth[turn] = (np.hypot(x[turn], y[turn]) - begin) / (end - begin)
    along[turn] = wall.length + wall.arm * angle
    return along, depth


@dataclass(frozen=True)
class WallSector:
    """Sector of the wall.

    mesh : in it the node set ``cut`` has the nodes of the first station
    cup : whose wall it is;  number : (n_station, n_layer + 1, n_column + 1) nodes
    pieces : first stations of fillet and flat part
    """

    mesh: SectorMesh
    cup: CupGeometry
    number: Ints
    pieces: tuple[int, int]

    def interpolate(self, field: Floats, points: Floats) -> Floats:
        """Nodal values (n_sector, n_node, 3) of sectors at points (n, 3) mm: cubic along the
        section in each of its three pieces, linear through the thickness and around."""
        along, depth = section_parameters(self.cup, points)
        coords = self.mesh.coords
        stations, _ = section_parameters(self.cup, coords[self.number[:, 0, 0]])
        _, layers = section_parameters(self.cup, coords[self.number[0, :, 0]])
        columns = np.arctan2(*coords[self.number[0, 0]][:, :2].T)
        angle = np.arctan2(points[:, 0], points[:, 1])
        ends = (0, *self.pieces, len(stations) - 1)
        values = np.empty((len(field), len(points), len(layers), len(columns), 3))
        limits = stations[list(self.pieces)]
        of_piece = np.searchsorted(limits, along)
        for piece in range(3):
            knots, on = slice(ends[piece], ends[piece + 1] + 1), of_piece == piece
            if on.any():
                along_knots = field[:, self.number[knots]]
                spline = scipy.interpolate.CubicSpline(stations[knots], along_knots, axis=1)
                values[:, on] = spline(along[on])
        through = _linear(values, layers, depth)
        return _linear(through, columns, angle)


def _linear(values: Floats, grid: Floats, at: Floats) -> Floats:
    """Values (m, n, k, …) on a grid (k,), interpolated to points (n,) of it."""
    k = np.clip(np.searchsorted(grid, at, side="right") - 1, 0, len(grid) - 2)
    rows = np.arange(len(at))
    share = ((at - grid[k]) / (grid[k + 1] - grid[k])).reshape(-1, *[1] * (values.ndim - 3))
    low, high = values[:, rows, k], values[:, rows, k + 1]
    found: Floats = low + share * (high - low)
    return found


def wall_sector(geometry: DriveGeometry, counts: WallCounts, start: float) -> WallSector:
    """Sector of the wall of a cup drive, as wide as a tooth.

    start : mm, distance from the back of the teeth at which it begins
    """
    profile = geometry.gears["flexible_spline"].profile
    lines = graded_section(geometry, counts, start)
    fraction = symmetric_steps(counts.layers, LAYER_RATIO)[:, None]
    section = lines.inner[:, None] + fraction * (lines.outer - lines.inner)[:, None]
    half, columns = np.pi / profile.n_teeth, _columns(geometry, counts)
    angle = np.linspace(-half, half, columns + 1)
    radius, z = (
        np.repeat(part[..., None], columns + 1, axis=2) for part in np.moveaxis(section, -1, 0)
    )
    points = np.concatenate([polar(radius, angle), z[..., None]], axis=-1).reshape(-1, 3)
    number = np.arange(z.size, dtype=np.int32).reshape(z.shape)
    hexes = _swept(number)
    mesh = SectorMesh(
        body="flexible_spline",
        n_sectors=profile.n_teeth,
        phase=0.0,
        coords=points,
        hexes=hexes,
        ccw_nodes=number[..., 0].ravel(),
        cw_nodes=number[..., -1].ravel(),
        faces={"end": _end_faces(number[lines.end :])},
        node_sets={"bore": number[-1].ravel(), "cut": number[0].ravel()},
        flanks=(),
        profile=profile,
        quality=element_quality(points, hexes),
    )
    return WallSector(mesh, geometry.cup, number, (lines.wall, lines.end))


def _swept(number: Ints) -> Ints:
    """Hexahedra (n, 8) of nodes by station, layer and column."""
    stations = number.reshape(len(number), -1)
    quads = grid_quads(np.arange(stations.shape[1]).reshape(number.shape[1:]))
    quads = np.roll(quads[:, ::-1], 1, axis=1)
    return sweep_quads(quads, stations)


def _end_faces(number: Ints) -> Ints:
    """Faces (n, 4) of closed end or flange on the inner line, and on the outer one."""
    inner, outer = grid_quads(number[:, 0]), grid_quads(number[:, -1])
    return np.concatenate((inner[:, ::-1], outer))
