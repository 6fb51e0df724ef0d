"""The start design: that of the design file, as a point of the search."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from swgpar.input.quantities import show, show_key
from swgpar.optimisation.spec import Variable


@dataclass(frozen=True)
class StartDesign:
    """values : of the variables by name, None where the start design is no point of the search
    reason : why it is none, empty otherwise
    """

    values: dict[str, Any] | None
    reason: str = ""


def start_design(variables: Sequence[Variable], designs: Sequence[BaseModel]) -> StartDesign:
    """The values that the variables have in the design file, or why the search cannot have them.

    designs : of the load cases: a case may leave out a section
    """
    contents = [design.model_dump() for design in designs]
    values = {}
    for variable in variables:
        given = {key: _value(contents, key) for key in variable.keys}
        first = given[variable.name]
        for key, value in given.items():
            if value is None:
                return StartDesign(None, f"{show_key(key)} has no value there")
            if value != first:
                return StartDesign(
                    None,
                    f"{show_key(variable.name)} = {show(first)} and {show_key(key)} = "
                    f"{show(value)} are one variable",
                )
        taken = variable.taken(first)
        if taken is None:
            return StartDesign(
                None,
                f"{show_key(variable.name)} = {show(first)} is out of range: allowed "
                f"{variable.range_text}",
            )
        values[variable.name] = taken
    return StartDesign(values)


def _value(contents: Sequence[Mapping[str, Any]], key: str) -> Any:
    """The value of a dotted key in the first design that has one; None without any."""
    for content in contents:
        found: Any = content
        for name in key.split("."):
            if isinstance(found, Mapping):
                found = found.get(name)
            elif isinstance(found, (list, tuple)) and name.isdecimal():
                found = found[int(name) - 1] if 1 <= int(name) <= len(found) else None
            else:
                found = None
        if found is not None:
            return found
    return None
