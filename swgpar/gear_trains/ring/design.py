"""Design file of an elastic ring."""

from __future__ import annotations

from typing import Annotated, Literal

from annotated_types import Len

from swgpar.errors import InputError
from swgpar.gear_trains.common_sections import GearTrain, Positive, TrainDesign
from swgpar.input.quantities import Section, not_negative, positive, quantity
from swgpar.input.require import require
from swgpar.vibration.curved_beam import BeamSection, Ring, supports_restrain_ring
from swgpar.vibration.thickness_limit import THICKEST, displacement_remark, frequency_remark

LEAST_STEPS = 10
"""Steps in a cycle of the harmonic part, which is linear within them: its amplitude is 3 % less."""

Speeds = Annotated[list[Positive], Len(1)]


class RingTrain(GearTrain):
    model: Literal["ring"] = quantity(text="the gear train")


class RingBody(Section):
    E: float = positive("modulus of elasticity", "GPa")
    nu: float = quantity(0.3, text="Poisson's ratio", gt=-1.0, le=0.5)
    density: float = positive("density", "kg/m³")
    outer_radius: float = positive("outer radius", "mm")
    inner_radius: float = positive("inner radius", "mm")
    face_width: float = positive("face width", "mm")
    elements: int = quantity(text="curved-beam elements", ge=3, le=2000)
    modes: int = quantity(6, text="bending modes that are listed", ge=1, le=100)


class RingSupports(Section):
    count: int = quantity(text="equally spaced supports; the first at angle 0", ge=1)
    radial: float = not_negative("radial stiffness of each", "N/m")
    tangential: float = not_negative("tangential stiffness of each", "N/m")
    torsional: float = not_negative("torsional stiffness of each", "N·m/rad")


class RingTeeth(Section):
    count: int = quantity(text="equally spaced teeth", ge=1)
    mass: float = not_negative("mass of each", "kg")
    inertia: float = not_negative("moment of inertia of each", "kg·m²")


class MovingLoad(Section):
    loads: int = quantity(3, text="equally spaced loads", ge=1, le=100)
    pressure_angle: float = not_negative("pressure angle", "deg", 20.0, lt=90.0)
    radius: float | None = positive(
        "radius on which loads act, such as the pitch radius", "mm", None
    )
    force: float = not_negative("mean force of each", "N")
    harmonic: float = not_negative("amplitude of its harmonic part", "N", 0.0)
    frequency: float = not_negative("frequency of the harmonic part", "rad/s", 0.0)
    cycles: float | None = positive(
        "cycles of the harmonic part in a revolution of the loads, in place of `frequency`",
        default=None,
        le=10_000.0,
    )
    noise: float = not_negative("amplitude of the white noise of each", "N·√s", 0.0)
    damping_mass: float = not_negative("damping over mass", "1/s")
    damping_stiffness: float = not_negative("damping over stiffness", "s")
    speeds: Speeds = quantity(
        unit="rad/s", text="speeds of the loads, each above 0; the first is the reference"
    )
    sweep: Speeds = quantity(
        unit="rad/s", text="first and last speed of the curve of critical speeds, each above 0"
    )
    sweep_speeds: int = quantity(120, text="speeds of that curve", ge=2, le=10_000)
    revolutions: int = quantity(
        2, text="revolutions of the loads; results are those of the last", ge=1, le=1000
    )
    steps: int = quantity(720, text="time steps of a revolution", ge=36, le=10_000_000)
    samples: int = quantity(
        200, text="Monte Carlo simulations at the first speed", ge=2, le=1_000_000
    )


