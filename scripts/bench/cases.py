"""Cases of the accuracy benchmark: each runs in a process of its own and is stored; rows with error
and rate."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from support.convergence import limit, rates

RATE_SLACK = 0.2
"""Of an asserted rate: on the finest levels terms of higher order still count, most for the stress
of hexahedra."""

Row = dict[str, Any]
Case = dict[str, Any]


@dataclass
class Cases:
    """out : folder of the finished cases;  ranks : of drives;  finest : number of levels at most;
    show : a new row"""

    out: Path
    ranks: int
    finest: int | None
    show: Callable[[Row], None]
    rows: list[Row] = field(default_factory=list)
    missed: list[str] = field(default_factory=list)

    def levels(self, count: int) -> range:
        """The levels of a series of `count`."""
        return range(min(count, self.finest or count))

    def solved(self, case: Case, ranks: int = 1) -> dict[str, Any]:
        """Unknowns, values, closed forms, seconds and memory of a case (accuracy_case.py); stored
        ones are read."""
        words = [f"{k}={v}" for k, v in {**case, "ranks": ranks}.items()]
        path = self.out / (re.sub(r"[^\w.=-]+", "_", "__".join(words)) + ".json")
        if not path.exists():
            script = str(Path(__file__).with_name("accuracy_case.py"))
            command = [sys.executable, script, json.dumps(case)]
            if ranks > 1:
                command = ["mpirun", "-n", str(ranks), *command]
            done = subprocess.run(
                command, check=True, capture_output=True, text=True, env=dict(os.environ)
            )
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(done.stdout.splitlines()[-1] + "\n", encoding="utf-8")
        return json.loads(path.read_text(encoding="utf-8"))

    def series(
        self,
        problem: str,
        choice: str,
        solved: list[dict[str, Any]],
        references: dict[str, tuple[float, str]],
        theory: dict[str, float],
        levels: list[Any] | None = None,
        ranks: int = 1,
        halved: bool = True,
    ) -> None:
        """Rows of one choice over the levels; a rate of theory that the two finest miss is noted.

        references : by quantity, the value and where it is from;  halved : each level halves the
        elements of the last
        """
        for quantity, (reference, source) in references.items():
            errors = [abs(s["values"][quantity] / reference - 1.0) for s in solved]
            observed = rates(errors) if halved else [None] * len(errors)
            for k, one in enumerate(solved):
                row: Row = {
                    "problem": problem,
                    "choice": choice,
                    "level": k if levels is None else levels[k],
                }
                row |= {
                    "unknowns": one["unknowns"],
                    "quantity": quantity,
                    "value": one["values"][quantity],
                }
                row |= {
                    "reference": reference,
                    "reference_from": source,
                    "error": errors[k],
                    "rate": observed[k],
                }
                row |= {"ranks": ranks, "seconds": one["seconds"], "memory_MB": one["memory_MB"]}
                self.rows.append(row)
                self.show(row)
            if (
                quantity in theory
                and self.finest is None
                and not observed[-1] > theory[quantity] - RATE_SLACK
            ):
                self.missed.append(
                    f"{problem}, {choice}, {quantity}: rate {observed[-1]}, theory "
                    f"{theory[quantity]}"
                )

    def check(self) -> None:
        """Raise AssertionError when rates of theory were missed."""
        assert not self.missed, "; ".join(self.missed)


def references(solved: list[dict[str, Any]]) -> dict[str, tuple[float, str]]:
    """By quantity the closed form, or else the limit of the last three of `solved`."""
    exact = solved[-1]["exact"]
    return {
        quantity: (exact[quantity], "closed form")
        if quantity in exact
        else (limit([s["values"][quantity] for s in solved])[0], "extrapolated")
        for quantity in solved[-1]["values"]
    }
