"""fields.vtkhdf: the fields of a result as one file that ParaView and VTK read without a plugin.

An unstructured grid over time, format VTKHDF 2: mesh once, fields of every increment one after the
other. The time is that of `swgpar.results.fields.times`. Fields that a body does not have are zero
there.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from swgpar.errors import InputError
from swgpar.results.fields import times
from swgpar.results.parallel_hdf5 import h5py

if TYPE_CHECKING:
    from swgpar.drive_results.drive_data import DriveData

HEXAHEDRON = 12
"""Of VTK's cell types."""

TENSOR = [0, 3, 5, 1, 4, 2]
"""Components xx xy xz yy yz zz in VTK's order xx yy zz xy yz xz."""

NAME = "fields.vtkhdf"


def require_fields(result: DriveData, name: str) -> None:
    """Raise InputError where a run kept no fields for the format with this name."""
    if not result.increments:
        raise InputError(
            f"the format {name} needs fields, and this run kept none: allowed with output.fields = "
            "true"
        )


def step_times(result: DriveData) -> np.ndarray:
    """Times (n,), degrees, of the increments with fields."""
    return times(result.history["wg_angle_deg"][np.asarray(result.field_increments) - 1])


def write_vtkhdf(result: DriveData, folder: Path) -> list[Path]:
    """Write all increments with fields, with all teeth; call it on one rank of a result from a
    folder."""
    require_fields(result, "vtkhdf")
    whole = result.grid(0, whole=True)
    points, cells = np.asarray(whole.points, dtype=float), whole.cells.reshape(-1, 9)[:, 1:]
    n, m = len(points), len(cells)
    steps = result.increments
    path = folder / NAME
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF", track_order=True)
        root.attrs["Version"] = np.array([2, 0])
        kind = h5py.string_dtype("ascii", 16)
        root.attrs.create("Type", np.bytes_("UnstructuredGrid"), dtype=kind)
        root["NumberOfPoints"], root["NumberOfCells"] = np.array([n]), np.array([m])
        root["NumberOfConnectivityIds"] = np.array([8 * m])
        root["Points"], root["Connectivity"] = points, cells.ravel().astype(np.int64)
        root["Offsets"] = 8 * np.arange(m + 1)
        root["Types"] = np.full(m, HEXAHEDRON, dtype=np.uint8)
        root["CellData/body"] = whole.cell_data["body"].astype(np.int32)
        group = root.create_group("Steps")
        group.attrs["NSteps"] = steps
        group["Values"] = step_times(result)
        group["NumberOfParts"] = np.ones(steps, dtype=np.int64)
        for name in ("PartOffsets", "PointOffsets", "CellDataOffsets/body"):
            group[name] = np.zeros(steps, dtype=np.int64)
        for name in ("CellOffsets", "ConnectivityIdOffsets"):
            group[name] = np.zeros((steps, 1), dtype=np.int64)
        for step in range(steps):
            grid = whole if step == 0 else result.grid(step, whole=True)
            for name, values in grid.point_data.items():
                values = np.nan_to_num(np.asarray(values))
                values = values[:, TENSOR] if values.ndim == 2 and values.shape[1] == 6 else values
                if step == 0:
                    shape = (steps * n, *values.shape[1:])
                    kind = np.float64 if name == "displacement" else np.float32
                    root.create_dataset(f"PointData/{name}", shape, dtype=kind)
                    group[f"PointDataOffsets/{name}"] = n * np.arange(steps)
                root[f"PointData/{name}"][step * n : (step + 1) * n] = values
    return [path]
