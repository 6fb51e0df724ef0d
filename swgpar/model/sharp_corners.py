r"""Concave edges of a body without a radius: where they are, and how far their stress reaches.

At a corner whose faces enclose the angle $\omega > \pi$ of material the stress grows as
$r^{\lambda - 1}$ with the distance $r$, where $\lambda$ is the smallest positive root of
$\lambda \sin\omega + \sin\lambda\omega = 0$ [Williams, Journal of Applied Mechanics 19 (1952),
526-528]. It has no limit: every finer mesh shows more of it. Convex corners have no such stress.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swgpar.geometry.arrays import Floats
from swgpar.geometry.bracketed_root import root_between
from swgpar.geometry.paired_lines import PairedLines
from swgpar.meshing.drive_geometry import CupGeometry, DriveGeometry
from swgpar.profiles import ToothProfile

RIGHT = 0.5 * np.pi
"""Angle (rad) by which the surface turns at a right corner."""

REACH = 0.5
"""Distance from a right corner over the size beside it as far as which its stress reaches: it is
raised by 37 % there, $2^{1 - \\lambda}$, if it is not at one size."""

FELT = np.radians(7.0)
"""Angle (rad) below which a corner counts as none: its stress reaches over 1 % of the size, less
than elements average over."""


@dataclass(frozen=True)
class SharpCorner:
    """A corner of the section of a body, all around: of the wall at a radius and z, of a tooth at
    x and y.

    at : (2,) mm;  reach : mm, as far as which its stress reaches
    of_tooth : whether `at` is x and y, of the tooth at +y and on both of its sides
    """

    at: tuple[float, float]
    reach: float
    of_tooth: bool = False

    def distance(self, points: Floats) -> Floats:
        """Distances (n,) mm of points (n, 3) mm of a sector."""
        x, y, z = points.T
        first, second = (np.abs(x), y) if self.of_tooth else (np.hypot(x, y), z)
        return np.hypot(first - self.at[0], second - self.at[1])

    def near(self, points: Floats) -> NDArray[np.bool_]:
        """Whether its stress reaches points (n, 3) mm of a sector, (n,)."""
        return self.distance(points) <= self.reach

    @property
    def text(self) -> str:
        """Words for it."""
        if self.of_tooth:
            return f"the corner of the tooth at radius {np.hypot(*self.at):.2f} mm"
        return f"the corner at radius {self.at[0]:.2f}, z {self.at[1]:.2f} mm"


def singular_exponent(turn: float) -> float:
    """The exponent lambda of displacements at a corner at which the surface turns by an angle (rad)
    between 0 and pi: 0.5445 at a right one, 0.5 at a crack."""
    omega = np.pi + turn
    return root_between(lambda x: x * np.sin(omega) + np.sin(x * omega), 0.5, 1.0)


def reach_of(turn: float, size: float) -> float:
    """Distance (mm) as far as which the stress of a corner reaches; 0 where it counts as none.

    There it is raised as much as that of a right corner at `REACH`.

    turn : rad, by which the surface turns towards the material;  size : mm, of what is beside it
    """
    if turn < FELT:
        return 0.0
    weaker = (1.0 - singular_exponent(RIGHT)) / (1.0 - singular_exponent(turn))
    return size * float(REACH**weaker)


def sharp_corners(geometry: DriveGeometry, body: str) -> tuple[SharpCorner, ...]:
    """Those of a body, but for the corner behind the teeth, whose sides the regions tell apart."""
    gear = geometry.gears[body]
    found = list(_of_tooth(gear.profile, gear.rim))
    if gear.profile.external and geometry.cup is not None:
        found += _of_wall(geometry.cup)
    return tuple(corner for corner in found if corner.reach > 0.0)


def _of_wall(cup: CupGeometry) -> Iterator[SharpCorner]:
    """Of both surfaces of wall and of closed end or flange, and in front of the corner behind the
    teeth."""
    wall = cup.wall
    if cup.back_fillet == 0.0:
        first, second = wall.outer.points[:2]
        slope = float(np.arctan2(second[1] - first[1], second[0] - first[0]))
        thickness = float(first[1] - wall.inner.points[0, 1])
        yield SharpCorner((float(first[1]), wall.back), reach_of(RIGHT + slope, thickness))
    for (distance, radius), reach in _of_lines(wall, fillet=-1):
        yield SharpCorner((radius, wall.back + distance), reach)
    for (way, height), reach in _of_lines(wall.plate, fillet=0):
        radius, z = wall.off_plate(np.array([way]), np.array([height]))[0].tolist()
        yield SharpCorner((radius, z), reach)


def _of_lines(lines: PairedLines, fillet: int) -> Iterator[tuple[list[float], float]]:
    """Points (mm) of both lines that nothing rounds, and how far (mm) their stress reaches.

    fillet : which of them are at the fillet, where lines go on level: 0 or -1
    """
    across = np.linalg.norm(lines.outer.points - lines.inner.points, axis=1)
    for line, outwards in ((lines.inner, -1.0), (lines.outer, 1.0)):
        along, up = np.diff(line.points, axis=0)[fillet]
        turn = float(np.arctan2(up, along)) * (1.0 if fillet == 0 else -1.0)
        size = float(min(across[fillet], np.hypot(along, up)))
        yield line.points[fillet].tolist(), reach_of(outwards * turn, size)
        for k, turn in enumerate(line.turning(), 1):
            if line.rounding[k] == 0.0:
                beside = np.linalg.norm(np.diff(line.points[k - 1 : k + 2], axis=0), axis=1)
                reach = reach_of(outwards * float(turn), float(min(across[k], *beside)))
                yield line.points[k].tolist(), reach


def _of_tooth(profile: ToothProfile, rim: float) -> Iterator[SharpCorner]:
    """Where segments of the flank join with an angle, and where the root meets its circle."""
    end = complex(*profile.tangent(profile.length)[0])
    along = np.exp(-1j * profile.polar_angle(profile.length)[0])
    kinks = profile.sign * np.append(profile.kinks, np.angle(along / end))
    lengths = np.diff(profile.breaks)
    sizes = np.minimum(lengths, np.append(lengths[1:], np.inf)).clip(max=rim)
    for s, kink, size in zip(profile.breaks[1:], kinks, sizes, strict=True):
        x, y = profile.point(s)[0]
        reach = reach_of(float(kink), float(size))
        yield SharpCorner((float(x), float(y)), reach, of_tooth=True)
