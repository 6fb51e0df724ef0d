"""Sections of a plane body: two sectors of one element each, which meet at nodes of their own."""

from __future__ import annotations

import numpy as np
import pytest

from swgpar.presentation.sections import PlaneBody

X, Y = np.array([1.0, 2.0, 2.0, 1.0, 2.0, 3.0, 3.0, 2.0]), np.array([0.0, 0.0, 1.0, 1.0] * 2)


def body(copies: int = 1) -> PlaneBody:
    """Squares from x = 1 to 2 and from 2 to 3 mm, between y = 0 and 1 mm; stress x."""
    lower = np.column_stack([X, Y, np.zeros(8)])
    points = np.concatenate([lower, lower + [0.0, 0.0, 1.0]])
    cells = np.array([[0, 1, 2, 3, 8, 9, 10, 11], [4, 5, 6, 7, 12, 13, 14, 15]])
    return PlaneBody.of(points, cells, np.tile(X, 2), copies)


def test_a_body_is_its_lower_layer_with_what_symmetry_left_out() -> None:
    whole = body(copies=2)
    assert whole.quads.shape == (4, 4)
    assert whole.points[whole.quads].mean(axis=1) == pytest.approx(
        np.array([[1.5, 0.5], [2.5, 0.5], [-1.5, -0.5], [-2.5, -0.5]])
    )
    assert whole.mises[whole.quads[2]] == pytest.approx(whole.mises[whole.quads[0]])


def test_sectors_are_joined_and_their_common_side_is_no_outline() -> None:
    section = body().section(0.0, (0.0, 4.0, 0.0, 4.0))
    assert section is not None
    assert len(section.points) == 6
    assert len(section.outline) == 6
    assert not (section.outline[..., 0] == 2.0).all(axis=1).any()
    assert section.mises == pytest.approx(section.points[:, 0])
    a, b, c = np.moveaxis(section.points[section.triangles], 1, 0)
    (u, v), (s, t) = (b - a).T, (c - a).T
    assert np.abs(0.5 * (u * t - v * s)).sum() == pytest.approx(2.0)


def test_only_elements_that_reach_into_the_box_are_drawn() -> None:
    section = body().section(0.0, (2.5, 4.0, 0.2, 0.4))
    assert section is not None
    assert section.points[:, 0].min() == 2.0
    assert body().section(0.0, (4.0, 5.0, 0.0, 1.0)) is None


def test_the_box_turns_with_its_angle() -> None:
    """A quarter of a turn clockwise: the figure's upward axis is the body's x."""
    section = body().section(-0.5 * np.pi, (-2.0, 0.0, 0.0, 4.0))
    assert section is not None
    assert section.points.max(axis=0) == pytest.approx([0.0, 3.0], abs=1e-12)
    assert section.mises == pytest.approx(section.points[:, 1])
