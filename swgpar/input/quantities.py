"""Physical quantities in input files: fields with unit and allowed range."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cached_property
from typing import Any, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from swgpar.errors import shortened
from swgpar.input.ranges import beyond, magnitudes

MAGNITUDE = "magnitude"
"""Kind of pydantic's finding for numbers of another magnitude than those of their unit."""

WHOLE_SECTION = "whole_section"
"""Kind of a finding on a section whose keys do not fit each other; its message goes on after the
section's name."""


class Section(BaseModel):
    """One table of an input file: immutable, no unknown keys, no silent conversion, finite numbers
    only."""

    # sections are read inside of a design: of themselves they need no validators
    model_config = ConfigDict(
        frozen=True, extra="forbid", strict=True, allow_inf_nan=False, defer_build=True
    )

    def __hash__(self) -> int:
        # curves are kept by their keys, which may be lists and tables
        return self._digest

    @cached_property
    def _digest(self) -> int:
        return hash(self.model_dump_json())

    @field_validator("*", mode="after")
    @classmethod
    def _has_a_magnitude(cls, value: Any, info: ValidationInfo) -> Any:
        """Refuse numbers of another magnitude than those of their unit (`swgpar.input.ranges`)."""
        if info.field_name is not None and beyond(
            value, unit_of(cls.model_fields[info.field_name])
        ):
            raise PydanticCustomError(MAGNITUDE, "another magnitude than that of its unit")
        return value


def quantity(default: Any = ..., *, unit: str = "", text: str, **limits: Any) -> Any:
    """Declare a field of a `Section` with its meaning, its unit and its allowed range.

    default : value when the key is absent; without it the key is required
    unit : of the value in the file; empty for a pure number
    text : meaning of the field, without the unit;  limits : any of ``gt``, ``ge``, ``lt``, ``le``
    """
    description = f"{text} ({unit})" if unit else text
    return Field(default, description=description, json_schema_extra={"unit": unit}, **limits)


def positive(text: str, unit: str = "", default: Any = ..., **limits: float) -> Any:
    """Declare a field whose numbers are above 0, see `quantity`."""
    return quantity(default, unit=unit, text=text, gt=0.0, **limits)


def not_negative(text: str, unit: str = "", default: Any = ..., **limits: float) -> Any:
    """Declare a field whose numbers are 0 or above, see `quantity`."""
    return quantity(default, unit=unit, text=text, ge=0.0, **limits)


def default_type(name: str) -> Callable[[Any], Any]:
    """Return a validator that gives a table without a `type` the type `name`; for fields with
    several sections."""
    return lambda value: {"type": name, **value} if isinstance(value, dict) else value


def show(value: Any) -> str:
    """Return `value` as written in TOML, on one line, shortened when long."""
    if isinstance(value, bool):
        text = "true" if value else "false"
    elif isinstance(value, str):
        text = json.dumps(value, ensure_ascii=False)
    elif isinstance(value, int) and abs(value) > 10**15:
        digits = len(str(abs(value))) if abs(value) < 10**4000 else 4000
        text = f"an integer of {digits} or more digits"
    elif isinstance(value, float):
        text = f"{value:.10g}"
    elif isinstance(value, dict):
        text = "a table" if value else "an empty table"
    else:
        text = " ".join(repr(value).split())
    return shortened(text)


def show_key(*names: Any) -> str:
    """Return the dotted key of these names, shortened when long."""
    return shortened(".".join(map(str, names)))


def unit_of(field: FieldInfo) -> str:
    """Return the unit declared with `quantity`, or an empty string."""
    extra = field.json_schema_extra
    return str(extra.get("unit", "")) if isinstance(extra, dict) else ""


def unit_of_key(design: BaseModel, key: str) -> str:
    """Return the unit of a dotted key of a design; empty for a pure number and for a section that
    the design lacks."""
    *sections, name = key.split(".")
    section: Any = design
    for part in sections:
        section = getattr(section, part, None)
    field = type(section).model_fields.get(name) if isinstance(section, BaseModel) else None
    return unit_of(field) if field is not None else ""


def plain_type(annotation: Any) -> Any:
    """The type of a key that may be left out, without None; of a choice of types the choice."""
    others = [each for each in get_args(annotation) if each is not type(None)]
    return others[0] if type(None) in get_args(annotation) and len(others) == 1 else annotation


def limits_of(field: FieldInfo) -> dict[str, Any]:
    """Limits of the numbers of a field, as declared with `quantity`: any of ``gt``, ``ge``, ``lt``,
    ``le``."""
    of_items = [
        limit for item in get_args(field.annotation) for limit in getattr(item, "__metadata__", ())
    ]
    return {
        name: getattr(limit, name)
        for limit in [*field.metadata, *of_items]
        for name in ("ge", "gt", "le", "lt")
        if hasattr(limit, name)
    }


def allowed(field: FieldInfo, *, smallest: bool = False) -> str:
    """Return the allowed range of a field as words, for example ``allowed above 0 to 100000 mm``.

    smallest : with the smallest magnitude of a number with its unit, for example ``allowed 0 and
    0.001 to 100000 mm``
    """
    least, largest = map(show, magnitudes(unit_of(field)))
    lower, upper = f"-{largest}", largest
    for name, limit in limits_of(field).items():
        if name in ("ge", "gt"):
            lower = show(limit) if name == "ge" else f"above {show(limit)}"
        else:
            upper = show(limit) if name == "le" else f"below {show(limit)}"
    if smallest:
        lower = {"above 0": least, "0": f"0 and {least}"}.get(
            lower, f"{lower} to -{least}, 0 and {least}"
        )
    unit = unit_of(field)
    return f"allowed {lower} to {upper}" + (f" {unit}" if unit else "")
