"""The contact of flanks with the largest pressure under load."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.answers import Answer, AnswerGroup, AnswerKind, answer, evaluation
from swgpar.results.history import Row

EDGE = (
    "lies on an edge: no property of the drive, and the stress at the teeth may be off by more "
    "than its error"
)


@evaluation
class LargestContact(AnswerGroup):
    """A row of pairs.csv: the one with the largest pressure, of those off an edge if there are any.

    increment, step, wg_angle_deg : when;  tooth, flank, ring_tooth : which
    ring : the ring gear, in a pancake drive
    angle_deg, radius_mm, z_mm : where
    force_N : of the pair;  edge : 1 where it lies on an edge
    """

    increment: int
    step: int
    wg_angle_deg: float
    tooth: int
    flank: str
    ring_tooth: int
    ring: str | None = None
    angle_deg: float
    radius_mm: float
    z_mm: float
    force_N: float
    pressure_MPa: float = answer(
        "contact.pressure",
        "largest pressure of the flanks under load, off edges",
        "MPa",
        "pressure_off_edges",
    )
    on_edge: bool = answer(
        "contact.on_edge", "whether a contact under load lies on an edge: 1 or 0"
    )
    edge: int = answer(
        "contact.pressure_on_edge",
        "largest pressure of the flanks under load",
        "MPa",
        "pressure_on_edges",
    )
    line_load_Nmm: float = answer("contact.line_load", "line load there", "N/mm")
    half_width_mm: float = answer("contact.half_width", "half width of the contact there", "mm")
    shear_MPa: float = answer(
        "contact.shear", "largest shear stress below the surface there", "MPa"
    )

    TITLE = "contact of the flanks under load"

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        return super().kinds(design) if design.resolves_root_stress else ()

    @property
    def pressure_off_edges(self) -> float | None:
        """The pressure (MPa) where it does not lie on an edge."""
        return None if self.edge else self.pressure_MPa

    @property
    def pressure_on_edges(self) -> float | None:
        """The pressure (MPa) where it lies on an edge."""
        return self.pressure_MPa if self.edge else None

    def answers(self) -> Iterator[Answer]:
        on = f" on the {self.ring.replace('_', ' ')}" if self.ring else ""
        place = (
            f"tooth {self.tooth}, {self.flank} flank{on}, radius {self.radius_mm:.2f}, z "
            f"{self.z_mm:.2f} mm"
        )
        for one in super().answers():
            if one.name.startswith("contact.pressure"):
                one = replace(one, place=place, remark=EDGE if self.edge else "")
            yield one


def largest_contact(pairs: Sequence[Row]) -> LargestContact | None:
    """The contact of the rows of pairs.csv; None where no pressure is known."""
    known = [pair for pair in pairs if np.isfinite(pair["pressure_MPa"])]
    if not known:
        return None
    largest = max(known, key=lambda pair: (not pair["edge"], pair["pressure_MPa"]))
    names = set(LargestContact.__dataclass_fields__) & set(largest)
    return LargestContact(
        **{name: largest[name] for name in names}, on_edge=any(pair["edge"] for pair in pairs)
    )
