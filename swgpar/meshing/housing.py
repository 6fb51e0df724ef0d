"""The housing of the ring gear: its rim continued outwards by layers of another material."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from swgpar.geometry.arrays import Floats
from swgpar.meshing.cross_section import CrossSection
from swgpar.meshing.drive_geometry import GearGeometry
from swgpar.meshing.recipe import ToothRecipe
from swgpar.meshing.sweep import grid_quads

GROWTH = 1.6
"""Ratio of the thicknesses of successive layers."""


def housing_radii(ring: GearGeometry, thickness: float, recipe: ToothRecipe) -> Floats:
    """Radii (n + 1,), mm, of circles between the housing's layers; one where its thickness is 0.

    The first layer is about as thick as those of the rim, others `GROWTH` times the one before.
    """
    inner = ring.profile.r_root_circle + ring.rim
    if thickness == 0.0:
        return np.array([inner])
    first = ring.rim / (recipe.rim + recipe.under)
    layers = max(1, round(np.log1p((GROWTH - 1.0) * thickness / first) / np.log(GROWTH)))
    ends = np.concatenate(([0.0], np.cumsum(GROWTH ** np.arange(layers))))
    return inner + thickness * ends / ends[-1]


def with_housing(section: CrossSection, radii: Floats) -> CrossSection:
    """The cross-section with a layer beyond its free circle for each of `radii` but the first."""
    layers, width, known = len(radii) - 1, len(section.free), len(section.coords)
    if not layers:
        return section
    unit = section.coords[section.free] / np.hypot(*section.coords[section.free].T)[:, None]
    new = known + np.arange(layers * width, dtype=np.int32).reshape(layers, width)
    # the free circle runs from the clockwise to the counter-clockwise side
    quads = grid_quads(np.concatenate((section.free[None], new)))
    added = np.ones(len(quads), dtype=bool)
    return replace(
        section,
        coords=np.concatenate((section.coords, (radii[1:, None, None] * unit).reshape(-1, 2))),
        quads=np.concatenate((section.quads, quads)),
        mirror=np.concatenate((section.mirror, new[:, ::-1].ravel())),
        edge=np.concatenate((section.edge, new[:, 0])),
        free=new[-1],
        below_root=np.concatenate((section.below_root, np.ones(new.size, dtype=bool))),
        root_layer=np.concatenate((section.root_layer, ~added)),
        rim_layer=np.concatenate((section.rim_layer, added)),
        housing=np.concatenate((section.housing, added)),
    )
