"""Pressure of a contact that is shorter than two layers of elements: half spaces on surfaces that
the mesh has moved, without its own indentation."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from support.crowned_block import MODULUS, PressedCrown, pressed_crown
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
