"""Forces on the cells of lines of contact: complementary, unique, with their derivatives."""

from __future__ import annotations

import numpy as np
import pytest

from support.contact_blocks import Surface, arc_block
from swgpar.contact.contact_lines import (
    CellLoads,
    FlankCompliance,
    Strips,
    complementary_forces,
    forces,
    line_starts,
)
from swgpar.contact.missing_compliance import MissingCompliance
from swgpar.fem.body import Body
from swgpar.materials import Isotropic

FACETS, COUNT = 6, 8
"""Facets of both flanks, 1 mm long; cells on each."""


def flank(facing: int, young: float) -> MissingCompliance:
    s, z = np.linspace(0.0, float(FACETS), FACETS + 1), np.array([0.0, 1.0])
    material = Isotropic(E=young, nu=0.3)
    block = arc_block(s, s, z, Surface((0.0, 0.0), 0.0, facing), material)
    (grid,) = block.mesh.flanks
    return MissingCompliance(
        block.mesh, grid, Body(block.mesh, (material,), 1.0).in_plane_elasticity
    )


BODIES = flank(-1, 210e3), flank(1, 70e3)


def line_of_cells() -> tuple[Strips, Strips]:
    """Cells of one line, which runs the other way on the master."""
    ends = np.linspace(0.0, float(FACETS), FACETS * COUNT + 1)
    slave = Strips(ends[:-1], ends[1:])
    return slave, Strips(FACETS - slave.high, FACETS - slave.low)


def compliance(strips: tuple[Strips, Strips]) -> np.ndarray:
    """D (n, n) of both bodies, of cells of one line."""
    n = len(strips[0].low)
    out = np.zeros(n * n)
    for body, ends in zip(BODIES, strips):
        body.add(np.array([0, n]), ends.low, ends.high, out)
    return out.reshape(n, n)


def two_lines(seed: int = 2) -> tuple[np.ndarray, np.ndarray, tuple[Strips, Strips]]:
    """Numbers of two lines' cells, gaps that are below zero in two places of the first line and in
    one of the second, and ends."""
    one = line_of_cells()
    n = len(one[0].low)
    line = np.repeat([3, 8], n)
    x = 0.5 * (one[0].low + one[0].high)
    valleys = [
        np.minimum((x - 1.4) ** 2, (x - 4.3) ** 2 + 0.02),
        (x - 3.1) ** 2,
    ]
    rng = np.random.default_rng(seed)
    gap = 1e-3 * (np.concatenate(valleys) - 0.1) + rng.uniform(-1e-5, 1e-5, 2 * n)
    return line, gap, tuple(Strips(np.tile(e.low, 2), np.tile(e.high, 2)) for e in one)


def pressed(
    line: np.ndarray,
    gap: np.ndarray,
    strips: tuple[Strips, Strips],
    softness: np.ndarray,
    share: float,
) -> CellLoads:
    """Forces on cells of lines, each on a flank of its own and 1 mm long."""
    bodies = FlankCompliance(BODIES[0], None), FlankCompliance(BODIES[1], None)
    return forces(line, line, gap, np.ones(len(line)), strips, bodies, softness, share)


@pytest.mark.parametrize("share", [1.0, 0.1])
def test_forces_are_complementary(share: float) -> None:
    """On all cells of a line, also on those far from the overlap; lines do not couple."""
    line, gap, strips = two_lines()
    found = pressed(line, gap, strips, np.zeros(len(line)), share)
    assert (found.force >= 0.0).all()
    d = compliance(line_of_cells()) / share
    for number in (3, 8):
        f, g = found.force[line == number], gap[line == number]
        left = g + d @ f
        assert 0 < np.count_nonzero(f) < len(f)
        assert left.min() > -1e-9 * np.abs(g).min() - 1e-12
        assert np.abs(left[f > 0.0]).max() < 1e-12
    # the second line alone has the same forces
    second = line == 8
    alone = tuple(Strips(e.low[second], e.high[second]) for e in strips)
    again = pressed(line[second], gap[second], alone, np.zeros(second.sum()), share)
    np.testing.assert_allclose(again.force, found.force[second], rtol=1e-12)


def test_softness_is_of_each_cell_alone() -> None:
    """It adds to the diagonal of D: cells yield by it under their own force."""
    line, gap, strips = two_lines()
    first = line == 3
    softness = np.linspace(0.0, 1e-4, len(line))
    found = pressed(line, gap, strips, softness, 0.5)
    for number in (3, 8):
        f, g = found.force[line == number], gap[line == number]
        d = compliance(line_of_cells()) + np.diag(softness[line == number])
        left = g + d @ f / 0.5
        assert left.min() > -1e-12 and np.abs(left[f > 0.0]).max() < 1e-12
    hard = pressed(line, gap, strips, np.zeros(len(line)), 0.5)
    assert found.force[first].sum() < 0.99 * hard.force[first].sum()


