"""Pressure along the profile on the lines of contact of a pair of flanks."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from swgpar.contact.search import FlankPair

RISES = 1.01
"""Pressure of a cell over that of the next one inwards from which it rises to the end."""

RISING = 4
"""Cells at an end over which the pressure rises to an edge."""

WIDE, PEAKED = 12, 0.03
"""Strips of a contact, and what halves of them may have more than these at the largest pressure: in
the middle of Hertz's contact 0.1 %."""

ROUND_OFF = 1e-9
"""Distance of two cells over the length of their line below which they touch."""


@dataclass(frozen=True)
class Strips:
    """Equal strips across a contact.

    first, width : mm, arc length at which the first one begins, and length of each
    pressure : (n,) MPa, means
    """

    first: float
    width: float
    pressure: np.ndarray


@dataclass(frozen=True)
class PressedLine:
    """The cells that carry on a line of contact.

    pair : of flanks;  z, length : mm, station along the face width and its share of it
    low, high : (n,) mm, ends of the cells, arc lengths from the tip of the flexible spline's tooth,
    ascending;  pressure : (n,) MPa, constant on each cell
    """

    pair: FlankPair
    z: float
    length: float
    low: np.ndarray
    high: np.ndarray
    pressure: np.ndarray

    @property
    def line_load(self) -> float:
        """N/mm"""
        return float(self.pressure @ (self.high - self.low))

    @property
    def largest(self) -> float:
        """Largest pressure, MPa."""
        return float(self.pressure.max())

    @property
    def ends(self) -> tuple[float, float]:
        """Ends (mm) of the contact in its outermost cells: the square of the pressure falls
        linearly to them."""
        if len(self.pressure) == 1:
            return float(self.low[0]), float(self.high[0])
        return (
            contact_end(self.low, self.high, self.pressure, 0, 1),
            contact_end(self.low, self.high, self.pressure, -1, -1),
        )

    @property
    def outermost_cells(self) -> tuple[float, float]:
        """Lengths (mm) of the outermost cells: within them the end of the contact is not known."""
        return float(self.high[0] - self.low[0]), float(self.high[-1] - self.low[-1])

    @property
    def ends_on_tips(self) -> tuple[bool, bool]:
        """Whether the contact ends on the tip of the flexible spline, of the ring gear: the
        pressure rises to a sharp edge, where it is largest, and falls to 0 where smooth flanks
        part."""
        gaps = self._gaps
        return _rises(self.pressure, gaps), _rises(self.pressure[::-1], gaps[::-1])

    @property
    def _gaps(self) -> np.ndarray:
        """Distances (n - 1,) between the cells, over the length of all."""
        return (self.low[1:] - self.high[:-1]) / (self.high[-1] - self.low[0])

    @property
    def contact(self) -> PressedLine:
        """Cells without a gap between them that have the largest pressure: flanks that nearly
        conform may touch at two places of a line."""
        apart = np.flatnonzero(self._gaps > ROUND_OFF) + 1
        parts = np.split(np.arange(len(self.pressure)), apart)
        cells = next(cells for cells in parts if self.pressure.argmax() in cells)
        low, high, pressure = (each[cells] for each in (self.low, self.high, self.pressure))
        return replace(self, low=low, high=high, pressure=pressure)

    def strips(self, number: int) -> Strips:
        """Equal strips that cover the contact, one less than their number as long as it, with the
        largest mean pressure that a strip has anywhere: where the pressure has a peak as narrow as
        they are, its place among fixed strips would decide."""
        begin, end = float(self.low[0]), float(self.high[-1])
        width = (end - begin) / (number - 1)
        places = np.column_stack([self.low, self.high]).ravel()
        steps = np.zeros(len(places))
        steps[1::2] = self.pressure * (self.high - self.low)
        load = np.cumsum(steps)
        # the load of a strip is piecewise linear in its place
        starts = np.concatenate([places, places - width])
        top = float(starts[_loads(starts, width, places, load).argmax()])
        first = top - width * np.ceil((top - begin) / width)
        every = _loads(first + width * np.arange(number), width, places, load)
        return Strips(float(first), width, every / width)

    @property
    def has_narrow_peak(self) -> bool:
        """Whether the pressure has a peak that is not much wider than the cells, as where the
        curvature of flanks that nearly conform jumps."""
        narrow, wide = (self.contact.strips(number).pressure for number in (2 * WIDE, WIDE))
        return bool(narrow.max() > (1.0 + PEAKED) * wide.max())


def _loads(starts: np.ndarray, width: float, places: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Line loads (n,) N/mm of strips from `starts` (n,) mm on. load : (m,) N/mm up to each of the
    places (m,) mm, linear between them"""
    up_to: np.ndarray = np.interp(starts + width, places, load) - np.interp(starts, places, load)
    return up_to


def _rises(pressure: np.ndarray, gaps: np.ndarray) -> bool:
    """Whether the pressure (n,) of cells from an end inwards is largest in the first one and falls
    over `RISING` cells of one contact. gaps : (n - 1,) between cells, over the length of all"""
    outer = pressure[:RISING]
    if len(outer) < RISING or outer[0] < pressure.max() or gaps[: RISING - 1].max() > ROUND_OFF:
        return False
    return bool((outer[:-1] > RISES * outer[1:]).all())


def contact_end(
    low: np.ndarray, high: np.ndarray, pressure: np.ndarray, k: int, inward: int
) -> float:
    """End (mm) of a contact beside its outermost strip k, or the end of that strip: the square of
    the pressure falls linearly to it.

    low, high : (n,) mm, ends of the strips;  pressure : (n,) MPa;  inward : 1 or -1, to the next
    strip
    """
    half = 0.5 * float(high[k] - low[k])
    outer, inner = pressure[[k, k + inward]] ** 2
    beyond = 2.0 * half * outer / (inner - outer) if inner > outer else half
    return 0.5 * float(low[k] + high[k]) - inward * min(float(beyond), half)
