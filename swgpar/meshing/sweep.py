"""Sweeping a plane mesh through stations: hexahedra, and quadrilaterals behind its lines."""

from __future__ import annotations

import numpy as np

from swgpar.geometry.arrays import Floats, Ints


def grid_quads(grid: Ints) -> Ints:
    """Quadrilaterals (n * m, 4) of a grid of nodes (n + 1, m + 1), by rows, then columns."""
    corners = (grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:])
    return np.stack(corners, axis=-1).reshape(-1, 4)


def sweep_quads(quads: Ints, rows: Ints) -> Ints:
    """Return the hexahedra (n_quad * n_step, 8) between consecutive copies of a plane mesh.

    quads : (n_quad, 4), counter-clockwise seen from the end of the sweep; numbers of columns of
        `rows`
    rows : (n_step + 1, n_column) nodes of each copy
    """
    return (
        np.concatenate((rows[:-1, quads], rows[1:, quads]), axis=-1).reshape(-1, 8).astype(np.int32)
    )


def sweep_line(line: Ints, rows: Ints) -> Ints:
    """Return the quadrilaterals (n_step * n_segment, 4) that a `line` of nodes (n,) leaves behind.

    Their right-hand normal points to the left of the line, seen from the end of the sweep.
    """
    a, b = rows[:, line[:-1]], rows[:, line[1:]]
    return np.stack((b[:-1], a[:-1], a[1:], b[1:]), axis=-1).reshape(-1, 4).astype(np.int32)


def symmetric_steps(n: int, ratio: float) -> Floats:
    """Return n + 1 numbers from 0 to 1; middle steps are `ratio` times as long as the outermost."""
    middle = np.abs((np.arange(n) + 0.5) / n * 2.0 - 1.0)
    reach = 1.0 - 1.0 / n  # of the outermost step
    steps = ratio ** (1.0 - middle / reach) if n > 1 else np.ones(1)
    return np.concatenate(([0.0], np.cumsum(steps) / steps.sum()))


def axial_stations(width: float, n: int, ratio: float, inner_width: float) -> Floats:
    """Return the coordinates z (n + 1,), mm, of the nodes along the face width.

    width : mm, face width of the gears; nodes lie at both ends
    n : number of elements
    ratio : length of the middle elements over that of the outermost ones
    inner_width : mm, face width of the wave generator; if smaller, nodes lie at its ends too
    """
    z = (symmetric_steps(n, ratio) - 0.5) * width
    if inner_width < width:
        half = 0.5 * inner_width
        # the nearest pair moves to the ends of the wave generator, the others are stretched with
        # it; at least one element stays on either side
        k = int(np.clip(np.argmin(np.abs(z[: (n + 1) // 2] + half)), 1, max(1, (n - 1) // 2)))
        ends = np.array((-0.5 * width, -half, half, 0.5 * width))
        z = np.interp(z, (z[0], z[k], z[n - k], z[n]), ends)
    z[[0, n]] = -0.5 * width, 0.5 * width
    return 0.5 * (z - z[::-1])
