"""Equations of motion of the planetary gear train, from its energy.

Coordinates: sun (x, y, u), each planet (ξ, η, u), carrier (x, y, u), then the nodes of the ring
(outward, tangential, rotation). Sun, carrier and planets move in the frame that rotates with the
carrier; gyroscopic terms are left out, as in print. u is a rotation times the base radius (sun,
planet) or times the radius of the planet centres (carrier). With the angle ψ of a planet and the
pressure angle a, the deflections of its meshes are

    sun   d = -x sin(ψ + a) + y cos(ψ + a) + u_s + ξ sin a - η cos a + u_p    (eq. 3.2)
    ring  d = -ξ sin a - η cos a - u_p + v sin a + (w + (r_r - R) r) cos a,

v outward and w tangential displacement of the ring's centre line of radius R, r the rotation of its
section: the mesh is on the pitch circle of radius r_r. Print has v and w alone (eq. 3.16), as if
the mesh were on the centre line; then forces do not balance, and a rigid rotation of the whole
train strains the meshes. The deflections of the bearing of a planet are ξ - x_c cos ψ - y_c sin ψ
and η + x_c sin ψ - y_c cos ψ - u_c. Between carrier and ring are the angles of generator and rotor,
where there are any.

Further deviations from print, which is no derivative of an energy in these equations: eq. 3.16
exchanges sine and cosine of v and w against eqs 3.21 and 3.82; eqs 3.9 to 3.11 and 3.79, 3.80 have
an unsymmetric carrier row; eqs 3.25 and 3.26 support the planet by the ground as well as by the
carrier; eq. 3.28 has the wind's speed squared in its linear part. In print a has the other sign
(eqs 3.25, 3.26): forces that separate the gears would drive the planet forward, and under the
wind's torque flanks would pull. The back flanks, which only a reversed load meets, have the same
line of action, and the mesh dampers act inside the backlash too, both as in print.

In the tooth cycle a planet at the angle ψ is z_r ψ ahead at the ring, and z_s ψ behind at the sun,
whose teeth pass it in the opposite direction. As z_s + z_r is a multiple of the number of planets,
both are one phase, z_s ψ. Sun and ring meshes of a planet are `mesh.phase` apart.

The ring meshes move along the ring. All time dependence is in their deflection rows and in the mesh
stiffnesses. The rest is constant, and its modes separate mass, stiffness and damping.
`PlanetaryModel` holds everything in these modes.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from swgpar.gear_trains.planetary_parts.sections import Carrier, Planet, PlanetaryParts, Sun
from swgpar.vibration.mesh_stiffness import MeshStiffness

SUN = 0


def planet_index(number: int) -> int:
    """First coordinate of a planet."""
    return 3 + 3 * number


def carrier_index(design: PlanetaryParts) -> int:
    """First coordinate of the carrier."""
    return 3 + 3 * design.planet.count


def ring_index(design: PlanetaryParts) -> int:
    """First coordinate of the ring."""
    ends = design.shaft_ends
    return carrier_index(design) + 3 + sum(end is not None for end in (ends.rotor, ends.generator))


def ring_pitch_radius(design: PlanetaryParts) -> float:
    """Pitch radius of the ring, m: the circle that all planets touch."""
    return 0.5e-3 * design.sun.pitch_diameter + 1e-3 * design.planet.pitch_diameter


def base_radii(design: PlanetaryParts) -> tuple[float, float, float]:
    """Base radii of sun and planets, and radius of the planets' centres, m."""
    cosine = np.cos(np.radians(design.mesh.pressure_angle))
    sun, planets = 0.5e-3 * design.sun.pitch_diameter, 0.5e-3 * design.planet.pitch_diameter
    return sun * cosine, planets * cosine, sun + planets


def fixed_deflection_rows(design: PlanetaryParts, size: int) -> np.ndarray:
    """Deflections (m, size) of the meshes per coordinate, without the part of the ring."""
    count, a = design.planet.count, np.radians(design.mesh.pressure_angle)
    rows = np.zeros((2 * count, size))
    for k, psi in enumerate(design.angles):
        planet = planet_index(k) + np.arange(3)
        rows[k, SUN : SUN + 3] = -np.sin(psi + a), np.cos(psi + a), 1.0
        rows[k, planet] = np.sin(a), -np.cos(a), 1.0
        rows[count + k, planet] = -np.sin(a), -np.cos(a), -1.0
    return rows


def bearing_rows(design: PlanetaryParts, size: int) -> np.ndarray:
    """Radial and tangential deflection (planets, 2, size) of the bearings of the planets per
    coordinate."""
    rows, at = np.zeros((design.planet.count, 2, size)), carrier_index(design) + np.arange(3)
    for k, psi in enumerate(design.angles):
        rows[k][:, planet_index(k) + np.arange(2)] = np.eye(2)
        turned = [-np.cos(psi), -np.sin(psi), 0.0], [np.sin(psi), -np.cos(psi), -1.0]
        rows[k][:, at] = turned
    return rows


