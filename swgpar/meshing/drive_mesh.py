"""The mesh of a whole drive, to look at and to write."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import meshio
import numpy as np

from swgpar.errors import InputError, OutputError
from swgpar.materials import Material
from swgpar.meshing.export import (
    WholeBody,
    as_msh,
    as_vtu,
    named_surfaces,
    whole_body,
    whole_drive,
)
from swgpar.meshing.inp import write_inp
from swgpar.meshing.quality import hex_volumes
from swgpar.meshing.sector import SectorMesh
from swgpar.whole_files import whole_files

if TYPE_CHECKING:
    import pyvista


FORMATS = ("vtu", "msh", "inp")


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
        return {name: whole_body(mesh) for name, mesh in self.sectors.items()}

    @cached_property
    def quality(self) -> dict[str, dict[str, float]]:
        """Counts and worst quality of every body.

        ``nodes`` and ``elements`` (all sectors), ``sector_elements``, ``volume`` (mm³), the quality
        """
        report = {}
        for body, mesh in self.sectors.items():
            own = (len(mesh.coords) - len(mesh.ccw_nodes)) // (1 if not mesh.plane else 2)
            report[body] = {
                "nodes": own * mesh.n_sectors,
                "elements": len(mesh.hexes) * mesh.n_sectors,
                "sector_elements": len(mesh.hexes),
                "volume": float(hex_volumes(mesh.coords, mesh.hexes).sum()) * mesh.n_sectors,
                **mesh.quality,
            }
        return report

    def write(
        self, folder: str | Path, formats: Sequence[str] = FORMATS, *, overwrite: bool = False
    ) -> list[Path]:
        """Write all sectors of all bodies as ``drive_120_122.vtu``, ``.msh`` and ``.inp``; call it
        on one rank. Returns the files, in the order of `formats`.

        Parameters
        ----------
        folder : made when it does not exist
        formats : any of "vtu" (ParaView), "msh" (Gmsh), "inp" (Abaqus, CalculiX)
        overwrite : whether files that are there are replaced

        Raises
        ------
        InputError
            An unknown format.
        OutputError
            The folder cannot be written, or a file is there already.
        """
        for name in formats:
            if name not in FORMATS:
                raise InputError(
                    f'mesh format = "{name}" is not available: allowed {", ".join(FORMATS)}'
                )
        drive, folder = whole_drive(self.sectors), Path(folder)
        teeth = "_".join(
            str(self.sectors[gear].n_sectors) for gear in ("flexible_spline", "ring_gear")
        )
        files = [f"drive_{teeth}.{name}" for name in formats]
        try:
            with whole_files(folder, overwrite=overwrite) as made:
                for name, file in zip(formats, files, strict=True):
                    if name == "vtu":
                        meshio.vtu.write(made / file, as_vtu(drive), compression="zlib")
                    elif name == "msh":
                        meshio.gmsh.write(
                            made / file, as_msh(drive), fmt_version="2.2", binary=True
                        )
                    else:
                        surfaces = named_surfaces(self.sectors)
                        write_inp(made / file, drive, surfaces, self.materials, self.thickness)
        except OSError as error:
            raise OutputError(
                f"the mesh cannot be written to {folder}: {error.strerror or error}"
            ) from None
        return [folder / file for file in files]

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
