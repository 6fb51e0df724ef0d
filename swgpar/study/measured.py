"""Quantities of a finished run by name: "mean.fs_s1" of the rotation, "step1.fs_s1" of the last increment of a step."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from typing import Any

from swgpar.errors import InputError
from swgpar.results.history import UNITS
from swgpar.run import MEANS

STEPS = 4
"""Steps 1 to 4: deflection, engagement, load, and the rotation, whose increments go on counting in the history."""


def names() -> list[str]:
    """All names of quantities."""
    columns = [name for name in UNITS if name not in ("step", "wall_s")]
    return [f"mean.{name}" for name in MEANS] + [f"step{k}.{name}" for k in range(1, STEPS + 1) for name in columns]


def refuse_unknown(where: str, name: str) -> None:
    """Raise InputError for a name that is no quantity, with the one most likely meant."""
    if name in names():
        return
    near = difflib.get_close_matches(name, names(), n=1)
    hint = f"did you mean {near[0]}?" if near else f"allowed mean. with {', '.join(MEANS)}, or step1. to step{STEPS}."
    raise InputError(f"{where}.{name} is not a quantity of a run: {hint}")


def unit(name: str) -> str:
    """Unit of a quantity, empty for a number."""
    return UNITS[name.partition(".")[2]]


def measured(name: str, means: Mapping[str, float], rows: Sequence[Mapping[str, Any]]) -> float | None:
    """Value of a quantity; None when the run has no increment of that step."""
    group, _, column = name.partition(".")
    if group == "mean":
        return means.get(column)
    number = int(group.removeprefix("step"))
    of_step = [row for row in rows if min(int(row["step"]), STEPS) == number]
    return float(of_step[-1][column]) if of_step else None
