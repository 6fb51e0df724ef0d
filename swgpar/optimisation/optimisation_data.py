"""Data of an optimisation: evaluations, the start design, the best ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swgpar.optimisation.bounds import AtBound
from swgpar.optimisation.problem import Evaluation
from swgpar.optimisation.spec import OptimiseSection


@dataclass(frozen=True, kw_only=True)
class SearchedDesigns:
    """Designs of a search, whether it has ended or goes on.

    section : what is sought;  units : of variables and quantities, by name
    evaluations : designs that were tried, by number;  best : numbers of the best ones
    start : number of the start design; None where it is no point of the search, or has not ended
    """

    section: OptimiseSection
    units: dict[str, str]
    evaluations: dict[int, Evaluation]
    best: list[int]
    start: int | None

    @property
    def rows(self) -> list[dict[str, Any]]:
        """Rows of optimise.csv: number, variables, status, quantities and verdicts, wall seconds,
        reason."""
        every = self.evaluations.values()
        quantities = dict.fromkeys(name for each in every for name in each.quantities)
        verdicts = dict.fromkeys(name for each in every for name in each.verdicts)
        return [
            {
                "evaluation": number,
                **each.values,
                "status": each.status,
                "best": int(number in self.best),
                **{name: each.quantities.get(name) for name in quantities},
                **{name: each.verdicts.get(name, "") for name in verdicts},
                "wall_s": each.wall_s,
                "reason": each.reason,
            }
            for number, each in sorted(self.evaluations.items())
        ]


def number_of(
    evaluations: Mapping[int, Evaluation], values: Mapping[str, Any] | None
) -> int | None:
    """Number of the first evaluation of a design; None where it has none."""
    same = (n for n in sorted(evaluations) if evaluations[n].values == values)
    return next(same, None)


@dataclass(frozen=True, kw_only=True)
class OptimisationData(SearchedDesigns):
    """What an optimisation gives, without figures; the same on every rank.

    Attributes
    ----------
    evaluations : dict of Evaluation
        All designs that were tried, by number.
    best : list of int
        Numbers of the best design, or of those of the Pareto front; empty where no design is
        feasible.
    start : int or None
        Number of the start design, that of the design file: 0, the first one that is tried. None
        where it is no point of the search, or has not ended.
    without_start : str
        Why the start design is no point of the search; empty where it is one.
    at_bounds : dict of tuple of AtBound
        Variables of the designs in `best` that are within 1 % of their range of a bound, by number.
    importance : dict
        Share of every variable in every objective; empty with few feasible designs.
    designs : dict of dict
        Content of the design files of `best`, by number.
    section : OptimiseSection
        What was sought: ``section.variable``, ``section.objective``, ``section.constraint``.
    units : dict of str
        Of variables and quantities, by name.
    folder : Path
        Holds optimise.csv, optimise.html, the storage and the winning design files.
    wall_s : float
        Seconds of this call.
    """

    without_start: str
    at_bounds: dict[int, tuple[AtBound, ...]]
    importance: dict[str, dict[str, float]]
    designs: dict[int, dict[str, Any]]
    folder: Path
    wall_s: float

    @property
    def compared(self) -> list[int]:
        """Numbers of the start design and of the best ones."""
        start = [] if self.start is None else [self.start]
        return list(dict.fromkeys([*start, *self.best]))
