"""Errors of the largest values of the contacts of flanks: by the mesh of the drive, and by the
increments at which they are looked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from swgpar.results.history import Row

MISSED = 1.0 / 3.0
"""Error of a largest value by the increments, over what every other increment changes: a smooth
curve rises between them by the square of their distance."""


@dataclass(frozen=True)
class ContactErrorShares:
    """Errors by the mesh of the drive as shares of the values; None where they are not known.

    pressure, pressure_off_edges : of the largest pressure of all pairs, and of those off edges
    force : of the largest force of a pair;  force_share : of its share in the force of all pairs
    on_lines : whether flanks touch on lines, as in the plane: the pair with the largest pressure is
    then the same on other meshes, and what it has beside follows from the pressure
    """

    pressure: float | None = None
    pressure_off_edges: float | None = None
    force: float | None = None
    force_share: float | None = None
    on_lines: bool = False


UNKNOWN = ContactErrorShares()
"""No error is known."""


def error_of_largest(
    pairs: Sequence[Row],
    largest: Callable[[Sequence[Row]], float],
    share: float | None,
) -> float | None:
    """Error of the largest value that rows of pairs.csv have; None where that by the mesh is not
    known.

    largest : value of the rows of some increments, 0 of none;  share : by the mesh

    What every other increment misses shows what lies between the increments.
    """
    if share is None:
        return None
    increments = sorted({pair["increment"] for pair in pairs})
    every = largest(pairs)
    halves = [
        largest([pair for pair in pairs if pair["increment"] in chosen])
        for chosen in (set(increments[::2]), set(increments[1::2]))
        if chosen
    ]
    return share * every + MISSED * (every - min(halves))
