"""Where a line of contact ends: where smooth flanks part, or on a sharp edge."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from swgpar.contact.pressed_lines import PressedLine
from swgpar.contact.search import FlankPair
from swgpar.flank_pressure.contact_station import line_station


def line(pressure: np.ndarray) -> PressedLine:
    ends = np.linspace(0.2, 0.3, len(pressure) + 1)
    pair = FlankPair(sector=0, side=1, ring=0, ring_sixths=0, ring_tooth=0)
    return PressedLine(pair, 0.0, 1.0, ends[:-1], ends[1:], pressure)


def test_smooth_flanks_end_where_they_part() -> None:
    x = np.linspace(-0.95, 0.95, 20)
    assert line(np.sqrt(1.0 - x**2)).ends_on_tips == (False, False)


def test_a_punch_ends_on_its_edges() -> None:
    """The pressure under a flat punch is 1 / sqrt(1 - x²); under a rounded one with one sharp edge
    it rises to that edge alone."""
    x = np.linspace(-0.95, 0.95, 20)
    assert line(1.0 / np.sqrt(1.0 - x**2)).ends_on_tips == (True, True)
    assert line(np.sqrt((1.0 + x) / (1.0 - x))).ends_on_tips == (False, True)
    assert line(np.sqrt((1.0 - x) / (1.0 + x))).ends_on_tips == (True, False)


def test_two_contacts_on_a_line_show_no_edge() -> None:
    """The outer one of both is small, and has two cells."""
    small = line(np.concatenate([[10.0, 7.0], np.linspace(20.0, 100.0, 8), [50.0, 10.0]]))
    assert small.ends_on_tips == (False, False)
    falling = np.array([90.0, 80.0, 70.0, 60.0, 50.0, 40.0])
    assert line(falling).ends_on_tips == (True, False)
    ends = np.array([0.0, 0.1, 0.5, 0.6, 0.7, 0.8])
    apart = replace(line(falling), low=ends, high=ends + 0.1)
    assert apart.ends_on_tips == (False, False)


def test_few_cells_show_no_edge() -> None:
    assert line(np.array([2.0])).ends_on_tips == (False, False)
    assert line(np.array([2.0, 1.0])).ends_on_tips == (False, False)


def test_the_end_is_not_known_within_the_outermost_cell() -> None:
    ends = np.array([0.2, 0.21, 0.23, 0.26])
    uneven = replace(line(np.array([1.0, 2.0, 1.0])), low=ends[:-1], high=ends[1:])
    assert uneven.outermost_cells == pytest.approx((0.01, 0.03))
    low, high = uneven.ends
    assert ends[0] < low < ends[1] and ends[-2] < high < ends[-1]


def test_a_line_with_two_contacts_has_the_pressure_and_width_of_one() -> None:
    """Strips of the line, of which the contacts are a twentieth each, show less."""
    x = np.linspace(-0.95, 0.95, 20)
    one = line(np.sqrt(1.0 - x**2))
    two = replace(
        one,
        low=np.concatenate([one.low - 1.9, one.low]),
        high=np.concatenate([one.high - 1.9, one.high]),
        pressure=np.concatenate([0.5 * one.pressure, one.pressure]),
    )
    alone, station = line_station(one, 48), line_station(two, 48)
    assert station.pressure_MPa == pytest.approx(alone.pressure_MPa)
    assert station.half_width_mm == pytest.approx(alone.half_width_mm)
    assert station.s_mm == pytest.approx(alone.s_mm)
    assert station.line_load_Nmm == pytest.approx(1.5 * alone.line_load_Nmm)
    assert max(station.cells_MPa) < 0.98 * alone.pressure_MPa


def test_a_peak_as_narrow_as_the_cells_is_seen() -> None:
    """Where the curvature of flanks that nearly conform jumps; not in the middle of a smooth
    contact, nor of one whose pressure rises to one side."""
    x = (np.arange(44) + 0.5) / 22.0 - 1.0
    smooth = np.sqrt(1.0 - x**2)
    assert not line(smooth).has_narrow_peak
    assert not line(smooth * (1.0 + 0.5 * x)).has_narrow_peak
    assert line(smooth + 0.8 * np.exp(-(((x + 0.8) / 0.05) ** 2))).has_narrow_peak


@pytest.mark.parametrize("begin", [0.0, 0.3, 0.5, 0.8])
def test_the_largest_mean_does_not_depend_on_where_a_peak_lies(begin: float) -> None:
    """A peak as long as a strip lies between two strips at fixed places."""
    fine = np.full(480, 100.0)
    first = 200 + round(10 * begin)
    fine[first : first + 10] = 300.0
    assert line(fine).largest_mean(48) == pytest.approx(300.0)


def test_the_largest_mean_of_a_smooth_contact_is_that_of_its_middle() -> None:
    x = np.linspace(-1.0, 1.0, 481)
    smooth = line(np.sqrt(1.0 - (0.5 * (x[:-1] + x[1:])) ** 2))
    assert smooth.largest_mean(48) == pytest.approx(smooth.strips(48).max(), rel=3e-4)
