"""Design file of a planetary stage under a steady torque, with errors and tolerances."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from annotated_types import Ge, Le

from swgpar.gear_trains.common_sections import GearTrain
from swgpar.gear_trains.planetary_parts.sections import (
    MeshCycle,
    Meshes,
    Planet,
    PlanetaryParts,
    ShaftEnds,
    check_parts,
)
from swgpar.input.quantities import Section, not_negative, positive, quantity
from swgpar.input.require import require

Numbers = list[float]
Phases = list[Annotated[float, Ge(-360.0), Le(360.0)]]


def _list(unit: str, text: str) -> Any:
    return quantity([], unit=unit, text=f"{text}; none without it")


class PlanetaryStageTrain(GearTrain):
    model: Literal["planetary_stage"] = quantity(text="the gear train")


class StagePlanet(Planet):
    clearance: float = not_negative("radial clearance of the bearing of each", "µm", 0.0)


class StageMeshes(Meshes):
    helix: float = not_negative("helix angle at the pitch circles", "deg", 0.0, le=45.0)
    sun_stiffness: float = positive("mean stiffness of sun and planet", "N/m")
    ring_stiffness: float = positive("mean stiffness of ring and planet", "N/m")
    variation: float = not_negative(
        "amplitude of the mesh stiffness over its mean", "", 0.0, le=0.4
    )
    sun_contact_ratio: float = quantity(1.5, text="contact ratio of sun and planet", ge=1.0, le=2.0)
    ring_contact_ratio: float = quantity(
        1.5, text="contact ratio of ring and planet", ge=1.0, le=2.0
    )
    phase: float = quantity(
        0.0, unit="cycles", text="phase of ring meshes behind sun meshes", ge=-1.0, le=1.0
    )


class StageLoad(Section):
    torque: float = positive("torque on the carrier, in the sense in which it turns", "N·m")
    gravity: float = not_negative("acceleration of gravity", "m/s²", 0.0, le=100.0)
    down: float = quantity(
        -90.0, unit="deg", text="direction of gravity from the first support", ge=-360.0, le=360.0
    )
    positions: int = quantity(
        500, text="places of the carrier in one revolution", ge=2, le=1_000_000
    )


class Rotor(Section):
    inertia: float = positive("moment of inertia", "kg·m²")
    torsional: float = positive("torsional stiffness of its shaft to the carrier", "N·m/rad")


class Generator(Section):
    inertia: float = positive(
        "moment of inertia at the end of the shaft of the sun, reduced to its speed", "kg·m²"
    )


class Errors(Section):
    pin_radial: Numbers = _list("µm", "outward error of the pin of each planet")
    pin_tangential: Numbers = _list("µm", "error of each pin in the sense of the carrier")
    sun_eccentricity: float = not_negative("eccentricity of the sun", "µm", 0.0)
    sun_phase: float = quantity(
        0.0, unit="deg", text="its direction from the first planet", ge=-360.0, le=360.0
    )
    planet_eccentricity: list[Annotated[float, Ge(0.0)]] = _list(
        "µm", "eccentricity of each planet"
    )
    planet_phase: Phases = _list("deg", "direction of each, from outward")
    ring_eccentricity: float = not_negative("eccentricity of the ring", "µm", 0.0)
    ring_phase: float = quantity(
        0.0, unit="deg", text="its direction from the first support", ge=-360.0, le=360.0
    )
    sun_pitch: Numbers = _list("µm", "how far the loaded flank of each tooth of the sun is ahead")
    planet_pitch: Numbers = _list("µm", "the same of the first planet")
    ring_pitch: Numbers = _list("µm", "the same of the ring")


class StageTolerances(Section):
    pin: float = not_negative("of pins outward and along, plus or minus", "µm", 0.0)
    sun_eccentricity: float = not_negative("of the sun, plus or minus in x and y", "µm", 0.0)
    planet_eccentricity: float = not_negative("of the planets, likewise", "µm", 0.0)
    ring_eccentricity: float = not_negative("of the ring, likewise", "µm", 0.0)
    pitch: float = not_negative("of the flanks of all teeth, plus or minus", "µm", 0.0)
    limits: float = positive(
        "distance of the tolerance limits from the mean", "standard deviations", 3.0
    )
    samples: int = quantity(1000, text="trains with random errors", ge=2, le=10_000_000)
    positions: int = quantity(
        36, text="places of the carrier in one revolution, of each train", ge=2, le=100_000
    )


class PlanetaryStageDesign(PlanetaryParts):
    """A planetary stage, its load and errors. Attributes are the sections of the design file."""

    gear_train: PlanetaryStageTrain
    planet: StagePlanet
    mesh: StageMeshes
    load: StageLoad
    rotor: Rotor | None = None
    generator: Generator | None = None
    errors: Errors = Errors()
    tolerances: StageTolerances | None = None

    @property
    def mesh_cycle(self) -> MeshCycle:
        m = self.mesh
        return MeshCycle(
            (m.sun_stiffness, m.ring_stiffness),
            (m.variation, m.variation),
            (m.sun_contact_ratio, m.ring_contact_ratio),
            m.phase,
        )

    @property
    def shaft_ends(self) -> ShaftEnds:
        return ShaftEnds(
            None if self.rotor is None else (self.rotor.inertia, self.rotor.torsional),
            None if self.generator is None else self.generator.inertia,
        )

    @property
    def planet_teeth(self) -> int:
        return (self.ring.teeth - self.sun.teeth) // 2

    def remarks(self) -> list[str]:
        sentence = self.remark_on_rim(self.ring.rim)
        return [sentence] if sentence else []


def check_fit(design: PlanetaryStageDesign) -> None:
    """Refuse values that do not fit each other."""
    check_parts(design)
    planet, errors = design.planet, design.errors
    of_planets = "pin_radial", "pin_tangential", "planet_eccentricity", "planet_phase"
    counts = dict.fromkeys(of_planets, (planet.count, "planet.count"))
    counts["sun_pitch"] = design.sun.teeth, "sun.teeth"
    counts["planet_pitch"] = design.planet_teeth, "teeth of a planet"
    counts["ring_pitch"] = design.ring.teeth, "ring.teeth"
    for name, (count, what) in counts.items():
        given = getattr(errors, name)
        allowed = f"no or {count} numbers ({what})"
        require(len(given) in (0, count), f"errors.{name}", given, allowed)
    same = len(errors.planet_phase) <= len(errors.planet_eccentricity)
    allowed = "with errors.planet_eccentricity only"
    require(same, "errors.planet_phase", errors.planet_phase, allowed)
    largest = 1e3 * design.module
    for section in (errors, design.tolerances):
        for name, field in type(section).model_fields.items() if section else ():
            if "µm" in str(field.description):
                value = getattr(section, name)
                values = value if isinstance(value, list) else [value]
                key = f"{'errors' if section is errors else 'tolerances'}.{name}"
                for one in values:
                    allowed = f"up to {largest:g} µm (one module)"
                    require(abs(one) <= largest, key, one, allowed)
    allowed = f"0 to {largest:g} µm (one module)"
    require(planet.clearance <= largest, "planet.clearance", planet.clearance, allowed)
