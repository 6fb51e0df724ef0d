"""Keys of a design as fields of a form: their texts, units, ranges and values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, get_args, get_origin

import annotated_types
from pydantic.fields import FieldInfo

from swgpar.input.design import Design
from swgpar.input.quantities import Section, allowed, unit_of

Kind = Literal["number", "whole number", "choice", "switch", "text"]


@dataclass(frozen=True)
class FormField:
    """One key of a design.

    key : dotted;  section : that holds it, dotted
    text : meaning, without the unit;  allowed : range in words
    kind : of the control;  choices : of a choice;  optional : whether the key may be left out
    value : of the design, None where it is left out
    low, high : least and largest value; infinite where there is none
    """

    key: str
    section: str
    text: str
    unit: str
    allowed: str
    kind: Kind
    value: Any
    optional: bool
    choices: tuple[str, ...] = ()
    low: float = float("-inf")
    high: float = float("inf")

    @property
    def name(self) -> str:
        """Last part of the key."""
        return self.key.rpartition(".")[2]

    def parsed(self, text: str | float | bool | None) -> Any:
        """The value that an entry means; a text that is no number stays one, and is refused by the
        design. A comma is a decimal sign, as in many countries."""
        if self.kind in ("switch", "choice") or text is None:
            return text
        entry = str(text).strip()
        if not entry and self.optional:
            return None
        if self.kind == "text":
            return entry
        entry = entry.replace(",", ".") if entry.count(",") == 1 and "." not in entry else entry
        try:
            number = float(entry)
        except ValueError:
            return entry
        return int(number) if self.kind == "whole number" and number.is_integer() else number


def form_fields(design: Design) -> list[FormField]:
    """Fields of all sections that a design has, in the order of its file. Lists of numbers and of
    tables have no control."""
    return list(_fields(design, ""))


def _fields(section: Section, path: str) -> Iterator[FormField]:
    nested: list[tuple[str, Section]] = []
    for name, field in type(section).model_fields.items():
        value, key = getattr(section, name), f"{path}{name}"
        if isinstance(value, Section):
            nested.append((key, value))
        elif path and (kind := _kind(field)) is not None:
            yield _field(key, path.rstrip("."), field, kind, value)
    for key, value in nested:
        yield from _fields(value, f"{key}.")


def _plain(field: FieldInfo) -> tuple[Any, bool]:
    """Type of a field without None, and whether it may be None."""
    types = get_args(field.annotation)
    if type(None) not in types:
        return field.annotation, False
    others = [each for each in types if each is not type(None)]
    return (others[0] if len(others) == 1 else None), True


def _kind(field: FieldInfo) -> Kind | None:
    """Kind of control of a field; None where it has none."""
    plain, _ = _plain(field)
    if get_origin(plain) is Literal:
        return "choice" if all(isinstance(one, str) for one in get_args(plain)) else None
    kinds: dict[Any, Kind] = {
        bool: "switch",
        int: "whole number",
        float: "number",
        str: "text",
    }
    return kinds.get(plain)


def _field(key: str, section: str, field: FieldInfo, kind: Kind, value: Any) -> FormField:
    plain, optional = _plain(field)
    low, high = float("-inf"), float("inf")
    for limit in field.metadata:
        if isinstance(limit, (annotated_types.Ge, annotated_types.Gt)):
            low = float(getattr(limit, "ge", getattr(limit, "gt", low)))
        elif isinstance(limit, (annotated_types.Le, annotated_types.Lt)):
            high = float(getattr(limit, "le", getattr(limit, "lt", high)))
    unit = unit_of(field)
    text = str(field.description or "").removesuffix(f" ({unit})")
    number = kind in ("number", "whole number")
    return FormField(
        key,
        section,
        text,
        unit,
        allowed(field) if number else "",
        kind,
        value,
        optional,
        tuple(get_args(plain)) if kind == "choice" else (),
        low,
        high,
    )
