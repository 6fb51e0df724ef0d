"""Curved-beam element of a thin ring with exact static shape functions, and rings of it.

Displacements of the centre line at the angle a: u outward, w counter-clockwise, and the rotation r
= (w - u') / R of its cross-section. The energy is that of Flügge's thin ring,

    U = 1/2 ∫ (E A e² + E I k²) R da,    e = (w' + u) / R,    k = (u + u'') / R²,

with the kinetic energy of u, w and r. Its exact solutions without load are six functions of a; they
are the source's (eqs 3.17 to 3.19 and 6.1 to 6.3, with its radial displacement inward; J.-S. Wu,
L.-K. Chiang, Dynamic analysis of an arch due to a moving load, Journal of Sound and Vibration 269
(2004) 511-534), the stretching one with J = 1 + I / (A R²). Stiffness and mass follow from the
energy and are symmetric. Deviations from print:

- shape functions are P(a) Q⁻¹, not P Qᵀ (eqs 3.67, 6.5); eq. 3.18 has a G3 term for that of G4;
- the stiffness is Q⁻ᵀ (∫ of the strains' products) Q⁻¹; the printed V Q⁻¹ (eqs 5.3, 6.21; D of eq.
  3.61) has signs and an entry R⁻¹ in the rows of the moments that make it unsymmetric.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

QUADRATURE = 8
"""Gauss points of the mass matrix: exact to round-off for elements of up to 60 degrees."""


@dataclass(frozen=True)
class BeamSection:
    """Of a ring. E : Pa;  density : kg/m³;  radius : m, centre line;  area : m²;  inertia : m⁴"""

    E: float
    density: float
    radius: float
    area: float
    inertia: float

    @classmethod
    def rectangle(
        cls, E: float, density: float, radius: float, thickness: float, width: float
    ) -> BeamSection:
        """A rectangular section. E : Pa;  density : kg/m³;  radius, thickness, width : m"""
        return cls(E, density, radius, width * thickness, width * thickness**3 / 12.0)

    @property
    def slenderness(self) -> float:
        """I / (A R²)"""
        return self.inertia / (self.area * self.radius**2)


def solutions(section: BeamSection, angle: float) -> np.ndarray:
    """P: (3, 6), u, w (m) and r (rad) of the six solutions at an angle from the middle."""
    a, c, s, j = angle, np.cos(angle), np.sin(angle), 1.0 + section.slenderness
    values = np.array(
        [
            [1.0, c, s, a * s, 0.0, a * c],
            [-j * a, -s, c, a * c - s, 1.0, -c - a * s],
            [-j * a, 0.0, 0.0, -2.0 * s, 1.0, -2.0 * c],
        ]
    )
    values[2] /= section.radius
    return values


def _strains(section: BeamSection, angle: float) -> np.ndarray:
    """(2, 6): e and k of the six solutions."""
    strains = np.zeros((2, 6))
    strains[0, 0] = -section.slenderness / section.radius
    strains[1, [0, 3, 5]] = 1.0, 2.0 * np.cos(angle), -2.0 * np.sin(angle)
    strains[1] /= section.radius**2
    return strains


@dataclass(frozen=True)
class Element:
    """An element over an angle. bending, stretching : both parts of the stiffness (6, 6);  mass :
    (6, 6)

    inverse : Q⁻¹ (6, 6)
    """

    section: BeamSection
    angle: float
    bending: np.ndarray
    stretching: np.ndarray
    mass: np.ndarray
    inverse: np.ndarray

    @classmethod
    def over(cls, section: BeamSection, angle: float) -> Element:
        """The element of a ring whose ends are `angle` rad apart."""
        ends = [solutions(section, end) for end in (-0.5 * angle, 0.5 * angle)]
        inverse = np.linalg.inv(np.vstack(ends))
        points, weights = np.polynomial.legendre.leggauss(QUADRATURE)
        inertial = section.density * np.diag([section.area, section.area, section.inertia])
        bending, stretching, mass = (np.zeros((6, 6)) for _ in range(3))
        for x, weight in zip(
            0.5 * angle * points, 0.5 * angle * section.radius * weights, strict=True
        ):
            strain, value = _strains(section, x) @ inverse, solutions(section, x) @ inverse
            stretching += weight * section.E * section.area * np.outer(strain[0], strain[0])
            bending += weight * section.E * section.inertia * np.outer(strain[1], strain[1])
            mass += weight * value.T @ inertial @ value
        return cls(section, angle, bending, stretching, mass, inverse)

    @property
    def stiffness(self) -> np.ndarray:
        """(6, 6)"""
        return self.bending + self.stretching

    def shape_functions(self, angle: float) -> np.ndarray:
        """(3, 6): u, w, r at an angle from the middle per displacement of both nodes (eq. 6.5)."""
        return solutions(self.section, angle) @ self.inverse


class Ring:
    """A ring: nodes at equal angles from 0 with three unknowns (u, w, r) each, supports and tooth
    masses.

    Parameters
    ----------
    section : its cross-section
    elements : their number
    supports : number of equally spaced ones from angle 0, and the stiffnesses (u, w, r) of each
    teeth : number of equally spaced ones from angle 0, and the masses (u, w, r) of each
    """

    def __init__(
        self,
        section: BeamSection,
        elements: int,
        supports: tuple[int, tuple[float, float, float]] | None = None,
        teeth: tuple[int, tuple[float, float, float]] | None = None,
    ) -> None:
        self.section, self.elements = section, elements
        self.element = Element.over(section, 2.0 * np.pi / elements)
        self.bending = self._assembled(self.element.bending)
        self.elastic = self.bending + self._assembled(self.element.stretching)
        self.stiffness = self.elastic.copy()
        self.mass = self._assembled(self.element.mass)
        for matrix, added in ((self.stiffness, supports), (self.mass, teeth)):
            if added is not None:
                self._add(matrix, *added)

    @property
    def size(self) -> int:
        """Unknowns."""
        return 3 * self.elements

    def modes(self) -> tuple[np.ndarray, np.ndarray]:
        """Natural frequencies (unknowns,) rad/s, growing, and shapes (unknowns, unknowns) of unit
        mass."""
        squares, shapes = eigh(self.stiffness, self.mass)
        return np.sqrt(squares.clip(0.0)), shapes

    def bending_share(self, shapes: np.ndarray) -> np.ndarray:
        """Bending's share of the strain energy of displacements (unknowns, n); 0 if rigid."""
        bending, elastic = (
            np.einsum("ik,ij,jk->k", shapes, m, shapes) for m in (self.bending, self.elastic)
        )
        return np.where(elastic > 0.0, bending / np.where(elastic > 0.0, elastic, 1.0), 0.0)

    def unknowns(self, element: int) -> np.ndarray:
        """Unknowns (6,) of the two nodes of an element."""
        first = 3 * element
        return (first + np.arange(6)) % self.size

    def interpolation(self, angle: float) -> np.ndarray:
        """(3, unknowns): u, w, r at an angle (rad) on the ring."""
        width = self.element.angle
        turned = angle % (2.0 * np.pi)
        number = min(int(turned / width), self.elements - 1)
        rows = np.zeros((3, self.size))
        rows[:, self.unknowns(number)] = self.element.shape_functions(
            turned - (number + 0.5) * width
        )
        return rows

    def _assembled(self, matrix: np.ndarray) -> np.ndarray:
        out = np.zeros((self.size, self.size))
        for number in range(self.elements):
            indices = self.unknowns(number)
            out[np.ix_(indices, indices)] += matrix
        return out

    def _add(self, matrix: np.ndarray, count: int, values: tuple[float, float, float]) -> None:
        for node in range(0, self.elements, self.elements // count):
            indices = 3 * node + np.arange(3)
            matrix[indices, indices] += values


def supports_restrain_ring(
    supports: int, radial: float, tangential: float, torsional: float, radius: float
) -> bool:
    """Whether equally spaced supports (N/m, N/m, N·m/rad) hold a ring (radius in m) in place."""
    angle = 2.0 * np.pi * np.arange(supports) / supports
    none, one = np.zeros(supports), np.ones(supports)
    motions = (
        (np.cos(angle), np.sin(angle), none),
        (-np.sin(angle), np.cos(angle), one),
        (none, none, one),
    )
    springs = radial, tangential, torsional / radius**2
    stiffness = sum(k * np.array(m) @ np.array(m).T for k, m in zip(springs, motions, strict=True))
    lowest, _, highest = np.linalg.eigvalsh(stiffness)
    return bool(lowest > 1e-12 * highest)


def free_frequencies(section: BeamSection, waves: int) -> np.ndarray:
    """Natural frequencies (2,) rad/s of a free ring with `waves` waves: bending, stretching.

    Exact for the energy above: u = U cos(n a), w = W sin(n a).
    """
    n, r, s = float(waves), section.radius, section
    bending = s.E * s.inertia * (1.0 - n * n) ** 2 / r**4
    stiffness = s.E * s.area / r**2 * np.array([[1.0, n], [n, n * n]]) + np.diag([bending, 0.0])
    mass = s.density * (s.area * np.eye(2) + s.inertia / r**2 * np.array([[n * n, n], [n, 1.0]]))
    return np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real.clip(0.0)))
