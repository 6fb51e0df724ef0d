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

    def strips(self, number: int) -> np.ndarray:
        """Mean pressures (number,) MPa on equal strips between the ends of the contact."""
        ends = np.linspace(self.low[0], self.high[-1], number + 1)
        return np.diff(self._load_up_to(ends)) / np.diff(ends)

    def largest_mean(self, number: int) -> float:
        """Largest mean pressure (MPa) on a strip of the contact, of which `number` are as long as
        it. Of a peak as narrow as a strip those at fixed places would have more or less."""
        width = (self.high[-1] - self.low[0]) / number
        # the load of a strip is linear in its place between those where an end meets a cell's
        ends = np.concatenate([self.low, self.high])
        starts = np.concatenate([ends, ends - width])
        return float((self._load_up_to(starts + width) - self._load_up_to(starts)).max() / width)

    def _load_up_to(self, s: np.ndarray) -> np.ndarray:
        """Line load (n,) N/mm of the cells up to arc lengths s (n,) mm."""
        places = np.column_stack([self.low, self.high]).ravel()
        steps = np.zeros(len(places))
        steps[1::2] = self.pressure * (self.high - self.low)
        load: np.ndarray = np.interp(s, places, np.cumsum(steps))
        return load

    @property
    def has_narrow_peak(self) -> bool:
        """Whether the pressure has a peak that is not much wider than the cells, as where the
        curvature of flanks that nearly conform jumps."""
        contact = self.contact
        return contact.largest_mean(2 * WIDE) > (1.0 + PEAKED) * contact.largest_mean(WIDE)


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
