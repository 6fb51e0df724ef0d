"""Answers: the numbers that a run gives, with their names, units, errors and places.

What an evaluation gives is a dataclass that knows which of its fields are answers. Names and units
are known before a run, so that studies and optimisations can check what they ask for.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from swgpar.design.drive_design import DriveDesign


@dataclass(frozen=True)
class AnswerKind:
    """What a number is.

    name : group and name, as in "stiffness.K1"
    text : what it is, without its unit;  unit : empty for a pure number
    path : where the evaluation has it: names of attributes or keys, with dots between; by default
    the end of the name
    detail : whether the terminal and the first table of the report leave it out
    """

    name: str
    text: str
    unit: str = ""
    path: str = ""
    detail: bool = False


@dataclass(frozen=True)
class Answer:
    """A number that a run has given.

    name, text, unit : as of its `AnswerKind`
    error : estimated, in the same unit; None where it is not known
    place : where it is;  remark : what to know about it
    limit : the largest value that is good; None where there is none
    """

    name: str
    value: float
    unit: str
    text: str
    error: float | None = None
    place: str = ""
    remark: str = ""
    limit: float | None = None
    detail: bool = False


class AnswerGroup:
    """What one evaluation of a run gives; its results are the fields of the dataclass that derives
    from it.

    Attributes
    ----------
    TITLE : heading of its answers
    ASKED_BY : what in the design file asks for it; empty for what every run has
    SECTION : attribute of the design without which there is none; empty for what needs no section
    KINDS : its answers, with upper-case words for parts of names that a design or a run gives
    """

    TITLE: ClassVar[str]
    ASKED_BY: ClassVar[str] = ""
    SECTION: ClassVar[str] = ""
    KINDS: ClassVar[tuple[AnswerKind, ...]]

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        """The answers that a run of a design has."""
        return () if cls.SECTION and getattr(design, cls.SECTION) is None else cls.KINDS

    def answers(self) -> Iterator[Answer]:
        """The answers that have a value."""
        return self.values_of(self.KINDS)

    def values_of(self, kinds: tuple[AnswerKind, ...]) -> Iterator[Answer]:
        """Answers of these kinds that have a value."""
        for kind in kinds:
            value = self._at(kind.path or kind.name.partition(".")[2])
            if value is not None:
                yield Answer(kind.name, float(value), kind.unit, kind.text, detail=kind.detail)

    def remarks(self) -> Iterator[str]:
        """Sentences that a user needs beside the answers."""
        return iter(())

    def _at(self, path: str) -> Any:
        value: Any = self
        for name in path.split("."):
            if value is None:
                return None
            value = value.get(name) if isinstance(value, Mapping) else getattr(value, name)
        return value


def place_text(
    region: str, tooth: int | None, radius: float, z: float, angle_deg: float | None = None
) -> str:
    """Words for a place. radius, z : mm;  angle_deg : from +y, counter-clockwise"""
    where = region
    if tooth is not None:
        where = (
            f"inside tooth {tooth}"
            if region == "inside the tooth"
            else f"{region} of tooth {tooth}"
        )
    angle = "" if angle_deg is None else f", {angle_deg:.1f}° from +y"
    return f"{where}, radius {radius:.2f}, z {z:.2f} mm{angle}"
