"""Physical quantities in input files: fields with unit and allowed range."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import annotated_types
from pydantic import BaseModel, ConfigDict, Field
from pydantic.fields import FieldInfo

from swgpar.errors import shortened


class Section(BaseModel):
    """One table of an input file: immutable, no unknown keys, no silent conversion, finite numbers only."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


def quantity(default: Any = ..., *, unit: str = "", text: str, **limits: float) -> Any:
    """Declare a field of a `Section` with its meaning, its unit and its allowed range.

    Parameters
    ----------
    default : Any
        Value when the key is absent; without it the key is required.
    unit : str
        Unit of the value in the file; empty for a pure number.
    text : str
        Meaning of the field, without the unit.
    **limits : float
        Any of ``gt``, ``ge``, ``lt``, ``le``.
    """
    description = f"{text} ({unit})" if unit else text
    return Field(default, description=description, json_schema_extra={"unit": unit}, **limits)


def default_type(name: str) -> Callable[[Any], Any]:
    """Return a validator that gives a table without a `type` the type `name`; for fields with several sections."""
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


def allowed(field: FieldInfo) -> str:
    """Return the allowed range of a field as words, for example ``allowed above 0 to inf mm``."""
    lower, upper = "-inf", "inf"
    for limit in field.metadata:
        if isinstance(limit, annotated_types.Ge):
            lower = show(limit.ge)
        elif isinstance(limit, annotated_types.Gt):
            lower = f"above {show(limit.gt)}"
        elif isinstance(limit, annotated_types.Le):
            upper = show(limit.le)
        elif isinstance(limit, annotated_types.Lt):
            upper = f"below {show(limit.lt)}"
    unit = unit_of(field)
    return f"allowed {lower} to {upper}" + (f" {unit}" if unit else "")
