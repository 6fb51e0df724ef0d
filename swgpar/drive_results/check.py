"""A verdict on a finished run."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """A verdict with the numbers behind it.

    good : the verdict, None where nothing can be said;  text : the numbers
    of_strength : whether it is about the drive and not about the computation
    """

    name: str
    good: bool | None
    text: str
    of_strength: bool = False