def test_forces_are_unique() -> None:
    """Whichever cells carry at first: the least of f g + f D f / 2, which no other forces have."""
    line, gap, strips = two_lines()
    first = line == 3
    d, g = compliance(line_of_cells()), gap[first]
    f = pressed(line, gap, strips, np.zeros(len(line)), 1.0).force[first]
    energy = f @ g + 0.5 * f @ d @ f
    rng = np.random.default_rng(5)
    for size in (1e-3, 1.0, 10.0):
        for _ in range(50):
            other = np.maximum(f + size * rng.uniform(-1.0, 1.0, len(f)), 0.0)
            assert other @ g + 0.5 * other @ d @ other > energy
    # the cells in another order
    order = rng.permutation(len(g))
    again, _ = complementary_forces(d[np.ix_(order, order)], g[order])
    np.testing.assert_allclose(again, f[order], rtol=1e-9, atol=1e-12 * f.max())


def test_forces_of_any_gaps() -> None:
    """Rough gaps, for which all wrong cells together return to where they were, have forces too."""
    d = compliance(line_of_cells())
    rng = np.random.default_rng(11)
    for _ in range(200):
        g = rng.uniform(-1e-3, 1e-3, len(d))
        f, acts = complementary_forces(d, g)
        assert acts.any() and (f[~acts] == 0.0).all() and (f[acts] > 0.0).all()
        left = g + d @ f
        assert left.min() > -1e-12 and np.abs(left[acts]).max() < 1e-12


@pytest.mark.parametrize("share", [1.0, 0.1])
def test_stiffness_is_that_of_differences(share: float) -> None:
    line, gap, strips = two_lines()
    found = pressed(line, gap, strips, np.zeros(len(line)), share)
    stiffness = np.zeros((len(gap), len(gap)))
    for cells, block in found.flanks:
        stiffness[np.ix_(cells, cells)] = block
        assert np.linalg.eigvalsh(0.5 * (block + block.T))[0] > 0.0
        assert np.abs(block - block.T).max() < 1e-9 * np.abs(block).max()
    h = 1e-9
    for k in np.flatnonzero(found.force > 0.0)[::5]:
        step = h * (np.arange(len(gap)) == k)
        plus, minus = (
            pressed(line, gap + sign * step, strips, np.zeros(len(line)), share).force
            for sign in (1.0, -1.0)
        )
        np.testing.assert_allclose(
            -(plus - minus) / (2.0 * h), stiffness[:, k], atol=1e-5 * np.abs(stiffness).max()
        )


def test_cells_without_a_foot_carry_nothing() -> None:
    """Nor do they change the forces of others, but by what they carried."""
    line, gap, strips = two_lines()
    all_cells = pressed(line, gap, strips, np.zeros(len(line)), 1.0)
    carrying = np.flatnonzero(all_cells.force > 0.0)
    without = gap.copy()
    without[carrying[::3]] = np.inf
    found = pressed(line, without, strips, np.zeros(len(line)), 1.0)
    assert not found.force[carrying[::3]].any() and np.isfinite(found.force).all()
    assert all(np.isfinite(block).all() for _, block in found.flanks)
    open_cells = gap.copy()
    open_cells[all_cells.force == 0.0] = np.inf
    same = pressed(line, open_cells, strips, np.zeros(len(line)), 1.0)
    np.testing.assert_allclose(same.force, all_cells.force, rtol=1e-9)


def test_no_overlap_no_forces() -> None:
    line, gap, strips = two_lines()
    for gaps in (np.abs(gap) + 1e-6, np.full(len(gap), np.inf)):
        found = pressed(line, gaps, strips, np.zeros(len(line)), 1.0)
        assert not found.force.any() and not found.flanks
    none = np.zeros(0)
    empty = Strips(none, none)
    found = pressed(none.astype(np.int64), none, (empty, empty), np.zeros(len(line)), 1.0)
    assert not len(found.force) and not found.flanks


def test_starts_of_lines() -> None:
    assert line_starts(np.array([2, 2, 5, 9, 9, 9])).tolist() == [0, 2, 3, 6]
    assert line_starts(np.zeros(0, dtype=np.int64)).tolist() == [0]
