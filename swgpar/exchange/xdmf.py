"""drive.xdmf and drive.h5: the fields of a result with all teeth, as meshio writes and reads them;
VTK reads them too.

One mesh for both bodies and all increments. The time is that of `swgpar.results.fields.times`.
Fields that a body does not have are zero there.
"""

from __future__ import annotations

from contextlib import chdir
from pathlib import Path
from typing import TYPE_CHECKING

import meshio
import numpy as np

from swgpar.exchange.vtkhdf import require_fields, step_times

if TYPE_CHECKING:
    from swgpar.drive_results.drive_data import DriveData

NAME = "drive.xdmf"


def write_xdmf(result: DriveData, folder: Path) -> list[Path]:
    """Write all increments with fields, with all teeth; call it on one rank of a result from a
    folder."""
    require_fields(result, "xdmf")
    path = folder / NAME
    # meshio opens drive.h5 in the working directory
    with chdir(folder), meshio.xdmf.TimeSeriesWriter(NAME) as series:
        for step, time in enumerate(step_times(result)):
            grid = result.grid(step, whole=True)
            if step == 0:
                cells = {"hexahedron": grid.cells.reshape(-1, 9)[:, 1:]}
                series.write_points_cells(np.asarray(grid.points), cells)
            fields = {name: np.nan_to_num(values) for name, values in grid.point_data.items()}
            series.write_data(time, fields, {"body": [grid.cell_data["body"].astype(np.int32)]})
    return [path, path.with_suffix(".h5")]
