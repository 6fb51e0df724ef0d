"""Load cases of a search: what is computed of every design, a run or a rating sheet."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from swgpar.answers.verdict import Judgement
from swgpar.errors import InputError
from swgpar.input.design import Design
from swgpar.input.quantities import show, show_key
from swgpar.input.toml_file import apply_overrides
from swgpar.optimisation.rated_quantities import (
    LEAST_MARGIN,
    MARGIN_OF,
    distance,
    growing,
    judged_as,
    rated_quantities,
    rated_values,
    require_reachable,
    row_of_least_margin,
)
from swgpar.optimisation.spec import HEADLINE, Constraint, LoadCaseSection, Wanted
from swgpar.rating.planned_runs import make_rated_drive
from swgpar.rating.rate_drive import rate_in_memory
from swgpar.rating.rows import rating_rows
from swgpar.rating.sheet import RatingSheet
from swgpar.results.quantity import Quantity
from swgpar.run_options import RunOptions
from swgpar.studies.case import not_known
from swgpar.studies.job import run_one
from swgpar.systems import System


@dataclass(frozen=True)
class CaseOutcome:
    """What a load case of a design gives.

    values : by the names of quantities;  unbounded : names of those that grow with every finer mesh
    verdicts : of rows and the headline, by the names that constraints ask for, and the rows that
    have least margins
    distances : of those from what the constraints allow, by the names of the constraints
    reason : why it has failed, empty otherwise;  wall_s : seconds
    """

    values: Mapping[str, float]
    unbounded: frozenset[str] = frozenset()
    verdicts: Mapping[str, str] = field(default_factory=dict)
    distances: Mapping[str, float] = field(default_factory=dict)
    reason: str = ""
    wall_s: float = 0.0


class ProblemCase(ABC):
    """A load case.

    section : its part of the file, without a name where the file has none
    system : of the designs;  table : content of the design file as it is run, without variables
    wanted : objectives and constraints that refer to it
    """

    def __init__(
        self,
        section: LoadCaseSection,
        system: System[Any, Any],
        table: dict[str, Any],
        wanted: list[Wanted],
    ) -> None:
        self.section, self.system, self.table, self.wanted = section, system, table, wanted
        self.design = self.load(table)
        known, derived = dict(self.quantities(self.design)), set()
        for one in wanted:
            if one.is_verdict and one.quantity == HEADLINE:
                continue
            if one.quantity not in known:
                if one.quantity not in system.check(self.design):
                    raise not_known(
                        "optimise: " if not section.name else "", known, system, one.quantity
                    )
                known[one.quantity] = Quantity("by swgpar check", "")
                derived.add(one.quantity)
        self.known, self.derived = known, frozenset(derived)

    def load(self, table: dict[str, Any]) -> Design:
        """The checked design of the case from the content of a design file; problems are
        InputErrors."""
        for name in self.section.without:
            table = _without(table, name)
        return self._make(apply_overrides(table, self.section.set))

    def derive(self, design: Design) -> dict[str, float]:
        """The quantities that follow without a run, by name."""
        if not self.derived:
            return {}
        found = self.system.check(design)
        return {name: float(found[name]) for name in self.derived}

    @abstractmethod
    def _make(self, table: dict[str, Any]) -> Design: ...

    @abstractmethod
    def quantities(self, design: Design) -> Mapping[str, Quantity]:
        """What it gives, by name."""

    @abstractmethod
    def compute(self, design: Design, system: System[Any, Any], options: RunOptions) -> CaseOutcome:
        """Compute a design; collective. system : that the cases of the design share"""


class RunCase(ProblemCase):
    """One run."""

    def _make(self, table: dict[str, Any]) -> Design:
        return self.system.load(table)

    def quantities(self, design: Design) -> Mapping[str, Quantity]:
        return self.system.quantities(design)

    def compute(self, design: Design, system: System[Any, Any], options: RunOptions) -> CaseOutcome:
        found = run_one(system, design, options)
        wall_s = found.wall_s or 0.0
        return CaseOutcome(found.values, found.unbounded, reason=found.reason, wall_s=wall_s)


class RatingCase(ProblemCase):
    """A rating sheet."""

    def _make(self, table: dict[str, Any]) -> Design:
        if self.system.noun != "a drive":
            raise InputError(f"rate = true has no meaning for {self.system.noun}: leave it out")
        return make_rated_drive(table)

    def quantities(self, design: Design) -> Mapping[str, Quantity]:
        rows = rating_rows(_rated(design))
        for one in self.wanted:
            if isinstance(one, Constraint) and one.verdict:
                require_reachable(rows, one.quantity, Judgement(one.verdict))
        return rated_quantities(rows)

    def compute(self, design: Design, system: System[Any, Any], options: RunOptions) -> CaseOutcome:
        sheet = rate_in_memory(_rated(design), options, system)
        asked = [one for one in self.wanted if isinstance(one, Constraint) and one.verdict]
        return CaseOutcome(
            rated_values(sheet),
            growing(sheet),
            {one.name: str(judged_as(sheet, one.quantity)) for one in asked}
            | {
                f"row of {one.name}": row_of_least_margin(sheet)
                for one in self.wanted
                if one.quantity == LEAST_MARGIN
            },
            {
                f"{one.name} {one.verdict}": distance(sheet, one.quantity, Judgement(one.verdict))
                for one in asked
            },
            self._failure(sheet),
            sum(run.wall_s or 0.0 for run in sheet.runs),
        )

    def _failure(self, sheet: RatingSheet) -> str:
        """Why the sheet does not have what is asked of it; empty where it has."""
        rows = {one.name: one for one in sheet.verdicts}
        for one in self.wanted:
            row = one.quantity.removeprefix(MARGIN_OF)
            if row in (HEADLINE, LEAST_MARGIN):
                failed = [run for run in sheet.runs if run.status == "failed"]
                if failed:
                    return f"run {failed[0].name}: {failed[0].reason}"
            elif row in rows and rows[row].answer is None:
                return f"{row}: {rows[row].why}"
        return ""


def _rated(design: Design) -> Any:
    """The design as the drive that `make_rated_drive` has made."""
    return design


def make_case(
    section: LoadCaseSection,
    system: System[Any, Any],
    tables: tuple[dict[str, Any], dict[str, Any]],
    wanted: list[Wanted],
) -> ProblemCase:
    """A load case; every problem is an InputError.

    tables : content of the design file as it is run, and as it is rated
    """
    given = tables[1]
    for name in section.without:
        if _section(given, name) is None:
            raise InputError(
                f"optimise.load_case {show(section.name)}: without = {show(name)} is no section "
                f"that the design file has: allowed {', '.join(map(show_key, given))}"
            )
    kind, table = (RatingCase, tables[1]) if section.rate else (RunCase, tables[0])
    try:
        return kind(section, system, table, wanted)
    except InputError as error:
        where = f"optimise.load_case {show(section.name)}: " if section.name else ""
        raise InputError(f"{where}{error}") from None


def _section(table: Any, name: str) -> Any:
    """The section of a dotted name in the content of a design file; None where there is none."""
    for part in name.split("."):
        table = table.get(part) if isinstance(table, Mapping) else None
    return table


def _without(table: dict[str, Any], name: str) -> dict[str, Any]:
    """The content of a design file without a section, if it is there."""
    first, _, rest = name.partition(".")
    if _section(table, name) is None:
        return table
    others = {key: value for key, value in table.items() if key != first}
    return {**others, first: _without(table[first], rest)} if rest else others
