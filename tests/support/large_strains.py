"""Blocks, beams and rings at large strains: isotropic laws with the same E and nu at small ones,
and the exact equilibrium of bending and of expansion under each of them.

A law is an energy of the principal stretches, in plane stress. Pure bending of a beam to an arc
[Rivlin, Proc. R. Soc. A 195 (1949)] and expansion of a ring depend on one coordinate alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root
from scipy.sparse.linalg import spsolve

from support.element_mesh import ElementMesh
from support.element_problems import arc, grid
from swgpar.materials import Isotropic

EXACT = {"rtol": 1e-9, "atol": 1e-11}
"""Of the integration over the depth."""

YOUNG = 30.0
"""MPa: of a soft TPU. All results are relative to it."""


def biot(stretch: np.ndarray, shear: float, lame: float) -> np.ndarray:
    """Linear in stretches: the law of the elements, in a homogeneous state."""
    return 2.0 * shear * (stretch - 1.0) + lame * (stretch - 1.0).sum()


def hencky(stretch: np.ndarray, shear: float, lame: float) -> np.ndarray:
    """Linear in true strains: Hooke's law between Kirchhoff stress and logarithms of stretches."""
    strain = np.log(stretch)
    return (2.0 * shear * strain + lame * strain.sum()) / stretch


def neo_hookean(stretch: np.ndarray, shear: float, lame: float) -> np.ndarray:
    """Rubber: mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)²."""
    return shear * (stretch - 1.0 / stretch) + lame * np.log(stretch).sum() / stretch


def saint_venant(stretch: np.ndarray, shear: float, lame: float) -> np.ndarray:
    """Linear in Green's strains."""
    strain = 0.5 * (stretch**2 - 1.0)
    return (2.0 * shear * strain + lame * strain.sum()) * stretch


LAWS = {
    "Hencky": hencky,
    "neo-Hookean": neo_hookean,
    "Saint Venant-Kirchhoff": saint_venant,
}
"""The others, which agree with that of the elements at small strains."""

Law = Callable[[np.ndarray, float, float], np.ndarray]


@dataclass(frozen=True)
class PlaneLaw:
    """Nominal stresses (MPa) by two principal stretches, free of stress along the third.

    law : nominal stresses (3,) by stretches (3,), shear modulus and Lamé's constant
    """

    law: Law
    poisson: float

    def _stresses(self, stretch: np.ndarray) -> np.ndarray:
        shear = 0.5 * YOUNG / (1.0 + self.poisson)
        return self.law(stretch, shear, 2.0 * shear * self.poisson / (1.0 - 2.0 * self.poisson))

    def uniaxial(self, strain: float) -> float:
        """Nominal stress of a bar, free on its sides."""

        def across(side: float) -> float:
            return float(self._stresses(np.array([1.0 + strain, side, side]))[1])

        side = brentq(across, 0.7, 1.4, xtol=1e-14)
        return float(self._stresses(np.array([1.0 + strain, side, side]))[0])

    def hoop(self, hoop: float, radial_stress: float) -> tuple[float, float]:
        """Radial stretch and nominal hoop stress by the hoop stretch and the nominal radial
        stress."""

        def residual(free: np.ndarray) -> np.ndarray:
            found = self._stresses(np.array([hoop, *np.exp(free)]))
            return (found[1:] - [radial_stress, 0.0]) / YOUNG

        free = np.exp(root(residual, [0.0, 0.0], tol=1e-13).x)
        return float(free[0]), float(self._stresses(np.array([hoop, *free]))[0])

    def bending(self, curvature: float) -> tuple[float, float]:
        """Moment (N mm per mm of width) of a beam 1 mm deep that is bent to this curvature (1/mm of
        undeformed length), and nominal stress of its outer fibre (MPa)."""

        def run(inner: float) -> tuple[float, float, float]:
            def slope(_: float, y: np.ndarray) -> list[float]:
                stretch, hoop = self.hoop(y[0] * curvature, y[1])
                return [stretch, hoop * curvature, hoop * y[0]]

            start = [inner, 0.0, 0.0]
            radius, stress, moment = solve_ivp(slope, (0.0, 1.0), start, **EXACT).y[:, -1]
            return stress, moment, self.hoop(radius * curvature, stress)[1]

        thin = 1.0 / curvature - 0.5
        inner = brentq(lambda r: run(r)[0], thin - 0.2, thin + 0.2, xtol=1e-10)
        return run(inner)[1:]

    def expansion(self, inside: float, outside: float, strain: float) -> float:
        """Mean nominal hoop stress (MPa) of a ring whose inner radius grows by `strain`.

        inside, outside : mm
        """

        def mean(radial: float) -> tuple[float, float]:
            def slope(at: float, y: np.ndarray) -> list[float]:
                stretch, hoop = self.hoop(y[0] / at, y[1])
                return [stretch, (hoop - y[1]) / at, hoop]

            start = [inside * (1.0 + strain), radial, 0.0]
            end = solve_ivp(slope, (inside, outside), start, **EXACT).y[:, -1]
            return float(end[1]), float(end[2] / (outside - inside))

        inner = brentq(lambda p: mean(p)[0], -YOUNG * strain, 0.0, xtol=1e-9)
        return mean(inner)[1]


