"""fatigue.h5 and fatigue.xdmf: nodal fields of one sector of the flexible spline, for ParaView."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from mpi4py import MPI

from swgpar.results import parallel_hdf5, xdmf
from swgpar.results.atomic import write_from_root
from swgpar.results.folder import SECTOR, SECTOR_XDMF
from swgpar.results.parallel_hdf5 import Block


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
    parallel_hdf5.write(
        folder / SECTOR, comm, {name: Block.of_root(comm, array) for name, array in arrays.items()}
    )
    write_from_root(comm, folder / SECTOR_XDMF, _xdmf(sector).encode())


def read_sector(folder: Path) -> SectorFields | None:
    """The fields in a folder, None without any."""
    if not (folder / SECTOR).exists():
        return None
    with h5py.File(folder / SECTOR, "r") as file:
        arrays = {name: data[:] for name, data in file.items()}
    return SectorFields(arrays.pop("points"), arrays.pop("cells"), arrays)


def _xdmf(sector: SectorFields) -> str:
    n = len(sector.points)
    items = [
        xdmf.hexahedra(f"{SECTOR}:/cells", len(sector.cells)),
        xdmf.points(f"{SECTOR}:/points", n),
    ]
    items += [xdmf.attribute(name, f"{SECTOR}:/{name}", n) for name in sector.fields]
    return xdmf.document([xdmf.grid("sector", items)])
