"""fields.h5 and fields.xdmf: nodal fields of every increment, for ParaView.

Every increment is a part file of its own, `fields/increment_0001.h5`, written by all ranks at once;
`fields.h5` is a small file of links to the mesh and to the increments, `fields.xdmf` describes
them. Nodes are stored sector by sector, so those between two sectors appear twice, with the same
values.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
from mpi4py import MPI

from swgpar.results import parallel_hdf5, xdmf
from swgpar.results.atomic import TEMPORARY, agreed, discard, finish, write_from_root
from swgpar.results.folder import FIELD_INDEX, FIELDS
from swgpar.results.parallel_hdf5 import Block

MESH = "mesh"
FLANKS = ("flank_nodes", "flank_s", "flank_z")
"""Data sets of a body's `FlankGrids`."""


def increment_name(index: int) -> str:
    """Name of the part file of increment `index`, from 1."""
    return f"increment_{index:04d}"


TIME_STEP = 1e-3
"""Degrees between the times of increments at the same angle."""


def times(angles: Sequence[float] | np.ndarray) -> np.ndarray:
    """Times (n,) of increments at these angles of the wave generator (n,), degrees.

    They are the angles, made to increase: those that assemble the drive are all at the first one.
    """
    found = np.array(angles, dtype=float)
    for k in range(1, len(found)):
        found[k] = max(found[k], found[k - 1] + TIME_STEP)
    return found


TENSOR6 = [0, 3, 5, 1, 4, 2]
"""Components xx yy zz xy yz zx in XDMF's order xx xy xz yy yz zz."""


def stored(name: str, values: np.ndarray) -> np.ndarray:
    """Nodal values (n_sectors, n_local[, n_components]) as they are kept on disk and in memory.

    Tensors have the components xx xy xz yy yz zz. Displacements are float64, others float32.
    """
    if values.ndim == 3 and values.shape[2] == 6:
        values = values[..., TENSOR6]
    kind = np.float64 if name == "displacement" else np.float32
    return np.ascontiguousarray(values.reshape(-1, *values.shape[2:]), dtype=kind)


class FlankGrids(NamedTuple):
    """Nodes of the flanks of one tooth sector of a body.

    nodes : (2, n_s, n_z) local node numbers, clockwise flank first
    s : (n_s,) mm, arc length from the tip;  z : (n_z,) mm, along the face width
    """

    nodes: np.ndarray
    s: np.ndarray
    z: np.ndarray


@dataclass(frozen=True)
class BodyPart:
    """The sectors of a body that a rank owns.

    points : (n_sectors, n_local, 3) mm, undeformed;  cells : (n_elem, 8) of one sector
    first : number of the first owned sector;  total : sectors of the modelled body
    flanks : nodes of one sector on its flanks; None of a body without teeth
    """

    points: np.ndarray
    cells: np.ndarray
    first: int
    total: int
    flanks: FlankGrids | None

    def block(self, rows: np.ndarray, per_sector: int) -> Block:
        """Rows (n, ...) of the owned sectors among those of all sectors."""
        return Block(rows, self.first * per_sector, self.total * per_sector)


class FieldWriter:
    """Writes mesh and increments below a results folder.

    Parameters
    ----------
    out : results folder
    comm : communicator; every call is collective
    """

    def __init__(self, out: Path, comm: MPI.Comm) -> None:
        self.out, self.comm = out, comm
        self._bodies: Mapping[str, BodyPart] = {}
        with agreed(comm, out / FIELDS):
            if comm.rank == 0:
                (out / FIELDS).mkdir(exist_ok=True)
                for left in (out / FIELDS).glob(f"*{TEMPORARY}"):
                    discard(left)

    def write_mesh(self, bodies: Mapping[str, BodyPart]) -> None:
        """Write the undeformed mesh of bodies by name."""
        self._bodies = bodies
        blocks = {}
        for name, part in bodies.items():
            n_sectors, n_local = part.points.shape[:2]
            sector = np.arange(part.first, part.first + n_sectors)[:, None, None] * n_local
            cells = (part.cells + sector).reshape(-1, 8)
            blocks[f"{name}/points"] = part.block(part.points.reshape(-1, 3), n_local)
            blocks[f"{name}/cells"] = part.block(cells, len(part.cells))
            if part.flanks is not None:
                grids = zip(FLANKS, part.flanks, strict=True)
                blocks |= {f"{name}/{key}": Block.of_root(self.comm, array) for key, array in grids}
        parallel_hdf5.write(self.out / FIELDS / f"{MESH}.h5", self.comm, blocks)

    def has(self, index: int) -> bool:
        """Whether the fields of an increment were written; seen from this rank."""
        return (self.out / FIELDS / f"{increment_name(index)}.h5").exists()

    def write_increment(self, index: int, fields: Mapping[str, Mapping[str, np.ndarray]]) -> None:
        """Write nodal fields: body -> name -> (n_sectors, n_local[, n_components])."""
        blocks = {
            f"{body}/{name}": self._bodies[body].block(stored(name, array), array.shape[1])
            for body, values in fields.items()
            for name, array in values.items()
        }
        parallel_hdf5.write(self.out / FIELDS / f"{increment_name(index)}.h5", self.comm, blocks)

    def write_index(
        self, increments: Sequence[tuple[int, float]], names: Mapping[str, Mapping[str, int]]
    ) -> None:
        """Rewrite both indices: increments (index, cam angle), body -> field -> components."""
        path = self.out / FIELD_INDEX
        with agreed(self.comm, path):
            if self.comm.rank == 0:
                temporary = path.with_name(path.name + TEMPORARY)
                discard(temporary)
                with h5py.File(temporary, "w") as file:
                    for part in (MESH, *(increment_name(i) for i, _ in increments)):
                        file[part] = h5py.ExternalLink(f"{FIELDS}/{part}.h5", "/")
                finish(temporary, path)
        write_from_root(self.comm, self.out / "fields.xdmf", self._xdmf(increments, names).encode())

    def _xdmf(
        self, increments: Sequence[tuple[int, float]], names: Mapping[str, Mapping[str, int]]
    ) -> str:
        when = times([angle for _, angle in increments]).tolist()
        series = []
        for body in self._bodies:  # a series for each: VTK adds [1], [2] ... to names that return
            grids = [
                xdmf.grid(f"{body}_{index:04d}", self._grid(body, index, angle, time, names[body]))
                for time, (index, angle) in zip(when, increments, strict=True)
            ]
            series.append(xdmf.series(body, grids))
        return xdmf.document(series)

    def _grid(
        self, body: str, index: int, angle: float, time: float, names: Mapping[str, int]
    ) -> Iterator[str]:
        """Content of the grid of a body at an increment. names : components of its fields"""
        part = self._bodies[body]
        count = part.total * part.points.shape[1]
        yield f'<Time Value="{time!r}"/><Information Name="wg_angle_deg" Value="{angle!r}"/>'
        yield xdmf.hexahedra(f"{FIELDS}/{MESH}.h5:/{body}/cells", part.total * len(part.cells))
        yield xdmf.points(f"{FIELDS}/{MESH}.h5:/{body}/points", count)
        for name, components in names.items():
            place = f"{FIELDS}/{increment_name(index)}.h5:/{body}/{name}"
            yield xdmf.attribute(name, place, count, components, 8 if name == "displacement" else 4)
