"""Natural modes of planetary trains: kinds, and frequencies of the train of Lin and Parker."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from support.paths import DRIVERS
from swgpar import load_design
from swgpar.gear_trains.planetary_parts.model import PlanetaryModel, base_radii, ring_pitch_radius
from swgpar.gear_trains.planetary_parts.natural_modes import natural_modes
from swgpar.input.toml_file import read_toml

DRIVER = DRIVERS / "planetary_stage.toml"

PARTS = "gear_train", "sun", "planet", "carrier", "ring", "damping", "load"
CYCLE = {"variation": 0.0, "sun_contact_ratio": 1.5, "ring_contact_ratio": 1.5, "phase": 0.0}
BASES = "sun", "planet", "carrier"
"""In the order of `base_radii`."""

GROUND = 1e15
"""Inertia of a rotor that does not move, kg·m²."""


@dataclass(frozen=True)
class Member:
    """mass : kg;  inertia : kg, over the square of the radius;  bearing, turning : N/m"""

    mass: float
    inertia: float
    bearing: float
    turning: float = 0.0


@dataclass(frozen=True)
class Train:
    """angle : pressure angle, deg;  mesh : stiffness of all meshes, N/m
    diameters : of the base circles of sun and planets, mm
    published : frequencies by number of planets and kind, in Hz or over `unit`
    """

    carrier: Member
    ring: Member
    sun: Member
    planet: Member
    mesh: float
    angle: float
    diameters: tuple[float, float]
    published: dict[int, dict[str, list[float]]]
    unit: float = 1.0


LIN_PARKER = Train(
    carrier=Member(5.43, 6.29, 1e8),
    ring=Member(2.35, 3.00, 1e8, turning=1e9),
    sun=Member(0.40, 0.39, 1e8),
    planet=Member(0.66, 0.61, 1e8),
    mesh=5e8,
    angle=24.6,
    diameters=(77.42, 100.35),
    published={
        3: {
            "rotational": [0.0, 1475.7, 1930.3, 2658.3, 7462.8, 11775.3],
            "translational": [743.2, 1102.4, 1896.0, 2276.4, 6986.3, 9647.9],
        },
        4: {
            "rotational": [0.0, 1536.6, 1970.6, 2625.7, 7773.6, 13071.1],
            "translational": [727.0, 1091.0, 1892.8, 2342.5, 7189.9, 10437.6],
            "planet": [1808.2, 5963.8, 6981.7],
        },
        5: {
            "rotational": [0.0, 1567.4, 2006.1, 2614.8, 8065.4, 14253.1],
            "translational": [710.0, 1072.0, 1888.1, 2425.3, 7382.4, 11172.3],
            "planet": [1808.2, 5963.8, 6981.7],
        },
    },
)
"""J. Lin, R. G. Parker (1999), tables 1 and 2."""

COOLEY_PARKER = Train(
    carrier=Member(12.0, 6.80, 5e7, turning=1e8),
    ring=Member(7.64, 8.09, 1e8, turning=1e8),
    sun=Member(3.0, 1.75, 2e7, turning=2e7),
    planet=Member(1.86, 1.25, 1e7),
    mesh=1e8,
    angle=20.0,
    diameters=(55.75, 27.0),
    published={
        3: {
            "rotational": [0.9296, 1.090, 1.358, 1.931, 5.566, 7.741],
            "translational": [0.7432, 1.018, 1.265, 1.487, 4.976, 6.282],
        },
        4: {
            "rotational": [0.9077, 1.046, 1.317, 2.013, 5.809, 8.383],
            "translational": [0.7199, 1.001, 1.317, 1.481, 5.153, 6.488],
            "planet": [0.9617, 4.320, 5.672],
        },
        5: {
            "rotational": [0.8802, 1.019, 1.281, 2.090, 6.030, 8.986],
            "translational": [0.6992, 0.9863, 1.344, 1.496, 5.317, 6.693],
            "planet": [0.9617, 4.320, 5.672],
        },
    },
    unit=np.sqrt(1e7 / 1.86) / (2.0 * np.pi),
)
"""C. G. Cooley, R. G. Parker (2012), carrier at rest; frequencies over that of a planet on its
bearing, with four digits."""

TRAINS = {"Lin and Parker": LIN_PARKER, "Cooley and Parker": COOLEY_PARKER}

OTHER_THAN_PRINTED = {
    (4, 727.0): 727.27,
    (4, 1091.0): 1091.16,
    (4, 1536.6): 1536.53,
    (5, 1.281): 1.28046,
}
"""Frequencies of rigid members, by number of planets, where print has another last digit."""


def lumped_frequencies(train: Train, count: int) -> np.ndarray:
    """Frequencies in Hz of a train with rigid members, from the equations of Lin and Parker;
    coordinates are x, y and the turn of carrier, ring and sun, and of each planet."""
    size, a = 9 + 3 * count, np.radians(train.angle)
    mass, stiffness = np.zeros(size), np.zeros((size, size))
    for k, member in enumerate((train.carrier, train.ring, train.sun)):
        mass[3 * k : 3 * k + 3] = member.mass, member.mass, member.inertia
        springs = member.bearing, member.bearing, member.turning
        stiffness[range(3 * k, 3 * k + 3), range(3 * k, 3 * k + 3)] = springs
    planet, mesh = train.planet, train.mesh
    for j in range(count):
        psi, at = 2.0 * np.pi * j / count, 9 + 3 * j
        mass[at : at + 3] = planet.mass, planet.mass, planet.inertia
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
        for row, k in ((sun, mesh), (ring, mesh), (out, planet.bearing), (along, planet.bearing)):
            stiffness += k * np.outer(row, row)
    squares = eigh(stiffness, np.diag(mass), eigvals_only=True)
    return np.sqrt(squares.clip(0.0)) / (2.0 * np.pi)


def with_rigid_ring(train: Train, count: int) -> PlanetaryModel:
    """The same train with a ring that is stiff enough to be rigid. Springs that hold the carrier
    against turning are a shaft to a rotor that does not move."""
    table = read_toml(DRIVER)
    parts = {name: table[name] for name in PARTS}
    mesh = table["mesh"] | {"sun_stiffness": train.mesh, "ring_stiffness": train.mesh} | CYCLE
    design = load_design(parts | {"mesh": mesh, "rotor": {"inertia": 1e9, "torsional": 1.0}})
    cosine, supports, rim = np.cos(np.radians(train.angle)), 6, 20.0

    def changed(section: str, **values: object) -> None:
        nonlocal design
        part = getattr(design, section).model_copy(update=values)
        design = design.model_copy(update={section: part})

    sun_diameter, planet_diameter = train.diameters
    changed("mesh", pressure_angle=train.angle)
    changed("sun", pitch_diameter=sun_diameter / cosine)
    changed("planet", count=count, pitch_diameter=planet_diameter / cosine)
    for name in ("sun", "planet", "carrier"):
        given, radius = getattr(train, name), base_radii(design)[BASES.index(name)]
        inertia = given.inertia * radius**2
        changed(name, mass=given.mass, inertia=inertia, bearing=given.bearing)
    changed("sun", torsional=train.sun.turning * base_radii(design)[0] ** 2)
    held = train.carrier.turning * base_radii(design)[2] ** 2
    changed("rotor", inertia=GROUND, torsional=held)
    base = ring_pitch_radius(design) * cosine
    changed("ring", rim=rim, face_width=25.0, E=1e9, nu=0.3, supports=supports)
    given = train.ring

    def inertia_less(radius: float) -> float:
        """Inertia of the ring in excess of the wanted one, with its mass."""
        changed("ring", root_radius=1e3 * radius - 0.5 * rim)
        density = given.mass / (2.0 * np.pi * radius * 1e-3 * rim * 0.025)
        per_mass = radius * given.bearing / supports
        turning = (given.turning * base**2 - given.bearing * radius**2) / supports
        changed("ring", density=density, radial=given.bearing / supports)
        changed("ring", tangential=per_mass / radius, torsional=turning)
        turn = np.tile([0.0, radius, 1.0], design.ring.elements)
        return float(turn @ design.elastic_ring().mass @ turn) - given.inertia * base**2

    mean = base * np.sqrt(given.inertia / given.mass)
    inertia_less(brentq(inertia_less, 0.7 * mean, 1.3 * mean, xtol=1e-12))
    return PlanetaryModel(design)


@lru_cache(maxsize=6)
def rigid_modes(name: str, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequencies in Hz, kinds and energies of the modes of the train alone."""
    found = natural_modes(with_rigid_ring(TRAINS[name], count))
    # two are at zero within round-off, in any order: in one of them the rotor alone has energy
    others = np.delete(np.arange(len(found.frequency)), found.energy.sum(axis=1).argmin())
    train = others[: 9 + 3 * count]
    return found.frequency[train], found.kind[train], found.energy[train]


