"""Reading of TOML input files with ``--set`` overrides into validated sections."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import tomli_w
from pydantic import ValidationError

from swgpar.errors import InputError
from swgpar.input.arguments import given_texts
from swgpar.input.quantities import Section, show, show_key
from swgpar.input.refusals import sentence
from swgpar.input.regular_file import read_regular

SectionType = TypeVar("SectionType", bound=Section)

FILE_KEYS = ("file", "inner_file", "outer_file", "end_far_file", "end_near_file")
"""Keys whose values are paths relative to the folder of the file that has them."""


def read_toml(path: str | Path) -> dict[str, Any]:
    """Read a TOML file; every failure is an `InputError` of one sentence that names the file.

    Keys of `FILE_KEYS` in its sections are paths relative to the folder of the file.
    """
    path = Path(path)
    try:
        text = read_regular(path).decode("utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"{path} cannot be read: there is no such file") from None
    except IsADirectoryError:
        raise InputError(f"{path} cannot be read: it is a directory, not a TOML file") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{path} cannot be read: byte {error.start} is not UTF-8 text") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{show(str(path))} cannot be read: {reason}") from None
    try:
        return _with_folder(tomllib.loads(text), path.parent)
    except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"{path} is not valid TOML: {reason}") from None


def _with_folder(table: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The table with the paths of its sections below a folder."""
    for section in table.values():
        if isinstance(section, dict):
            for key in FILE_KEYS:
                if isinstance(section.get(key), str):
                    section[key] = str(folder / section[key])
            _with_folder(section, folder)
    return table


def require_source(name: str, value: Any) -> None:
    """Refuse what is neither a path nor the content of a file."""
    if not isinstance(value, (str, Path, Mapping)):
        raise InputError(
            f"{name} is of the type {type(value).__name__}: allowed are a path, a dict or a loaded "
            f"{name}"
        )


def parse_value(text: str) -> Any:
    """Return `text` read as a TOML value; a text that is none stays a bare string."""
    try:
        table = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return table["value"] if set(table) == {"value"} else text


Overrides = Sequence[str] | Mapping[str, Any]
"""Values for keys of a design file: texts ``"section.key=value"``, or a mapping from
``"section.key"`` to the value."""


def apply_overrides(table: dict[str, Any], overrides: Overrides) -> dict[str, Any]:
    """Return a copy of `table` with the keys of `overrides` set, in order."""
    if isinstance(overrides, Mapping):
        for key in given_texts("overrides", list(overrides)):
            table = with_value(table, key, _plain(overrides[key]))
        return table
    for override in given_texts("overrides", overrides):
        key, text = split_override(override)
        table = with_value(table, key, parse_value(text))
    return table


def _plain(value: Any) -> Any:
    """A copy as TOML would give it: no NumPy numbers, arrays or tuples."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, (list, tuple)) else value


def split_override(override: str) -> tuple[str, str]:
    """Key and text of the value of a ``section.key=value``."""
    key, equals, text = override.partition("=")
    names = [name.strip() for name in key.split(".")]
    if not equals or not text.strip() or len(names) < 2 or not all(names):
        raise InputError(f"--set {show(override)} cannot be read: write section.key=value")
    return ".".join(names), text.strip()


def with_value(table: dict[str, Any], key: str, value: Any) -> dict[str, Any]:
    """Return a copy of `table` with the value of ``section.key`` replaced; missing sections are
    added.

    In a list of tables the part after its name is the number of the entry, from 1:
    ``load.program.2.torque``.

    Raises InputError where a part of the key names a value instead of a section, or an entry that
    is not there.
    """
    table = _plain(table)
    target, names = table, key.split(".")
    for depth, name in enumerate(names[:-1], start=1):
        if isinstance(target, list):
            target = _entry(target, name, key, value)
        else:
            target = target.setdefault(name, {})
        if not isinstance(target, dict | list):
            raise InputError(
                f"{show_key(key)} = {show(value)} cannot be applied: {show_key(*names[:depth])} = "
                f"{show(target)} is a value, not a section"
            )
    if isinstance(target, list):
        raise InputError(
            f"{key} = {show(value)} cannot be applied: write a key of the entry, {key}.key"
        )
    target[names[-1]] = value
    return table


def flat(table: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys and values of a table and of the tables in it."""
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from flat(value, f"{path}{name}.")
        else:
            yield f"{path}{name}", value


def _entry(tables: list[Any], number: str, key: str, value: Any) -> Any:
    """The entry of a list of tables with this number, from 1."""
    if number.isdecimal() and 1 <= int(number) <= len(tables):
        return tables[int(number) - 1]
    raise InputError(
        f"{key} = {show(value)} cannot be applied: {number} is no entry, allowed 1 to {len(tables)}"
    )


def to_toml(table: Mapping[str, Any]) -> str:
    """The text of a TOML file with this content; keys without a value (None) are left out."""
    text = tomli_w.dumps(_without_none(table))
    # plain lists on one line; line ends inside of texts are escaped
    return re.sub(r"\[\n((?: +[^\[\]\n]+,\n)+) *\]", _on_one_line, text)


def _on_one_line(match: re.Match[str]) -> str:
    items = match[1].split(",\n")[:-1]
    return f"[{', '.join(item.strip() for item in items)}]"


def _without_none(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _without_none(item) for key, item in value.items() if item is not None}
    return [_without_none(item) for item in value] if isinstance(value, (list, tuple)) else value


def toml_value(value: Any) -> str:
    """A value, list or table as TOML on one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {toml_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml_value, value)) + "]"
    return tomli_w.dumps({"value": value}).removeprefix("value = ").strip()


def validate(model: type[SectionType], table: dict[str, Any]) -> SectionType:
    """Validate `table` against `model`; the first finding becomes an `InputError` of one
    sentence."""
    try:
        return model.model_validate(table)
    except ValidationError as error:
        raise InputError(sentence(model, error)) from None
