"""Physical quantities in input files: fields with unit and range, and the sentences that refuse bad values."""

from __future__ import annotations

import difflib
import json
from collections.abc import Callable, Sequence
from typing import Any, get_args, get_origin

import annotated_types
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.fields import FieldInfo


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
    """Return `value` the way a user would write it in TOML, on one line, shortened when long."""
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
    return text if len(text) <= 60 else text[:57] + "..."


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


PLURALS = {list[str]: "a list of texts", dict[str, float]: "a table of numbers", dict[str, Any]: "a table"}
"""What fields that hold several values are called."""


def _section_classes(field: FieldInfo) -> list[type[Section]]:
    """Return the section a field holds, or all those it has the choice of; none for a plain value."""
    choices = get_args(field.annotation) or (field.annotation,)
    return [choice for choice in choices if isinstance(choice, type) and issubclass(choice, Section)]


def _locate(model: type[Section], path: Sequence[Any]) -> tuple[type[Section], FieldInfo | None, list[Any]]:
    """Return the section that holds the last key of `path`, the field when it is a known key, and the keys.

    Below a field with several sections pydantic puts the type that was chosen into the path: it is no key.
    """
    path, keys = list(path), []
    field = None
    while path:
        keys.append(path.pop(0))
        field = model.model_fields.get(str(keys[-1]))
        classes = _section_classes(field) if field else []
        if len(classes) > 1 and path:
            tag = path.pop(0)
            classes = [c for c in classes if tag in get_args(c.model_fields["type"].annotation)]
        if not (classes and path):
            break
        model = classes[0]
    return model, field, keys


def _unknown_key(model: type[Section], path: Sequence[Any], value: Any) -> str:
    """Refuse an unknown key and suggest the one most likely meant."""
    parent = ".".join(map(str, path[:-1]))
    names = list(model.model_fields)
    where = f"section [{parent}]" if parent else "design file"
    given = f"{'.'.join(map(str, path))} = {show(value)}"
    near = difflib.get_close_matches(str(path[-1]), names, n=1, cutoff=0.5)
    if near:
        return f"{given} is not a key of the {where}: did you mean {parent + '.' if parent else ''}{near[0]}?"
    return f"{given} is not a key of the {where}: allowed {', '.join(names)}"


def sentence(model: type[Section], error: ValidationError) -> str:
    """Turn the first finding of pydantic into one sentence with key, value and allowed range.

    An unknown key goes first: it is the likely cause of a missing one.
    """
    findings = error.errors(include_url=False)
    findings.sort(key=lambda item: item["type"] != "extra_forbidden")
    finding = findings[0]
    kind, path, value = finding["type"], finding["loc"], finding.get("input")
    if not path:
        return "the design file has to be a table of sections"
    owner, field, path = _locate(model, path)
    key = ".".join(map(str, path))
    if kind == "extra_forbidden" or field is None:
        return _unknown_key(owner, path, value)
    inner = _section_classes(field)
    if kind == "union_tag_invalid":
        choices = " or ".join(json.dumps(name) for c in inner for name in get_args(c.model_fields["type"].annotation))
        return f"{key}.type = {show(value['type'])} is not available: allowed {choices}"
    if inner:
        keys = ", ".join(inner[0].model_fields)
        if kind == "missing":
            return f"{key} is missing: the section [{key}] has the keys {keys}"
        return f"{key} = {show(value)} is not a section: write [{key}] with the keys {keys}"
    if kind == "literal_error":
        choices = " or ".join(json.dumps(choice) for choice in field.annotation.__args__)
        return f"{key} = {show(value)} is not available: allowed {choices}"
    if field.annotation is bool:
        limits, noun = "allowed true or false", "true or false"
    elif field.annotation in (int, float, float | None):
        limits, noun = allowed(field), "a whole number" if field.annotation is int else "a number"
    elif field.annotation in PLURALS:
        limits, noun = f"allowed {field.description}", PLURALS[field.annotation]
    elif get_origin(field.annotation) is list:
        limits, noun = f"allowed {field.description}", "a list of that many numbers"
    elif field.annotation is str:
        limits, noun = f"allowed {field.description}", "a text"
    else:
        choices = " or ".join(json.dumps(choice) for choice in getattr(field.annotation, "__args__", ()))
        limits, noun = f"allowed {choices}", "a text"
    if kind == "missing":
        return f"{key} is missing: give {noun}, {limits}"
    if kind == "finite_number":
        return f"{key} = {show(value)} is not a finite number: {limits}"
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        return f"{key} = {show(value)} is out of range: {limits}"
    return f"{key} = {show(value)} is not {noun}: {limits}"
