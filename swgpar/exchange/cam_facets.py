"""The rigid cam as a layer of hexahedra below its surface, whose outer faces other programs take as
contact surface."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.cams import cam_outlines

SAGITTA = 1e-4
"""Largest height of the cam's curve over a facet, as a share of the module."""

DEPTH = 0.1
"""Thickness of the layer, as a share of the module."""

AXIAL_FACETS = 16
"""Facets along the width of a cam with crowning or slope."""

OUTER_FACE = 3
"""Face of a hexahedron, from 0, that lies on the cam."""


class CamFacets(NamedTuple):
    """points : (n, 3) mm;  elements : (m, 8) from 0;  sagitta : mm, largest height of the curve
    over a facet"""

    points: np.ndarray
    elements: np.ndarray
    sagitta: float


def cam_facets(design: DriveDesign, half_width: float, inset: float) -> CamFacets:
    """Facets of the cam with crowning and slope at its temperature, in |z| <= half_width (mm).

    inset : mm, by which the surface lies below the exact one. The facets of the flexible spline lie
        within its exact inner cylinder; their mean distance from it is the inset with which facets
        touch as the exact surfaces do. The mean height of the curve over the facets of the cam is
        taken off.
    """
    surface, module, micro = design.grown_cam_surface(), design.drive.module, design.micro_geometry
    count = 256
    while (sagitta := _sagitta(design, count)) > SAGITTA * module:
        count = int(np.ceil(count * max(1.05, np.sqrt(sagitta / (SAGITTA * module)))))
    stations = AXIAL_FACETS if micro.wg_crowning or micro.wg_slope else 1
    z = np.linspace(-half_width, half_width, stations + 1)
    points: list[np.ndarray] = []
    elements: list[np.ndarray] = []
    first = 0
    for part in cam_outlines(design.cam(), count):
        x, y = part.T
        if np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) < 0.0:  # clockwise
            part = part[::-1]
        _, normal, _ = design.cam().evaluate(part)
        n = len(part)
        # of nodes: station, layer, point
        grid = np.empty((stations + 1, 2, n, 3))
        grid[..., :2], grid[..., 2] = part, z[:, None, None]
        for _ in range(3):
            level, gradient, _ = surface.evaluate(grid[:, 1].reshape(-1, 3))
            slope2 = (gradient[:, :2] ** 2).sum(axis=1)
            step = (level / slope2)[:, None] * gradient[:, :2]
            grid[:, 1, :, :2] -= step.reshape(stations + 1, n, 2)
        grid[:, 1, :, :2] += (2.0 / 3.0 * sagitta - inset) * normal
        grid[:, 0, :, :2] = grid[:, 1, :, :2] - DEPTH * module * normal
        number = first + np.arange(grid[..., 0].size).reshape(grid.shape[:3])
        here, after = number, np.roll(number, -1, axis=2)
        # inward, outward, then along the curve: seen from +z counter-clockwise, of which S4
        # (corners 1 2 6 5 of the second edge) is the outer face
        lower, upper = slice(None, -1), slice(1, None)
        corners = [
            here[lower, 0], here[lower, 1], after[lower, 1], after[lower, 0],
            here[upper, 0], here[upper, 1], after[upper, 1], after[upper, 0],
        ]  # fmt: skip
        elements.append(np.stack(corners, axis=-1).reshape(-1, 8))
        points.append(grid.reshape(-1, 3))
        first += grid[..., 0].size
    return CamFacets(np.concatenate(points), np.concatenate(elements), sagitta)


def _sagitta(design: DriveDesign, count: int) -> float:
    middles = [
        0.5 * (part + np.roll(part, -1, axis=0)) for part in cam_outlines(design.cam(), count)
    ]
    return float(-design.cam().evaluate(np.concatenate(middles))[0].min())
