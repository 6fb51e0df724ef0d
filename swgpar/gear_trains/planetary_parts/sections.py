"""Sections of design files of planetary trains, and what must fit in them."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Ge, Lt

from swgpar.gear_trains.common_sections import TrainDamping, TrainDesign
from swgpar.input.quantities import Section, not_negative, positive, quantity
from swgpar.input.require import require
from swgpar.vibration.curved_beam import BeamSection, Ring, supports_restrain_ring
from swgpar.vibration.thickness_limit import THICKEST, displacement_remark

ADDENDUM = 1.0
"""Of the planets, in modules: the standard one of ISO 53."""

DEEPEST = 3.0
"""Largest distance of the root of the ring from its pitch circle, in modules: the dedendum of 1.25
and profile shift."""

PLACE_TOLERANCE = 1e-3
"""Of the places in which planets can be assembled, in pitches of sun and ring together."""


class Sun(Section):
    teeth: int = quantity(text="number of teeth", ge=6, le=1000)
    mass: float = positive("mass", "kg")
    inertia: float = positive("moment of inertia", "kg·m²")
    pitch_diameter: float = positive("pitch diameter", "mm")
    bearing: float = not_negative("stiffness of the bearing", "N/m")
    torsional: float = positive("torsional stiffness of the shaft", "N·m/rad")


class Planet(Section):
    count: int = quantity(3, text="number of planets", ge=2, le=12)
    angles: list[Annotated[float, Ge(0.0), Lt(360.0)]] = quantity(
        [], unit="deg", text="places of the planets, from 0 ascending; without them equally spaced"
    )
    mass: float = positive("mass of each", "kg")
    inertia: float = positive("moment of inertia of each", "kg·m²")
    pitch_diameter: float = positive("pitch diameter", "mm")
    bearing: float = positive("stiffness of the bearing of each on the carrier", "N/m")


class Carrier(Section):
    mass: float = positive("mass", "kg")
    inertia: float = positive("moment of inertia", "kg·m²")
    bearing: float = positive("stiffness of the bearing", "N/m")
    speed: float = positive("speed", "rad/s")


class RingGear(Section):
    teeth: int = quantity(text="number of teeth", ge=10, le=2000)
    E: float = positive("modulus of elasticity", "GPa")
    nu: float = quantity(0.3, text="Poisson's ratio", gt=-1.0, le=0.5)
    density: float = positive("density", "kg/m³")
    root_radius: float = positive("root radius, the inner radius of the rim", "mm")
    rim: float = positive("rim thickness", "mm")
    face_width: float = positive("face width", "mm")
    elements: int = quantity(text="curved-beam elements", ge=3, le=200)
    supports: int = quantity(text="equally spaced supports; the first at angle 0", ge=1)
    radial: float = not_negative("radial stiffness of each support", "N/m")
    tangential: float = positive("tangential stiffness of each support", "N/m")
    torsional: float = not_negative("torsional stiffness of each support", "N·m/rad")


class Meshes(Section):
    pressure_angle: float = positive("pressure angle", "deg", 20.0, lt=45.0)
    half_backlash: float = not_negative("half of the backlash of all meshes", "µm")
    harmonics: int = quantity(3, text="Fourier terms of the mesh stiffness", ge=1, le=100)


@dataclass(frozen=True)
class MeshCycle:
    """Stiffness of sun and ring meshes over the tooth cycle, sun first.

    mean : (2,) N/m;  variation : (2,) amplitudes over the means;  contact_ratio : (2,)
    phase : of ring meshes behind sun meshes, cycles;  overlap : overlap ratio of helical teeth
    """

    mean: tuple[float, float]
    variation: tuple[float, float]
    contact_ratio: tuple[float, float]
    phase: float
    overlap: float = 0.0


@dataclass(frozen=True)
class ShaftEnds:
    """Inertias at the ends of the shafts, none without them.

    rotor : kg·m² and N·m/rad of its shaft to the carrier
    generator : kg·m², on the shaft of the sun, which else ends at the ground
    """

    rotor: tuple[float, float] | None = None
    generator: float | None = None


class PlanetaryParts(TrainDesign):
    """The parts of a planetary train. Attributes are sections of the design file."""

    sun: Sun
    planet: Planet
    carrier: Carrier
    ring: RingGear
    mesh: Meshes
    damping: TrainDamping

    @property
    @abstractmethod
    def mesh_cycle(self) -> MeshCycle:
        """How stiff the meshes are."""

    @property
    def shaft_ends(self) -> ShaftEnds:
        return ShaftEnds()

    @property
    def module(self) -> float:
        """Of the transverse section, mm."""
        return self.sun.pitch_diameter / self.sun.teeth

    @property
    def angles(self) -> np.ndarray:
        """Angles of the planets in the carrier's frame, (planets,) rad (eq. 3.3)."""
        if self.planet.angles:
            return np.radians(self.planet.angles)
        return 2.0 * np.pi * np.arange(self.planet.count) / self.planet.count

    def remark_on_rim(self, rim: float) -> str:
        """Where beam theory ends for a rim (mm) of the ring, or nothing."""
        sentence = displacement_remark(rim, self.ring.root_radius + 0.5 * rim, self.ring.supports)
        return f"a rim of {rim:g} mm: {sentence}" if sentence else ""

    def elastic_ring(self) -> Ring:
        """The ring with its supports."""
        r = self.ring
        radius = 1e-3 * (r.root_radius + 0.5 * r.rim)
        size = 1e-3 * r.rim, 1e-3 * r.face_width
        section = BeamSection.rectangle(1e9 * r.E, r.nu, r.density, radius, *size)
        return Ring(section, r.elements, (r.supports, (r.radial, r.tangential, r.torsional)))


