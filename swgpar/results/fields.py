"""fields.h5 and fields.xdmf: nodal fields of every increment, for ParaView.

Every increment is a part file of its own, `fields/increment_0001.h5`, written by all ranks at once; `fields.h5`
is a small file of links to the mesh and to the increments, `fields.xdmf` describes them. Nodes are stored sector
by sector, so those between two sectors appear twice, with the same values.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr

import h5py
import numpy as np
from mpi4py import MPI

from swgpar.results import parallel_hdf5
from swgpar.results.atomic import TEMPORARY, agreed, discard, finish, write_from_root
from swgpar.results.parallel_hdf5 import Block

INDEX = "fields.h5"
"""Links to the mesh and to the fields of all increments."""

FOLDER = "fields"
MESH = "mesh"


def increment_name(index: int) -> str:
    """Name of the part file of increment `index`, from 1."""
    return f"increment_{index:04d}"


TIME_STEP = 1e-3
"""Degrees between the times of increments at the same angle."""


def times(angles: Sequence[float] | np.ndarray) -> np.ndarray:
    """Times (n,) of increments at these angles of the wave generator (n,), degrees.

    They are the angles, made to increase: the increments that assemble the drive are all at the first one.
    """
    found = np.array(angles, dtype=float)
    for k in range(1, len(found)):
        found[k] = max(found[k], found[k - 1] + TIME_STEP)
    return found


TENSOR6 = [0, 3, 5, 1, 4, 2]
"""Components xx yy zz xy yz zx in XDMF's order xx xy xz yy yz zz."""


def stored(name: str, values: np.ndarray) -> np.ndarray:
    """Nodal values (n_sectors, n_local[, n_components]) in the form in which they are kept, on disk and in memory.

    Tensors have the components xx xy xz yy yz zz. Displacements are float64, all other fields float32.
    """
    if values.ndim == 3 and values.shape[2] == 6:
        values = values[..., TENSOR6]
    kind = np.float64 if name == "displacement" else np.float32
    return np.ascontiguousarray(values.reshape(-1, *values.shape[2:]), dtype=kind)


class FieldWriter:
    """Writes mesh and increments below a results folder.

    Parameters
    ----------
    out : results folder
    comm : communicator; every call is collective
    """

    def __init__(self, out: Path, comm: MPI.Comm) -> None:
        self.out, self.comm = out, comm
        self.shapes: dict[str, tuple[int, int]] = {}
        with agreed(comm, out / FOLDER):
            if comm.rank == 0:
                (out / FOLDER).mkdir(exist_ok=True)
                for left in (out / FOLDER).glob(f"*{TEMPORARY}"):
                    discard(left)

    def write_mesh(
        self, bodies: Mapping[str, tuple[np.ndarray, np.ndarray, int, int]], extra: Mapping[str, np.ndarray]
    ) -> None:
        """Write the undeformed mesh.

        bodies : name -> points (n_sectors, n_local, 3) mm, one sector's cells (n_elem, 8), first sector, all sectors
        extra : further small data sets, the same on all ranks
        """
        blocks = {}
        for name, (points, cells, first, total) in bodies.items():
            n_sectors, n_local = points.shape[:2]
            sector = np.arange(first, first + n_sectors)[:, None, None] * n_local
            blocks[f"{name}/points"] = Block(points.reshape(-1, 3), first * n_local, total * n_local)
            blocks[f"{name}/cells"] = Block((cells + sector).reshape(-1, 8), first * len(cells), total * len(cells))
            self.shapes[name] = (total * n_local, total * len(cells))
        for name, array in extra.items():
            rows = array if self.comm.rank == 0 else array[:0]
            blocks[name] = Block(np.ascontiguousarray(rows), 0, len(array))
        parallel_hdf5.write(self.out / FOLDER / f"{MESH}.h5", self.comm, blocks)

    def has(self, index: int) -> bool:
        """Whether the fields of an increment were written; seen from this rank."""
        return (self.out / FOLDER / f"{increment_name(index)}.h5").exists()

    def write_increment(self, index: int, fields: Mapping[str, tuple[Mapping[str, np.ndarray], int, int]]) -> None:
        """Write nodal fields: body -> name -> (n_sectors, n_local[, n_components]), first sector, sectors in all."""
        blocks = {}
        for body, (values, first, total) in fields.items():
            for name, array in values.items():
                n_local = array.shape[1]
                blocks[f"{body}/{name}"] = Block(stored(name, array), first * n_local, total * n_local)
        parallel_hdf5.write(self.out / FOLDER / f"{increment_name(index)}.h5", self.comm, blocks)

    def write_index(self, increments: Sequence[tuple[int, float]], names: Mapping[str, Mapping[str, int]]) -> None:
        """Rewrite fields.h5 and fields.xdmf: increments (index, cam angle), body -> field -> components."""
        path = self.out / INDEX
        with agreed(self.comm, path):
            if self.comm.rank == 0:
                temporary = path.with_name(path.name + TEMPORARY)
                with h5py.File(temporary, "w") as file:
                    for part in (MESH, *(increment_name(i) for i, _ in increments)):
                        file[part] = h5py.ExternalLink(f"{FOLDER}/{part}.h5", "/")
                finish(temporary, path)
        write_from_root(self.comm, self.out / "fields.xdmf", self._xdmf(increments, names).encode())

    def _xdmf(self, increments: Sequence[tuple[int, float]], names: Mapping[str, Mapping[str, int]]) -> str:
        kinds = {1: "Scalar", 3: "Vector", 6: "Tensor6"}
        lines = ['<?xml version="1.0"?>', '<Xdmf Version="3.0"><Domain>']
        when = times([angle for _, angle in increments]).tolist()
        # a series for each body: VTK adds [1], [2] ... to names that return
        for body, (n_points, n_cells) in self.shapes.items():
            lines.append(f'<Grid Name={quoteattr(body)} GridType="Collection" CollectionType="Temporal">')
            for time, (index, angle) in zip(when, increments, strict=True):
                lines.append(
                    f"<Grid Name={quoteattr(f'{body}_{index:04d}')}>"
                    f'<Time Value="{time!r}"/><Information Name="wg_angle_deg" Value="{angle!r}"/>'
                    f'<Topology TopologyType="Hexahedron" NumberOfElements="{n_cells}">'
                    f'<DataItem Format="HDF" NumberType="Int" Precision="8" Dimensions="{n_cells} 8">'
                    f"{FOLDER}/{MESH}.h5:/{body}/cells</DataItem></Topology>"
                    f'<Geometry GeometryType="XYZ"><DataItem Format="HDF" NumberType="Float" Precision="8" '
                    f'Dimensions="{n_points} 3">{FOLDER}/{MESH}.h5:/{body}/points</DataItem></Geometry>'
                )
                for name, components in names[body].items():
                    size = f"{n_points}" if components == 1 else f"{n_points} {components}"
                    precision = 8 if name == "displacement" else 4
                    lines.append(
                        f'<Attribute Name={quoteattr(name)} AttributeType="{kinds[components]}" Center="Node">'
                        f'<DataItem Format="HDF" NumberType="Float" Precision="{precision}" Dimensions="{size}">'
                        f"{FOLDER}/{increment_name(index)}.h5:/{body}/{name}</DataItem></Attribute>"
                    )
                lines.append("</Grid>")
            lines.append("</Grid>")
        lines.append("</Domain></Xdmf>")
        return "\n".join(lines) + "\n"
