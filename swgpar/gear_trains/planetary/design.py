"""Design file of a planetary gear train in the wind."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from annotated_types import Len

from swgpar.gear_trains.common_sections import GearTrain, MonteCarlo, Positive
from swgpar.gear_trains.planetary_parts.sections import (
    MeshCycle,
    Meshes,
    PlanetaryParts,
    RingGear,
    check_parts,
    check_rims,
)
from swgpar.input.quantities import Section, not_negative, positive, quantity
from swgpar.input.require import require

Thicknesses = Annotated[list[Positive], Len(1)]


class PlanetaryTrain(GearTrain):
    model: Literal["planetary"] = quantity(text="the gear train")


class ComparedRing(RingGear):
    rims: Thicknesses = quantity(
        unit="mm", text="rim thicknesses that are compared by linearisation, each above 0"
    )


class GivenMeshes(Meshes):
    sun_stiffness: float = positive("mean stiffness of sun and planet", "N/m")
    ring_stiffness: float = positive("mean stiffness of ring and planet", "N/m")
    variation: float = not_negative("amplitude of the mesh stiffness over its mean", le=0.4)
    sun_contact_ratio: float = quantity(text="contact ratio of sun and planet", ge=1.0, le=2.0)
    ring_contact_ratio: float = quantity(text="contact ratio of ring and planet", ge=1.0, le=2.0)
    phase: float = quantity(
        0.0, unit="cycles", text="phase of ring meshes behind sun meshes", ge=-1.0, le=1.0
    )


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


class PlanetaryDesign(PlanetaryParts):
    """A planetary gear train and its wind. Attributes are the sections of the design file."""

    gear_train: PlanetaryTrain
    ring: ComparedRing
    mesh: GivenMeshes
    wind: Wind
    time: PlanetaryTime
    monte_carlo: MonteCarlo

    @property
    def end(self) -> float:
        """End of the simulation, s."""
        return 2.0 * math.pi / self.carrier.speed * self.time.revolutions

    @property
    def mesh_cycle(self) -> MeshCycle:
        m = self.mesh
        return MeshCycle(
            (m.sun_stiffness, m.ring_stiffness),
            (m.variation, m.variation),
            (m.sun_contact_ratio, m.ring_contact_ratio),
            m.phase,
        )

    def remarks(self) -> list[str]:
        rims = dict.fromkeys([self.ring.rim, *self.ring.rims])
        return [sentence for rim in rims if (sentence := self.remark_on_rim(rim))]


def check_fit(design: PlanetaryDesign) -> None:
    """Refuse values that do not fit each other."""
    check_parts(design)
    check_rims(design, "rims", design.ring.rims)
    time = design.time
    for name in ("steps", "linearised_steps"):
        count, allowed = getattr(time, name), f"multiples of {time.rows} (time.rows)"
        require(count % time.rows == 0, f"time.{name}", count, allowed)
