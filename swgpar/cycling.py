"""Active contact sets that come back: found out in Newton's iteration, and the way out.

Newton's iteration on contact is one over sets: which points of cam, pins and flanks touch, and which of the flanks
slip. It cycles when a set returns although the residual has not fallen meanwhile. It cannot go on for ever in any case:
an increment has at most `solver.max_iterations` of them, and is halved at most `solver.max_cutbacks` times.

The way out is a line search that ends on the descending side (`SearchedStep.careful`), on segments of the flanks that
are kept as they are; where that ends they are cut anew, and the iteration goes on from there. Without friction residual
and tangent are the derivatives of a potential, and for given segments and a convex potential that ends every cycle:

1. Along a Newton step s from x the slope of the potential starts at -F . s < 0 and only grows, by convexity.
2. The step is kept where the slope is still negative, so that it was negative all along: the potential falls.
3. Hence no state is met twice. As the kept step also leaves at most half of the slope (or is the full one), and the
   slope changes at a rate of at most L |s|^2, the potential falls by (F . s)^2 / (4 L |s|^2) or more in every step.
   It is bounded below, so that F . s, and with it F, goes to zero.

The search's usual end takes a slope up to half of its start on either side: about a quarter fewer residuals, no such
proof. With friction there is no potential; the way out is then no more than a careful search, and what does not
converge is cut back.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import numpy as np
from mpi4py import MPI


def fingerprint(comm: MPI.Comm, parts: Iterable[np.ndarray]) -> int:
    """A number for the arrays of all ranks together, the same on every rank: equal for equal arrays. Collective."""
    digest = hashlib.blake2b(digest_size=8, person=comm.rank.to_bytes(8, "little"))
    for part in parts:
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(np.ascontiguousarray(part).tobytes())
    return int(comm.allreduce(int.from_bytes(digest.digest(), "little"), op=MPI.BXOR))


class VisitedSets:
    """Active sets of one Newton iteration, with the smallest residual that each has had."""

    def __init__(self) -> None:
        self.best: dict[int, float] = {}
        self.last: int | None = None

    def returns(self, found: int, residual: float) -> bool:
        """Whether the set `found`, left meanwhile, is back without a smaller residual."""
        before = self.best.get(found, np.inf)
        back = found != self.last and residual >= before < np.inf
        self.best[found], self.last = min(before, residual), found
        return back
