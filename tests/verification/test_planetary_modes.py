"""Natural modes of planetary trains: kinds, and frequencies of the train of Lin and Parker."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from support.paths import DRIVERS
from swgpar import load_design
from swgpar.gear_trains.planetary.design import PlanetaryDesign
from swgpar.gear_trains.planetary_parts.model import PlanetaryModel, base_radii, ring_pitch_radius
from swgpar.gear_trains.planetary_parts.natural_modes import PlanetaryModes, natural_modes

DRIVER = DRIVERS / "planetary.toml"


@dataclass(frozen=True)
class Member:
    """mass : kg;  inertia : kg, over the square of the radius;  bearing, turning : N/m"""

    mass: float
    inertia: float
    bearing: float = 1e8
    turning: float = 0.0


CARRIER, RING, SUN = Member(5.43, 6.29), Member(2.35, 3.00, turning=1e9), Member(0.40, 0.39)
PLANET = Member(0.66, 0.61)
MESH, ANGLE = 5e8, np.radians(24.6)

PUBLISHED = {
    "rotational": [0.0, 1475.7, 1930.3, 2658.3, 7462.8, 11775.3],
    "translational": [743.2, 1102.4, 1896.0, 2276.4, 6986.3, 9647.9],
}
"""Frequencies in Hz of Lin and Parker (1999), three planets."""


def lumped_frequencies(count: int) -> np.ndarray:
    """Frequencies in Hz of the train of Lin and Parker with rigid members, from their equations;
    coordinates are x, y and the turn of carrier, ring and sun, and of each planet."""
    size, a = 9 + 3 * count, ANGLE
    mass, stiffness = np.zeros(size), np.zeros((size, size))
    for k, member in enumerate((CARRIER, RING, SUN)):
        mass[3 * k : 3 * k + 3] = member.mass, member.mass, member.inertia
        springs = member.bearing, member.bearing, member.turning
        stiffness[range(3 * k, 3 * k + 3), range(3 * k, 3 * k + 3)] = springs
    for j in range(count):
        psi, at = 2.0 * np.pi * j / count, 9 + 3 * j
        mass[at : at + 3] = PLANET.mass, PLANET.mass, PLANET.inertia
        sun, ring, out, along = np.zeros((4, size))
        sun[6:9], sun[at : at + 3] = (
            (-np.sin(psi - a), np.cos(psi - a), 1.0),
            (-np.sin(a), -np.cos(a), 1.0),
        )
        ring[3:6], ring[at : at + 3] = (
            (-np.sin(psi + a), np.cos(psi + a), 1.0),
            (np.sin(a), -np.cos(a), -1.0),
        )
        out[:2], out[at] = (np.cos(psi), np.sin(psi)), -1.0
        along[:3], along[at + 1] = (-np.sin(psi), np.cos(psi), 1.0), -1.0
        for row, k in ((sun, MESH), (ring, MESH), (out, PLANET.bearing), (along, PLANET.bearing)):
            stiffness += k * np.outer(row, row)
    squares = eigh(stiffness, np.diag(mass), eigvals_only=True)
    return np.sqrt(squares.clip(0.0)) / (2.0 * np.pi)


def with_rigid_ring(count: int) -> PlanetaryModel:
    """The same train with a ring that is stiff enough to be rigid."""
    design = load_design(DRIVER)
    cosine, supports, rim = np.cos(ANGLE), 6, 20.0

    def changed(section: str, **values: object) -> None:
        nonlocal design
        part = getattr(design, section).model_copy(update=values)
        design = design.model_copy(update={section: part})

    changed("sun", pitch_diameter=77.42 / cosine, torsional=0.0)
    changed("planet", count=count, pitch_diameter=100.35 / cosine)
    sun, planet, centres = base_radii(design := _at_angle(design))
    changed("sun", mass=SUN.mass, inertia=SUN.inertia * sun**2, bearing=SUN.bearing)
    inertia = PLANET.inertia * planet**2
    changed("planet", mass=PLANET.mass, inertia=inertia, bearing=PLANET.bearing)
    inertia = CARRIER.inertia * centres**2
    changed("carrier", mass=CARRIER.mass, inertia=inertia, bearing=CARRIER.bearing)
    changed("mesh", sun_stiffness=MESH, ring_stiffness=MESH)
    base = ring_pitch_radius(design) * cosine
    changed("ring", rim=rim, face_width=25.0, E=1e9, nu=0.3, supports=supports)

    def inertia_less(radius: float) -> float:
        """Inertia of the ring in excess of the wanted one, with its mass."""
        changed("ring", root_radius=1e3 * radius - 0.5 * rim)
        density = RING.mass / (2.0 * np.pi * radius * 1e-3 * rim * 0.025)
        per_mass = radius * RING.bearing / supports
        turning = (RING.turning * base**2 - RING.bearing * radius**2) / supports
        changed("ring", density=density, radial=RING.bearing / supports)
        changed("ring", tangential=per_mass / radius, torsional=turning)
        turn = np.tile([0.0, radius, 1.0], design.ring.elements)
        return float(turn @ design.elastic_ring().mass @ turn) - RING.inertia * base**2

    inertia_less(brentq(inertia_less, 0.12, 0.2, xtol=1e-12))
    return PlanetaryModel(design)


def _at_angle(design: PlanetaryDesign) -> PlanetaryDesign:
    mesh = design.mesh.model_copy(update={"pressure_angle": float(np.degrees(ANGLE))})
    return design.model_copy(update={"mesh": mesh})


def rigid_modes(count: int) -> PlanetaryModes:
    return natural_modes(with_rigid_ring(count))


@pytest.mark.parametrize("count", [3, 4, 5])
def test_frequencies_of_a_train_with_rigid_members(count: int) -> None:
    found, expected = rigid_modes(count), lumped_frequencies(count)
    lowest = found.frequency[: len(expected)]
    np.testing.assert_allclose(lowest[1:], expected[1:], rtol=2e-4)
    assert lowest[0] < 0.01 * lowest[1]  # round-off of a ring this stiff
    kinds = found.kind[: len(expected)].tolist()
    # six rotational modes, six pairs of translational ones, three sets of planet modes
    numbers = {"rotational": 6, "translational": 12, "planet": 3 * (count - 3)}
    assert {kind: kinds.count(kind) for kind in numbers} == numbers
    for n in np.flatnonzero(found.kind[: len(expected)] == "planet"):
        assert found.energy[n, 1] > 0.9999


def test_published_frequencies() -> None:
    found = rigid_modes(3)
    for kind, published in PUBLISHED.items():
        each = 1 if kind == "rotational" else 2
        ours = found.frequency[:18][found.kind[:18] == kind][::each]
        np.testing.assert_allclose(ours, published, atol=0.06, rtol=2e-4)


def test_kinds_of_the_driver() -> None:
    """Modes of each kind have its motions; energies add up; most modes are those of the ring."""
    train = PlanetaryModel(load_design(DRIVER))
    found = natural_modes(train)
    np.testing.assert_allclose(found.energy.sum(axis=1), 1.0, rtol=1e-9)
    assert (np.diff(found.frequency) >= 0.0).all()
    kinds = found.kind.tolist()
    assert kinds.count("planet") == 0 and kinds.count("ring") >= 3 * 18 - 3
    assert kinds.count("rotational") >= 4 and kinds.count("translational") >= 8
    for shape in found.shapes.T[found.kind == "rotational"]:
        assert np.abs(shape[:2]).max() < 1e-6 * np.abs(shape).max()
    for shape in found.shapes.T[found.kind == "translational"]:
        assert abs(shape[2]) < 1e-6 * np.abs(shape).max()
