"""The mesh of a whole drive, to look at and to write."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from swgpar.materials import Material
from swgpar.meshing.export import FORMATS, mesh_report, whole_body, write_mesh
from swgpar.meshing.sector import SectorMesh

if TYPE_CHECKING:
    import pyvista


class WholeBody(NamedTuple):
    """A body with all its teeth. points : (n, 3) mm;  cells : (m, 8), plane (m, 4), VTK order"""

    points: np.ndarray
    cells: np.ndarray


@dataclass(frozen=True)
class DriveMesh:
    """The mesh of a whole drive: all teeth of both gears, undeformed.

    Attributes
    ----------
    sectors : one tooth sector of every body, by its name
    materials : of every body and of a housing, by name;  thickness : mm, of the plane model

    Examples
    --------
    >>> mesh = swgpar.mesh("drivers/cup_45deg.toml", "coarse")
    >>> mesh.quality["flexible_spline"]["elements"]
    30960
    >>> mesh.grid().plot()
    >>> mesh.write("results/mesh", formats=("vtu", "inp"))
    """

    sectors: dict[str, SectorMesh]
    materials: Mapping[str, Material]
    thickness: float

    @cached_property
    def bodies(self) -> dict[str, WholeBody]:
        """Points and cells of every body, by its name."""
        return {name: WholeBody(*whole_body(mesh)) for name, mesh in self.sectors.items()}

    @cached_property
    def quality(self) -> dict[str, dict[str, float]]:
        """Counts and worst quality of every body, see `swgpar.meshing.export.mesh_report`."""
        return mesh_report(self.sectors)

    def write(
        self, folder: str | Path, formats: Sequence[str] = FORMATS, *, overwrite: bool = False
    ) -> list[Path]:
        """Write the mesh into a folder and return the files; call it on one rank.

        Parameters
        ----------
        formats : any of "vtu" (ParaView), "msh" (Gmsh), "inp" (Abaqus, CalculiX)
        overwrite : whether files that are there are replaced

        Raises
        ------
        InputError
            An unknown format.
        OutputError
            The folder cannot be written, or a file is there already.
        """
        given = self.sectors, self.materials, self.thickness, folder, formats
        return write_mesh(*given, overwrite=overwrite)

    def grid(self) -> pyvista.UnstructuredGrid:
        """The mesh for PyVista; the cell data "body" counts the bodies, flexible spline first."""
        import pyvista

        bodies = list(self.bodies.values())
        first = np.cumsum([0, *(len(body.points) for body in bodies)])
        cells = np.concatenate(
            [body.cells + start for start, body in zip(first, bodies, strict=False)]
        )
        solid = cells.shape[1] == 8
        kind = pyvista.CellType.HEXAHEDRON if solid else pyvista.CellType.QUAD
        points = np.concatenate([body.points for body in bodies])
        grid = pyvista.UnstructuredGrid({kind: cells}, points)
        grid.cell_data["body"] = np.repeat(
            np.arange(len(bodies)), [len(body.cells) for body in bodies]
        )
        return grid
