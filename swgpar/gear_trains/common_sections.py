"""Sections and kinds of values that the design files of gear trains share."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Self

from annotated_types import Gt

from swgpar.gear_trains.published import SECTIONS, made_of_changed
from swgpar.input.design import Design
from swgpar.input.quantities import Section, not_negative, quantity
from swgpar.input.require import require
from swgpar.input.toml_file import Overrides, apply_overrides

Positive = Annotated[float, Gt(0.0)]

MAX_STEPS = 10_000_000
"""Largest number of time steps of a simulation."""


def require_steps(key: str, step: float, duration: float) -> None:
    """Refuse a time step (s) that is longer than the simulation, or of which there are too many."""
    least = duration / MAX_STEPS
    allowed = f"{least:.6g} to {duration:g} s (at most {MAX_STEPS} steps)"
    require(least <= step <= duration, key, step, allowed)


class GearTrain(Section):
    """Every design narrows `model` to the one name of its own."""

    model: str = quantity(text="the gear train")
    seed: int = quantity(1, text="seed of all random samples", ge=0)


class TrainDamping(Section):
    mass: float = not_negative("damping over mass", "1/s")
    stiffness: float = not_negative(
        "damping over stiffness, of meshes over their mean stiffness", "s"
    )


class MonteCarlo(Section):
    samples: int = quantity(text="simulations of each case", ge=2, le=100_000_000)


class TrainOutput(Section):
    figures: bool = quantity(True, text="draw the figures")


class TrainDesign(Design):
    """What every gear train's design file may hold beside its own sections."""

    system: ClassVar[str] = "gear_train"

    published: dict[str, Any] = quantity({}, text="published values by quantity")
    measured: dict[str, Any] = quantity({}, text="measured values by quantity")
    output: TrainOutput = TrainOutput()

    def with_values(self, values: Overrides) -> Self:
        """As that of `Design`. Published and measured values that do not fit the new design
        are left out."""
        table = self.model_dump(exclude_unset=True)
        return made_of_changed(self._maker, table, apply_overrides(table, values))

    def to_compare(self) -> dict[str, dict[str, Any]]:
        """Values to compare by section: published, measured."""
        return {name: getattr(self, name) for name in SECTIONS}

    def remarks(self) -> list[str]:
        """Sentences about what is allowed and may not be meant."""
        return []