class PlanetaryModel:
    """The gear train in the modes of all but its meshes.

    Attributes
    ----------
    shapes : (n, n), columns are modes;  stiffness, damping : (n,) of unit modal masses
    mesh : MeshStiffness of the meshes, sun meshes first;  mesh_damping : (m,) N·s/m
    fixed_rows : (m, n), deflections of the meshes per coordinate, without the part of the ring
    on_ring : (3,), deflection of a ring mesh per v, w and r of the ring there
    half_backlash : m;  torque_vector : (n,) modal forces of a unit torque on the rotor, or on the
        carrier without a rotor
    """

    def __init__(self, design: PlanetaryParts) -> None:
        self.design, self.ring = design, design.elastic_ring()
        self.mass, self.constant = self._matrices()
        squares, self.shapes = eigh(self.constant, self.mass)
        self.stiffness = squares.clip(0.0)
        self.damping = design.damping.mass + design.damping.stiffness * self.stiffness
        count, m, cycle = design.planet.count, design.mesh, design.mesh_cycle
        mean, variation, ratios = (
            np.repeat(one, count) for one in (cycle.mean, cycle.variation, cycle.contact_ratio)
        )
        phases = 2.0 * np.pi * np.repeat([0.0, cycle.phase], count)
        phases += np.tile(design.sun.teeth * self.design.angles, 2)
        frequency = design.carrier.speed * design.ring.teeth
        self.mesh = MeshStiffness(
            mean, variation * mean, ratios, frequency, m.harmonics, phases, cycle.overlap
        )
        self.mesh_damping = design.damping.stiffness * mean
        self.half_backlash = 1e-6 * m.half_backlash
        torque_row = np.zeros(self.size)
        if design.shaft_ends.rotor is None:
            torque_row[carrier_index(design) + 2] = 1.0 / base_radii(design)[2]
        else:
            torque_row[ring_index(design) - 1] = 1.0
        self.torque_vector = self.shapes.T @ torque_row
        a = np.radians(m.pressure_angle)
        outside = ring_pitch_radius(design) - self.ring.section.radius
        self.on_ring = np.array([np.sin(a), np.cos(a), outside * np.cos(a)])
        self.fixed_rows = fixed_deflection_rows(design, self.size)

    @property
    def size(self) -> int:
        """n"""
        return len(self.mass)

    def _matrices(self) -> tuple[np.ndarray, np.ndarray]:
        """Mass and stiffness (n, n) without meshes."""
        design, first = self.design, ring_index(self.design)
        n = first + self.ring.size
        mass, stiffness = np.zeros((n, n)), np.zeros((n, n))
        sun_radius, planet_radius, centres = base_radii(design)
        lumped: list[tuple[int, Sun | Carrier | Planet, float]] = [
            (SUN, design.sun, sun_radius),
            (carrier_index(design), design.carrier, centres),
            *((planet_index(k), design.planet, planet_radius) for k in range(design.planet.count)),
        ]
        for first_index, section, radius in lumped:
            at = first_index + np.arange(3)
            mass[at, at] = section.mass, section.mass, section.inertia / radius**2
        for first_index, section in ((SUN, design.sun), (carrier_index(design), design.carrier)):
            at = first_index + np.arange(2)
            stiffness[at, at] = section.bearing
        self._add_shafts(mass, stiffness)
        for stretches in bearing_rows(design, n):
            stiffness += design.planet.bearing * stretches.T @ stretches
        mass[first:, first:], stiffness[first:, first:] = self.ring.mass, self.ring.stiffness
        return mass, stiffness

    def _add_shafts(self, mass: np.ndarray, stiffness: np.ndarray) -> None:
        """Add shafts and what is at their ends, which turn by angles in rad."""
        ends, end = self.design.shaft_ends, carrier_index(self.design) + 3
        sun_radius, _, centres = base_radii(self.design)
        shafts = [(SUN + 2, sun_radius, self.design.sun.torsional, ends.generator)]
        if ends.rotor is not None:
            inertia, torsional = ends.rotor
            shafts.append((carrier_index(self.design) + 2, centres, torsional, inertia))
        for gear, radius, torsional, inertia in shafts:
            twist = np.zeros(len(mass))
            twist[gear] = 1.0 / radius
            if inertia is not None:
                twist[end], mass[end, end] = -1.0, inertia
                end += 1
            stiffness += torsional * np.outer(twist, twist)

    def deflection_rows(self, t: float) -> np.ndarray:
        """Deflections (m, n) of the meshes per coordinate at a time in s."""
        rows, count = self.fixed_rows.copy(), self.design.planet.count
        for k, psi in enumerate(self.design.angles):
            at_mesh = self.ring.interpolation(self.design.carrier.speed * t + psi)
            rows[count + k, ring_index(self.design) :] = self.on_ring @ at_mesh
        return rows

    def local_flexibility(self, times: np.ndarray) -> np.ndarray:
        """Displacement (times, planets, 3) of the ring under each of its meshes per unit force on
        it there, between the nodes of the ring as if they were held."""
        places = self.design.carrier.speed * times[:, None] + self.design.angles
        within = self.ring.flexibility_within(places.ravel()).reshape(*places.shape, 3, 3)
        return within @ self.on_ring

    def mesh_stiffness(self, times: np.ndarray) -> np.ndarray:
        """Stiffnesses (times, m) N/m of the meshes with the part of the ring between its nodes in
        series."""
        return self._in_series(np.array([self.mesh.at(t) for t in times]), times)

    def mean_stiffness(self, t: float) -> np.ndarray:
        """Mean stiffnesses (m,) N/m of the meshes where they are at a time in s, likewise."""
        return self._in_series(self.mesh.mean[None].copy(), np.array([t]))[0]

    def _in_series(self, stiffness: np.ndarray, times: np.ndarray) -> np.ndarray:
        """Change stiffnesses (times, m) of the meshes to those with the ring between its nodes."""
        ring = stiffness[:, self.design.planet.count :]
        ring /= 1.0 + ring * (self.local_flexibility(times) @ self.on_ring)
        return stiffness

    def modal_deflection_rows(self, times: np.ndarray) -> np.ndarray:
        """Deflections (times, m, n) of the meshes per mode."""
        return np.array([self.deflection_rows(t) for t in times]) @ self.shapes
