"""Clearance of the undeformed teeth: what is known of interference before a run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from swgpar.answers.answer import Answer, AnswerGroup, AnswerKind, evaluation, part_answers
from swgpar.checks.clearance import Clearance
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GearName

CLEARANCES: dict[GearName, AnswerKind] = {
    "ring_gear": AnswerKind("clearance.ring_gear", "smallest clearance of the rigid teeth", "mm"),
    "dynamic_spline": AnswerKind(
        "clearance.dynamic_spline", "smallest clearance in the dynamic spline", "mm"
    ),
}


@evaluation
class RigidClearance(AnswerGroup):
    """Smallest distances of the undeformed teeth between the minor axes, below 0 where they
    overlap.

    places : by gear;  interference : a sentence for each gear whose teeth overlap
    """

    ring_gear: float = part_answers(CLEARANCES["ring_gear"])
    dynamic_spline: float | None = part_answers(CLEARANCES["dynamic_spline"], default=None)
    places: dict[str, str]
    interference: tuple[str, ...]

    TITLE = "clearance of the undeformed teeth"

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        rings = design.gears[1:]
        return tuple(kind for kind in super().kinds(design) if kind.path in rings)

    def answers(self) -> Iterator[Answer]:
        for one in super().answers():
            yield replace(one, place=self.places[one.name.partition(".")[2]])

    def remarks(self) -> Iterator[str]:
        return iter(self.interference)


def rigid_clearance(clearances: Sequence[Clearance]) -> RigidClearance:
    """From those of all ring gears of a drive."""
    every = {clearance.ring: clearance for clearance in clearances}
    distances = {ring: clearance.nearest.distance for ring, clearance in every.items()}
    return RigidClearance(
        ring_gear=distances["ring_gear"],
        dynamic_spline=distances.get("dynamic_spline"),
        places={ring: clearance.place for ring, clearance in every.items()},
        interference=tuple(filter(None, (clearance.remark for clearance in every.values()))),
    )
