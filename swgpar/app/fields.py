"""Keys of a design as fields of a form: their texts, units, ranges and values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, get_args, get_origin

from pydantic.fields import FieldInfo

from swgpar.input.design import Design
from swgpar.input.quantities import Section, allowed, limits_of, plain_type, unit_of

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
        design."""
        if self.kind in ("switch", "choice") or text is None:
            return text
        entry = str(text).strip()
        if not entry and self.optional:
            return None
        if self.kind == "text":
            return entry
        number = number_of(entry)
        if self.kind == "whole number" and isinstance(number, float) and number.is_integer():
            return int(number)
        return number


def number_of(entry: str) -> Any:
    """The number that an entry means, else its text. A comma is a decimal sign, as in many
    countries."""
    entry = entry.strip()
    entry = entry.replace(",", ".") if entry.count(",") == 1 and "." not in entry else entry
    try:
        return float(entry)
    except ValueError:
        return entry


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


@dataclass(frozen=True)
class MissingSection:
    """A section that a design may have and lacks.

    name : dotted;  text : what it is
    required : fields of the keys that it needs
    """

    name: str
    text: str
    required: list[FormField]


def missing_sections(design: Design) -> list[MissingSection]:
    """Sections that a design lacks and that the form can add, in the order of its file: those
    whose needed keys have a field."""
    return list(_missing(design, ""))


def _missing(section: Section, path: str) -> Iterator[MissingSection]:
    for name, field in type(section).model_fields.items():
        value, key = getattr(section, name), f"{path}{name}"
        kind = plain_type(field.annotation)
        if isinstance(value, Section):
            yield from _missing(value, f"{key}.")
        elif value is None and isinstance(kind, type) and issubclass(kind, Section):
            needed = {inner: one for inner, one in kind.model_fields.items() if one.is_required()}
            kinds = {inner: _kind(one) for inner, one in needed.items()}
            if None not in kinds.values():
                required = [
                    _field(f"{key}.{inner}", key, one, kinds[inner], None)  # type: ignore[arg-type]
                    for inner, one in needed.items()
                ]
                text = (kind.__doc__ or "").split("\n\n")[0].replace("\n", " ").strip()
                yield MissingSection(key, " ".join(text.split()), required)


def is_optional(design: Design, section: str) -> bool:
    """Whether a design may lack a section that it has; by its dotted name."""
    *outer, name = section.split(".")
    owner: Any = design
    for part in outer:
        owner = getattr(owner, part)
    return type(None) in get_args(type(owner).model_fields[name].annotation)


def _kind(field: FieldInfo) -> Kind | None:
    """Kind of control of a field; None where it has none."""
    plain = plain_type(field.annotation)
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
    plain, limits = plain_type(field.annotation), limits_of(field)
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
        type(None) in get_args(field.annotation),
        tuple(get_args(plain)) if kind == "choice" else (),
        float(limits.get("ge", limits.get("gt", "-inf"))),
        float(limits.get("le", limits.get("lt", "inf"))),
    )
