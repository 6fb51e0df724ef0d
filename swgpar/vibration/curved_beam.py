"""Curved-beam element of a ring with shear, with exact static shape functions, and rings of it.

Displacements of the centre line at the angle a: u outward, w counter-clockwise, and the rotation r
of its cross-section, which stays plane (Timoshenko). The fibre at the distance z outside the centre
line has the strain (R e + z r') / (R + z). The energy is

    U = 1/2 ∫ (E A e² + E I* k² + S g²) R da,
    e = (w' + u) / R,    k = (e - r') / R,    g = r + (u' - w) / R,

with I* = ∫ z² R / (R + z) dA (Winkler and Bach) and the shear stiffness S; the kinetic energy is
that of u and w + z r of all fibres. I* = ∫ z² dA, S without limit and fibres of equal length are
Flügge's thin ring, r = (w - u') / R, which is the source's. The exact solutions without load are
six functions of a; without shear they are the source's (eqs 3.17 to 3.19 and 6.1 to 6.3, with its
radial displacement inward; J.-S. Wu, L.-K. Chiang, Dynamic analysis of an arch due to a moving
load, Journal of Sound and Vibration 269 (2004) 511-534), the stretching one with
J = 1 + I* / (A R²). Shear multiplies the growing ones by 1 + E I* / (S R²). Stiffness and mass
follow from the energy and are symmetric. Deviations from print:

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


SHEAR_COEFFICIENT = 5.0 / 6.0
"""Of a rectangle at rest: shear stress as a parabola (E. Reissner)."""


@dataclass(frozen=True)
class BeamSection:
    """Of a ring.

    Attributes
    ----------
    E : Pa;  density : kg/m³;  radius : m, centre line
    area, inertia : m², m⁴
    bending : m⁴, I* of the bending stiffness
    shear : N, S
    coupling : m³, ∫ z (1 + z / R) dA: outer fibres are longer, and w moves them with r
    """

    E: float
    density: float
    radius: float
    area: float
    inertia: float
    bending: float
    shear: float
    coupling: float

    @classmethod
    def rectangle(
        cls, E: float, nu: float, density: float, radius: float, thickness: float, width: float
    ) -> BeamSection:
        """A rectangular section thinner than twice the radius.

        E : Pa;  nu : Poisson's ratio;  density : kg/m³;  radius, thickness, width : m
        """
        area, inertia = width * thickness, width * thickness**3 / 12.0
        # R / h ∫ dz / (R + z) - 1, as a series where the logarithm would lose its digits
        x = 0.5 * thickness / radius
        longer = np.arctanh(x) / x - 1.0 if x > 1e-3 else x**2 / 3.0 + x**4 / 5.0
        shear = 0.5 * E / (1.0 + nu) * SHEAR_COEFFICIENT * area * (1.0 + longer)
        bending = area * radius**2 * longer
        return cls(E, density, radius, area, inertia, bending, shear, inertia / radius)

    @property
    def slenderness(self) -> float:
        """I* / (A R²)"""
        return self.bending / (self.area * self.radius**2)

    @property
    def shearing(self) -> float:
        """E I* / (S R²)"""
        return self.E * self.bending / (self.shear * self.radius**2)

    @property
    def stiffnesses(self) -> np.ndarray:
        """(3,) N, N·m² and N, of stretching, bending and shear."""
        return np.array([self.E * self.area, self.E * self.bending, self.shear])

    @property
    def inertia_matrix(self) -> np.ndarray:
        """(3, 3) kg/m, kg and kg·m, of u, w and r."""
        matrix = np.diag([self.area, self.area, self.inertia])
        matrix[[1, 2], [2, 1]] = self.coupling
        return self.density * matrix


def solutions(section: BeamSection, angle: float) -> np.ndarray:
    """P: (3, 6), u, w (m) and r (rad) of the six solutions at an angle from the middle."""
    a, c, s, j = angle, np.cos(angle), np.sin(angle), 1.0 + section.slenderness
    g = 1.0 + section.shearing
    values = np.array(
        [
            [1.0, c, s, g * a * s, 0.0, g * a * c],
            [-j * a, -s, c, g * (a * c - s), 1.0, -g * (c + a * s)],
            [-j * a, 0.0, 0.0, -2.0 * s, 1.0, -2.0 * c],
        ]
    )
    values[2] /= section.radius
    return values


def _strains(section: BeamSection, angle: float) -> np.ndarray:
    """(3, 6): e, k and g of the six solutions."""
    c, s = 2.0 * np.cos(angle), 2.0 * np.sin(angle)
    strains = np.zeros((3, 6))
    strains[0, 0] = -section.slenderness / section.radius
    strains[1, [0, 3, 5]] = np.array([1.0, c, -s]) / section.radius**2
    strains[2, [3, 5]] = section.shearing / section.radius * np.array([s, c])
    return strains


@dataclass(frozen=True)
class Element:
    """An element over an angle.

    bending, stretching : (6, 6), parts of the stiffness; bending has the shear
    mass : (6, 6)
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
        inertial, stiffnesses = section.inertia_matrix, section.stiffnesses
        bending, stretching, mass = (np.zeros((6, 6)) for _ in range(3))
        for x, weight in zip(
            0.5 * angle * points, 0.5 * angle * section.radius * weights, strict=True
        ):
            strain, value = _strains(section, x) @ inverse, solutions(section, x) @ inverse
            parts = [weight * k * np.outer(e, e) for k, e in zip(stiffnesses, strain, strict=True)]
            stretching += parts[0]
            bending += parts[1] + parts[2]
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

    def flexibility_within(self, angles: np.ndarray) -> np.ndarray:
        """(n, 3, 3): u, w, r at angles (n,) rad per force there (N, N, N·m) if the nodes are held.

        What a load within an element adds to the interpolated displacements of the nodes: with it
        the deflection under the load is exact at rest. 0 at the nodes.
        """
        left = angles % self.element.angle
        sides = self._cantilever(left), self._cantilever(left - self.element.angle)
        # two springs on one point: their stiffnesses add up
        return np.asarray(sides[0] @ np.linalg.solve(sides[0] + sides[1], sides[1]))

    def _cantilever(self, spans: np.ndarray) -> np.ndarray:
        """(n, 3, 3): u, w, r of the end of an arc per force there; its other end, at the angles
        -spans (n,) rad from it, is held."""
        s, r = self.section, self.section.radius
        # a strain (e, k, g) moves what lies beyond it by `steps` rad⁻¹, as a rigid body
        steps = np.array([[0.0, 0.0, r], [r, 0.0, 0.0], [1.0, -r, 0.0]])
        compliance = np.diag([1.0 / (s.E * s.area), 1.0 / (s.E * s.bending), 1.0 / s.shear]) / r
        inner = steps @ compliance @ steps.T
        points, weights = np.polynomial.legendre.leggauss(QUADRATURE)
        out = np.zeros((len(spans), 3, 3))
        for point, weight in zip(0.5 * (1.0 + points), 0.5 * weights, strict=True):
            carried = np.zeros_like(out)
            cosine, sine = np.cos(point * spans), np.sin(point * spans)
            carried[:, 0] = np.stack([cosine, sine, -r * sine], axis=1)
            carried[:, 1] = np.stack([-sine, cosine, r * (1.0 - cosine)], axis=1)
            carried[:, 2, 2] = 1.0
            size = (weight * np.abs(spans))[:, None, None]
            out += size * (carried @ inner @ carried.transpose(0, 2, 1))
        return out

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
    """Natural frequencies (3,) rad/s of a free ring with `waves` waves, two or more: bending, then
    those of stretching and shear.

    Exact for the energy above: u = U cos(n a), w = W sin(n a), r = V sin(n a).
    """
    n, r = float(waves), section.radius
    strains = np.array([[1.0, n, 0.0], [1.0 / r, n / r, -n], [-n, -1.0, r]]) / r
    # with strains as unknowns: round-off of the stiff ones does not reach bending
    of_strains = np.linalg.inv(strains) / np.sqrt(section.stiffnesses)
    mass = of_strains.T @ section.inertia_matrix @ of_strains
    return 1.0 / np.sqrt(np.linalg.eigvalsh(mass)[::-1])
