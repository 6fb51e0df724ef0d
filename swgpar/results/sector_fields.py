"""fatigue.h5 and fatigue.xdmf: nodal fields of one sector of the flexible spline, for ParaView."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from mpi4py import MPI

from swgpar.results import parallel_hdf5
from swgpar.results.atomic import write_from_root
from swgpar.results.folder import SECTOR, SECTOR_XDMF
from swgpar.results.parallel_hdf5 import Block, h5py


@dataclass(frozen=True)
class SectorFields:
    """Nodal fields of one sector, the tooth centred on +y.

    points : (n, 3) mm, undeformed;  cells : (m, 8) hexahedra in VTK order
    fields : by name, (n,)
    """

    points: np.ndarray
    cells: np.ndarray
    fields: Mapping[str, np.ndarray]


def write_sector(folder: Path, comm: MPI.Comm, sector: SectorFields) -> None:
    """Write the files from rank 0; collective."""
    arrays = {"points": sector.points, "cells": sector.cells.astype(np.int64), **sector.fields}
    blocks = {
        name: Block(np.ascontiguousarray(array if comm.rank == 0 else array[:0]), 0, len(array))
        for name, array in arrays.items()
    }
    parallel_hdf5.write(folder / SECTOR, comm, blocks)
    write_from_root(comm, folder / SECTOR_XDMF, _xdmf(sector).encode())


def read_sector(folder: Path) -> SectorFields | None:
    """The fields in a folder, None without any."""
    if not (folder / SECTOR).exists():
        return None
    with h5py.File(folder / SECTOR, "r") as file:
        arrays = {name: data[:] for name, data in file.items()}
    return SectorFields(arrays.pop("points"), arrays.pop("cells"), arrays)


def _xdmf(sector: SectorFields) -> str:
    n, m = len(sector.points), len(sector.cells)

    def item(name: str, size: str, kind: str = "Float") -> str:
        start = f'<DataItem Format="HDF" NumberType="{kind}" Precision="8" Dimensions="{size}">'
        return f"{start}{SECTOR}:/{name}</DataItem>"

    fields = "".join(
        f'<Attribute Name={quoteattr(name)} AttributeType="Scalar" Center="Node">{item(name, str(n))}</Attribute>\n'
        for name in sector.fields
    )
    return (
        '<?xml version="1.0"?>\n<Xdmf Version="3.0"><Domain><Grid Name="sector">\n'
        f'<Topology TopologyType="Hexahedron" NumberOfElements="{m}">{item("cells", f"{m} 8", "Int")}</Topology>\n'
        f'<Geometry GeometryType="XYZ">{item("points", f"{n} 3")}</Geometry>\n{fields}</Grid></Domain></Xdmf>\n'
    )
