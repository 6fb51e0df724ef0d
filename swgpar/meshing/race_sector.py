"""A ring without teeth as a chain of congruent sectors: the outer race of a bearing."""

from __future__ import annotations

import numpy as np

from swgpar.meshing.quality import element_quality
from swgpar.meshing.sector import SectorMesh
from swgpar.meshing.sweep import grid_quads, sweep_line, sweep_quads

OUTER_RACE = "outer_race"
"""Name of a bearing's outer race as a body."""

RADIAL = 1
"""Elements through the thickness of the race: with incompatible modes one is exact in bending."""

SAME = 1e-9
"""Share of a sector below which coordinates are the same."""


def race_sector(spline: SectorMesh, outer: float, thickness: float, width: float) -> SectorMesh:
    """Sector of a bearing's outer race, with outer nodes opposite those of the flexible spline.

    spline : tooth sector of the flexible spline;  outer, thickness, width : mm

    In the plane the mesh is as wide as the spline's.
    """
    angle, z = _grid(spline)
    if not spline.plane:
        z = np.unique(np.clip(z, -0.5 * width, 0.5 * width))
    radius = np.linspace(outer - thickness, outer, RADIAL + 1)
    return annular_sector(OUTER_RACE, radius, angle, z, spline.n_sectors, spline.plane)


def race_grid(race: SectorMesh, surface: str) -> np.ndarray:
    """Nodes (n_around + 1, n_z) of the surface ``inner`` or ``outer``, clockwise side first."""
    angle, z = _grid(race, surface)
    nodes = np.unique(race.faces[surface])
    return nodes.reshape(len(z), len(angle)).T


def opposite_cells(spline: SectorMesh, race: SectorMesh) -> tuple[np.ndarray, np.ndarray]:
    """Cells of the race's outer surface opposite the spline's faces ``inner``, by first nodes.

    Returns columns (n_face,) around and layers (n_face,) along z, -1 beyond the race's width.
    """
    angle, z = _grid(race, "outer")
    corners = spline.coords[spline.faces["inner"]]
    x, y, height = corners.mean(axis=1).T
    # a face that the race covers in part has its middle beyond the race or within
    inward = corners[np.arange(len(corners)), np.abs(corners[..., 2]).argmin(axis=1), 2]
    height = np.where(np.abs(height) < z[-1], height, 0.5 * (inward + np.copysign(z[-1], height)))
    layer = np.searchsorted(z, height) - 1
    reached = np.abs(inward) < z[-1] * (1.0 - SAME)
    return np.searchsorted(angle, np.arctan2(-x, y)) - 1, np.where(
        spline.plane | reached, layer, -1
    )


def _grid(mesh: SectorMesh, surface: str = "inner") -> tuple[np.ndarray, np.ndarray]:
    """Angles (rad, clockwise side first) and z (mm) of the nodes of a surface."""
    x, y, z = mesh.coords[np.unique(mesh.faces[surface])].T
    return _distinct(np.arctan2(-x, y)), _distinct(z)


def _distinct(values: np.ndarray) -> np.ndarray:
    ordered = np.sort(values)
    return ordered[np.append(True, np.diff(ordered) > SAME * np.ptp(ordered))]


def annular_sector(
    body: str, radius: np.ndarray, angle: np.ndarray, z: np.ndarray, sectors: int, plane: bool
) -> SectorMesh:
    """Sector with nodes at these radii (mm), angles (rad from +y, counter-clockwise) and z (mm)."""
    z, r, phi = np.meshgrid(z, radius, angle, indexing="ij")
    coords = np.stack([-r * np.sin(phi), r * np.cos(phi), z], axis=-1).reshape(-1, 3)
    number = np.arange(len(coords), dtype=np.int32).reshape(z.shape)
    rows = number.reshape(len(number), -1)
    grid = number[0]
    # counter-clockwise seen from +z: angles run counter-clockwise, radii outward
    hexes = sweep_quads(np.roll(grid_quads(grid), 1, axis=1), rows)
    surface = number[:1] if plane else number
    return SectorMesh(
        body=body,
        n_sectors=sectors,
        phase=0.0,
        coords=coords,
        hexes=hexes,
        ccw_nodes=number[:, :, -1].ravel(),
        cw_nodes=number[:, :, 0].ravel(),
        faces={"inner": sweep_line(grid[0], rows), "outer": sweep_line(grid[-1, ::-1], rows)},
        node_sets={"bore": surface[:, 0].ravel(), "outer": surface[:, -1].ravel()},
        flanks=(),
        profile=None,
        quality=element_quality(coords, hexes),
        lower_nodes=np.tile(rows[0], 2) if plane else None,
    )
