"""Active contact sets that come back: found out in Newton's iteration, and the way out.

Newton's iteration on contact is one over sets: which points of cam, pins and flanks touch, and which of the flanks
slip. It cycles when a set returns although the residual has not fallen meanwhile, and sticks where the residual does
not fall at all. It cannot go on for ever in any case: after `solver.max_iterations` the residual has to halve within
every `HALVING` further ones, a solve has at most `MOST` times that many, and an increment is halved at most
`solver.max_cutbacks` times.

The way out is a line search that ends on the descending side (`LineSearch.careful`), on segments of the flanks that
are kept as they are; where that ends they are cut anew, and the iteration goes on from there. Without friction residual
and tangent are the derivatives of a potential, and for given segments and a convex potential that ends every cycle:

1. Along a Newton step s from x the slope of the potential starts at -F . s < 0 and only grows, by convexity.
2. The step is kept where the slope is still negative, so that it was negative all along: the potential falls.
3. Hence no state is met twice. As the kept step also leaves at most half of the slope (or is the full one), and the
   slope changes at a rate of at most L |s|^2, the potential falls by (F . s)^2 / (4 L |s|^2) or more in every step.
   It is bounded below, so that F . s, and with it F, goes to zero.

The search's usual end takes a slope up to half of its start on either side: about a quarter fewer residuals, no such
proof.

With friction there is no potential, as the largest traction follows the pressure. For given pressures in the law there
is one, but for the change of the master's metric (Tresca's problem): the way out solves such problems, the pressures of
each being those found by the last, until they agree to `AGREEMENT` or `ROUNDS` are over (Licht, Pratt and Raous, 1991:
they do where the coefficient is small). Friction follows the pressure again where it goes on from there.

Where one face carries all, segments can move farther with the state than the state with them, so that an iteration in
which they are cut anew runs away from any solution. What is left then is a solution on the segments of the way out:
forces balance on them as on any others, and only the places of the quadrature points tell where the solve came from.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from swgpar.contact.flanks import FrozenSegments

MOST, HALVING = 8, 10
"""Newton iterations of a solve over `solver.max_iterations`, and within how many the residual has to halve then."""

PATIENCE, PROGRESS = 8, 0.9
"""Iterations over which the residual has to fall below this share of its smallest before, or else it sticks."""

ROUNDS, AGREEMENT = 20, 1e-3
"""Problems with given pressures in the law of friction, and how closely the last two have to agree."""


def fingerprint(comm: MPI.Comm, parts: Iterable[np.ndarray]) -> int:
    """A number for the arrays of all ranks together, the same on every rank: equal for equal arrays. Collective."""
    digest = hashlib.blake2b(digest_size=8, person=comm.rank.to_bytes(8, "little"))
    for part in parts:
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(np.ascontiguousarray(part).tobytes())
    return int(comm.allreduce(int.from_bytes(digest.digest(), "little"), op=MPI.BXOR))


def falls(residuals: Sequence[float], within: int, share: float) -> bool:
    """Whether the last `within` of the residuals have one below this share of all before."""
    return len(residuals) <= within or min(residuals[-within:]) < share * min(residuals[:-within])


def exhausted(residuals: Sequence[float], allowed: int) -> bool:
    """Whether Newton's iteration with these residuals, from the start's on, has had its chance."""
    return len(residuals) > allowed and not falls(residuals, HALVING, 0.5)


@dataclass
class CycleBreaker:
    """How far one solve has gone on the way out.

    active : segments are held, pressures given in the law of friction, and the line search is careful
    begun : that is or has been so; afterwards the iteration starts close to the solution
    rounds : of given pressures
    solution : the state found so and its segments, as long as it is an alternative to those cut anew
    """

    active: bool = False
    begun: bool = False
    rounds: int = 0
    solution: tuple[PETSc.Vec, FrozenSegments] | None = None


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
