"""Design file of a gear pair."""

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
    require_steps,
)
from swgpar.input.quantities import Section, not_negative, positive, quantity
from swgpar.input.require import require

PositiveTorques = Annotated[list[Positive], Len(1)]


LEAST_TEETH = 6
"""Of a gear; the file does not give the number of teeth."""


class PairTrain(GearTrain):
    model: Literal["gear_pair"] = quantity(text="the gear train")


class PairGear(Section):
    mass: float = positive("mass", "kg")
    inertia: float = positive("moment of inertia", "kg·m²")
    radius: float = positive("pitch radius", "mm")
    bearing: float = positive("stiffness of the bearings along the line of action", "N/m")


class PairMesh(Section):
    stiffness: float = positive("mean mesh stiffness", "N/m")
    half_backlash: float = not_negative("half of the backlash", "µm")
    variation: float = not_negative(
        "amplitude of the mesh stiffness over its mean", default=0.0, le=0.4
    )
    contact_ratio: float = quantity(1.5, text="contact ratio", ge=1.0, le=2.0)
    frequency: float = not_negative("mesh frequency", "rad/s", 0.0)
    harmonics: int = quantity(3, text="Fourier terms of the mesh stiffness", ge=1, le=100)


class PairLoad(Section):
    input: PositiveTorques = quantity(
        unit="N·m", text="torques on the first gear, one for each case, each above 0"
    )
    output: PositiveTorques = quantity(
        unit="N·m", text="torques on the second gear, one for each case, each above 0"
    )
    noise: float = not_negative("amplitude of the white noise on the relative rotation", "N")
    spectral_density: float = positive(
        "two-sided spectral density of the noise of amplitude 1", default=1.0
    )


class PairTime(Section):
    end: float = positive("end of the simulation; densities belong to it", "s")
    step: float = positive("time step", "s")
    rows: int = quantity(100, text="moments of time that are kept", ge=1, le=100_000)


class GearPairDesign(TrainDesign):
    """A gear pair and its load. Attributes are the sections of the design file."""

    gear_train: PairTrain
    gear_1: PairGear
    gear_2: PairGear
    mesh: PairMesh
    damping: TrainDamping
    load: PairLoad
    time: PairTime
    monte_carlo: MonteCarlo

    @property
    def steps(self) -> int:
        """Number of time steps, a multiple of `every`."""
        return self.time.rows * self.every

    @property
    def every(self) -> int:
        """Steps from one row to the next."""
        return max(1, round(self.time.end / self.time.step / self.time.rows))

    @property
    def step(self) -> float:
        """The time step that ends at the end, s."""
        return self.time.end / self.steps


def check_fit(design: GearPairDesign) -> None:
    """Refuse values that do not fit each other."""
    torques, cases = design.load.output, len(design.load.input)
    require(len(torques) == cases, "load.output", torques, f"{cases} torques (load.input)")
    radius = min(design.gear_1.radius, design.gear_2.radius)
    half = 1e3 * math.pi * radius / (2.0 * LEAST_TEETH)
    allowed = f"0 to {half:.6g} µm (a quarter of the pitch of a gear of {LEAST_TEETH} teeth)"
    require(
        design.mesh.half_backlash <= half, "mesh.half_backlash", design.mesh.half_backlash, allowed
    )
    require_steps("time.step", design.time.step, design.time.end)
