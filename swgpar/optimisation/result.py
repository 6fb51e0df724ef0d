"""What an optimisation gives."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swgpar.optimisation.problem import Evaluation


@dataclass(frozen=True)
class OptimisationResult:
    """What an optimisation gives; the same on every rank.

    Attributes
    ----------
    evaluations : dict of Evaluation
        All designs that were tried, by number.
    best : list of int
        Numbers of the best design, or of those of the Pareto front; empty where no design is
        feasible.
    importance : dict
        Share of every variable in every objective; empty with few feasible designs.
    designs : dict of dict
        Content of the design files of `best`, by number.
    folder : Path
        Holds optimise.csv, optimise.html, the storage and the winning design files.
    wall_s : float
        Seconds of this call.

    Examples
    --------
    >>> found = swgpar.optimise("drivers/optimise/parabolic_cam.toml", "results/cam")
    >>> found.evaluations[found.best[0]].quantities
    """

    evaluations: dict[int, Evaluation]
    best: list[int]
    importance: dict[str, dict[str, float]]
    designs: dict[int, dict[str, Any]]
    folder: Path
    wall_s: float

    @property
    def rows(self) -> list[dict[str, Any]]:
        """Rows of optimise.csv: number, variables, status, quantities, wall seconds, reason."""
        quantities = list(
            dict.fromkeys(name for each in self.evaluations.values() for name in each.quantities)
        )
        return [
            {
                "evaluation": number,
                **each.values,
                "status": each.status,
                "best": int(number in self.best),
                **{name: each.quantities.get(name) for name in quantities},
                "wall_s": each.wall_s,
                "reason": each.reason,
            }
            for number, each in sorted(self.evaluations.items())
        ]
