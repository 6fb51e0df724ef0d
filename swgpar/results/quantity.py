"""What a run gives by name, for tables, figures and comparisons."""

from __future__ import annotations

from dataclasses import dataclass


def with_unit(name: str, unit: str) -> str:
    """A heading: the name and, where there is one, the unit."""
    return f"{name} ({unit})" if unit else name


@dataclass(frozen=True)
class Quantity:
    """A number that a run gives, or a list of `count` numbers.

    meaning : without its unit;  unit : empty for a pure number
    detail : whether tables of the main quantities leave it out
    remark : what to know about its value
    """

    meaning: str
    unit: str = ""
    count: int = 1
    detail: bool = False
    remark: str = ""

    @property
    def text(self) -> str:
        """Meaning and unit."""
        return with_unit(self.meaning, self.unit)
