"""Sentences that refuse what does not fit: the key, its value and what is allowed."""

from __future__ import annotations

from typing import Any

from swgpar.errors import InputError
from swgpar.input.quantities import show


def require(holds: bool, key: str, value: Any, allowed: str) -> None:
    """Raise InputError where the value of a key is out of range."""
    if not holds:
        raise InputError(f"{key} = {show(value)} is out of range: allowed {allowed}")


def require_available(holds: bool, what: str, beside: str, allowed: str) -> None:
    """Raise InputError where something is not available beside something else."""
    if not holds:
        raise InputError(f"{what} is not available with {beside}: allowed {allowed}")
