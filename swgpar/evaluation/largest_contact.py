"""The contacts of flanks with the largest pressure under load: of all pairs, and of those off
edges."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from swgpar.answers.answer import (
    NO_ESTIMATE,
    Answer,
    AnswerGroup,
    AnswerKind,
    answer,
    evaluation,
    part_answers,
    with_error,
    with_no_limit,
)
from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.contact_error_shares import UNKNOWN, ContactErrorShares, error_of_largest
from swgpar.results.history import Row

EDGE = "no property of the drive, and the stress at the teeth may be off by more than its error"

OTHER_EDGE = "its pressure grows with every finer mesh, and may become the largest"

TOLD = 0.02
"""Share of the largest force in an increment from which a pair without a pressure is told of."""


FLANK_PRESSURE = AnswerKind(
    "contact.pressure",
    "largest pressure of the flanks under load",
    "MPa",
    "largest.pressure_MPa",
    error="error_MPa",
)
FORCE = AnswerKind("contact.force", "force of the pair there", "N", "largest.force_N")
LINE_LOAD = AnswerKind("contact.line_load", "line load there", "N/mm", "largest.line_load_Nmm")
HALF_WIDTH = AnswerKind(
    "contact.half_width", "half width of the contact there", "mm", "largest.half_width_mm"
)
SHEAR = AnswerKind(
    "contact.shear", "largest shear stress below the surface there", "MPa", "largest.shear_MPa"
)
PRESSURE_OFF_EDGES = AnswerKind(
    "contact.pressure_off_edges",
    "the same of the pairs that do not lie on an edge",
    "MPa",
    "off_edges.pressure_MPa",
    error="error_off_edges_MPa",
)
EDGE_FORCE = AnswerKind("contact.edge_force", "largest force under load of a pair on an edge", "N")

POWERS = {FORCE.name: 2.0, LINE_LOAD.name: 2.0, HALF_WIDTH.name: 2.0, SHEAR.name: 1.0}
"""Error of what the pair with the largest pressure has, as a share, over that of its pressure. On a
line the pressure is as the root of the line load. The half width is a quotient of both."""


@dataclass(frozen=True)
class LoadedPair:
    """A row of pairs.csv: its columns are the fields."""

    increment: int
    step: int
    wg_angle_deg: float
    tooth: int
    flank: str
    ring_tooth: int
    angle_deg: float
    force_N: float
    pressure_MPa: float
    line_load_Nmm: float
    half_width_mm: float
    shear_MPa: float
    radius_mm: float
    z_mm: float
    edge: int
    ring: str = ""
    edge_place: str = ""

    @property
    def place(self) -> str:
        """Words for the place."""
        on = f" on the {self.ring.replace('_', ' ')}" if self.ring else ""
        return (
            f"tooth {self.tooth}, {self.flank} flank{on}, radius {self.radius_mm:.2f}, z "
            f"{self.z_mm:.2f} mm"
        )


@evaluation
class LargestContact(AnswerGroup):
    """Largest pressures of the flanks under load.

    largest : pair with the largest of all pressures;  off_edges : with the largest of those that do
    not lie on an edge; None without one
    edge_force_N : 0 where no pair lies on an edge
    unknown_force_N : largest force of a pair whose pressure could not be computed; 0 without one
    error_MPa, error_off_edges_MPa : of both pressures; None where they are not known, as that of
    the first one is where any pair lies on an edge
    on_lines : whether the errors of the other values of `largest` follow, see `POWERS`
    """

    largest: LoadedPair | None = part_answers(FLANK_PRESSURE, FORCE, LINE_LOAD, HALF_WIDTH, SHEAR)
    off_edges: LoadedPair | None = part_answers(PRESSURE_OFF_EDGES)
    edge_force_N: float = part_answers(EDGE_FORCE)
    on_edge: bool = answer(
        "contact.on_edge", "whether a contact under load lies on an edge: 1 or 0", exact=True
    )
    unknown_force_N: float
    error_MPa: float | None = None
    error_off_edges_MPa: float | None = None
    on_lines: bool = False

    TITLE = "contact of the flanks under load"

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        return super().kinds(design) if design.compares_meshes else ()

    def answers(self) -> Iterator[Answer]:
        pairs = {FLANK_PRESSURE.name: self.largest, PRESSURE_OFF_EDGES.name: self.off_edges}
        largest = self.largest
        for one in super().answers():
            pair = pairs.get(one.name)
            if pair is not None:
                one = replace(one, place=pair.place, remark=self._remark(one.name, pair))
            if one.name in POWERS and self.on_lines and self.error_MPa is not None:
                share = POWERS[one.name] * self.error_MPa / largest.pressure_MPa
                one = with_error(one, share * one.value)
            if largest and largest.edge and one.name in (FLANK_PRESSURE.name, SHEAR.name):
                one = with_no_limit(one)
            yield one

    def reasons(self) -> Mapping[str, str]:
        unknown = f"{NO_ESTIMATE}: {self._unknown}"
        return {
            FLANK_PRESSURE.name: unknown,
            PRESSURE_OFF_EDGES.name: f"all of the pairs lie on edges, with up to "
            f"{self.edge_force_N:.4g} N"
            if self.largest
            else unknown,
        }

    @property
    def _unknown(self) -> str:
        return (
            f"the pressure of a pair with {self.unknown_force_N:.4g} N could not be computed"
            if self.unknown_force_N
            else ""
        )

    def _remark(self, name: str, pair: LoadedPair) -> str:
        edge = ""
        if pair.edge:
            edge = f"{pair.force_N:.4g} N on the {pair.edge_place or 'edge'}: {EDGE}"
        elif self.on_edge and name == FLANK_PRESSURE.name:
            edge = (
                f"another pair lies on an edge, with up to {self.edge_force_N:.4g} N: {OTHER_EDGE}"
            )
        return "; ".join(filter(None, (edge, self._unknown)))


def largest_contact(
    pairs: Sequence[Row], errors: ContactErrorShares = UNKNOWN
) -> LargestContact | None:
    """The contacts of the rows of pairs.csv; None without rows. errors : by the mesh, where they
    are known"""
    if not pairs:
        return None
    known = [pair for pair in pairs if np.isfinite(pair["pressure_MPa"])]
    top: dict[int, float] = {}
    for pair in pairs:
        top[pair["increment"]] = max(top.get(pair["increment"], 0.0), pair["force_N"])
    unknown = [
        pair["force_N"]
        for pair in pairs
        if np.isnan(pair["pressure_MPa"]) and pair["force_N"] > TOLD * top[pair["increment"]]
    ]
    on_edges = [pair["force_N"] for pair in pairs if pair["edge"]]
    return LargestContact(
        largest=_with_largest_pressure(known),
        off_edges=_with_largest_pressure([pair for pair in known if not pair["edge"]]),
        edge_force_N=max(on_edges, default=0.0),
        on_edge=bool(on_edges),
        unknown_force_N=max(unknown, default=0.0),
        error_MPa=None if on_edges else _error(known, errors.pressure),
        error_off_edges_MPa=_error(
            [pair for pair in known if not pair["edge"]], errors.pressure_off_edges
        ),
        on_lines=errors.on_lines,
    )


def _error(pairs: Sequence[Row], share: float | None) -> float | None:
    return error_of_largest(
        pairs, lambda rows: max((pair["pressure_MPa"] for pair in rows), default=0.0), share
    )


def _with_largest_pressure(pairs: Sequence[Row]) -> LoadedPair | None:
    if not pairs:
        return None
    largest = max(pairs, key=lambda pair: pair["pressure_MPa"])
    return LoadedPair(
        **{one.name: largest[one.name] for one in fields(LoadedPair) if one.name in largest}
    )
