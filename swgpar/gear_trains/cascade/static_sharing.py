"""Load sharing at rest: rigid gears with gaps, flexible units, the flywheel fixed.

Every mesh can push but not pull. With the flywheel fixed, the energy of the flexible units has its
minimum where each unit is twisted by the displacement of the rack less all gaps on its own path to
the flywheel. The path of an odd pinion leads over its G1, G2, G3 and G4, that of an even one over
the G1 of its odd neighbour as well. A mesh on several paths closes as soon as one of them carries
load, and none can open it again. So the over-determined contact needs no search, and a pinion
carries nothing until its own path is closed. (The source moves
the gears in small steps instead and finds the contacts by rules.)
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from swgpar.gear_trains.cascade.design import MESH_COUNTS, PINIONS, CascadeDesign, Direction
from swgpar.gear_trains.cascade.flex_unit import FlexUnits


def even_pinion_mask() -> np.ndarray:
    """(8,) bool"""
    return np.arange(PINIONS) % 2 == 1


def path_gap_angles(
    design: CascadeDesign, direction: Direction, errors: dict[str, np.ndarray] | None = None
) -> np.ndarray:
    """Twist of the pinions that the gaps on their paths take, rad, (..., 8).

    errors : by kind of mesh (..., number of its meshes), m; they add to the gaps at the pitch line
    """
    gaps = {}
    for kind, count in MESH_COUNTS.items():
        nominal = getattr(design, kind).gaps(direction, count)
        gaps[kind] = nominal + (errors[kind] if errors else 0.0)
    pinion = np.arange(PINIONS)
    pair, side = pinion // 2, pinion // 4
    g1, per_g2 = design.radius("g1"), design.g2.teeth / design.g1.teeth
    twist = gaps["rack_pinion"] / design.radius("pinion")
    twist = twist + np.where(even_pinion_mask(), gaps["g1_g1"][..., pair], 0.0) / g1
    twist = twist + gaps["g1_g2"][..., pair] / g1
    return twist + gaps["g3_g4"][..., side] / design.radius("g3") * per_g2


@dataclass(frozen=True)
class StaticSharing:
    """Pinion forces at given rack forces.

    units : the flexible units;  radius : of the pinions, m;  gaps : (..., 8) of `path_gap_angles`
    """

    units: FlexUnits
    radius: float
    gaps: np.ndarray

    def forces(self, travel: np.ndarray) -> np.ndarray:
        """Pinion forces (..., 8) in N at the rack's travel (...) in m."""
        twist = np.maximum(travel[..., None] / self.radius - self.gaps, 0.0)
        return self.units.ratios * self.units.torque(twist) / self.radius

    def travel(self, force: np.ndarray | float) -> np.ndarray:
        """Travel of the rack in m at rack forces in N, by bisection to the last digit."""
        force = np.asarray(force, dtype=float)
        # the softest unit, behind the largest gap, would be twisted by no more than that
        softest = min(self.units.stiffness, self.units.initial) * self.units.ratios.sum()
        low = self.radius * self.gaps.min(axis=-1) + np.zeros_like(force)
        high = self.radius * (self.gaps.max(axis=-1) + force * self.radius / softest)
        for _ in range(60):
            middle = 0.5 * (low + high)
            above = self.forces(middle).sum(axis=-1) > force
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        return 0.5 * (low + high)

    def gaps_of(self, carried: np.ndarray) -> np.ndarray:
        """Differences of the gaps (8,) in rad with which the pinions carry forces (8,) in N; the
        smallest is 0. A pinion without force has at least the gap that it gets."""
        twist = self.units.twist(carried * self.radius / self.units.ratios)
        return twist.max() - twist

    def shares(self, force: np.ndarray | float) -> np.ndarray:
        """Load shares (..., 8) at rack forces in N (eq. 8); they sum to one."""
        carried = self.forces(self.travel(force))
        return carried / carried.sum(axis=-1, keepdims=True)


def lateral_force(design: CascadeDesign, carried: np.ndarray) -> np.ndarray:
    """Force (...) across the rack in N of pinion forces (..., 8) in N, from the odd pinions on its
    one side to the even ones on the other: the radial forces of both do not cancel out."""
    even = even_pinion_mask()
    along = carried[..., ~even].sum(axis=-1) - carried[..., even].sum(axis=-1)
    return along * np.tan(np.radians(design.tolerances.pressure_angle))


def static_sharing(
    design: CascadeDesign,
    direction: Direction,
    *,
    errors: dict[str, np.ndarray] | None = None,
    equal_units: bool = False,
) -> StaticSharing:
    """The static model of a design; with `equal_units` without the units' stiffness ratios."""
    units = FlexUnits.of(design)
    if equal_units:
        units = FlexUnits(units.stiffness, units.initial, units.end, np.ones(PINIONS))
    return StaticSharing(units, design.radius("pinion"), path_gap_angles(design, direction, errors))


def first_share_crossing(sharing: StaticSharing, highest: float) -> float:
    """Lowest rack force in N at which shares of two pinions cross; NaN for none below `highest`.

    sharing : of one gearbox, gaps (8,)
    """
    force = np.linspace(0.0, highest, 4001)[1:]
    share = sharing.shares(force)
    crossed = []
    for i, j in combinations(range(PINIONS), 2):
        difference = share[:, i] - share[:, j]
        both = (share[:-1, i] > 0.0) & (share[:-1, j] > 0.0)
        for k in np.flatnonzero((difference[:-1] * difference[1:] < 0.0) & both)[:1]:
            slope = (difference[k + 1] - difference[k]) / (force[k + 1] - force[k])
            crossed.append(force[k] - difference[k] / slope)
    return float(min(crossed, default=np.nan))
