"""Design file of a cascade gearbox. The source gives few of its data: the others are inputs with
plausible values."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from annotated_types import Len

from swgpar.gear_trains.common_sections import GearTrain, Positive, TrainDesign, require_steps
from swgpar.input.quantities import Section, quantity
from swgpar.input.require import require

PINIONS = 8
Ratios = Annotated[list[Positive], Len(PINIONS, PINIONS)]
Forces = Annotated[list[Positive], Len(1)]
GRADES: dict[str, Any] = {"ge": 0.0, "le": 12.0}


class CascadeTrain(GearTrain):
    model: Literal["cascade"] = quantity(text="the gear train")


class Rack(Section):
    mass: float = quantity(unit="kg", text="mass of the rack", gt=0.0)
    length: float = quantity(
        unit="m", text="toothed length; the circumference in the tolerance formulas", gt=0.0
    )
    pitch_grade: float = quantity(text="ISO 1328 grade of the pitch deviation", **GRADES)
    runout_grade: float = quantity(text="ISO 1328 grade of the runout", **GRADES)


class CascadeGear(Section):
    teeth: int = quantity(text="number of teeth", ge=6, le=1000)
    inertia: float = quantity(unit="kg·m²", text="moment of inertia", gt=0.0)
    face_width: float = quantity(unit="mm", text="face width", gt=0.0)
    pitch_grade: float = quantity(text="ISO 1328 grade of the pitch deviation", **GRADES)
    runout_grade: float = quantity(text="ISO 1328 grade of the runout", **GRADES)
    position: float = quantity(
        unit="mm", text="tolerance of the shaft position, plus or minus", ge=0.0
    )
    axle_angle: float = quantity(
        unit="mrad", text="tolerance of the shaft direction, plus or minus", ge=0.0
    )


class CascadeMesh(Section):
    module: float = quantity(unit="mm", text="module", gt=0.0)
    stiffness: float = quantity(unit="N/m", text="mean mesh stiffness", gt=0.0)
    variation: float = quantity(
        0.0, text="amplitude of the mesh stiffness over its mean", ge=0.0, lt=1.0
    )
    gap_A: float = quantity(
        0.0,
        unit="mm",
        text="backlash at the pitch line up to the flanks that carry load in direction A",
        ge=0.0,
    )
    gap_B: float = quantity(
        0.0,
        unit="mm",
        text="backlash at the pitch line up to the flanks that carry load in direction B",
        ge=0.0,
    )


class FlexUnit(Section):
    ratio: Ratios = quantity(
        text="stiffness ratios of the units of pinions 1 to 8 to their mean (Table 3), each above 0"
    )
    stiffness: float = quantity(unit="N·m/deg", text="mean stiffness beyond `linear_above`", gt=0.0)
    linear_above: float = quantity(
        unit="mm", text="deformation beyond which the stiffness is constant", gt=0.0
    )
    initial_stiffness: float = quantity(
        unit="N·m/deg", text="mean stiffness at zero deformation", gt=0.0
    )
    radius: float = quantity(unit="mm", text="radius at which the deformation is measured", gt=0.0)


class Shafts(Section):
    g2_g3: float = quantity(unit="N·m/rad", text="stiffness of a shaft between G2 and G3", gt=0.0)
    g4_flywheel: float = quantity(
        unit="N·m/rad", text="stiffness of the shaft between G4 and flywheel", gt=0.0
    )


class Flywheel(Section):
    inertia: float = quantity(unit="kg·m²", text="moment of inertia with the generator", gt=0.0)
    generator: float = quantity(
        unit="N·m·s/rad", text="damping constant of the generator: torque over speed", gt=0.0
    )


class CascadeDamping(Section):
    metal: float = quantity(
        unit="s", text="damping over stiffness of meshes in contact and of shafts", ge=0.0
    )
    flex: float = quantity(unit="s", text="damping over stiffness of the flexible units", ge=0.0)
    contact_ramp: float = quantity(
        unit="µm",
        text="penetration of the flanks over which the contact damping rises to its full value "
        "(smooth step, eq. 10)",
        gt=0.0,
    )


class CascadeLoad(Section):
    forces: Forces = quantity(
        text="rack forces for which load shares are reported (kN), each above 0"
    )
    peak: float = quantity(
        unit="kN", text="largest rack force, of the period and the population_tasks", gt=0.0
    )
    period: float = quantity(
        unit="s",
        text="period of the sinusoidal rack force; its first half is direction B",
        ge=0.01,
    )
    braked: float = quantity(
        unit="kN", text="rack force with the flywheel fixed by its brake", gt=0.0
    )
    braked_ramp: float = quantity(
        0.2, unit="s", text="rise time of the rack force against the brake", gt=0.0
    )
    braked_hold: float = quantity(
        0.2,
        unit="s",
        text="hold time of that force; load shares are means over its second half",
        gt=0.0,
    )
    overload: float = quantity(text="allowed excess of a load share over 1/8", ge=0.0, lt=0.875)

    @property
    def largest_share(self) -> float:
        """Load share above which a pinion is overloaded."""
        return 1.0 / PINIONS + self.overload


class Tolerances(Section):
    samples: int = quantity(text="samples of the tolerance stack-up", ge=10, le=10_000_000)
    pressure_angle: float = quantity(
        20.0, unit="deg", text="pressure angle of all meshes", gt=0.0, lt=45.0
    )
    limit: float = quantity(
        3.0,
        unit="standard deviations",
        text="distance of the tolerance limits from the mean",
        gt=0.0,
    )


class Population(Section):
    gearboxes: int = quantity(text="gearboxes with random pitch errors", ge=1, le=1_000_000)
    ramp: float = quantity(
        unit="s", text="rise time of the rack force of the population in motion", gt=0.0
    )
    hold: float = quantity(
        unit="s", text="hold time of that force; load shares are means over it", gt=0.0
    )
    step: float = quantity(unit="s", text="time step of the population in motion", gt=0.0)


class CascadeDesign(TrainDesign):
    """A cascade gearbox, its load and its tolerances. Attributes are the sections of the design
    file."""

    gear_train: CascadeTrain
    rack: Rack
    pinion: CascadeGear
    g1: CascadeGear
    g2: CascadeGear
    g3: CascadeGear
    g4: CascadeGear
    rack_pinion: CascadeMesh
    g1_g1: CascadeMesh
    g1_g2: CascadeMesh
    g3_g4: CascadeMesh
    flex_unit: FlexUnit
    shafts: Shafts
    flywheel: Flywheel
    damping: CascadeDamping
    load: CascadeLoad
    tolerances: Tolerances
    population: Population

    def radius(self, gear: str) -> float:
        """Pitch radius of a gear, m."""
        return 0.5e-3 * getattr(self, gear).teeth * getattr(self, MODULE_OF[gear]).module

    @property
    def ratio(self) -> float:
        """Speed of the flywheel over that of the pinions."""
        return self.g1.teeth / self.g2.teeth * self.g3.teeth / self.g4.teeth


MODULE_OF = {"pinion": "rack_pinion", "g1": "g1_g2", "g2": "g1_g2", "g3": "g3_g4", "g4": "g3_g4"}
"""The mesh whose module a gear has."""


def check_fit(design: CascadeDesign) -> None:
    """Refuse values that do not fit each other."""
    module, other = design.g1_g1.module, design.g1_g2.module
    require(module == other, "g1_g1.module", module, f"{other:g} mm (g1_g2.module)")
    for name in ("rack_pinion", "g1_g1", "g1_g2", "g3_g4"):
        mesh = getattr(design, name)
        half = 0.5 * math.pi * mesh.module
        for key in ("gap_A", "gap_B"):
            allowed = f"0 to {half:.6g} mm (half of the pitch, {name}.module)"
            require(getattr(mesh, key) <= half, f"{name}.{key}", getattr(mesh, key), allowed)
    peak, section = design.load.peak, design.population
    for force in design.load.forces:
        require(force <= peak, "load.forces", force, f"above 0 to {peak:g} kN (load.peak)")
    allowed = f"above 0 to {section.hold:g} s (population.hold)"
    require(section.step <= section.hold, "population.step", section.step, allowed)
    require_steps("population.step", section.step, section.ramp + section.hold)
