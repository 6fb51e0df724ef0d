"""Errors of planetary stages, and what they add to the deflections of the meshes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.gear_trains.planetary_parts.model import SUN, PlanetaryModel
from swgpar.gear_trains.planetary_stage.design import PlanetaryStageDesign, StageTolerances
from swgpar.vibration.sampling import random_stream

LOADED = -1.0
"""Sign of the deflection of a mesh in contact on its loaded flank, when the carrier drives."""

STREAM = 2
"""First number of the keys of these samples' streams."""


@dataclass(frozen=True)
class StageErrors:
    """Errors of some trains, m.

    pin : (trains, planets, 2), outward and along
    sun, ring : (trains, 2), displacement of the pitch circle in x and y at the start
    planet : (trains, planets, 2), the same outward and along
    sun_pitch, ring_pitch : (trains, teeth) and planet_pitch : (trains, planets, teeth), how far the
        loaded flanks are ahead
    """

    pin: np.ndarray
    sun: np.ndarray
    planet: np.ndarray
    ring: np.ndarray
    sun_pitch: np.ndarray
    planet_pitch: np.ndarray
    ring_pitch: np.ndarray


def _shapes(design: PlanetaryStageDesign) -> dict[str, tuple[int, ...]]:
    count = design.planet.count
    return {
        "pin": (count, 2),
        "sun": (2,),
        "planet": (count, 2),
        "ring": (2,),
        "sun_pitch": (design.sun.teeth,),
        "planet_pitch": (count, design.planet_teeth),
        "ring_pitch": (design.ring.teeth,),
    }


def given_errors(design: PlanetaryStageDesign) -> StageErrors:
    """The errors of the design file, of one train."""
    given = design.errors
    found = {name: np.zeros(shape) for name, shape in _shapes(design).items()}
    for direction, name in enumerate(("pin_radial", "pin_tangential")):
        if values := getattr(given, name):
            found["pin"][:, direction] = values
    found["sun"][:] = _polar(given.sun_eccentricity, given.sun_phase)
    found["ring"][:] = _polar(given.ring_eccentricity, given.ring_phase)
    if given.planet_eccentricity:
        sizes = np.array(given.planet_eccentricity)
        phases = np.array(given.planet_phase or np.zeros(len(sizes)))
        found["planet"][:] = _polar(sizes, phases).T
    for name in ("sun_pitch", "ring_pitch"):
        if values := getattr(given, name):
            found[name][:] = values
    if given.planet_pitch:
        found["planet_pitch"][0] = given.planet_pitch
    return StageErrors(**{name: 1e-6 * array[None] for name, array in found.items()})


def _polar(size: float | np.ndarray, degrees: float | np.ndarray) -> np.ndarray:
    return np.array([size * np.cos(np.radians(degrees)), size * np.sin(np.radians(degrees))])


def random_errors(
    design: PlanetaryStageDesign, tolerances: StageTolerances, block: int, count: int
) -> StageErrors:
    """Normal errors of the trains of a block, around those of the design file."""
    random = random_stream(design.gear_train.seed, STREAM, block)
    t = tolerances
    sizes = [t.pin, t.sun_eccentricity, t.planet_eccentricity, t.ring_eccentricity, *3 * [t.pitch]]
    found, own = {}, given_errors(design)
    for (name, shape), size in zip(_shapes(design).items(), sizes, strict=True):
        drawn = random.standard_normal((count, *shape))
        found[name] = getattr(own, name) + 1e-6 * size / t.limits * drawn
    return StageErrors(**found)


class MeshErrors:
    """What the errors of some trains add to the deflections of their meshes."""

    def __init__(
        self, train: PlanetaryModel, design: PlanetaryStageDesign, errors: StageErrors
    ) -> None:
        self.train, self.design, self.errors = train, design, errors

    def at(self, t: float) -> np.ndarray:
        """Added deflections (trains, m) in m at a time in s.

        The sun turns by z_r / z_s and a planet by -z_r / z_p revolutions against the carrier in
        one of its own; the ring turns back with the carrier's speed.
        """
        design, errors = self.design, self.errors
        count, turned = design.planet.count, design.carrier.speed * t
        at_ring, rows = design.ring.teeth * turned, self.train.fixed_rows
        sun = _turned(errors.sun, at_ring / design.sun.teeth)
        planet = _turned(errors.planet, -at_ring / design.planet_teeth)
        ring = _turned(errors.ring, -turned)
        added = np.empty((len(errors.sun), 2 * count))
        for k, psi in enumerate(design.angles):
            first = 3 + 3 * k
            added[:, k] = sun @ rows[k, SUN : SUN + 2] + planet[:, k] @ rows[k, first : first + 2]
            outward = ring @ [np.cos(psi), np.sin(psi)]
            along = ring @ [-np.sin(psi), np.cos(psi)]
            moved = np.stack([outward, along], axis=1) @ self.train.on_ring[:2]
            added[:, count + k] = moved + planet[:, k] @ rows[count + k, first : first + 2]
        return added + LOADED * self._pitch(t)

    def _pitch(self, t: float) -> np.ndarray:
        """How far the flanks in contact are ahead, (trains, m) m: the mean of two pairs."""
        errors, count = self.errors, self.design.planet.count
        mesh = self.train.mesh
        cycles = (mesh.frequency * t - mesh.phase) / (2.0 * np.pi)
        near = np.round(cycles)
        both = np.abs(cycles - near) < 0.5 * (mesh.contact_ratio - 1.0)
        pairs = np.where(both, [near - 1.0, near], np.floor(cycles)).astype(int)
        # the ring passes the planets in the sense opposite to that of the sun
        teeth = self.design.sun.teeth + self.design.ring.teeth
        ahead = np.round(teeth * self.design.angles / (2.0 * np.pi)).astype(int)
        planets = np.arange(count)
        found = np.zeros((len(errors.sun), 2 * count))
        for pair in pairs:
            at_sun, at_ring = pair[:count], pair[count:]
            found[:, :count] += errors.sun_pitch[:, at_sun % errors.sun_pitch.shape[1]]
            found[:, count:] += errors.ring_pitch[:, (at_ring + ahead) % errors.ring_pitch.shape[1]]
            for meshes, numbers in ((slice(0, count), at_sun), (slice(count, None), at_ring)):
                number = numbers % errors.planet_pitch.shape[2]
                found[:, meshes] += errors.planet_pitch[:, planets, number]
        return found / len(pairs)


def _turned(vectors: np.ndarray, angle: float) -> np.ndarray:
    """Vectors (..., 2) turned by an angle."""
    c, s = np.cos(angle), np.sin(angle)
    return vectors @ np.array([[c, s], [-s, c]])
