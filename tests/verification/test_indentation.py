"""Pressure of a contact that is shorter than two layers of elements: half spaces on surfaces that
the mesh has moved, without its own indentation; lines of the law in it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from support.crowned_block import (
    HALF_LENGTH,
    HALF_WIDTH,
    MODULUS,
    Ellipse,
    PressedCrown,
    pressed_crown,
)
from swgpar.flank_pressure.indentation import indentation
from swgpar.flank_pressure.patch_contact import PatchContact, patch_contact


def pressure(found: PressedCrown, into: np.ndarray) -> PatchContact:
    """Contact of half spaces under the force of the mesh. into : (n_s, n_z) mm, of the nodes"""
    near = np.abs(found.s) < 1.0
    moved = CubicSpline(found.z, into[near].mean(axis=0))
    return patch_contact(
        lambda s, z: found.gap(s, z) + moved(z),
        np.zeros_like,
        (found.z[0], found.z[-1]),
        0.05,
        force=found.force.sum(),
        place=found.force.sum(axis=0) @ found.z / found.force.sum(),
        modulus=MODULUS,
    )


@pytest.mark.parametrize(
    ("layers", "place", "element"),
    [(6, 0.0, 0.2), (6, 0.25, 0.2), (6, 0.5, 0.2), (12, 0.0, 0.2), (12, 0.5, 0.2), (12, 0.25, 0.1)],
)
def test_pressure_of_an_ellipse(layers: int, place: float, element: float) -> None:
    """Hertz's largest pressure, wherever the contact lies in a layer."""
    found = pressed_crown(layers, place, element)
    exact = found.exact
    own = indentation(found.blocks.flanks.law.missing[0], found.z, found.force)
    ratio = pressure(found, found.into - own).pressure.max() / exact.peak
    twice = pressure(found, found.into).pressure.max() / exact.peak
    print(
        f"ellipse: {layers} layers, place {place}, element {element}: length over layer "
        f"{2.0 * exact.half_length / (found.z[1] - found.z[0]):.2f}, peak {ratio:.4f}, with the "
        f"indentation twice {twice:.4f}, iterations {found.blocks.iterations}"
    )
    assert ratio == pytest.approx(1.0, abs=0.02)
    assert twice < ratio


@pytest.mark.parametrize(("layers", "place"), [(6, 0.0), (6, 0.25), (6, 0.5), (12, 0.5)])
def test_lines_of_the_law_on_an_ellipse(layers: int, place: float) -> None:
    """Lines whose layer is loaded on a part of its width, and lines beside them."""
    found = pressed_crown(layers, place)
    exact, flanks = found.exact, found.blocks.flanks
    active = flanks.cells.active
    assert active is not None
    lines = flanks.law.pressed_lines(active)
    peak, load = exact.peak, 0.5 * np.pi * exact.half_width * exact.peak
    for line in lines:
        height = max(1.0 - (line.z / exact.half_length) ** 2, 0.0)
        ratio = line.line_load / load
        print(
            f"{layers} layers, place {place}, z {line.z:.2f}: load {ratio:.3f} ({height:.3f}), "
            f"pressure {line.largest / peak:.3f} ({np.sqrt(height):.3f})"
        )
        assert ratio == pytest.approx(height, abs=0.1)
        if height > 0.5:
            assert line.largest / peak == pytest.approx(np.sqrt(height), rel=0.05)
    carried = sum(line.line_load * line.length for line in lines)
    assert carried == pytest.approx(found.force.sum(), rel=1e-9)


def test_force_does_not_depend_on_the_place_in_a_layer() -> None:
    """At the approach of the ellipse. Without the coupling of the lines these forces are 1.10, 1.12
    and 1.26, with it 1.08, 1.09 and 1.03: the error of two lines on a layer. On 12 to 40 layers
    they are 1.02 to 1.05: the block yields less than a half space."""
    made = Ellipse(HALF_WIDTH, HALF_LENGTH).force
    force = [pressed_crown(6, place).force.sum() / made for place in (0.0, 0.25, 0.5)]
    assert np.ptp(force) < 0.07
    finer = np.mean([pressed_crown(12, place).force.sum() / made for place in (0.0, 0.5)])
    assert np.mean(force) == pytest.approx(finer, rel=0.04)