class RingDesign(TrainDesign):
    """A ring, what holds it and what moves in it. Attributes are the sections of the design
    file."""

    gear_train: RingTrain
    ring: RingBody
    supports: RingSupports | None = None
    teeth: RingTeeth | None = None
    moving_load: MovingLoad | None = None

    def remarks(self) -> list[str]:
        texts = self.remark_on_modes, self.remark_on_loads, self._remark_on_steps
        return [text for text in texts if text]

    @property
    def remark_on_modes(self) -> str:
        """Where beam theory ends for the modes, or nothing."""
        body = self.ring
        mean = 0.5 * (body.outer_radius + body.inner_radius)
        return frequency_remark(body.outer_radius - body.inner_radius, mean, body.modes)

    @property
    def remark_on_loads(self) -> str:
        """Where beam theory ends for the moving loads, or nothing."""
        body, s = self.ring, self.supports
        if self.moving_load is None or s is None:
            return ""
        mean = 0.5 * (body.outer_radius + body.inner_radius)
        return displacement_remark(body.outer_radius - body.inner_radius, mean, s.count)

    @property
    def _remark_on_steps(self) -> str:
        """Where the steps are too long for the harmonic part, or nothing."""
        load = self.moving_load
        if load is None or load.harmonic == 0.0:
            return ""
        slowest = min(*load.speeds, *load.sweep)
        cycles = load.frequency / slowest
        if cycles * LEAST_STEPS <= load.steps:
            return ""
        return (
            f"moving_load.frequency = {load.frequency:g} rad/s has {cycles:.3g} cycles in a "
            f"revolution at {slowest:g} rad/s: the harmonic part is another one with fewer than "
            f"{LEAST_STEPS} of moving_load.steps in a cycle"
        )

    def beam_section(self) -> BeamSection:
        """The rectangular section."""
        body = self.ring
        thickness, width = 1e-3 * (body.outer_radius - body.inner_radius), 1e-3 * body.face_width
        radius = 0.5e-3 * (body.outer_radius + body.inner_radius)
        return BeamSection.rectangle(1e9 * body.E, body.nu, body.density, radius, thickness, width)

    def elastic_ring(self) -> Ring:
        """The ring with its supports and teeth."""
        s, t = self.supports, self.teeth
        return Ring(
            self.beam_section(),
            self.ring.elements,
            (s.count, (s.radial, s.tangential, s.torsional)) if s is not None else None,
            (t.count, (t.mass, t.mass, t.inertia)) if t is not None else None,
        )


def check_fit(design: RingDesign) -> None:
    """Refuse values that do not fit each other."""
    body, load = design.ring, design.moving_load
    inner, outer, elements = body.inner_radius, body.outer_radius, body.elements
    least = outer * (1.0 - 0.5 * THICKEST) / (1.0 + 0.5 * THICKEST)
    thick = "a ring as thick as the radius of its centre line"
    allowed = f"{least:g} mm ({thick}) to below {outer:g} mm (ring.outer_radius)"
    require(least <= inner < outer, "ring.inner_radius", inner, allowed)
    allowed = f"divisors of {elements} (ring.elements)"
    for name in ("supports", "teeth"):
        section = getattr(design, name)
        if section is not None:
            require(elements % section.count == 0, f"{name}.count", section.count, allowed)
    allowed = f"1 to {elements} (ring.elements)"
    require(body.modes <= elements, "ring.modes", body.modes, allowed)
    if load is not None:
        _check_load(design, load)


def _check_load(design: RingDesign, load: MovingLoad) -> None:
    s, body, damping = design.supports, design.ring, load.damping_stiffness
    if s is None:
        raise InputError(
            "supports is missing: allowed only without moving_load, which would carry the ring away"
        )
    radius = 0.5e-3 * (body.inner_radius + body.outer_radius)
    held = supports_restrain_ring(s.count, s.radial, s.tangential, s.torsional, radius)
    what = "the ring under moving_load against rigid translation and rotation"
    allowed = f"stiffnesses of the supports that hold {what}"
    require(held, "supports.tangential", s.tangential, allowed)
    why = "without moving_load.damping_mass, or noise would add up for ever"
    fits = load.damping_mass + damping > 0.0
    require(fits, "moving_load.damping_stiffness", damping, f"above 0 to inf s {why}")
    allowed = f"at least {2 * s.count}, for a node between two supports"
    require(body.elements // s.count >= 2, "ring.elements", body.elements, allowed)
    allowed = f"multiples of {load.loads} (moving_load.loads)"
    require(load.steps % load.loads == 0, "moving_load.steps", load.steps, allowed)
    if load.cycles is not None:
        allowed = "0 with moving_load.cycles"
        require(load.frequency == 0.0, "moving_load.frequency", load.frequency, allowed)
        allowed = (
            f"above 0 to {load.steps / LEAST_STEPS:g} ({LEAST_STEPS} of moving_load.steps each)"
        )
        fits = load.cycles * LEAST_STEPS <= load.steps
        require(fits, "moving_load.cycles", load.cycles, allowed)
    if load.radius is not None:
        innermost, outer = 0.5 * body.inner_radius, body.outer_radius
        allowed = (
            f"{innermost:g} mm (half of ring.inner_radius) to {outer:g} mm (ring.outer_radius)"
        )
        fits = innermost <= load.radius <= outer
        require(fits, "moving_load.radius", load.radius, allowed)
    fits = len(load.sweep) == 2 and load.sweep[0] < load.sweep[1]
    require(fits, "moving_load.sweep", load.sweep, "two speeds, the lower one first")
