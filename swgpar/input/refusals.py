"""The sentence that refuses a bad value of an input file: its key, the value and what is
allowed."""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterable, Sequence
from typing import Any, Literal, get_args, get_origin

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from swgpar.input.quantities import (
    MAGNITUDE,
    WHOLE_SECTION,
    Section,
    allowed,
    plain_type,
    show,
    show_key,
)

RANGE_FINDINGS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")
"""Kinds of pydantic's findings for numbers beyond the limits of their field."""

NOUNS: dict[Any, str] = {
    list[str]: "a list of texts",
    list[list[float]]: "a list of lists of numbers",
    dict[str, float]: "a table of numbers",
    dict[str, Any]: "a table",
}
"""Nouns for the values of fields that hold several."""


def _section_classes(field: FieldInfo) -> list[type[Section]]:
    """Return the section a field holds, or all those it has the choice of; none for a plain
    value."""
    choices = get_args(field.annotation) or (field.annotation,)
    return [
        choice for choice in choices if isinstance(choice, type) and issubclass(choice, Section)
    ]


def _is_list(field: FieldInfo) -> bool:
    """Whether a field holds a list of sections."""
    return get_origin(field.annotation) is list and bool(_section_classes(field))


def _locate(
    model: type[Section], path: Sequence[Any]
) -> tuple[type[Section], FieldInfo | None, list[Any]]:
    """Return the section that holds the last key of `path`, the field when it is a known key, and
    the keys.

    Below a field with several sections pydantic adds the chosen type to the path. It is not a key,
    and left out. Below a list of sections it adds the index, which becomes the number of the entry,
    from 1.
    """
    path, keys = list(path), []
    field = None
    while path:
        keys.append(path.pop(0))
        field = model.model_fields.get(str(keys[-1]))
        classes = _section_classes(field) if field else []
        if field and field.discriminator and path:
            tag = path.pop(0)
            classes = [c for c in classes if tag in get_args(c.model_fields["type"].annotation)]
        if field and classes and path and _is_list(field):
            keys.append(path.pop(0) + 1)
        if not (classes and path):
            break
        model = classes[0]
    return model, field, keys


def _unknown_key(model: type[Section], path: Sequence[Any], value: Any) -> str:
    """Refuse an unknown key and suggest the one most likely meant."""
    parent = show_key(*path[:-1])
    tables = {name for name, field in model.model_fields.items() if _section_classes(field)}
    names = list(model.model_fields)
    where = f"section [{parent}]" if parent else "design file"
    given = f"{show_key(*path)} = {show(value)}"
    alike = [name for name in names if (name in tables) == isinstance(value, dict)]
    inner = [
        f"{name}.{path[-1]}"
        for name, field in model.model_fields.items()
        if any(path[-1] in section.model_fields for section in _section_classes(field))
    ]
    near = inner or difflib.get_close_matches(str(path[-1]), alike, n=1, cutoff=0.5)
    if near:
        return (
            f"{given} is not a key of the {where}: did you mean "
            f"{parent + '.' if parent else ''}{near[0]}?"
        )
    return f"{given} is not a key of the {where}: allowed {', '.join(names)}"


def sentence(model: type[Section], error: ValidationError) -> str:
    """Return the first finding of pydantic as one sentence with key, value and allowed range.

    Unknown keys come first, as they are a likely cause of missing ones.
    """
    findings = error.errors(include_url=False)
    findings.sort(key=lambda item: item["type"] != "extra_forbidden")
    finding = findings[0]
    kind, value = finding["type"], finding.get("input")
    path: Sequence[int | str] = finding["loc"]
    if not path:
        return "the design file has to be a table of sections"
    owner, field, path = _locate(model, path)
    if kind == "extra_forbidden" or field is None:
        return _unknown_key(owner, path, value)
    key = show_key(*path)
    if kind == WHOLE_SECTION:
        return f"{key} {finding['msg']}"
    if _section_classes(field):
        return _bad_section(field, kind, key, value)
    if kind == "literal_error":
        parts = (field.annotation, *get_args(field.annotation))  # of an optional key too
        names = [name for part in parts if get_origin(part) is Literal for name in get_args(part)]
        return f"{key} = {show(value)} is not available: allowed {_choices(names)}"
    return _bad_value(field, kind, key, value)


def _choices(names: Iterable[str]) -> str:
    return " or ".join(json.dumps(name) for name in names)


def _bad_section(field: FieldInfo, kind: str, key: str, value: Any) -> str:
    """Refuse the value of a field that holds a section: an unknown type, none at all, or something
    else."""
    sections = _section_classes(field)
    if kind == "union_tag_invalid":
        types = (
            name
            for section in sections
            for name in get_args(section.model_fields["type"].annotation)
        )
        return f"{key}.type = {show(value['type'])} is not available: allowed {_choices(types)}"
    keys = ", ".join(sections[0].model_fields)
    header = f"[[{key.rstrip('.0123456789')}]]" if _is_list(field) else f"[{key}]"
    if kind == "missing":
        return f"{key} is missing: the section {header} has the keys {keys}"
    return f"{key} = {show(value)} is not a section: write {header} with the keys {keys}"


def _expected(field: FieldInfo) -> tuple[str, str]:
    """Noun for the values of a field, and the words that say which are allowed."""
    kind = plain_type(field.annotation)
    if kind is bool:
        return "true or false", "allowed true or false"
    if kind in (int, float):
        return "a whole number" if kind is int else "a number", allowed(field)
    if kind in NOUNS:
        return NOUNS[kind], f"allowed {field.description}"
    if get_origin(kind) is list:
        return "a list of that many numbers", f"allowed {field.description}"
    if kind is str:
        return "a text", f"allowed {field.description}"
    return "a text", f"allowed {_choices(getattr(kind, '__args__', ()))}"


def _bad_value(field: FieldInfo, kind: str, key: str, value: Any) -> str:
    """Refuse a plain value: missing, not finite, beyond its range, or of another type."""
    noun, limits = _expected(field)
    if kind == "missing":
        return f"{key} is missing: give {noun}, {limits}"
    if kind == "finite_number":
        return f"{key} = {show(value)} is not a finite number: {limits}"
    if kind == MAGNITUDE:
        return f"{key} = {show(value)} is out of range: {allowed(field, smallest=True)}"
    if kind in RANGE_FINDINGS:
        return f"{key} = {show(value)} is out of range: {limits}"
    shown = repr(value) if isinstance(value, float) else show(value)  # 1.0 is no whole number
    return f"{key} = {shown} is not {noun}: {limits}"
