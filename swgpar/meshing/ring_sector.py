"""A plain ring as a chain of congruent sectors: the body of benchmarks, without teeth."""

from __future__ import annotations

import numpy as np

from swgpar.errors import InputError
from swgpar.meshing.quality import hex_quality
from swgpar.meshing.sector import SectorMesh
from swgpar.meshing.sweep import sweep_line, sweep_quads

AROUND = 2
"""Elements around a sector: even, so that nodes lie on its middle, which for sector 0 is the major axis."""


def ring_sector(
    inner: float, outer: float, width: float, sectors: int, radial: int, axial: int, plane: bool
) -> SectorMesh:
    """Sector centred on +y of a ring between two radii, its mid-plane at z = 0.

    Parameters
    ----------
    inner, outer, width : float, mm
    sectors : int
        Sectors of the whole ring, two elements around each; a multiple of 4 has nodes every 45 degrees.
    radial, axial : int
        Elements through the thickness and along the width; the plane model has one layer.
    plane : bool
        Quadrilaterals in plane stress instead of hexahedra.

    Faces ``inner`` and ``outer``, node sets ``bore`` (the inner surface) and ``outer``, no flanks.
    """
    if not 0.0 < inner < outer:
        raise InputError(f"inner radius = {inner:g} is out of range: allowed above 0 to below {outer:g} mm (the outer)")
    angle = np.pi / sectors * np.linspace(-1.0, 1.0, AROUND + 1)
    radius = np.linspace(inner, outer, radial + 1)
    z = width * np.linspace(-0.5, 0.5, (1 if plane else axial) + 1)
    z, r, phi = np.meshgrid(z, radius, angle, indexing="ij")
    coords = np.stack([-r * np.sin(phi), r * np.cos(phi), z], axis=-1).reshape(-1, 3)
    number = np.arange(len(coords), dtype=np.int32).reshape(z.shape)
    rows = number.reshape(len(number), -1)
    grid = number[0]
    # counter-clockwise seen from +z: angles run counter-clockwise, radii outward
    quads = np.stack([grid[:-1, 1:], grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:]], axis=-1).reshape(-1, 4)
    hexes = sweep_quads(quads, rows)
    surface = number[:1] if plane else number
    return SectorMesh(
        body="ring",
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
        quality=hex_quality(coords, hexes),
        lower_nodes=np.tile(rows[0], 2) if plane else None,
    )
