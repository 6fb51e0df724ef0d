"""Arguments of the Python interface: values of another type are refused in a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Real
from pathlib import Path
from typing import Any

from swgpar.errors import InputError
from swgpar.input.quantities import show


def given_path(name: str, value: Any) -> Path:
    """The path that a user has given; an empty text, the working directory, is refused.

    Raises InputError.
    """
    if not isinstance(value, (str, Path)):
        raise InputError(f"{name} = {show(value)} is no path: allowed is a text or a Path")
    if isinstance(value, str) and not value.strip():
        raise InputError(f"{name} = {show(value)} names no folder: give the path of one")
    return Path(value)


def require_number(name: str, value: Any) -> None:
    """Raise InputError for what is no number, or no finite one."""
    number = isinstance(value, Real) and not isinstance(value, bool)
    if not number or not abs(value) < float("inf"):
        raise InputError(f"{name} = {show(value)} is no number: allowed are finite numbers")


def require_choice(name: str, value: Any, allowed: Sequence[Any]) -> None:
    """Raise InputError for a value that is none of those that are allowed."""
    if isinstance(value, bool) or value not in allowed:
        raise InputError(
            f"{name} = {show(value)} is not available: allowed {', '.join(map(show, allowed))}"
        )


def given_texts(name: str, value: Any) -> list[str]:
    """The texts of a list that a user has given. Raises InputError."""
    if isinstance(value, str) or not isinstance(value, (Sequence, set, frozenset)):
        raise InputError(f"{name} = {show(value)} is no list: allowed is a list of texts")
    if not all(isinstance(item, str) for item in value):
        raise InputError(f"{name} = {show(value)} is no list of texts: allowed are texts alone")
    return list(value)
