"""Design file of a planetary gear train."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from annotated_types import Len

from swgpar.gear_trains.common_sections import (
    GearTrain,
    MonteCarlo,
    Positive,
    TrainDamping,
    TrainDesign,
)
from swgpar.input.quantities import Section, not_negative, positive, quantity
from swgpar.input.require import require
from swgpar.vibration.curved_beam import BeamSection, Ring, supports_restrain_ring
from swgpar.vibration.thickness_limit import THICKEST, displacement_remark

Thicknesses = Annotated[list[Positive], Len(1)]


ADDENDUM = 1.0
"""Of the planets, in modules: the standard one of ISO 53."""

DEEPEST = 3.0
"""Largest distance of the root of the ring from its pitch circle, in modules: the dedendum of 1.25
and profile shift."""


class PlanetaryTrain(GearTrain):
    model: Literal["planetary"] = quantity(text="the gear train")


class Sun(Section):
    teeth: int = quantity(text="number of teeth", ge=6, le=1000)
    mass: float = positive("mass", "kg")
    inertia: float = positive("moment of inertia", "kg·m²")
    pitch_diameter: float = positive("pitch diameter", "mm")
    bearing: float = not_negative("stiffness of the bearing", "N/m")
    torsional: float = positive("torsional stiffness of the shaft", "N·m/rad")


class Planet(Section):
    count: int = quantity(3, text="equally spaced planets", ge=2, le=12)
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
    rims: Thicknesses = quantity(
        text="rim thicknesses that are compared by linearisation (mm), each above 0"
    )
    face_width: float = positive("face width", "mm")
    elements: int = quantity(text="curved-beam elements", ge=3, le=200)
    supports: int = quantity(text="equally spaced supports; the first at angle 0", ge=1)
    radial: float = not_negative("radial stiffness of each support", "N/m")
    tangential: float = positive("tangential stiffness of each support", "N/m")
    torsional: float = not_negative("torsional stiffness of each support", "N·m/rad")


class Meshes(Section):
    sun_stiffness: float = positive("mean stiffness of sun and planet", "N/m")
    ring_stiffness: float = positive("mean stiffness of ring and planet", "N/m")
    pressure_angle: float = positive("pressure angle", "deg", 20.0, lt=45.0)
    half_backlash: float = not_negative("half of the backlash of all meshes", "µm")
    variation: float = not_negative("amplitude of the mesh stiffness over its mean", le=0.4)
    sun_contact_ratio: float = quantity(text="contact ratio of sun and planet", ge=1.0, le=2.0)
    ring_contact_ratio: float = quantity(text="contact ratio of ring and planet", ge=1.0, le=2.0)
    phase: float = quantity(
        0.0, unit="cycles", text="phase of ring meshes behind sun meshes", ge=-1.0, le=1.0
    )
    harmonics: int = quantity(3, text="Fourier terms of the mesh stiffness", ge=1, le=100)


class Wind(Section):
    speed: float = positive("mean speed", "km/h")
    turbulence: float = not_negative("standard deviation over the mean of the speed", le=1.0)
    length: float = positive("length of the turbulence", "m")
    a1: float = not_negative("constant of the turbulence filter", default=0.4)
    a2: float = positive("constant of the turbulence filter", default=0.25)
    air_density: float = positive("density of the air", "kg/m³", 1.225)
    rotor_radius: float = positive("radius of the rotor", "m")
    power_coefficient: float = positive("power coefficient", le=0.593)


class PlanetaryTime(Section):
    revolutions: float = positive("carrier revolutions that are computed", default=1.0, le=1000.0)
    steps: int = quantity(text="time steps in all", ge=10, le=10_000_000)
    linearised_steps: int = quantity(text="time steps of the linearisation", ge=10, le=10_000_000)
    rows: int = quantity(200, text="moments of time that are kept", ge=1, le=100_000)


class PlanetaryDesign(TrainDesign):
    """A planetary gear train and its wind. Attributes are the sections of the design file."""

    gear_train: PlanetaryTrain
    sun: Sun
    planet: Planet
    carrier: Carrier
    ring: RingGear
    mesh: Meshes
    damping: TrainDamping
    wind: Wind
    time: PlanetaryTime
    monte_carlo: MonteCarlo

    @property
    def end(self) -> float:
        """End of the simulation, s."""
        return 2.0 * math.pi / self.carrier.speed * self.time.revolutions

    def remarks(self) -> list[str]:
        rims = dict.fromkeys([self.ring.rim, *self.ring.rims])
        return [sentence for rim in rims if (sentence := self.remark_on_rim(rim))]

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


def check_fit(design: PlanetaryDesign) -> None:
    """Refuse values that do not fit each other."""
    ring, time, sun = design.ring, design.time, design.sun
    between, both, planet = ring.teeth - sun.teeth, ring.teeth + sun.teeth, design.planet
    allowed = f"{sun.teeth} (sun.teeth) and twice a planet's teeth"
    require(between % 2 == 0 and between > 0, "ring.teeth", ring.teeth, allowed)
    fits_in = "or equally spaced planets do not fit in"
    allowed = f"divisors of {both} (sun.teeth + ring.teeth), {fits_in}"
    require(both % planet.count == 0, "planet.count", planet.count, allowed)
    diameter, fitting = planet.pitch_diameter, sun.pitch_diameter * between / (2.0 * sun.teeth)
    allowed = f"{fitting:g} mm within 0.1 % (module of the sun, and teeth between sun and ring)"
    fits = abs(diameter / fitting - 1.0) <= 1e-3
    require(fits, "planet.pitch_diameter", diameter, allowed)
    _check_teeth(design)
    allowed = f"divisors of {ring.elements} (ring.elements)"
    require(ring.elements % ring.supports == 0, "ring.supports", ring.supports, allowed)
    thickest = ring.root_radius / (1.0 / THICKEST - 0.5)
    allowed = f"above 0 to {thickest:g} mm (a rim as thick as the radius of its centre line)"
    for key, rims in (("rim", [ring.rim]), ("rims", ring.rims)):
        for rim in rims:
            require(rim <= thickest, f"ring.{key}", rim, allowed)
    springs = ring.radial, ring.tangential, ring.torsional
    radius = 1e-3 * (ring.root_radius + 0.5 * ring.rim)
    held = supports_restrain_ring(ring.supports, *springs, radius)
    against = "against rigid translation and rotation"
    allowed = f"supports whose stiffnesses hold the ring {against}"
    require(held, "ring.supports", ring.supports, allowed)
    for name in ("steps", "linearised_steps"):
        count, allowed = getattr(time, name), f"multiples of {time.rows} (time.rows)"
        require(count % time.rows == 0, f"time.{name}", count, allowed)


def _check_teeth(design: PlanetaryDesign) -> None:
    """Refuse planets that overlap, a rim that is not outside the teeth, and too much backlash."""
    sun, planet, ring, mesh = design.sun, design.planet, design.ring, design.mesh
    module = sun.pitch_diameter / sun.teeth
    centres = 0.5 * (sun.pitch_diameter + planet.pitch_diameter)
    tips = planet.pitch_diameter + 2.0 * ADDENDUM * module
    largest = int(math.pi / math.asin(0.5 * tips / centres)) if tips < 2.0 * centres else 1
    fits = planet.count <= largest
    touch = f"the tips of more planets overlap: tip diameter {tips:g} mm, addendum one module"
    require(fits, "planet.count", planet.count, f"2 to {largest}; {touch}")
    pitch = 0.5 * sun.pitch_diameter + planet.pitch_diameter
    deepest = pitch + DEEPEST * module
    allowed = f"above {pitch:g} mm (pitch radius) to {deepest:g} mm ({DEEPEST:g} modules outside)"
    require(pitch < ring.root_radius <= deepest, "ring.root_radius", ring.root_radius, allowed)
    half = 250.0 * math.pi * module * math.cos(math.radians(mesh.pressure_angle))
    allowed = f"0 to {half:.6g} µm (a quarter of the base pitch)"
    require(mesh.half_backlash <= half, "mesh.half_backlash", mesh.half_backlash, allowed)
