"""Variables that a design has at a bound of the search: the optimum may lie beyond it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from swgpar.optimisation.spec import Variable

NEAR = 0.01
"""Part of the range between the bounds within which a value is at a bound."""


@dataclass(frozen=True)
class AtBound:
    """variable : its name;  side : "lower" or "upper";  bound : the value;  value : of the
    design"""

    variable: str
    side: str
    bound: float
    value: float

    @property
    def text(self) -> str:
        """It in words."""
        return f"{self.variable} = {self.value:.5g} is at its {self.side} bound {self.bound:.5g}"


def at_bounds(variables: Sequence[Variable], values: Mapping[str, Any]) -> tuple[AtBound, ...]:
    """The variables of a design within 1 % of their range of a bound, on the scale on which they
    are searched. Choices have no bounds."""
    found = []
    for variable in variables:
        if variable.low is None or variable.high is None:
            continue
        place, value = position(variable, values[variable.name]), float(values[variable.name])
        if place <= NEAR:
            found.append(AtBound(variable.name, "lower", variable.low, value))
        elif place >= 1.0 - NEAR:
            found.append(AtBound(variable.name, "upper", variable.high, value))
    return tuple(found)


def position(variable: Variable, value: Any) -> float:
    """Where a value is between the bounds, 0 to 1, on the scale of the search; of choices between
    the first and the last."""
    if variable.low is None or variable.high is None:
        return variable.choices.index(value) / max(len(variable.choices) - 1, 1)
    low, high, x = (
        math.log(number) if variable.log else float(number)
        for number in (variable.low, variable.high, value)
    )
    return (x - low) / (high - low)
