"""Linear problems of elasticity with known answers: mesh, supports, load, and the numbers that are
compared.

Every problem takes a level, which doubles the elements in each direction, and whether it is meshed
by quadrilaterals. Sources: MacNeal and Harder, Finite Elements in Analysis and Design 1 (1985), for
the beams; Roark's Formulas for Stress and Strain for the ring; Lamé for the cylinder; Cook (1974)
for the membrane.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from mpi4py import MPI

from support.contact_blocks import block
from support.element_mesh import ElementMesh
from swgpar.materials import Isotropic, Material
from swgpar.petsc import PETSc
from swgpar.solve.linear_solver import MatrixKind
from swgpar.solve.linear_solvers import make_linear_solver

GAMG_RTOL = 1e-9
"""Residual at which GAMG's iteration ends: far below the errors of all meshes."""

Measure = Callable[[ElementMesh, np.ndarray], dict[str, float]]


@dataclass(frozen=True)
class Linear:
    """A meshed problem.

    points (n, 3), elements (m, 8) or (m, 4), thickness of quadrilaterals
    fixed (n, 3) : components that are held;  load (n, 3) : forces
    measure : of mesh and displacement, the numbers that are compared;  exact : their closed forms,
    where there are any
    """

    points: np.ndarray
    elements: np.ndarray
    material: Material
    fixed: np.ndarray
    load: np.ndarray
    measure: Measure
    exact: dict[str, float] = field(default_factory=dict)
    thickness: float = 1.0

    @property
    def unknowns(self) -> int:
        """Of the mesh, two per node in the plane."""
        return (3 if self.elements.shape[1] == 8 else 2) * len(self.points)

    def solve(self, incompatible: bool = True, linear: str = "direct") -> dict[str, float]:
        """The numbers that are compared, with MUMPS ("direct") or GAMG ("iterative") as `swgpar
        run` sets them up."""
        mesh = ElementMesh(self.points, self.elements, self.material, self.thickness, incompatible)
        return self.measure(mesh, solve(mesh, self.fixed, self.load, linear))


def solve(mesh: ElementMesh, fixed: np.ndarray, load: np.ndarray, linear: str) -> np.ndarray:
    """Linear displacement (n, 3) under `load` (n, 3); `fixed` components stay where they are."""
    dims = 3 if mesh.m == 8 else 2
    values = mesh.blocks(np.zeros_like(load))[:, :dims, :dims]
    free = ~fixed[:, :dims]
    row = np.repeat(np.arange(len(free)), np.diff(mesh.start))
    diagonal = row == mesh.column
    scale = np.abs(values[diagonal]).max()
    values = values * (free[row][:, :, None] & free[mesh.column][:, None, :])
    values[diagonal] += scale * (~free)[:, :, None] * np.eye(dims)
    upper = mesh.column >= row
    start = np.searchsorted(row[upper], np.arange(len(free) + 1))
    csr = [v.astype(PETSc.IntType) for v in (start, mesh.column[upper])]
    size = (dims * len(free), dims * len(free))
    matrix = PETSc.Mat().createSBAIJ(
        size, dims, csr=(*csr, np.ascontiguousarray(values[upper])), comm=PETSc.COMM_SELF
    )
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    if linear == "iterative":
        PETSc.Options("element_")["ksp_rtol"] = GAMG_RTOL
    kind = MatrixKind(MPI.COMM_SELF, mesh.points[:, :dims], symmetric=True)
    solver = make_linear_solver(linear, kind, "element_")
    solver.prepare(matrix, np.arange(len(free)))
    answer = solver.solve(np.where(free, load[:, :dims], 0.0).ravel())
    if solver.failure:
        raise ArithmeticError(solver.failure)
    solver.destroy()
    u = np.zeros_like(load)
    u[:, :dims] = answer.reshape(-1, dims)
    return u


