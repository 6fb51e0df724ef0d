"""Sections and kinds of values that the design files of gear trains share."""

from __future__ import annotations

from typing import Annotated, Any

from annotated_types import Ge, Gt

from swgpar.quantities import Section, quantity

Positive = Annotated[float, Gt(0.0)]
NotNegative = Annotated[float, Ge(0.0)]


class TrainDesign(Section):
    """What every gear train's design file may hold beside its own sections."""

    published: dict[str, Any] = quantity({}, text="published values by quantity")


class Output(Section):
    figures: bool = quantity(True, text="draw the figures")
