"""Contact of two elastic bodies over a small patch, with any gap between them: pressure, length and
width.

Near the contact both bodies are half spaces. A pressure p moves their surfaces by 1 / (pi E*) ∫ p /
r dA (Johnson, Contact Mechanics, 3.2); that closes the gap where p > 0. Force and place of its
resultant are given, the approach and the tilt of the bodies follow. Hertz's ellipse is the special
case of a parabolic gap.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from swgpar.contact.pressed_lines import contact_end
from swgpar.flank_pressure.shear import largest_shear

CELLS_ACROSS, CELLS_ALONG = 24, 28
"""Cells of constant pressure over the width and along the length of the grid."""

FEWEST = 12
"""Cells in the contact, in either direction, below which the grid is made smaller."""

MAX_GRIDS, MAX_CHANGES = 24, 80
"""Changes of the grid, and of the cells in contact on one of them."""

FIRST_GUESS = 0.5
"""Share of the grid, as that of an ellipse around the force, whose cells are in contact at
first."""

MARGIN = 1.25
"""Size of a smaller grid over that of the contact."""

SMALLER = 0.9
"""Width or length of a smaller grid over the present one, above which it would not resolve the
contact better."""


@dataclass(frozen=True)
class PatchContact:
    """Contact over a patch.

    z : (n,) mm, stations along the length that carry a load
    cells : (n, m) MPa, pressure of the cells across a station, constant on each
    first : (n,) mm, middle of the first of them across;  cell_width, cell_length : mm, of every
    cell
    middle, half_width : (n,) mm, of the contact at a station
    at_end : whether it reaches the end of a body across;  reaches : whether it reaches one of the
    ends of its length
    """

    z: np.ndarray
    cells: np.ndarray
    first: np.ndarray
    cell_width: float
    cell_length: float
    middle: np.ndarray
    half_width: np.ndarray
    at_end: bool
    reaches: bool

    @property
    def line_load(self) -> np.ndarray:
        """Line load (n,) N/mm of the stations."""
        return self.cells.sum(axis=1) * self.cell_width

    @property
    def pressure(self) -> np.ndarray:
        """Largest pressure (n,) MPa at the stations."""
        return self.cells.max(axis=1)

    @property
    def largest_shear(self) -> float:
        """Largest shear stress below the station with the largest pressure, MPa."""
        top = int(self.pressure.argmax())
        pressure = self.cells[top]
        low = self.first[top] + self.cell_width * (np.arange(len(pressure)) - 0.5)
        acts = pressure > 0.0
        low, pressure = low[acts], pressure[acts]
        half_width = float(self.half_width[top])
        return largest_shear(low, low + self.cell_width, pressure, half_width)


Gap = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Gives the gap (n_s, n_z) mm, up to a constant and a tilt, at s (n_s, n_z) and z (n_z,); infinite
beyond the body."""


def patch_contact(
    gap: Gap,
    centre: Callable[[np.ndarray], np.ndarray],
    ends: tuple[float, float],
    width: float,
    *,
    force: float,
    place: float,
    modulus: float,
) -> PatchContact:
    """Pressure of a force on bodies with a gap.

    Parameters
    ----------
    gap : see `Gap`;  centre : gives s (n,) mm of the least gap at z (n,) mm
    ends : z (mm) of the ends of the bodies;  width : mm, order of the contact's width; it need not
    be near
    force : N, above 0;  place : z (mm) of its resultant;  modulus : E*, MPa

    Raises ArithmeticError if no contact is found.
    """
    low, high, half = *ends, width
    stations = np.linspace(low, high, CELLS_ALONG + 1)
    least, middle_line = (
        centre(stations),
        np.zeros(2),
    )  # the least gap is looked for once: only a place to begin at
    for _ in range(MAX_GRIDS):
        grid = _Grid(
            gap,
            partial(_centre, stations, least, middle_line),
            low,
            high,
            half,
        )
        pressure = grid.solve(force, place, modulus)
        if pressure is None:  # cells that are too long do not carry the force at its place
            reach = 0.25 * (high - low)
            low, high, half = max(ends[0], place - reach), min(ends[1], place + reach), 0.5 * half
            continue
        acts = pressure > 0.0
        columns = np.flatnonzero(acts.any(axis=0))
        across = int(acts.sum(axis=0).max())
        border = acts[[0, -1]] & np.isfinite(grid.beyond())
        if border.any():
            half *= 2.0
            continue
        open_ends = np.array([low, high]) != np.array(ends)
        short = np.array([columns[0] == 0, columns[-1] == CELLS_ALONG - 1]) & open_ends
        if short.any():
            longer = 0.5 * (high - low)
            low, high = (
                max(ends[0], low - longer * short[0]),
                min(ends[1], high + longer * short[1]),
            )
            continue
        narrower, line = half, middle_line
        if across < FEWEST:
            shift, furthest = grid.middle_line(acts)
            narrower, line = max(MARGIN * furthest, 2.0 * grid.dt), middle_line + shift
        shorter = low, high
        if len(columns) < FEWEST:
            middle = 0.5 * (grid.z[columns[0]] + grid.z[columns[-1]])
            reach = max(0.5 * MARGIN * (len(columns) + 1), 1.5) * grid.dz
            shorter = max(ends[0], middle - reach), min(ends[1], middle + reach)
        if narrower > SMALLER * half and shorter[1] - shorter[0] > SMALLER * (high - low):
            return grid.contact(pressure, ends)
        half, middle_line, (low, high) = narrower, line, shorter
    raise ArithmeticError(f"no contact was found for a force of {force:g} N")


