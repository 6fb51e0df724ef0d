"""The registry of linear solvers: what `solver.linear` may name.

A further kind is a class that extends `LinearSolver` (`swgpar/solve/linear_solver.py`), in a file
of its own, and an entry here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal


@dataclass(frozen=True)
class LinearSolverEntry:
    """A linear solver that a design may choose.

    cls : where its class is, with the module; it is imported when a run solves
    meaning : a phrase for the reference
    symmetric_only : whether it solves with symmetric matrices alone: it is refused with friction
    """

    cls: str
    meaning: str
    symmetric_only: bool = False


LINEAR_SOLVERS = {
    "direct": LinearSolverEntry("swgpar.solve.factors.MumpsFactor", "MUMPS"),
    "iterative": LinearSolverEntry(
        "swgpar.solve.krylov.SmoothedAggregation", "GMRES with GAMG", symmetric_only=True
    ),
}
"""By the names of `solver.linear`; the first one is the default."""

if TYPE_CHECKING:
    LinearSolverName = str
else:
    LinearSolverName = Literal[*LINEAR_SOLVERS]
    """A value of `solver.linear`."""
