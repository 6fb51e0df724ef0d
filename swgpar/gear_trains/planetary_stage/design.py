"""Design file of a planetary stage under a steady torque, with errors and tolerances."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from annotated_types import Ge, Le

from swgpar.errors import InputError
from swgpar.gear_trains.common_sections import GearTrain
from swgpar.gear_trains.planetary_parts.sections import (
    MeshCycle,
    Meshes,
    Planet,
    PlanetaryParts,
    ShaftEnds,
    check_parts,
)
from swgpar.gear_trains.planetary_stage.tooth_meshes.helical import HelicalTeeth, mesh_cycle
from swgpar.gear_trains.planetary_stage.tooth_meshes.plane_pair import TipRelief
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
    sun_stiffness: float | None = positive("mean stiffness of sun and planet", "N/m", None)
    ring_stiffness: float | None = positive("mean stiffness of ring and planet", "N/m", None)
    variation: float | None = not_negative(
        "amplitude of the mesh stiffness over its mean", "", None, le=0.4
    )
    sun_contact_ratio: float | None = quantity(
        None, text="contact ratio of sun and planet", ge=1.0, le=2.0
    )
    ring_contact_ratio: float | None = quantity(
        None, text="contact ratio of ring and planet", ge=1.0, le=2.0
    )
    phase: float | None = quantity(
        None, unit="cycles", text="phase of ring meshes behind sun meshes", ge=-1.0, le=1.0
    )


GIVEN = (
    *("sun_stiffness", "ring_stiffness", "variation"),
    *("sun_contact_ratio", "ring_contact_ratio", "phase"),
)
"""Keys of [mesh] without [teeth]."""


class TeethSection(Section):
    stiffness: Literal["iso_6336", "plane"] = quantity(
        "iso_6336", text="mesh stiffness by ISO 6336-1, method B, or by plane finite elements"
    )
    addendum: float = positive("addendum of all gears", "modules", 1.0, le=1.5)
    dedendum: float = positive("dedendum of all gears", "modules", 1.25, le=1.8)
    sun_shift: float = quantity(
        0.0,
        unit="modules",
        text="profile shift of the sun; that of the planets is the opposite",
        ge=-1.0,
        le=1.0,
    )
    tip_relief: float = not_negative(
        'relief of all tips along the line of action, with stiffness = "plane"', "µm", 0.0
    )
    relief_length: float = positive(
        "length of the relief along the path of contact from its ends, in pitches of the base "
        "circles",
        "pitches",
        0.2,
        le=1.0,
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
    teeth: TeethSection | None = None
    load: StageLoad
    rotor: Rotor | None = None
    generator: Generator | None = None
    errors: Errors = Errors()
    tolerances: StageTolerances | None = None

    @property
    def mesh_cycle(self) -> MeshCycle:
        if self.teeth is not None:
            return mesh_cycle(self.gear_teeth(self.teeth), self.tooth_load, self.teeth.stiffness)
        m = self.mesh
        found = [getattr(m, name) for name in GIVEN]
        sun, ring, variation, *contact_ratio, phase = found
        overlap = self.ring.face_width * np.tan(np.radians(m.helix)) / (np.pi * self.module)
        ratios = contact_ratio[0], contact_ratio[1]
        return MeshCycle((sun, ring), (variation, variation), ratios, phase, float(overlap))

    @property
    def tooth_load(self) -> float:
        """Load of a mesh along its line of action over the face width, N/mm."""
        lever = 1e-3 * (self.sun.pitch_diameter + self.planet.pitch_diameter)
        force = self.load.torque / (self.planet.count * lever)
        return force / np.cos(np.radians(self.mesh.pressure_angle)) / self.ring.face_width

    def gear_teeth(self, teeth: TeethSection) -> HelicalTeeth:
        """What the meshes need to know of the teeth."""
        ring = self.ring
        return HelicalTeeth(
            (self.sun.teeth, self.planet_teeth, ring.teeth),
            self.module,
            float(np.radians(self.mesh.pressure_angle)),
            float(np.radians(self.mesh.helix)),
            (teeth.addendum, teeth.dedendum, teeth.sun_shift),
            ring.face_width,
            (1e3 * ring.E, ring.nu),
            TipRelief(1e-3 * teeth.tip_relief, teeth.relief_length),
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
    _check_meshes(design)
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
    if design.teeth is not None:
        relief, allowed = design.teeth.tip_relief, f"0 to {largest:g} µm (one module)"
        require(relief <= largest, "teeth.tip_relief", relief, allowed)
    for section in (errors, design.tolerances):
        for name, field in type(section).model_fields.items() if section else ():
            if "µm" in str(field.description):
                value = getattr(section, name)
                values = value if isinstance(value, list) else [value]
                key = f"{'errors' if section is errors else 'tolerances'}.{name}"
                signed = section is errors and ("pin" in name or "pitch" in name)
                allowed = f"{-largest if signed else 0:g} to {largest:g} µm (one module)"
                for one in values:
                    require(abs(one) <= largest, key, one, allowed)
    allowed = f"0 to {largest:g} µm (one module)"
    require(planet.clearance <= largest, "planet.clearance", planet.clearance, allowed)


def _check_meshes(design: PlanetaryStageDesign) -> None:
    """Refuse keys of meshes that are missing or given twice, and teeth that do not mesh."""
    for name in GIVEN:
        value = getattr(design.mesh, name)
        if design.teeth is None and value is None:
            raise InputError(f"mesh.{name} is missing: give a number, or the section [teeth]")
        allowed = "no value with [teeth], which says it"
        require(design.teeth is None or value is None, f"mesh.{name}", value, allowed)
    if design.teeth is None:
        return
    teeth, stage = design.teeth, design.gear_teeth(design.teeth).transverse
    allowed = (
        f"less: the tips of the ring are inside its base circle ({stage.ring.base_radius:g} mm)"
    )
    outside = stage.ring.tip_radius > stage.ring.base_radius
    require(outside, "teeth.addendum", teeth.addendum, allowed)
    for name, mesh in zip(("sun", "ring"), stage.meshes, strict=True):
        allowed = (
            f"values with a contact ratio of {name} and planet from 1 to below 2, not "
            f"{mesh.contact_ratio:.4g}"
        )
        require(1.0 <= mesh.contact_ratio < 2.0, "teeth.addendum", teeth.addendum, allowed)
    allowed = '0 with teeth.stiffness = "iso_6336", which has no relief; "plane" has'
    relieved = teeth.stiffness == "plane" or teeth.tip_relief == 0.0
    require(relieved, "teeth.tip_relief", teeth.tip_relief, allowed)
    deeper = teeth.dedendum > teeth.addendum
    allowed = f"above {teeth.addendum:g} modules (teeth.addendum): tips need clearance"
    require(deeper, "teeth.dedendum", teeth.dedendum, allowed)
