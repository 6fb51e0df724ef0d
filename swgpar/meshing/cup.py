"""The cup's slice of one tooth sector: the lower rim continued to the closed end or flange."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from swgpar.geometry.arrays import Floats, Ints
from swgpar.geometry.cup_wall import decay_length
from swgpar.meshing.cross_section import CrossSection
from swgpar.meshing.drive_geometry import CupGeometry, DriveGeometry
from swgpar.meshing.recipe import CupRecipe, MeshRecipe
from swgpar.meshing.spacing import polar
from swgpar.meshing.sweep import grid_quads, sweep_line, sweep_quads, symmetric_steps

SHORTEST = 0.25
"""Mean length of the elements of the cylinder over its thickness, at least: a short wall has fewer
elements."""

ROUND_OFF = 1e-6
"""Shares of closed end or flange that are nothing."""

ACROSS_WASHERS = 2
"""Elements across the ring of the washers, at least."""

GROWTH = 1.6
"""Ratio of the lengths of successive elements behind the fillet at the back of the teeth, and from
the ends of a long cylinder to its middle, at most."""

LONG = 6.0
"""Length of a cylinder over its decay length up to which a recipe's elements share all of it.
Bending by the teeth and by the closed end decays within some decay lengths of them, however long
the wall is: a longer one has the same elements at its ends, and more of them."""


def steps_of_cylinder(length: float, recipe: CupRecipe, decay: float) -> Floats:
    """Distances (n,), mm, of the stations of a cylinder, as far as `length`; decay : length, mm."""
    usual = length * symmetric_steps(recipe.cylinder, recipe.end_ratio)
    if length <= LONG * decay:
        return usual
    longest = float(np.diff(usual).max())
    steps = [usual[1] * LONG * decay / length]
    while sum(steps) < 0.5 * length:
        steps.append(min(GROWTH * steps[-1], longest))
    half = 0.5 * length * np.cumsum([0.0, *steps]) / sum(steps)
    return np.concatenate((half, length - half[-2::-1]))


def cylinder_stations(
    length: float, recipe: CupRecipe, decay: float, fillet: float, layers: int
) -> Floats:
    """Distances (n,), mm, of the cylinder's stations from the back of the teeth as far as `length`.

    decay : length, mm, over which bending of the wall decays
    fillet : its radius, mm;  layers : elements along it, from which those behind it grow
    """
    usual = steps_of_cylinder(length, recipe, decay)
    if fillet == 0.0:
        return usual
    step = fillet / layers
    stations = list(step * np.arange(layers + 1))
    while True:
        step *= GROWTH
        behind = usual[usual > stations[-1] + 0.5 * step]
        if len(behind) < 2 or step > behind[1] - behind[0] or stations[-1] + 1.5 * step > length:
            break
        stations.append(stations[-1] + step)
    if not len(behind):
        stations[-1] = length
    return np.array([*stations, *behind])


def fillet_points(share: Floats, radius: float) -> tuple[Floats, Floats]:
    """Points of the fillet at the back of the teeth: height above the wall, distance from it, mm.

    share : (n,) of the fillet, -1 at its end on the wall, 0 in its middle, 1 at the teeth
    """
    angle = 0.25 * np.pi * (1.0 + share)
    return radius * (1.0 - np.cos(angle)), radius * (1.0 - np.sin(angle))


@dataclass(frozen=True)
class Meridian:
    """Stations of the wall in the meridian plane, from the back of the teeth to the bore or rim.

    inner, outer : (n_station, 2) mm, points (r, z) of both surfaces
    wall, end : station at which the fillet begins, and the closed end or flange
    """

    inner: Floats
    outer: Floats
    wall: int
    end: int


def meridian(cup: CupGeometry, recipe: CupRecipe, layers: int = 1) -> Meridian:
    """Return the stations of the wall.

    layers : elements along the half of the fillet at the back of the teeth that belongs to the wall

    The sizes of the cup are those of a checked design (`swgpar.checks.cup_checks`).
    """
    wall, back_fillet = cup.wall, cup.back_fillet
    length = float(wall.along(np.array([wall.length]))[0])
    elements = int(np.clip(np.ceil(length / (SHORTEST * wall.thickness)), 1, recipe.cylinder))
    recipe = recipe.model_copy(update={"cylinder": elements})
    decay = decay_length(float(wall.inner.points[0, 1]), wall.thickness)
    usual = wall.at_length(cylinder_stations(length, recipe, decay, back_fillet, layers))
    s = wall.stations(usual, usual[usual <= back_fillet * (1.0 + 1e-9)])
    angle = wall.turn_angles(recipe.fillet)[1:]
    share = symmetric_steps(recipe.closed_end, recipe.end_ratio)
    if cup.clamping_radius is not None:  # a clamped ring is not bent: one element
        free = cup.plate_length_at(np.array(cup.clamping_radius)) / cup.plate_length
        share = np.append(share * free, 1.0) if free > 0.0 else np.array([0.0, 1.0])
    elif cup.has_washers:
        share = _shares_with_washers(cup, recipe)
    ways = cup.plate_stations(cup.plate_length * share)[1:]
    return section_lines(cup, s, angle, ways)


def _shares_with_washers(cup: CupGeometry, recipe: CupRecipe) -> Floats:
    """Stations (n,) on closed end or flange, 0 at the fillet and 1 at its edge, with those at both
    edges of the washers."""
    inner, outer = sorted(cup.plate_length_at(np.array(cup.attached_ring)) / cup.plate_length)
    found = [0.0]
    for end, least in ((inner, 1), (outer, ACROSS_WASHERS), (1.0, 1)):
        length = end - found[-1]
        if length > ROUND_OFF:
            count = max(least, round(recipe.closed_end * length))
            ratio = recipe.end_ratio if len(found) == 1 else 1.0
            found += list(found[-1] + length * symmetric_steps(count, ratio)[1:])
    return np.array(found)


def section_lines(cup: CupGeometry, s: Floats, angle: Floats, ways: Floats) -> Meridian:
    """Stations of the wall's section.

    s : (n,) mm, places from the back of the teeth to the fillet
    angle : (m,) rad along the fillet, above 0
    ways : (k,) mm, from the fillet along closed end or flange, above 0
    """
    wall, back_fillet = cup.wall, cup.back_fillet
    side = -1.0 if wall.outwards else 1.0
    plate, lines = wall.plate, []
    beside = plate.outer_distance(ways)
    far = wall.off_plate(ways, plate.inner.radius(ways))
    near = wall.off_plate(beside, plate.outer.radius(beside))
    faces = (far, near) if wall.outwards else (near, far)
    for line, turn, face in zip((wall.inner, wall.outer), wall.turns, faces, strict=True):
        distance = s if line is wall.inner else wall.outer_distance(s)
        radius = line.radius(distance)
        cylinder = np.stack((radius, wall.back + distance), axis=-1)
        if line is wall.outer and back_fillet:
            on = s <= back_fillet * (1.0 + 1e-9)
            up, along = fillet_points(-s[on] / back_fillet, back_fillet)
            cylinder[on] = np.stack((radius[on] + up, wall.back + along), axis=-1)
        arms = np.stack((side * np.cos(angle), np.sin(angle)), axis=-1)
        arms *= turn.distance(angle)[:, None]
        lines.append(np.concatenate((cylinder, wall.center + arms, face)))
    return Meridian(lines[0], lines[1], len(s) - 1, len(s) - 1 + len(angle))


def depth_fractions(section: CrossSection, grid: Ints, r_inner: float, thickness: float) -> Floats:
    """Fraction (n_node,) of the wall at nodes of a `wall_grid`: 0 at its inner, 1 at its outer face

    Where the layers below the root are attached, their top follows the root and the teeth; the
    fraction then counts layers, not radius, and the outer surface is level from its first station.
    """
    fraction = np.zeros(len(section.coords))
    fraction[grid] = (np.hypot(*section.coords[grid].transpose(2, 0, 1)) - r_inner) / thickness
    rim = section.below_root[grid[:, 0]]
    interface = fraction[grid[rim]].max()
    extra = grid[~rim]
    layer = np.arange(1, len(extra) + 1)[:, None]
    fraction[extra] = interface + (1.0 - interface) * layer / max(len(extra), 1)
    return fraction


@dataclass(frozen=True)
class CupSlice:
    """Nodes and elements of the cup behind one tooth.

    coords : (n, 3) mm, of the nodes that are not those of the toothed part;  hexes : (n_elem, 8)
    cw, ccw : (n_pair,) nodes on the sides of the sector, without those of the toothed part
    bore : (n_bore,) nodes of the bore, or of the rim of the flange
    end : (n_face, 4) faces of closed end or flange, both sides, right-hand normal outwards
    """

    coords: Floats
    hexes: Ints
    cw: Ints
    ccw: Ints
    bore: Ints
    end: Ints


def wall_grid(section: CrossSection, root_too: bool) -> Ints:
    """Return the nodes (n_layer + 1, n_column + 1) of the cross-section that the cup continues.

    Rows go from the free surface outwards, columns from the clockwise to the counter-clockwise
    side. root_too : whether the layers below the root belong to it
    """
    continued = section.rim_layer | section.root_layer if root_too else section.rim_layer
    opposite = {}
    for quad in section.quads[continued].tolist():
        for k in range(4):
            opposite[quad[(k + 1) % 4], quad[k]] = quad[(k + 2) % 4], quad[(k + 3) % 4]
    rows = [section.free.tolist()]
    while (rows[-1][0], rows[-1][1]) in opposite:
        pairs = [opposite[edge] for edge in pairwise(rows[-1])]
        rows.append([pairs[0][0], *(last for _, last in pairs)])
    return np.array(rows, dtype=np.int32)


def rounded_back(drive: DriveGeometry, section: CrossSection, back: Floats) -> Floats:
    """Nodes (n_section, 3), mm, of the back of the teeth, those at the wall moved onto its fillet.

    The layer of nodes below the root that is nearest to the end of the fillet becomes its end.
    Without such a layer the fillet has a node in its middle only.
    """
    cup, thickness = drive.cup, drive.cup_thickness
    if cup.back_fillet == 0.0:
        return back
    rows = wall_grid(section, root_too=True)
    rim = len(wall_grid(section, root_too=False)) - 1  # the row of the corner
    step = drive.gears["flexible_spline"].rim - thickness
    under = len(rows) - 1 - rim
    last = under
    if cup.back_fillet < step * (1.0 - 1e-9):
        last = min(max(1, round(under * cup.back_fillet / step)), under - 1)
    # the last row of all is the surface of the root, which stays
    up, along = fillet_points(np.arange(min(last, under - 1) + 1) / max(last, 1), cup.back_fillet)
    radius = np.hypot(back[rows, 0], back[rows, 1])
    moved, z = radius.copy(), back[rows, 2]
    moved[rim : rim + len(up)] = (drive.inner_radius + thickness + up)[:, None]
    z[rim : rim + len(up)] += along[:, None]
    # in the rim in proportion to the distance from inside
    inside = (radius[:rim] - drive.inner_radius) / thickness
    moved[:rim] += inside * up[0]
    z[:rim] += inside * along[0]
    new = back.copy()
    new[rows, :2] *= (moved / radius)[..., None]
    new[rows, 2] = z
    return new


def joined_columns(n_column: int) -> list[int]:
    """Numbers of columns that become one: threes, and in the middle single ones left over."""
    threes, rest = divmod(n_column // 2, 3)
    return [*[3] * threes, *[1] * (2 * rest), *[3] * threes]


def transition(below: Ints, above: Ints, between: Ints, groups: list[int]) -> Ints:
    """Return the hexahedra (n, 8) between a station with all columns and one with joined columns.

    below : (n_layer + 1, n_column + 1) nodes;  above : (n_layer + 1, n_group + 1) nodes
    between : (n_layer + 1, 2 * n_three) nodes, two for every three columns that become one
    groups : numbers of columns that become one
    """
    quads, column, inside = [], 0, 0
    for k, width in enumerate(groups):
        low, left, right = below[:, column : column + width + 1].T, above[:, k], above[:, k + 1]
        if width == 1:
            quads.append((low[0], low[1], right, left))
        else:
            first, second = between[:, inside], between[:, inside + 1]
            quads += [
                (low[0], low[1], first, left),
                (low[1], low[2], second, first),
                (low[2], low[3], right, second),
                (first, second, right, left),
            ]
            inside += 2
        column += width
    # (n_layer + 1, n_quad, 4), counter-clockwise seen from outside
    faces = np.array(quads).transpose(2, 0, 1)
    return np.concatenate((faces[:-1], faces[1:]), axis=-1).reshape(-1, 8).astype(np.int32)


def last_full_station(lines: Meridian, recipe: CupRecipe, module: float) -> int:
    """Station behind which columns are joined: of the cylinder, a pitch or more behind the teeth if
    there is one. The last one where none are joined."""
    if not recipe.joined_columns:
        return len(lines.inner) - 1
    z = lines.inner[: lines.wall, 1]
    behind = np.flatnonzero(z - z[0] >= np.pi * module)
    return int(behind[0]) if len(behind) else len(z) - 1


def cup_slice(
    drive: DriveGeometry, recipe: MeshRecipe, section: CrossSection, back: Ints, first: int
) -> CupSlice:
    """Return the cup beyond the back of the teeth.

    back : (n_section,) nodes at the back of the teeth;  first : number that the first new node gets
    """
    grid = wall_grid(section, drive.cup.continues_root)
    lines = meridian(drive.cup, recipe.cup, recipe.flexible_spline.under)
    inner, outer = lines.inner, lines.outer
    fraction = depth_fractions(section, grid, drive.inner_radius, drive.cup_thickness)
    angle = np.arctan2(*section.coords.T)
    if recipe.cup.joined_columns:
        angle[grid] = angle[grid[0]]  # radial columns, below the root too
    coords: list[Floats] = []

    def new_nodes(rz_inner: Floats, rz_outer: Floats, columns: Ints) -> Ints:
        """Numbers (n_station, n) of nodes between points (n_station, 2) of both surfaces."""
        rz = rz_inner[:, None] + fraction[columns, None] * (rz_outer - rz_inner)[:, None]
        points = np.concatenate((polar(rz[..., 0], angle[columns]), rz[..., 1:]), axis=-1)
        number = first + sum(map(len, coords)) + np.arange(rz[..., 0].size, dtype=np.int32)
        coords.append(points.reshape(-1, 3))
        return number.reshape(rz.shape[:2])

    number = np.full((len(inner), len(section.coords)), -1, dtype=np.int32)
    number[0] = back
    columns = np.unique(grid)
    last = last_full_station(lines, recipe.cup, drive.module)
    full, joined = slice(1, last + 1), slice(last + 1, None)
    number[full, columns] = new_nodes(inner[full], outer[full], columns)
    continued = np.isin(section.quads, grid).all(axis=1)
    hexes = [sweep_quads(section.quads[continued], number[: last + 1])]
    if recipe.cup.joined_columns:
        groups = joined_columns(grid.shape[1] - 1)
        ends = np.concatenate(([0], np.cumsum(groups)))
        coarse, dropped = grid[:, ends], np.delete(grid, ends, axis=1)
        # as far from the joined columns as a column is wide, where the elements are long
        length = inner[last + 1, 1] - inner[last, 1]
        pitch = 2.0 * np.pi * drive.inner_radius / drive.gears["flexible_spline"].profile.n_teeth
        share = 1.0 - min(0.5, pitch / (grid.shape[1] - 1) / length)
        on_inner, on_outer = (
            line[[last]] + share * (line[[last + 1]] - line[[last]]) for line in (inner, outer)
        )
        between = new_nodes(on_inner, on_outer, dropped.ravel()).reshape(dropped.shape)
        kept = np.unique(coarse)
        number[joined, kept] = new_nodes(inner[joined], outer[joined], kept)
        hexes.append(transition(number[last][grid], number[last + 1][coarse], between, groups))
        hexes.append(sweep_quads(np.roll(grid_quads(coarse), 1, axis=1), number[joined]))
        grid = coarse
    edge = section.edge[np.isin(section.edge, columns)]
    at_end = number[lines.end :]
    end = [sweep_line(grid[0], at_end), sweep_line(grid[-1][::-1], at_end)]
    return CupSlice(
        coords=np.concatenate(coords),
        hexes=np.concatenate(hexes),
        cw=number[1:, edge].ravel(),
        ccw=number[1:, section.mirror[edge]].ravel(),
        bore=np.sort(number[-1][number[-1] >= 0]),
        end=np.concatenate(end),
    )