def check_parts(design: PlanetaryParts) -> None:
    """Refuse parts that do not fit each other."""
    ring, sun, planet = design.ring, design.sun, design.planet
    between = ring.teeth - sun.teeth
    allowed = f"{sun.teeth} (sun.teeth) and twice a planet's teeth"
    require(between % 2 == 0 and between > 0, "ring.teeth", ring.teeth, allowed)
    _check_places(design)
    diameter, fitting = planet.pitch_diameter, sun.pitch_diameter * between / (2.0 * sun.teeth)
    allowed = f"{fitting:g} mm within 0.1 % (module of the sun, and teeth between sun and ring)"
    fits = abs(diameter / fitting - 1.0) <= 1e-3
    require(fits, "planet.pitch_diameter", diameter, allowed)
    _check_teeth(design)
    allowed = f"divisors of {ring.elements} (ring.elements)"
    require(ring.elements % ring.supports == 0, "ring.supports", ring.supports, allowed)
    check_rims(design, "rim", [ring.rim])
    springs = ring.radial, ring.tangential, ring.torsional
    radius = 1e-3 * (ring.root_radius + 0.5 * ring.rim)
    held = supports_restrain_ring(ring.supports, *springs, radius)
    against = "against rigid translation and rotation"
    allowed = f"supports whose stiffnesses hold the ring {against}"
    require(held, "ring.supports", ring.supports, allowed)


def check_rims(design: PlanetaryParts, key: str, rims: list[float]) -> None:
    """Refuse rims (mm) that are thicker than the radius of their centre line."""
    thickest = design.ring.root_radius / (1.0 / THICKEST - 0.5)
    allowed = f"above 0 to {thickest:g} mm (a rim as thick as the radius of its centre line)"
    for rim in rims:
        require(rim <= thickest, f"ring.{key}", rim, allowed)


def _check_places(design: PlanetaryParts) -> None:
    """Refuse planets that cannot be assembled where they are."""
    planet, both = design.planet, design.sun.teeth + design.ring.teeth
    if not planet.angles:
        allowed = f"divisors of {both} (sun.teeth + ring.teeth), or equally spaced planets do not "
        require(both % planet.count == 0, "planet.count", planet.count, allowed + "fit in")
        return
    allowed = f"{planet.count} ascending angles (planet.count), the first 0"
    rising = planet.angles[0] == 0.0 and bool(np.all(np.diff(planet.angles) > 0.0))
    whole = rising and len(planet.angles) == planet.count
    require(whole, "planet.angles", planet.angles, allowed)
    for angle in planet.angles:
        step = angle * both / 360.0
        allowed = (
            f"multiples of {360.0 / both:.6g} deg (360 deg over sun.teeth + ring.teeth), where "
            "planets fit in"
        )
        require(abs(step - round(step)) <= PLACE_TOLERANCE, "planet.angles", angle, allowed)


def _check_teeth(design: PlanetaryParts) -> None:
    """Refuse planets that overlap, a rim that is not outside the teeth, and too much backlash."""
    sun, planet, ring, mesh = design.sun, design.planet, design.ring, design.mesh
    module = design.module
    centres = 0.5 * (sun.pitch_diameter + planet.pitch_diameter)
    tips = planet.pitch_diameter + 2.0 * ADDENDUM * module
    least = 2.0 * math.asin(0.5 * tips / centres) if tips < 2.0 * centres else math.pi
    largest = int(2.0 * math.pi / least)
    touch = f"the tips of more planets overlap: tip diameter {tips:g} mm, addendum one module"
    require(planet.count <= largest, "planet.count", planet.count, f"2 to {largest}; {touch}")
    gaps = np.diff([*planet.angles, 360.0 + planet.angles[0]]) if planet.angles else np.array([])
    allowed = f"{math.degrees(least):.6g} deg or more from one to the next, or tips overlap"
    require(not (gaps < math.degrees(least)).any(), "planet.angles", planet.angles, allowed)
    pitch = 0.5 * sun.pitch_diameter + planet.pitch_diameter
    deepest = pitch + DEEPEST * module
    allowed = f"above {pitch:g} mm (pitch radius) to {deepest:g} mm ({DEEPEST:g} modules outside)"
    require(pitch < ring.root_radius <= deepest, "ring.root_radius", ring.root_radius, allowed)
    half = 250.0 * math.pi * module * math.cos(math.radians(mesh.pressure_angle))
    allowed = f"0 to {half:.6g} µm (a quarter of the base pitch)"
    require(mesh.half_backlash <= half, "mesh.half_backlash", mesh.half_backlash, allowed)