def _centre(stations: np.ndarray, least: np.ndarray, line: np.ndarray, z: np.ndarray) -> np.ndarray:
    """s (n,) mm of the middle of a grid at z (n,) mm: that of the least gap at the stations (m,)
    and a line with coefficients of `numpy.polyval`."""
    return np.interp(z, stations, least) + np.polyval(line, z)


class _Grid:
    """Cells that follow the line of the least gap: n_t over the width, n_z along the length."""

    def __init__(
        self,
        gap: Gap,
        centre: Callable[[np.ndarray], np.ndarray],
        low: float,
        high: float,
        half: float,
    ) -> None:
        t, z = np.linspace(-half, half, CELLS_ACROSS + 1), np.linspace(low, high, CELLS_ALONG + 1)
        self.t, self.dt = 0.5 * (t[:-1] + t[1:]), t[1] - t[0]
        self.z, self.dz = 0.5 * (z[:-1] + z[1:]), z[1] - z[0]
        self.s0 = centre(self.z)
        self._gap_at = gap
        self.gap = gap(self.t[:, None] + self.s0, self.z)

    def beyond(self) -> np.ndarray:
        """Gap (2, n_z) mm in the cells beside the grid."""
        return self._gap_at(
            np.array([[self.t[0] - self.dt], [self.t[-1] + self.dt]]) + self.s0, self.z
        )

    def middle_line(self, acts: np.ndarray) -> tuple[np.ndarray, float]:
        """Straight line along the middle of the contact, and its largest distance (mm) from the
        contact's edge.

        acts : (n_t, n_z) bool, cells in contact;  the line has the coefficients (2,) of
        `numpy.polyval` over z
        """
        columns = np.flatnonzero(acts.any(axis=0))
        first = acts[:, columns].argmax(axis=0)
        last = CELLS_ACROSS - 1 - acts[::-1, columns].argmax(axis=0)
        edges, z = (
            np.array([self.t[first] - 0.5 * self.dt, self.t[last] + 0.5 * self.dt]),
            self.z[columns],
        )
        line = (
            np.polyfit(z, edges.mean(axis=0), 1)
            if len(columns) > 2
            else np.array([0.0, edges.mean()])
        )
        return line, float(np.abs(edges - np.polyval(line, z)).max())

    def _influence(self, modulus: float) -> np.ndarray:
        """Displacement (n, n) mm of cells by a pressure of 1 MPa on one of them (Johnson, 3.25)."""
        steps = np.arange(1 - CELLS_ACROSS, CELLS_ACROSS)[:, None, None] * self.dt
        x = steps + self.s0[:, None] - self.s0
        y = np.broadcast_to(self.z[:, None] - self.z, x.shape)
        a, b = 0.5 * self.dt, 0.5 * self.dz

        def term(u: np.ndarray, v: np.ndarray, w: np.ndarray) -> np.ndarray:
            size = np.maximum(np.abs(u), np.finfo(float).tiny)  # the term vanishes with u
            return u * (np.arcsinh(v / size) - np.arcsinh(w / size))

        table = term(x + a, y + b, y - b) + term(x - a, y - b, y + b)
        table += term(y + b, x + a, x - a) + term(y - b, x - a, x + a)
        i = np.arange(CELLS_ACROSS)
        offset = i[:, None] - i + CELLS_ACROSS - 1
        n = CELLS_ACROSS * CELLS_ALONG
        return table[offset].transpose(0, 2, 1, 3).reshape(n, n) / (np.pi * modulus)

    def solve(self, force: float, place: float, modulus: float) -> np.ndarray | None:
        """Pressure (n_t, n_z) MPa; None where no cells in contact are found."""
        influence, area = self._influence(modulus), self.dt * self.dz
        lever = np.tile(self.z - place, CELLS_ACROSS)
        present = np.isfinite(self.gap).ravel()
        gap = np.where(present, self.gap.ravel(), 0.0)
        modes = np.column_stack([np.ones_like(lever), lever])
        reach = max(min(place - self.z[0], self.z[-1] - place), 2.0 * self.dz)
        first = (self.t[:, None] / self.t[-1]) ** 2 + ((self.z - place) / reach) ** 2 < FIRST_GUESS
        closed = present & first.ravel()
        for _ in range(MAX_CHANGES):
            at = np.flatnonzero(closed)
            if not closed.reshape(self.gap.shape).any(axis=0).sum() > 1:
                return None
            system = np.zeros((len(at) + 2, len(at) + 2))
            system[:-2, :-2] = influence[np.ix_(at, at)]
            system[:-2, -2:], system[-2:, :-2] = -modes[at], area * modes[at].T
            found = np.linalg.solve(system, np.concatenate([-gap[at], [force, 0.0]]))
            pressure = np.zeros(len(closed))
            pressure[at] = found[:-2]
            pulls = pressure < 0.0
            if pulls.any():
                closed = closed & ~pulls
                continue
            penetration = modes @ found[-2:] - influence[:, at] @ found[:-2] - gap
            penetrates = present & ~closed & (penetration > 1e-9 * np.abs(penetration).max())
            if not penetrates.any():
                return pressure.reshape(CELLS_ACROSS, CELLS_ALONG)
            closed = closed | penetrates
        return None

    def contact(self, pressure: np.ndarray, ends: tuple[float, float]) -> PatchContact:
        """The contact by the pressure (n_t, n_z) MPa of this grid."""
        columns = np.flatnonzero(pressure.any(axis=0))
        sides = np.array([self._sides(pressure[:, k]) for k in columns])
        left, right = sides.T
        reaches = (columns[0] == 0 and self.z[0] - self.dz < ends[0]) or (
            columns[-1] == CELLS_ALONG - 1 and self.z[-1] + self.dz > ends[1]
        )
        middle = self.s0[columns] + 0.5 * (left + right)
        half = 0.5 * (right - left)
        return PatchContact(
            z=self.z[columns],
            cells=pressure[:, columns].T,
            first=self.s0[columns] + self.t[0],
            cell_width=float(self.dt),
            cell_length=float(self.dz),
            middle=middle,
            half_width=half,
            at_end=self._body_ends_beside(pressure),
            reaches=bool(reaches),
        )

    def _sides(self, pressure: np.ndarray) -> tuple[float, float]:
        """Ends (mm, from the centre) of the contact in a column with pressures (n_t,) MPa."""
        acts = np.flatnonzero(pressure)
        if len(acts) == 1:
            return self.t[acts[0]] - 0.5 * self.dt, self.t[acts[0]] + 0.5 * self.dt
        strips = self.t - 0.5 * self.dt, self.t + 0.5 * self.dt, pressure
        return contact_end(*strips, acts[0], 1), contact_end(*strips, acts[-1], -1)

    def _body_ends_beside(self, pressure: np.ndarray) -> bool:
        """Whether the body ends beside the contact by the pressure (n_t, n_z) MPa in any column."""
        below, above = self.beyond()
        missing = ~np.isfinite(np.vstack([below, self.gap, above]))
        for column in np.flatnonzero(pressure.any(axis=0)):
            acts = np.flatnonzero(pressure[:, column])
            if missing[[acts[0], acts[-1] + 2], column].any():
                return True
        return False
