"""Problems of elasticity with known answers for the two elements: mesh, supports, load, and the error of one number.

Every problem takes a level, which doubles the elements in each direction, and returns the mesh's unknowns, the computed
and the exact value. Sources: MacNeal and Harder, Finite Elements in Analysis and Design 1 (1985), for beams;
Timoshenko, Strength of Materials, for the ring; Lamé for the cylinder; Cook (1974) for the membrane, with the converged
value of 23.965 for nu = 1/3 that the literature agrees on.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))
from contact_blocks import block  # noqa: E402
from element_mesh import ElementMesh  # noqa: E402

SMALL = 1e-6
"""Load factor: displacements so small that the answer is the linear one."""


@dataclass(frozen=True)
class Solved:
    """unknowns : of the mesh;  value, exact : the number that is compared"""

    unknowns: int
    value: float
    exact: float

    @property
    def error(self) -> float:
        """Relative."""
        return abs(self.value / self.exact - 1.0)


def grid(counts: tuple[int, int, int], size: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Points and hexahedra of a regular box."""
    points, hexes, _ = block(*(np.linspace(0.0, s, n + 1) for n, s in zip(counts, size)))
    return points, hexes


def beam(shape: str, level: int) -> Solved:
    """Straight beam 6 x 0.2 x 0.1 under a force in its plane at the tip; the shape is that of the coarsest elements."""
    k = 2**level
    points, hexes = grid((6 * k, k, k), (6.0, 0.2, 0.1))
    x, y = points[:, 0].copy(), points[:, 1]
    sign = {
        "regular": 0.0 * x,
        "parallelogram": 1.0 + 0.0 * x,
        "trapezoid": np.interp(x, range(7), (-1.0) ** np.arange(7)),
    }
    ends = np.interp(x, [0.0, 1.0, 5.0, 6.0], [0.0, 1.0, 1.0, 0.0])  # the ends stay upright
    points[:, 0] = x + ends * sign[shape] * (y - 0.1)
    return cantilever(points, points, hexes, 1, (1e7, 0.3), 0.1081)


def cantilever(
    box: np.ndarray, points: np.ndarray, hexes: np.ndarray, axis: int, elastic: tuple[float, float], exact: float
) -> Solved:
    """A beam clamped at x = 0, with a unit force along `axis` on its other end: mean displacement there.

    box, points : (n, 3) nodes of the straight beam and of the beam itself
    """
    fixed = np.repeat((box[:, 0] < 1e-9)[:, None], 3, axis=1)
    tip = box[:, 0] > box[:, 0].max() - 1e-9
    load = np.zeros_like(points)
    load[tip, axis] = SMALL * consistent(box[tip][:, 1:])
    u = ElementMesh(points, hexes, *elastic).solve(fixed, np.zeros_like(points), load)
    return Solved(points.size, float(u[tip, axis].mean()) / SMALL, exact)


def consistent(points: np.ndarray) -> np.ndarray:
    """Shares of a uniform load on a rectangle of nodes (n, 2) of a regular grid."""
    share = np.ones(len(points))
    for column in points.T:
        share *= np.where((column < column.min() + 1e-9) | (column > column.max() - 1e-9), 0.5, 1.0)
    return share / share.sum()


def pinched_ring(level: int) -> Solved:
    """Quarter of a thin ring, R = 58, t = 1, pinched by two forces: shortening of the diameter, Timoshenko with shear.

    With (t / R)^2 terms: P R^3 / (E I) (pi / 4 - 2 / pi) plus normal and shear deformation, nu = 0, shear factor 6/5.
    """
    n, radius, young, force = 8 * 2**level, 58.0, 210e3, 1e-3
    points, hexes, _ = block(
        np.linspace(0, np.pi / 2, n + 1), np.linspace(-0.5, 0.5, 2**level + 1), np.array([0.0, 1.0])
    )
    angle, r = points[:, 0].copy(), radius + points[:, 1]
    points = np.column_stack([r * np.sin(angle), r * np.cos(angle), points[:, 2]])
    top, side = angle < 1e-9, angle > np.pi / 2 - 1e-9
    fixed = np.zeros(points.shape, dtype=bool)
    fixed[top, 0] = fixed[side, 1] = True
    fixed[:, 2] |= points[:, 2] < 1e-9
    load = np.zeros_like(points)
    load[top, 1] = 0.5 * force * consistent(np.column_stack([r[top], points[top, 2]]))
    u = ElementMesh(points, hexes, young, 0.0).solve(fixed, np.zeros_like(points), load)
    inertia, area = 1.0 / 12.0, 1.0
    bending = force * radius**3 / (young * inertia) * (np.pi / 4.0 - 2.0 / np.pi)
    stretch = force * radius / (young * area) * np.pi / 4.0 * (1.0 + 1.2 * 2.0)
    return Solved(points.size, 2.0 * float(u[top, 1].mean()), bending + stretch)


