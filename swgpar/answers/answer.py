"""Answers: the numbers that a run gives, with their names, units, errors and places.

What an evaluation gives is a dataclass whose fields declare which of them are answers. Names and
units are known before a run, so that studies and optimisations can check what they ask for.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass, replace
from types import UnionType
from typing import Any, ClassVar, TypeVar, dataclass_transform, get_args, get_type_hints

from swgpar.design.drive_design import DriveDesign

T = TypeVar("T")

NO_ESTIMATE, NO_LIMIT = "no estimate", "no limit"
"""In place of an error: it is not known; the value grows with every finer mesh."""


@dataclass(frozen=True)
class AnswerKind:
    """What a number is.

    name : group and name, as in "stiffness.K1", with upper-case words for parts that a design gives
    text : what it is, without its unit;  unit : empty for a pure number
    path : where the evaluation has it: names of attributes or keys, with dots between; by default
    the field that declares it
    detail : whether the terminal and the first table of the report leave it out
    exact : whether it has no error: a count, a number that is given, an error
    error, place, remark, limit : where the evaluation has those of the `Answer`, like `path`
    """

    name: str
    text: str
    unit: str = ""
    path: str = ""
    detail: bool = False
    exact: bool = False
    error: str = ""
    place: str = ""
    remark: str = ""
    limit: str = ""

    def of(self, word: str, part: str) -> AnswerKind:
        """The kind for one of the parts for which an upper-case word stands."""
        name, text = (one.replace(word, part) for one in (self.name, self.text))
        return replace(self, name=name, text=text)

    def answer(self, value: float | None, **more: Any) -> Answer:
        """The answer of this kind with a value. more : further fields"""
        return Answer(self.name, value, self.unit, self.text, detail=self.detail, **more)


@dataclass(frozen=True)
class Answer:
    """A number that a run has given.

    name, text, unit : as of its `AnswerKind`
    value : None where it cannot be computed; the remark says why
    error : estimated, in the same unit; None where it is not known
    no_error : in place of an error `NO_ESTIMATE` or `NO_LIMIT`; empty where the number has none
    place : where it is;  remark : what to know about it
    limit : the largest value that is good; None where there is none
    """

    name: str
    value: float | None
    unit: str
    text: str
    error: float | None = None
    no_error: str = ""
    place: str = ""
    remark: str = ""
    limit: float | None = None
    detail: bool = False


def part_answers(*kinds: AnswerKind, default: Any = MISSING) -> Any:
    """A field of an `evaluation` whose parts are answers."""
    return field(default=default, metadata={"answers": kinds})


def answer(
    name: str, text: str, unit: str = "", path: str = "", *, default: Any = MISSING, **more: Any
) -> Any:
    """A field of an `evaluation` that is an answer; arguments are those of `AnswerKind`."""
    return part_answers(AnswerKind(name, text, unit, path, **more), default=default)


def joined_error(*parts: float | None) -> float | None:
    """Error that independent parts make together; None where one of them is not known.

    A part that is not known is not zero: without it there is no error to state.
    """
    known = [part for part in parts if part is not None and math.isfinite(part)]
    return math.hypot(*known) if len(known) == len(parts) else None


def with_error(one: Answer, error: float | None) -> Answer:
    """The answer with its error; `NO_ESTIMATE` where that is not known."""
    return replace(one, error=error, no_error=NO_ESTIMATE if error is None else "")


def with_no_limit(one: Answer) -> Answer:
    """The answer of a value that grows with every finer mesh."""
    return replace(one, error=None, no_error=NO_LIMIT)


def known_quotient(above: float, below: float, error: float) -> float | None:
    """above / below; None where `below` is not larger than its error, as a quotient of round-off
    is."""
    return above / below if abs(below) > error else None


@dataclass_transform(
    frozen_default=True, kw_only_default=True, field_specifiers=(answer, part_answers, field)
)
def evaluation(kind: type[T]) -> type[T]:
    """Make a class a frozen dataclass whose fields may be made by `answer` or `part_answers`."""
    return dataclass(frozen=True, kw_only=True)(kind)


def declared_answers(kind: type) -> tuple[AnswerKind, ...]:
    """Answers that the fields of an `evaluation` and of its parts declare, in their order."""
    found, types = [], get_type_hints(kind)
    for one in fields(kind):
        declared = one.metadata.get("answers", ())
        found += [replace(answer, path=answer.path or one.name) for answer in declared]
        annotation = types[one.name]
        for part in get_args(annotation) if isinstance(annotation, UnionType) else (annotation,):
            # the answers of a base class are those of the class itself
            if isinstance(part, type) and is_dataclass(part) and not issubclass(kind, part):
                found += [
                    replace(answer, path=f"{one.name}.{answer.path}")
                    for answer in declared_answers(part)
                ]
    return tuple(found)


class AnswerGroup:
    """What one evaluation of a run gives: an `evaluation` derives from it.

    Attributes
    ----------
    TITLE : heading of its answers
    ASKED_BY : what in the design file asks for it; empty for what every run has
    SECTION : attribute of the design without which there is none; empty for what needs no section
    IN_PROGRAMS : whether a run of a load program has it
    """

    TITLE: ClassVar[str]
    ASKED_BY: ClassVar[str] = ""
    SECTION: ClassVar[str] = ""
    IN_PROGRAMS: ClassVar[bool] = True

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        """The answers that a run of a design has."""
        missing = cls.SECTION and getattr(design, cls.SECTION) is None
        missing = missing or (design.has_program and not cls.IN_PROGRAMS)
        return () if missing else declared_answers(cls)

    @classmethod
    def kinds_with(cls, word: str, parts: Iterable[str]) -> tuple[AnswerKind, ...]:
        """The declared answers with each of these parts of their names in place of a word."""
        return tuple(kind.of(word, part) for part in parts for kind in declared_answers(cls))

    def answers(self) -> Iterator[Answer]:
        """The answers that have a value, and those of `reasons`."""
        reasons = self.reasons()
        for kind in declared_answers(type(self)):
            value = self._at(kind.path)
            error = self._at(kind.error)
            if value is not None or kind.name in reasons:
                known = kind.exact or value is None or error is not None
                yield kind.answer(
                    None if value is None else float(value),
                    error=error,
                    no_error="" if known else NO_ESTIMATE,
                    place=self._at(kind.place) or "",
                    remark=reasons[kind.name] if value is None else self._at(kind.remark) or "",
                    limit=self._at(kind.limit),
                )

    def reasons(self) -> Mapping[str, str]:
        """Why an answer has no value, by its name: a dash and this sentence are shown."""
        return {}

    def remarks(self) -> Iterator[str]:
        """Sentences that a user needs beside the answers."""
        return iter(())

    def _at(self, path: str) -> Any:
        value: Any = self if path else None
        for name in path.split("."):
            if value is not None:
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
