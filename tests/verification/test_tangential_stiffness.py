"""A pressed cylinder that is moved along the block it sticks to."""

from __future__ import annotations

import numpy as np
import pytest

from support.hertz import (
    HALF_WIDTH,
    RADIUS,
    SIZE,
    STEEL,
    centre_yields,
    cylinder_on_block,
    plane_modulus,
)

COEFFICIENT = 0.2


def tangential_stiffness(ratio: float) -> float:
    """N/mm per length of the cylinder, of the far sides, over E*. ratio : length of the elements
    over the half width of the contact"""
    blocks = cylinder_on_block(ratio * HALF_WIDTH, 0.25, (STEEL, STEEL), 1.125, True)
    modulus = 0.5 * plane_modulus(STEEL)
    load = 0.25 * np.pi * modulus * HALF_WIDTH**2 / RADIUS
    approach = 2.0 * load * centre_yields(STEEL)
    upper = np.arange(len(blocks.points)) >= blocks.first
    u = np.zeros_like(blocks.points)
    u[upper, 1] = -approach
    blocks.press(u, np.zeros_like(u))
    flanks = blocks.flanks
    flanks.friction_coefficient = flanks.history.coefficient = COEFFICIENT
    blocks.before = u.copy()
    shift = 0.02 * COEFFICIENT * approach  # all but the outermost cells stick
    forces = []
    for way in (0.0, shift):
        u[upper & (blocks.points[:, 1] > SIZE - 1e-9), 0] += way
        forces.append(blocks.press(u, np.zeros_like(u)).contact[blocks.first :, 0].sum())
    return float(forces[1] - forces[0]) / shift / modulus


def test_slip_does_not_depend_on_the_mesh() -> None:
    """Lengths of elements differ by a factor of ten, stiffnesses by 0.9 %. With a stiffness of
    50 E per mm of sticking surface it was 0.231 on elements of 1.5 half widths and 0.299 on
    elements of 15. The normal stiffness, load over approach, is 0.285: the far sides are held in
    both directions, and a layer is softer in shear."""
    found = [tangential_stiffness(ratio) for ratio in (1.5, 6.0, 15.0)]
    print("tangential stiffness over E*:", " ".join(f"{k:.4f}" for k in found))
    assert np.ptp(found) < 0.01 * max(found)
    assert np.mean(found) == pytest.approx(0.221, rel=0.01)