@pytest.mark.parametrize("count", [3, 4, 5])
@pytest.mark.parametrize("name", TRAINS)
def test_frequencies_of_a_train_with_rigid_members(name: str, count: int) -> None:
    (found, kind, energy), expected = (
        rigid_modes(name, count),
        lumped_frequencies(TRAINS[name], count),
    )
    np.testing.assert_allclose(found, expected, rtol=2e-4, atol=0.01 * expected[1])
    kinds = kind.tolist()
    # six rotational modes, six pairs of translational ones, three sets of planet modes
    numbers = {"rotational": 6, "translational": 12, "planet": 3 * (count - 3)}
    assert {kind: kinds.count(kind) for kind in numbers} == numbers
    assert (energy[kind == "planet", 1] > 0.9999).all()


@pytest.mark.parametrize("count", [3, 4, 5])
@pytest.mark.parametrize("name", TRAINS)
def test_published_frequencies(name: str, count: int) -> None:
    """To the digits of print, but for four numbers of print."""
    train = TRAINS[name]
    lumped = lumped_frequencies(train, count) / train.unit
    found, kind, _ = rigid_modes(name, count)
    for one, published in train.published[count].items():
        each = {"rotational": 1, "translational": 2, "planet": count - 3}[one]
        ours = (found[kind == one] / train.unit)[::each]
        for number, printed in zip(ours, published, strict=True):
            near = OTHER_THAN_PRINTED.get((count, printed), printed)
            digit = 0.1 if train.unit == 1.0 else 10.0 ** (np.floor(np.log10(printed)) - 3)
            half = 0.51 * digit  # half a digit, and 1 % of one for the rounding of the inputs
            assert np.abs(lumped - near).min() <= half, (number, printed)
            # the stiff ring leaves round-off of up to 1e-5 in a frequency, as the processor adds up
            allowed = half + 1e-5 * near
            assert number == pytest.approx(near, abs=allowed, rel=2e-4) or near == 0.0


def test_kinds_of_the_driver() -> None:
    """Modes of each kind have its motions; energies add up; most modes are those of the ring."""
    train = PlanetaryModel(load_design(DRIVERS / "planetary.toml"))
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
