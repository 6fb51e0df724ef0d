"""Design file of a cascade gearbox. The source gives few of its data: the others are inputs with
plausible values."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

import numpy as np
from annotated_types import Ge, Len

from swgpar.gear_trains.common_sections import GearTrain, Positive, TrainDesign, require_steps
from swgpar.input.quantities import Section, not_negative, positive, quantity
from swgpar.input.require import require

PINIONS = 8
PAIRS, SIDES = PINIONS // 2, 2
MESH_COUNTS = {"rack_pinion": PINIONS, "g1_g1": PAIRS, "g1_g2": PAIRS, "g3_g4": SIDES}
"""Meshes of the gearbox by kind: rack with pinions 1 to 8; even with odd G1 of a pair; odd G1 with
G2; G3 with G4."""

Direction = Literal["A", "B"]
MeshGaps = list[Annotated[float, Ge(0.0)]]
Ratios = Annotated[list[Positive], Len(PINIONS, PINIONS)]
Forces = Annotated[list[Positive], Len(1)]
GRADES: dict[str, Any] = {"ge": 0.0, "le": 12.0}


class CascadeTrain(GearTrain):
    model: Literal["cascade"] = quantity(text="the gear train")


class Rack(Section):
    mass: float = positive("mass of the rack", "kg")
    length: float = positive("toothed length; the circumference in the tolerance formulas", "m")
    pitch_grade: float = quantity(text="ISO 1328 grade of the pitch deviation", **GRADES)
    runout_grade: float = quantity(text="ISO 1328 grade of the runout", **GRADES)


class CascadeGear(Section):
    teeth: int = quantity(text="number of teeth", ge=6, le=1000)
    inertia: float = positive("moment of inertia", "kg·m²")
    face_width: float = positive("face width", "mm")
    pitch_grade: float = quantity(text="ISO 1328 grade of the pitch deviation", **GRADES)
    runout_grade: float = quantity(text="ISO 1328 grade of the runout", **GRADES)
    position: float = not_negative("tolerance of the shaft position, plus or minus", "mm")
    axle_angle: float = not_negative("tolerance of the shaft direction, plus or minus", "mrad")


class CascadeMesh(Section):
    module: float = positive("module", "mm")
    stiffness: float = positive("mean mesh stiffness", "N/m")
    variation: float = not_negative(
        "amplitude of the mesh stiffness over its mean", default=0.0, lt=1.0
    )
    gap_A: float = not_negative(
        "backlash at the pitch line up to the flanks that carry load in direction A", "mm", 0.0
    )
    gap_B: float = not_negative(
        "backlash at the pitch line up to the flanks that carry load in direction B", "mm", 0.0
    )
    gaps_A: MeshGaps = quantity(
        [], unit="mm", text="`gap_A` of each mesh of this kind in its place, each 0 or above"
    )
    gaps_B: MeshGaps = quantity(
        [], unit="mm", text="`gap_B` of each mesh of this kind in its place, each 0 or above"
    )

    def gaps(self, direction: Direction, count: int) -> np.ndarray:
        """Backlash of the `count` meshes of this kind in a direction, (count,) m."""
        given = getattr(self, f"gaps_{direction}") or [getattr(self, f"gap_{direction}")] * count
        return 1e-3 * np.array(given)


class FlexUnit(Section):
    ratio: Ratios = quantity(
        text="stiffness ratios of the units of pinions 1 to 8 to their mean (Table 3), each above 0"
    )
    stiffness: float = positive("mean stiffness beyond `linear_above`", "N·m/deg")
    linear_above: float = positive("deformation beyond which the stiffness is constant", "mm")
    initial_stiffness: float = positive("mean stiffness at zero deformation", "N·m/deg")
    radius: float = positive("radius at which the deformation is measured", "mm")
    largest_deformation: float | None = positive(
        "largest deformation allowed; with it limit loads are computed", "mm", None
    )


class Shafts(Section):
    g2_g3: float = positive("stiffness of a shaft between G2 and G3", "N·m/rad")
    g4_flywheel: float = positive("stiffness of the shaft between G4 and flywheel", "N·m/rad")


class Flywheel(Section):
    inertia: float = positive("moment of inertia with the generator", "kg·m²")
    generator: float = positive("damping constant of the generator: torque over speed", "N·m·s/rad")


class CascadeDamping(Section):
    metal: float = not_negative("damping over stiffness of meshes in contact and of shafts", "s")
    flex: float = not_negative("damping over stiffness of the flexible units", "s")
    contact_ramp: float = positive(
        "penetration of the flanks over which the contact damping rises to its full value "
        "(smooth step, eq. 10)",
        "µm",
    )


class CascadeLoad(Section):
    forces: Forces = quantity(
        unit="kN", text="rack forces for which load shares are reported, each above 0"
    )
    peak: float = positive("largest rack force, of the period and the population_tasks", "kN")
    period: float = quantity(
        unit="s",
        text="period of the sinusoidal rack force; its first half is direction B",
        ge=0.01,
    )
    braked: float = positive("rack force with the flywheel fixed by its brake", "kN")
    braked_ramp: float = positive("rise time of the rack force against the brake", "s", 0.2)
    braked_hold: float = positive(
        "hold time of that force; load shares are means over its second half", "s", 0.2
    )
    overload: float = not_negative("allowed excess of a load share over 1/8", lt=0.875)

    @property
    def largest_share(self) -> float:
        """Load share above which a pinion is overloaded."""
        return 1.0 / PINIONS + self.overload


class Tolerances(Section):
    samples: int = quantity(text="samples of the tolerance stack-up", ge=10, le=10_000_000)
    pressure_angle: float = positive("pressure angle of all meshes", "deg", 20.0, lt=45.0)
    limit: float = positive(
        "distance of the tolerance limits from the mean", "standard deviations", 3.0
    )


class Population(Section):
    gearboxes: int = quantity(text="gearboxes with random pitch errors", ge=1, le=1_000_000)
    direction: Direction = quantity("B", text="direction of the rack force of the population")
    ramp: float = positive("rise time of the rack force of the population in motion", "s")
    hold: float = positive("hold time of that force; load shares are means over it", "s")
    step: float = positive("time step of the population in motion", "s")


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
    for name, count in MESH_COUNTS.items():
        mesh = getattr(design, name)
        half = 0.5 * math.pi * mesh.module
        within = f"0 to {half:.6g} mm (half of the pitch, {name}.module)"
        for side in ("A", "B"):
            gap, gaps = getattr(mesh, f"gap_{side}"), getattr(mesh, f"gaps_{side}")
            require(gap <= half, f"{name}.gap_{side}", gap, within)
            allowed = f"no or {count} numbers, one for each mesh"
            require(len(gaps) in (0, count), f"{name}.gaps_{side}", gaps, allowed)
            for one in gaps:
                require(one <= half, f"{name}.gaps_{side}", one, within)
    peak, section = design.load.peak, design.population
    for force in design.load.forces:
        require(force <= peak, "load.forces", force, f"above 0 to {peak:g} kN (load.peak)")
    allowed = f"above 0 to {section.hold:g} s (population.hold)"
    require(section.step <= section.hold, "population.step", section.step, allowed)
    require_steps("population.step", section.step, section.ramp + section.hold)
