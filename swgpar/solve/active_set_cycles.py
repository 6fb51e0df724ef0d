"""Active contact sets that return: their detection in Newton's iteration, and the cycle breaker.

Newton's iteration on contact is an iteration over sets: which points of cam, pins and flanks touch,
and which points of the flanks slip. It cycles when a set returns although the residual has not
decreased meanwhile. It sticks where the residual does not decrease at all. It always ends: after
`solver.max_iterations` the residual has to halve within every `HALVING` further iterations, a solve
has at most `MAX_ITERATIONS_FACTOR` times as many; `solver.max_cutbacks` limits the halvings.

The cycle breaker combines a line search that ends on the descending side (`LineSearch.descending`)
with frozen cells of the flanks and, with friction, given bounds. Why the active set cannot cycle
then, and what follows, is in docs/theory/newton_step.md ("Cycle breaker").
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence

import numpy as np
from mpi4py import MPI

MAX_ITERATIONS_FACTOR, HALVING = 8, 10
"""Most iterations over `solver.max_iterations`; iterations in which a residual has to halve."""

PATIENCE, NEAR_PATIENCE, MIN_DECREASE = 8, 3, 0.9
"""Iterations in which the residual has to fall below this share of its smallest value before: far
from the solution, and near it, where only a jump of the forces holds it up."""


def fingerprint(comm: MPI.Comm, parts: Iterable[np.ndarray]) -> int:
    """A number for the arrays of all ranks, the same on each: equal for equal arrays. Collective"""
    digest = hashlib.blake2b(digest_size=8, person=comm.rank.to_bytes(8, "little"))
    for part in parts:
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(np.ascontiguousarray(part).tobytes())
    return int(comm.allreduce(int.from_bytes(digest.digest(), "little"), op=MPI.BXOR))


def is_decreasing(residuals: Sequence[float], within: int, share: float) -> bool:
    """Whether the last `within` of the residuals have one below this share of all before."""
    return len(residuals) <= within or min(residuals[-within:]) < share * min(residuals[:-within])


def is_exhausted(residuals: Sequence[float], allowed: int) -> bool:
    """Whether Newton's iteration with these residuals, from the first one on, is used up."""
    return len(residuals) > allowed and not is_decreasing(residuals, HALVING, 0.5)


class VisitedSets:
    """Active sets of one Newton iteration, with the smallest residual that each has had."""

    def __init__(self) -> None:
        self.best: dict[int, float] = {}
        self.last: int | None = None

    def returns(self, active_set: int, residual: float) -> bool:
        """Whether the set was left meanwhile and returns without a smaller residual."""
        before = self.best.get(active_set, np.inf)
        returned = active_set != self.last and residual >= before < np.inf
        self.best[active_set], self.last = min(before, residual), active_set
        return returned
