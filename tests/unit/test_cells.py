"""Cells of lines: cut along the edges of the master's facets, at their places in the material
elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

from swgpar.contact.cells import Cells, Stations, divided

EDGES = np.array([0.0, 0.4, 1.0, 1.7])
"""mm, of the master's facets."""


def line(low: float, high: float, number: int = 16) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the cells on a face whose ends have these places on the master."""
    _, begin, end = divided(
        np.array([[low, high]]), np.array([high - low]), EDGES, np.array([[number]])
    )
    return begin, end


@pytest.mark.parametrize("number", [8, 13, 16, 64])
@pytest.mark.parametrize(("low", "high"), [(0.9, 0.3), (0.1, 1.6), (1.65, 0.05), (-0.5, 0.2)])
def test_cells_cover_the_face_and_end_at_edges(low: float, high: float, number: int) -> None:
    begin, end = line(low, high, number)
    assert begin[0] == 0.0 and end[-1] == 1.0 and len(begin) == number
    np.testing.assert_array_equal(begin[1:], end[:-1])
    width = end - begin
    assert width.min() > 0.49 / number and width.max() < 2.01 / number
    crossed = (EDGES - low) / (high - low)
    for place in crossed[(crossed > 0.5 / number) & (crossed < 1.0 - 0.5 / number)]:
        assert np.abs(begin - place).min() < 1e-12
    # cells without an edge beside them are where they always are
    ends = np.arange(1, number) / number
    far = np.abs(ends[:, None] - crossed).min(axis=1) > 0.5 / number
    np.testing.assert_allclose(begin[1:][far], ends[far], rtol=1e-14)


def test_pieces_have_their_own_cells() -> None:
    """An edge moves the nearest end, whichever piece it is in; the others stay."""
    parts = np.array([[1, 4, 1, 1], [1, 1, 2, 1]])
    foot = np.array([[0.9, 0.3], [2.0, 3.0]])  # the first is cut at 5/6, the second nowhere
    row, begin, end = divided(foot, np.diff(foot, axis=1)[:, 0], EDGES, parts)
    assert row.tolist() == [0] * 7 + [1] * 5
    ends = [0.0, 0.25, 0.3125, 0.375, 0.4375, 0.5, 5.0 / 6.0]
    np.testing.assert_allclose(begin[row == 0], ends, rtol=1e-14)
    np.testing.assert_allclose(begin[row == 1], [0.0, 0.25, 0.5, 0.625, 0.75], rtol=1e-14)
    for k in (0, 1):
        np.testing.assert_array_equal(begin[row == k][1:], end[row == k][:-1])


def test_cells_change_continuously_while_a_face_slides() -> None:
    """Where an edge passes from one cell's end to the next, it is in the middle between them."""
    before = line(0.9, 0.3)
    for shift in np.linspace(0.0, 0.2, 2001)[1:]:
        now = line(0.9 + shift, 0.3 + shift)
        moved = np.abs(np.array(now) - np.array(before)).max()
        assert moved < 1.01 * 0.5 / 16 + 1e-3
        before = now


def test_a_foot_beyond_reach_stands_a_face_away() -> None:
    """Across the tooth there is none: the other end and the face's length place the cuts."""
    rows = np.array([[np.nan, 0.3], [0.9, np.nan], [np.nan, np.nan]])
    length, number = np.full(3, -0.6), np.full((3, 1), 16)
    row, begin, end = divided(rows, length, EDGES, number)
    for k in (0, 1):
        np.testing.assert_allclose(begin[row == k], line(0.9, 0.3)[0], atol=1e-12)
    # without any foot there are no cuts
    np.testing.assert_allclose((end - begin)[row == 2], 1.0 / 16.0, rtol=1e-12)


def test_points_and_areas_integrate_over_the_face() -> None:
    """Shares of two stations and two points: polynomials of third order along the profile and
    along z."""
    stations = Stations.of(2, plane=False)
    begin, end = line(0.9, 0.3)
    n = len(begin)
    cells = Cells(
        np.zeros(2 * n, dtype=np.int64),
        np.tile(begin, 2),
        np.tile(end, 2),
        np.repeat(stations.place, n),
        np.repeat(stations.share, n),
    )
    assert cells.area.sum() == pytest.approx(1.0, rel=1e-14)
    integral = (cells.area * cells.a**3 * cells.b**3).sum()
    assert integral == pytest.approx(1.0 / 16.0, rel=1e-12)
    plane = Stations.of(2, plane=True)
    assert plane.place.tolist() == [0.5] and plane.share.tolist() == [1.0]