def thick_cylinder(poisson: float, level: int) -> Solved:
    """Quarter of a cylinder, radii 3 and 9, under inner pressure in plane strain: displacement inside (Lamé)."""
    k, a, b, young = 2**level, 3.0, 9.0, 1000.0
    points, hexes, _ = block(np.linspace(0, np.pi / 2, 3 * k + 1), np.linspace(a, b, 5 * k + 1), np.array([0.0, 1.0]))
    angle, r = points[:, 0].copy(), points[:, 1].copy()
    points = np.column_stack([r * np.sin(angle), r * np.cos(angle), points[:, 2]])
    fixed = np.zeros(points.shape, dtype=bool)
    fixed[:, 2] = True
    fixed[angle < 1e-9, 0] = fixed[angle > np.pi / 2 - 1e-9, 1] = True
    inner = np.flatnonzero(r < a + 1e-9)
    share = np.where((angle[inner] < 1e-9) | (angle[inner] > np.pi / 2 - 1e-9), 0.5, 1.0)
    step, load = np.pi / 2 / (3 * k), np.zeros_like(points)
    normal = np.column_stack([np.sin(angle[inner]), np.cos(angle[inner])])
    load[inner, :2] = SMALL * 2.0 * a * np.tan(step / 2.0) * 0.5 * share[:, None] * normal
    u = ElementMesh(points, hexes, young, poisson).solve(fixed, np.zeros_like(points), load)
    exact = (1.0 + poisson) / young * a / (b**2 - a**2) * ((1.0 - 2.0 * poisson) * a**2 + b**2)
    return Solved(points.size, float((u[inner, :2] * normal).sum(axis=1).mean()) / SMALL, exact)


def cook(level: int) -> Solved:
    """Cook's membrane in plane stress, quadrilaterals: deflection of the tip's middle."""
    k = 2 * 2**level
    s, t = np.meshgrid(np.linspace(0, 1, k + 1), np.linspace(0, 1, k + 1), indexing="ij")
    points = np.stack([48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s), 0.0 * s], axis=-1).reshape(-1, 3)
    number = np.arange(s.size).reshape(s.shape)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    fixed = np.repeat((points[:, 0] < 1e-9)[:, None], 3, axis=1)
    load = np.zeros_like(points)
    share = np.ones(k + 1)
    share[[0, -1]] = 0.5
    load[number[-1], 1] = SMALL * share / k
    u = ElementMesh(points, quads, 1.0, 1.0 / 3.0, 1.0).solve(fixed, np.zeros_like(points), load)
    return Solved(2 * len(points), float(u[number[-1, k // 2], 1]) / SMALL, 23.965)


def twisted_beam(level: int) -> Solved:
    """Beam 12 x 1.1 x 0.32 twisted by a right angle, force along its width at the tip."""
    k = 2**level
    points, hexes = grid((12 * k, 2 * k, k), (12.0, 1.1, 0.32))
    x, y, z = points[:, 0].copy(), points[:, 1] - 0.55, points[:, 2] - 0.16
    c, s = np.cos(0.5 * np.pi * x / 12.0), np.sin(0.5 * np.pi * x / 12.0)
    turned = np.column_stack([x, c * y - s * z, s * y + c * z])
    return cantilever(points, turned, hexes, 2, (29e6, 0.22), 0.005424)


PROBLEMS: dict[str, tuple[Callable[[int], Solved], int, float | None]] = {
    "beam, regular": (lambda level: beam("regular", level), 4, None),
    "beam, parallelogram": (lambda level: beam("parallelogram", level), 4, None),
    "beam, trapezoid": (lambda level: beam("trapezoid", level), 4, None),
    "pinched thin ring": (pinched_ring, 5, 2.0),
    "thick cylinder, nu = 0.3": (lambda level: thick_cylinder(0.3, level), 5, 2.0),
    "thick cylinder, nu = 0.499": (lambda level: thick_cylinder(0.499, level), 5, 2.0),
    "Cook's membrane": (cook, 6, None),
    "twisted beam": (twisted_beam, 3, None),
}
"""Problem, number of levels, and the rate in h that theory gives where it gives one."""