def bent_beam(strain: float, poisson: float, deep: int, plane: bool) -> tuple[float, float]:
    """Moment (N mm per mm of width) and nominal stress of the outer fibre (MPa) of elements.

    The beam, 1 mm deep, is bent to a quarter of a circle: a thin one would have `strain` in its
    outer fibre. deep : elements over the depth, which are as long as deep, and as wide
    """
    radius, length, width = 0.5 / strain, 0.25 * np.pi / strain, 1.0 / deep
    along = np.linspace(0.0, length, max(round(length * deep), 4) + 1)
    across = np.linspace(-0.5, 0.5, deep + 1)
    points, elements = grid(along, across, None if plane else np.array([0.0, width]))
    mesh = ElementMesh(points, elements, _soft(poisson), width)
    start, end = points[:, 0] < 1e-9, points[:, 0] > length - 1e-9
    turn, out = points[:, 0] / radius, radius + points[:, 1]
    u = np.column_stack([out * np.sin(turn), out * np.cos(turn), points[:, 2]]) - points
    fixed = np.zeros(points.shape, dtype=bool)
    fixed[start, 0] = fixed[end, 1] = True
    fixed[points[:, 2] < 1e-9, 2] = True
    u = equilibrium(mesh, fixed, u)
    moment = -mesh.residual(u)[start, 0] @ (points + u)[start, 1]
    top = np.isin(elements, np.flatnonzero(start & (points[:, 1] > 0.5 - 1e-9)))
    return float(moment) / width, float(mesh.stress(u)[..., 0][top].mean())


def pressed_ring(strain: float, poisson: float, deep: int, plane: bool) -> float:
    """Mean hoop stress (MPa) of elements of a ring of radii 10 and 11 mm, whose inner radius grows
    by `strain`. deep : elements over its depth"""
    angles, radii = np.linspace(0.0, 0.5 * np.pi, 16 * deep + 1), np.linspace(10.0, 11.0, deep + 1)
    points, elements, fixed, flat = arc(angles, radii, plane)
    inner, mesh = flat[:, 1] < 10.0 + 1e-9, ElementMesh(points, elements, _soft(poisson))
    fixed[inner, :2] = True
    u = equilibrium(mesh, fixed, points * [strain, strain, 0.0])
    return -float(mesh.residual(u)[flat[:, 0] < 1e-9, 0].sum())


def stretched_bar(strain: float, poisson: float, plane: bool) -> float:
    """Nominal stress (MPa) of elements of a bar, free on its sides."""
    line = np.linspace(0.0, 1.0, 3)
    points, elements = grid(line, line, None if plane else line)
    mesh, fixed = ElementMesh(points, elements, _soft(poisson)), points < 1e-9
    end = points[:, 0] > 1.0 - 1e-9
    fixed[end, 0] = True
    u = equilibrium(mesh, fixed, points * [strain, 0.0, 0.0])
    return float(mesh.residual(u)[end, 0].sum())


def least_stiffness(strain: float, poisson: float, plane: bool) -> float:
    """Least eigenvalue of the tangent of a stretched block of 4 elements along each edge, over that
    without a strain: below 0 the elements, or the law, are unstable."""
    line = np.linspace(0.0, 1.0, 5)
    points, elements = grid(line, line, None if plane else line)
    mesh, fixed = ElementMesh(points, elements, _soft(poisson)), points < 1e-9
    fixed[points[:, 0] > 1.0 - 1e-9, 0] = True
    fixed[:, 2] |= plane
    free = np.flatnonzero(~fixed.ravel())

    def least(along: float) -> float:
        u = points * [along, -poisson * along, 0.0 if plane else -poisson * along]
        tangent = mesh.tangent(u)[free][:, free].toarray()
        return float(np.linalg.eigvalsh(tangent)[0])

    return least(strain) / least(0.0)


def _soft(poisson: float) -> Isotropic:
    return Isotropic(E=YOUNG, nu=poisson)


def equilibrium(mesh: ElementMesh, fixed: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Displacement (n, 3) without loads on free components, by Newton's method from u (n, 3)."""
    held = fixed.copy()
    held[:, 2] |= mesh.m == 4
    free = np.flatnonzero(~held.ravel())
    for _ in range(30):
        u = u.copy()
        step = spsolve(mesh.tangent(u)[free][:, free].tocsc(), -mesh.residual(u).ravel()[free])
        u.ravel()[free] += step
        if np.abs(step).max() < 1e-10:
            return u
    raise ArithmeticError("no equilibrium after 30 steps")