def grid(x: np.ndarray, y: np.ndarray, z: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Points and hexahedra between lines of coordinates; without z quadrilaterals."""
    if z is not None:
        return block(x, y, z)[:2]
    points = np.stack([*np.meshgrid(x, y, indexing="ij"), np.zeros((len(x), len(y)))], axis=-1)
    number = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    quads = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
    return points.reshape(-1, 3), np.stack([q.ravel() for q in quads], axis=1)


def beam(shape: str, level: int, plane: bool) -> Linear:
    """Straight beam 6 x 0.2 x 0.1 under a unit force in its plane at the tip.

    The shape is that of the six coarsest elements, slanted by 45 degrees; finer ones divide them.
    """
    k = 2**level
    lines = (
        np.linspace(0.0, 6.0, 6 * k + 1),
        np.linspace(0.0, 0.2, k + 1),
        np.linspace(0.0, 0.1, k + 1),
    )
    box, elements = grid(*lines[:2], None if plane else lines[2])
    x, y = box[:, 0], box[:, 1]
    sign = {
        "regular": 0.0,
        "parallelogram": 1.0,
        "trapezoid": np.interp(x, range(7), (-1.0) ** np.arange(7)),
    }[shape]
    points = box.copy()
    points[:, 0] += (
        np.interp(x, [0.0, 1.0, 5.0, 6.0], [0.0, 1.0, 1.0, 0.0]) * sign * (y - 0.1)
    )  # the ends stay upright
    return cantilever(box, points, elements, 1, Isotropic(E=1e7, nu=0.3), 0.1)


def cantilever(
    box: np.ndarray,
    points: np.ndarray,
    elements: np.ndarray,
    axis: int,
    material: Material,
    thickness: float,
) -> Linear:
    """A beam clamped at x = 0, with a unit force along `axis` on its other end: mean displacement
    there.

    box, points : (n, 3) nodes of the straight beam and of the beam itself
    """
    fixed = np.repeat((box[:, 0] < 1e-9)[:, None], 3, axis=1)
    tip = box[:, 0] > box[:, 0].max() - 1e-9
    share, load = consistent(box[tip][:, 1:]), np.zeros_like(points)
    load[tip, axis] = share
    return Linear(
        points,
        elements,
        material,
        fixed,
        load,
        lambda mesh, u: {"displacement": float(share @ u[tip, axis])},
        thickness=thickness,
    )


def consistent(points: np.ndarray) -> np.ndarray:
    """Shares of a uniform load on a rectangle (or a line) of nodes (n, 2) of a regular grid."""
    share = np.ones(len(points))
    for column in points.T:
        if np.ptp(column) > 0.0:
            share *= np.where(
                (column < column.min() + 1e-9) | (column > column.max() - 1e-9), 0.5, 1.0
            )
    return share / share.sum()


def arc(
    angles: np.ndarray, radii: np.ndarray, plane: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """A quarter of a ring, of unit width, from the y axis to the x axis: points, elements, angles
    and radii of points.

    With the supports of both planes of symmetry, and of the side z = 0 of hexahedra.
    """
    flat, elements = grid(angles, radii, None if plane else np.array([0.0, 1.0]))
    angle, radius = flat[:, 0], flat[:, 1]
    points = np.column_stack([radius * np.sin(angle), radius * np.cos(angle), flat[:, 2]])
    fixed = np.zeros(points.shape, dtype=bool)
    fixed[angle < 1e-9, 0] = fixed[angle > 0.5 * np.pi - 1e-9, 1] = True
    fixed[points[:, 2] < 1e-9, 2] = True
    return points, elements, fixed, flat


def pinched_ring(level: int, plane: bool) -> Linear:
    """Quarter of a thin ring, R = 58, t = 1, pinched by two unit forces: shortening of the
    diameter.

    P R^3 / (E I) (k1 pi / 4 - 2 k2^2 / pi) with k1 = 1 - alpha + beta, k2 = 1 - alpha (Roark's
    Formulas for Stress and Strain, ring under two opposite forces): alpha = I / (A R^2) from the
    curvature and the normal force, beta = alpha E / G times 6/5 from shear; nu = 0.
    """
    n, radius, young = 8 * 2**level, 58.0, 210e3
    lines = np.linspace(0.0, 0.5 * np.pi, n + 1), radius + np.linspace(-0.5, 0.5, 2**level + 1)
    points, elements, fixed, flat = arc(*lines, plane)
    top, load = flat[:, 0] < 1e-9, np.zeros_like(points)
    share = consistent(flat[top, 1:])
    load[top, 1] = 0.5 * share
    alpha = 1.0 / (12.0 * radius**2)
    beta = 1.2 * 2.0 * alpha
    exact = (
        radius**3
        / (young / 12.0)
        * ((1.0 - alpha + beta) * np.pi / 4.0 - 2.0 * (1.0 - alpha) ** 2 / np.pi)
    )

    def measure(mesh: ElementMesh, u: np.ndarray) -> dict[str, float]:
        return {"displacement": 2.0 * float(share @ u[top, 1])}

    return Linear(
        points, elements, Isotropic(E=young, nu=0.0), fixed, load, measure, {"displacement": exact}
    )


def thick_cylinder(poisson: float, level: int, plane: bool) -> Linear:
    """Quarter of a cylinder, radii 3 and 9, under unit pressure inside: displacement and hoop
    stress there (Lamé).

    Hexahedra in plane strain, quadrilaterals in plane stress.
    """
    k = 2**level
    a = 3.0
    b = 9.0
    young = 1000.0
    points, elements, fixed, flat = arc(
        np.linspace(0.0, 0.5 * np.pi, 3 * k + 1), np.linspace(a, b, 5 * k + 1), plane
    )
    fixed[:, 2] = True
    inner = np.flatnonzero(flat[:, 1] < a + 1e-9)
    angle, step = flat[inner, 0], 0.5 * np.pi / (3 * k)
    share = np.where((angle < 1e-9) | (angle > 0.5 * np.pi - 1e-9), 0.5, 1.0) * (
        1.0 if plane else 0.5
    )
    normal = np.column_stack([np.sin(angle), np.cos(angle)])
    load = np.zeros_like(points)
    load[inner, :2] = a * np.sin(step) * share[:, None] * normal  # on the chords of the elements
    load[fixed] = 0.0
    factor = a / (b**2 - a**2) / young
    if plane:
        moved = factor * ((1.0 - poisson) * a**2 + (1.0 + poisson) * b**2)
    else:
        moved = factor * (1.0 + poisson) * ((1.0 - 2.0 * poisson) * a**2 + b**2)
    exact = {"displacement": moved, "hoop stress": (a**2 + b**2) / (b**2 - a**2)}

    def measure(mesh: ElementMesh, u: np.ndarray) -> dict[str, float]:
        top = inner[angle < 1e-9]  # on the y axis, where the hoop stress acts along x
        hoop = mesh.stress(u)[..., 0][np.isin(mesh.elements, top)].mean()
        return {
            "displacement": float((u[inner, :2] * normal).sum(axis=1).mean()),
            "hoop stress": float(hoop),
        }

    return Linear(points, elements, Isotropic(E=young, nu=poisson), fixed, load, measure, exact)


def cook(level: int, plane: bool) -> Linear:
    """Cook's membrane, E = 1, nu = 1/3, in plane stress: deflection of the tip's middle under a
    unit force."""
    k = 2 * 2**level
    flat, elements = grid(np.linspace(0.0, 1.0, k + 1), np.linspace(0.0, 1.0, k + 1), None)
    s, t = flat[:, 0], flat[:, 1]
    points = np.column_stack([48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s), 0.0 * s])
    tip = s > 1.0 - 1e-9
    load = np.zeros_like(points)
    load[tip, 1] = consistent(flat[tip, 1:])
    middle = int(np.flatnonzero(tip & (np.abs(t - 0.5) < 1e-9))[0])
    fixed = np.repeat((s < 1e-9)[:, None], 3, axis=1)

    def measure(mesh: ElementMesh, u: np.ndarray) -> dict[str, float]:
        return {"displacement": float(u[middle, 1])}

    return Linear(points, elements, Isotropic(E=1.0, nu=1.0 / 3.0), fixed, load, measure)


def twisted_beam(level: int, plane: bool) -> Linear:
    """Beam 12 x 1.1 x 0.32 twisted by a right angle, unit force along its width at the tip."""
    k = 2**level
    lines = (
        np.linspace(0.0, 12.0, 12 * k + 1),
        np.linspace(0.0, 1.1, 2 * k + 1),
        np.linspace(0.0, 0.32, k + 1),
    )
    box, hexes = grid(*lines)
    x, y, z = box[:, 0], box[:, 1] - 0.55, box[:, 2] - 0.16
    c, s = np.cos(0.5 * np.pi * x / 12.0), np.sin(0.5 * np.pi * x / 12.0)
    return cantilever(
        box,
        np.column_stack([x, c * y - s * z, s * y + c * z]),
        hexes,
        2,
        Isotropic(E=29e6, nu=0.22),
        1.0,
    )


ELEMENTS = {
    "C3D8I": (False, True),
    "C3D8": (False, False),
    "CPS4I": (True, True),
    "CPS4": (True, False),
}
"""In the plane, with incompatible modes; by the names of Abaqus and CalculiX."""


@dataclass(frozen=True)
class Problem:
    """make : of level and plane;  plane, solid : numbers of levels;  like : the problem whose limit
    this one shares

    rates : in the element size, of the elements with incompatible modes, where theory gives them
    for a smooth solution: 2 for displacements, 1 for stresses on a boundary
    """

    make: Callable[[int, bool], Linear]
    plane: int
    solid: int
    like: str | None = None
    rates: dict[str, float] = field(default_factory=dict)


SMOOTH = {"displacement": 2.0, "hoop stress": 1.0}
PROBLEMS = {
    "beam, regular": Problem(partial(beam, "regular"), 8, 5),
    "beam, parallelogram": Problem(partial(beam, "parallelogram"), 7, 5, "beam, regular"),
    "beam, trapezoid": Problem(partial(beam, "trapezoid"), 7, 5, "beam, regular"),
    "pinched thin ring": Problem(pinched_ring, 6, 5, rates={"displacement": 2.0}),
    "thick cylinder, nu = 0.3": Problem(partial(thick_cylinder, 0.3), 7, 5, rates=SMOOTH),
    "thick cylinder, nu = 0.499": Problem(partial(thick_cylinder, 0.499), 0, 5, rates=SMOOTH),
    "Cook's membrane": Problem(cook, 9, 0),
    "twisted beam": Problem(twisted_beam, 0, 4),
}
ITERATIVE = {
    ("thick cylinder, nu = 0.3", "C3D8I"): 5,
    ("twisted beam", "C3D8I"): 4,
    ("Cook's membrane", "CPS4I"): 8,
}
"""Problems and elements that are solved with GAMG too, with the number of levels."""
