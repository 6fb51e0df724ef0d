"""Line contact of two elastic bodies with any gap between them: pressure, width of the contact and
shear below it.

Near the contact both bodies are half planes; Hertz's formulas are the special case of a parabolic
gap. Flanks made of arcs have gaps whose curvature jumps, so the integral equation is solved
instead: the displacement of the surfaces by the pressure p is -2 / (pi E*) ∫ p(x') ln|x - x'| dx',
and it closes the gap where p > 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from swgpar.contact.pressed_lines import contact_end
from swgpar.flank_pressure.shear import largest_shear

STRIPS, ACROSS = 64, 24
"""Strips of constant pressure; least number of them in the contact."""

MAX_GRIDS, MAX_CHANGES = 30, 60
"""Changes of the strips' range, and of the strips in contact on one of them."""


@dataclass(frozen=True)
class LineContact:
    """Contact along a line.

    x : (n,) mm, middle of the strips;  pressure : (n,) MPa, constant on each
    middle, half_width : mm, of the contact;  at_end : whether it reaches the end of a body
    """

    x: np.ndarray
    pressure: np.ndarray
    middle: float
    half_width: float
    at_end: bool

    @property
    def peak(self) -> float:
        """Largest pressure, MPa."""
        return float(self.pressure.max())

    def largest_shear(self) -> float:
        """Largest shear stress below the surface, half the difference of the principal stresses,
        MPa."""
        edge = 0.5 * (self.x[1] - self.x[0])
        acts = self.pressure > 0.0
        x, p = self.x[acts], self.pressure[acts]
        return largest_shear(x - edge, x + edge, p, self.half_width)


def line_contact(
    gap: Callable[[np.ndarray], np.ndarray], start: float, width: float, load: float, modulus: float
) -> LineContact:
    """Pressure of a line load on bodies with a gap.

    Parameters
    ----------
    gap : gives the gap (n,) mm up to a constant at x (n,) mm; infinite beyond the end of a body
    start, width : mm, where the contact is looked for, and the order of its width; neither needs to
    be near
    load : N/mm, above 0;  modulus : E*, MPa

    Raises ArithmeticError if no contact is found.
    """
    low, high = start - width, start + width
    for _ in range(MAX_GRIDS):
        edges = np.linspace(low, high, STRIPS + 1)
        x, size = 0.5 * (edges[:-1] + edges[1:]), edges[1] - edges[0]
        pressure = _pressure(gap(x), size, load, modulus)
        acts = np.flatnonzero(pressure > 0.0)
        if not len(acts):
            break
        first, last = acts[0], acts[-1]
        free = ~np.isfinite(gap(np.array([low - size, high + size])))
        if (first == 0 and not free[0]) or (last == STRIPS - 1 and not free[1]):
            low, high = (
                low - (high - low) * (first == 0),
                high + (high - low) * (last == STRIPS - 1),
            )
        elif last - first + 1 < ACROSS:
            middle, half = (
                0.5 * (edges[first] + edges[last + 1]),
                max(1.2 * 0.5 * (last - first + 1), 1.5) * size,
            )
            low, high = max(low, middle - half), min(high, middle + half)
        else:
            strips = edges[:-1], edges[1:], pressure
            left, right = contact_end(*strips, first, 1), contact_end(*strips, last, -1)
            beside = gap(np.array([x[first] - size, x[last] + size]))
            return LineContact(
                x,
                pressure,
                0.5 * (left + right),
                0.5 * (right - left),
                bool(not np.isfinite(beside).all()),
            )
    raise ArithmeticError(f"no contact was found for a line load of {load:g} N/mm")


def _pressure(gap: np.ndarray, size: float, load: float, modulus: float) -> np.ndarray:
    """Pressures (n,) MPa of strips of this size (mm) under a line load (N/mm), 0 where they are
    open."""
    present = np.isfinite(gap)
    index = np.arange(len(gap)) + 0.5
    edge = np.abs(np.arange(-len(gap), len(gap) + 1) + 0.5)
    terms = edge * np.log(edge) * np.sign(np.arange(-len(gap), len(gap) + 1) + 0.5)
    distance = (index[:, None] - index).astype(int)
    offset = distance + len(gap)
    # integral of ln|x - x'| over a strip, in units of its size; a constant only moves the approach
    influence = -2.0 / (np.pi * modulus) * size * (terms[offset] - terms[offset - 1])
    closed = present.copy()
    gap = np.where(present, gap, 0.0)
    pressure = np.zeros(len(gap))
    for _ in range(MAX_CHANGES):
        n = int(closed.sum())
        system = np.zeros((n + 1, n + 1))
        system[:n, :n] = influence[np.ix_(closed, closed)]
        system[:n, n], system[n, :n] = -1.0, size
        found = np.linalg.solve(system, np.append(-gap[closed], load))
        pressure[:] = 0.0
        pressure[closed] = found[:n]
        penetrates = present & ~closed & (influence @ pressure + gap < found[n] * (1.0 - 1e-12))
        pulls = pressure < 0.0
        if not pulls.any() and not penetrates.any():
            break
        closed = (closed & ~pulls) if pulls.any() else closed | penetrates
    else:
        raise ArithmeticError("the strips in contact do not settle")
    return np.maximum(pressure, 0.0)
