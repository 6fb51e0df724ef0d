"""Stiffness of pairs of teeth by plane finite elements and line contact.

Each gear is a tooth on a part of its rim, in plane strain, held at the depth and at the sides of
this part. The contact itself is that of two cylinders: between the flank and the middle of the
tooth the displacement is the closed form of a half-space (C. Weber, K. Banaschek, Formänderung und
Profilrücknahme bei gerad- und schrägverzahnten Rädern, Vieweg 1953), below it that of the elements.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy

from swgpar.gear_trains.planetary_stage.tooth_meshes.pairs import GearMesh, ToothedGear
from swgpar.kernel import reference_elements

ACROSS, ALONG, DEEP, ASIDE = 16, 24, 16, 16
"""Elements across and along the tooth, in the depth of the rim, and beside the tooth."""

FILLET, DEPTH, SIDES = 0.38, 4.0, 3.0
"""Radius of the fillet and depth of the rim in modules; pitches of rim on each side."""

POSITIONS = 48
"""Places of a pair on the path of contact."""


@dataclass(frozen=True)
class PairStiffness:
    """Of a unit of width, MPa.

    single : largest stiffness of a pair (c');  mean : of the mesh in a tooth cycle (c_gamma)
    variation : amplitude of the rectangular wave over the mean
    """

    single: float
    mean: float
    variation: float


@dataclass(frozen=True)
class TipRelief:
    """Linear relief of the tips of both gears. depth : at the tip, mm along the line of action

    length : of the path of contact from its end, in base pitches
    """

    depth: float = 0.0
    length: float = 0.2

    def gap(self, mesh: GearMesh, place: np.ndarray) -> np.ndarray:
        """Between the unloaded flanks (mm) at places on the path of contact."""
        (begin, end), length = mesh.path, self.length * mesh.base_pitch
        into = np.maximum(place - (end - length), 0.0) + np.maximum(begin + length - place, 0.0)
        return self.depth * into / length


@lru_cache(maxsize=64)
def pair_stiffness(
    mesh: GearMesh, load: float, E: float, nu: float, relief: TipRelief = TipRelief()
) -> PairStiffness:
    """Stiffness along the line of action under a load (N/mm) on the mesh; E in MPa. With relief it
    is the load over the approach of the gears."""
    begin, end = mesh.path
    place = np.linspace(begin, end, POSITIONS)
    flexibility = _contact_flexibility(mesh, place, load, E, nu)
    for gear, beyond in ((mesh.driving, place), (mesh.driven, -place)):
        flexibility += Tooth(gear, E, nu).flexibility(beyond)
    pairs, pitch = 1.0 / flexibility, mesh.base_pitch
    first = np.linspace(begin, begin + pitch, 4 * POSITIONS, endpoint=False)
    sums = load / approach(mesh, place, pairs, relief, load, first)
    both = first + pitch <= end
    if relief.depth:
        mean = float(sums.mean())
    else:  # each pair goes along the whole path in its time of contact
        mean = float(0.5 * (pairs[1:] + pairs[:-1]) @ np.diff(place)) / pitch
    height = sums[both].mean() - sums[~both].mean() if both.any() and not both.all() else 0.0
    return PairStiffness(float(pairs.max()), mean, float(0.5 * height / mean))


def approach(
    mesh: GearMesh,
    place: np.ndarray,
    pairs: np.ndarray,
    relief: TipRelief,
    load: float,
    first: np.ndarray,
) -> np.ndarray:
    """Approach (n,) in mm of the gears under a load, when the first pair is at places (n,) and the
    second one a base pitch behind the first; a pair carries once the approach closes its gap.

    pairs : stiffness of a pair at the places on the path
    """
    at = np.stack([first, first + mesh.base_pitch])
    stiff = np.interp(at, place, pairs)
    stiff[at > mesh.path[1]] = 0.0
    gap = relief.gap(mesh, at)
    alone = np.where(stiff > 0.0, gap + load / np.where(stiff > 0.0, stiff, 1.0), np.inf)
    shared = (load + (stiff * gap).sum(axis=0)) / stiff.sum(axis=0)
    carries = (shared > gap) & (stiff > 0.0)
    return np.where(carries.all(axis=0), shared, alone.min(axis=0))


def _depths(gear: ToothedGear, beyond: np.ndarray) -> np.ndarray:
    """From the flank to the middle of the tooth along the line of action."""
    radius, angle = _flank(gear, beyond)
    across = radius * np.sin(half_angle(gear, radius))
    turned = half_angle(gear, radius)
    direction = np.cos(angle) * np.cos(turned) + gear.sign * np.sin(angle) * np.sin(turned)
    return across / direction


def _flank(gear: ToothedGear, beyond: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Radius and pressure angle of places on the path of contact, from the pitch point towards the
    tip of the gear."""
    curvature = gear.pitch_radius * np.sin(gear.angle) + gear.sign * beyond
    return np.hypot(gear.base_radius, curvature), np.arctan2(curvature, gear.base_radius)


def _contact_flexibility(
    mesh: GearMesh, place: np.ndarray, load: float, E: float, nu: float
) -> np.ndarray:
    """Approach of the flanks to the middles of both teeth over the load, mm/(N/mm)."""
    curvature = np.zeros_like(place)
    for gear, beyond in ((mesh.driving, place), (mesh.driven, -place)):
        radius = gear.pitch_radius * np.sin(gear.angle) + gear.sign * beyond
        curvature += gear.sign / np.maximum(radius, 1e-3 * gear.module)
    plane = (1.0 - nu**2) / E
    half_width = np.sqrt(8.0 * load * plane / (np.pi * np.abs(curvature)))
    total = np.zeros_like(place)
    for gear, beyond in ((mesh.driving, place), (mesh.driven, -place)):
        depth = _depths(gear, beyond)
        total += np.log(2.0 * depth / half_width) - 0.5 * nu / (1.0 - nu)
    return 2.0 * plane / np.pi * total


def half_angle(gear: ToothedGear, radius: np.ndarray) -> np.ndarray:
    """Half of the angle of the tooth at radii; radial below the base circle, with a fillet."""
    inside = np.arccos(np.minimum(gear.base_radius / radius, 1.0))
    turn = np.tan(inside) - inside - np.tan(gear.angle) + gear.angle
    flank = 0.5 * gear.tooth_angle - gear.sign * turn
    fillet = FILLET * gear.module
    above = np.clip(gear.sign * (radius - gear.root_radius), 0.0, fillet)
    rounded = fillet - np.sqrt(fillet**2 - (fillet - above) ** 2)
    return np.minimum(flank + rounded / radius, np.pi / abs(gear.teeth))


class Tooth:
    """A tooth on its rim; the middle of the tooth is on the x axis."""

    def __init__(self, gear: ToothedGear, E: float, nu: float) -> None:
        self.gear = gear
        rows, depth = ALONG + 1, -gear.sign * DEPTH * gear.module
        bent = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, rows)))
        self.radii = gear.root_radius + (gear.tip_radius - gear.root_radius) * bent
        below = gear.root_radius + depth * np.linspace(0.0, 1.0, DEEP + 1)[1:] ** 1.5
        part = np.linspace(-1.0, 1.0, ACROSS + 1)
        base = half_angle(gear, self.radii[:1])[0]
        side = 2.0 * np.pi / abs(gear.teeth) * SIDES
        away = base + (side - base) * np.linspace(0.0, 1.0, ASIDE + 1)[1:] ** 1.5
        around = np.concatenate([-away[::-1], base * part, away])
        angles = half_angle(gear, self.radii)[1:, None] * part
        tooth = self.radii[1:, None] * np.exp(1j * angles)
        rim = np.concatenate([self.radii[:1], below])[:, None] * np.exp(1j * around)
        nodes = np.concatenate([rim.ravel(), tooth.ravel()])
        self.coords = np.stack([nodes.real, nodes.imag, 0.0 * nodes.real], axis=1)
        of_rim = np.arange(rim.size).reshape(rim.shape)
        own = np.arange(tooth.size).reshape(tooth.shape) + rim.size
        whole = np.vstack([of_rim[0, ASIDE : ASIDE + ACROSS + 1], own])
        elements = np.concatenate([_quads(of_rim), _quads(whole)])
        corner = self.coords[elements]
        one, two = corner[:, 1] - corner[:, 0], corner[:, 3] - corner[:, 0]
        clockwise = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0] < 0.0
        elements[clockwise] = elements[clockwise][:, ::-1]
        held = np.concatenate([of_rim[-1], of_rim[:, 0], of_rim[:, -1]])
        self.solve = _factor(self.coords, elements, held, E, nu)
        self.flank_nodes = whole[:, -1]
        self.middle_nodes = np.concatenate(
            [of_rim[:0:-1, ASIDE + ACROSS // 2], whole[:, ACROSS // 2]]
        )

    def flexibility(self, beyond: np.ndarray) -> np.ndarray:
        """Displacement of the middle of the tooth along the line of action per load on the flank,
        mm/(N/mm), at places from the pitch point towards the tip."""
        gear, (radius, angle) = self.gear, _flank(self.gear, beyond)
        turned = half_angle(gear, radius)
        out, around = np.exp(1j * turned), 1j * np.exp(1j * turned)
        normal = -np.cos(angle) * around - gear.sign * np.sin(angle) * out
        middle = (radius * out + _depths(gear, beyond) * normal).real
        forces = np.zeros((len(self.coords), 2, len(beyond)))
        self._spread(forces, self.flank_nodes, self.radii, radius, normal)
        moved = self.solve(forces.reshape(-1, len(beyond))).reshape(forces.shape)
        at, places = self.coords[self.middle_nodes, 0], self.middle_nodes
        order = np.argsort(at)
        found = np.empty(len(beyond))
        for k, x in enumerate(middle):
            u = [np.interp(x, at[order], moved[places[order], i, k]) for i in (0, 1)]
            found[k] = u[0] * normal[k].real + u[1] * normal[k].imag
        return found

    def _spread(
        self,
        forces: np.ndarray,
        nodes: np.ndarray,
        radii: np.ndarray,
        radius: np.ndarray,
        normal: np.ndarray,
    ) -> None:
        """Put unit loads between two nodes of the flank."""
        order = np.argsort(radii)
        sorted_radii, sorted_nodes = radii[order], nodes[order]
        upper = np.clip(np.searchsorted(sorted_radii, radius), 1, len(radii) - 1)
        low, high = sorted_radii[upper - 1], sorted_radii[upper]
        weight = np.clip((radius - low) / (high - low), 0.0, 1.0)
        for k in range(len(radius)):
            for node, part in ((upper[k] - 1, 1.0 - weight[k]), (upper[k], weight[k])):
                forces[sorted_nodes[node], :, k] += part * np.array(
                    [normal[k].real, normal[k].imag]
                )


def _quads(grid: np.ndarray) -> np.ndarray:
    corners = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    return np.stack([corner.ravel() for corner in corners], axis=1)


def _factor(
    coords: np.ndarray, elements: np.ndarray, held: np.ndarray, E: float, nu: float
) -> Callable[[np.ndarray], np.ndarray]:
    """Solver of displacements (2 nodes, loads) for forces likewise, in plane strain."""
    direct = E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
    across, shear = direct * nu / (1.0 - nu), 0.5 * E / (1.0 + nu)
    law = np.array([[direct, across, 0.0], [across, direct, 0.0], [0.0, 0.0, shear]])
    in_plane = (3 * np.arange(4)[:, None] + np.arange(2)).ravel()
    matrices = reference_elements(coords[elements], law, 1.0).stiffness
    matrices = matrices[:, in_plane][:, :, in_plane]
    of = (2 * elements[:, :, None] + np.arange(2)).reshape(len(elements), 8)
    rows, columns = np.repeat(of, 8, axis=1).ravel(), np.tile(of, 8).ravel()
    size = 2 * len(coords)
    stiffness = scipy.sparse.csc_matrix((matrices.ravel(), (rows, columns)), shape=(size, size))
    fixed = np.zeros(len(coords), dtype=bool)
    fixed[held] = True
    free = np.flatnonzero(~np.repeat(fixed, 2))
    factor = scipy.sparse.linalg.splu(stiffness[free][:, free])

    def solve(forces: np.ndarray) -> np.ndarray:
        moved = np.zeros_like(forces)
        moved[free] = factor.solve(np.ascontiguousarray(forces[free]))
        return moved

    return solve
