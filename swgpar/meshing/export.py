"""Full drives in the files of other programs: VTU (ParaView), MSH (gmsh), INP (Abaqus, CalculiX).

The plane model is written as quadrilaterals at z = 0.
"""

from __future__ import annotations

from typing import NamedTuple

import meshio
import numpy as np

from swgpar.geometry.arrays import Floats, Ints
from swgpar.geometry.rotation import rotated
from swgpar.meshing.inp import element_faces
from swgpar.meshing.sector import SectorMesh
from swgpar.meshing.sweep import grid_quads

HOUSING = "housing"
"""Name of the housing among the bodies of the files."""


def sector_numbers(mesh: SectorMesh) -> Ints:
    """Numbers (n_sectors, n_node) of every sector's nodes in the body; shared nodes have one."""
    own = np.ones(len(mesh.coords), dtype=bool)
    if mesh.plane:
        own = mesh.lower_nodes == np.arange(len(mesh.coords))
    own[mesh.ccw_nodes] = False
    own_number = np.cumsum(own) - 1
    n_own = int(own.sum())
    numbers = own_number + np.arange(mesh.n_sectors)[:, None] * n_own
    numbers[:, mesh.ccw_nodes] = np.roll(numbers, -1, axis=0)[:, mesh.cw_nodes]
    if mesh.plane:
        numbers = numbers[:, mesh.lower_nodes]
    return numbers.astype(np.int32)


class WholeBody(NamedTuple):
    """A body with all its teeth. points : (n, 3) mm;  cells : (m, 8), plane (m, 4), VTK order"""

    points: Floats
    cells: Ints


def whole_body(mesh: SectorMesh) -> WholeBody:
    """Nodes and elements of all sectors; numbers of `sector_numbers`."""
    numbers = sector_numbers(mesh)
    angle = mesh.sector_angle(np.arange(mesh.n_sectors))[:, None]
    coords = np.empty((int(numbers.max()) + 1, 3))
    coords[numbers] = rotated(mesh.coords, angle)
    if mesh.plane:
        coords[:, 2] = 0.0
    return WholeBody(coords, numbers[:, mesh.elements].reshape(-1, mesh.elements.shape[1]))


def named_nodes(mesh: SectorMesh) -> dict[str, Ints]:
    """Return node sets of the whole body: its surfaces, its flanks and its node sets."""
    sets = {name: np.unique(faces) for name, faces in mesh.faces.items()} | dict(mesh.node_sets)
    if mesh.flanks:
        sets["flanks"] = np.unique(np.concatenate([flank.nodes.ravel() for flank in mesh.flanks]))
    numbers = sector_numbers(mesh)
    return {f"{mesh.body}_{name}": np.unique(numbers[:, nodes]) for name, nodes in sets.items()}


def named_surfaces(meshes: dict[str, SectorMesh]) -> dict[str, Ints]:
    """Element and face (n, 2), both from 0, of the surfaces of all bodies, one after another."""
    surfaces, first = {}, 0
    for mesh in meshes.values():
        quads = dict(mesh.faces)
        if mesh.flanks:
            quads["flanks"] = np.concatenate([grid_quads(flank.nodes) for flank in mesh.flanks])
        number = first + element_numbers(mesh)
        for name, facets in quads.items():
            element, face = element_faces(mesh, facets).T
            faces = np.broadcast_to(face, (mesh.n_sectors, len(face)))
            surfaces[f"{mesh.body}_{name}"] = np.stack(
                (number[:, element], faces), axis=-1
            ).reshape(-1, 2)
        first += number.size
    return surfaces


def element_numbers(mesh: SectorMesh) -> Ints:
    """Numbers (n_sectors, n_elem), from 0, of a body's elements: part after part, by sectors."""
    number, first = np.empty((mesh.n_sectors, len(mesh.elements)), dtype=np.int32), 0
    for part in mesh.parts:
        count = mesh.n_sectors * len(part)
        number[:, part] = first + np.arange(count, dtype=np.int32).reshape(mesh.n_sectors, -1)
        first += count
    return number


def whole_drive(meshes: dict[str, SectorMesh]) -> meshio.Mesh:
    """Return all bodies as one mesh; they are its cell sets and numbered by the cell data ``body``.

    A housing counts as a body here, the last one.
    """
    points, cells, names = [], [], []
    point_sets: dict[str, np.ndarray] = {}
    offset = 0
    for mesh in meshes.values():
        coords, elements = whole_body(mesh)
        kind = "quad" if mesh.plane else "hexahedron"
        points.append(coords)
        by_sector = elements.reshape(mesh.n_sectors, -1, elements.shape[1]) + offset
        for name, part in zip((mesh.body, HOUSING), mesh.parts):
            cells.append((kind, by_sector[:, part].reshape(-1, elements.shape[1])))
            names.append(name)
        point_sets |= {name: nodes + offset for name, nodes in named_nodes(mesh).items()}
        offset += len(coords)
    body = [
        np.full(len(elements), number, dtype=np.int32) for number, (_, elements) in enumerate(cells)
    ]
    empty = np.empty(0, dtype=np.int64)
    cell_sets = {
        name: [np.arange(len(block)) if k == number else empty for k, block in enumerate(body)]
        for number, name in enumerate(names)
    }
    return meshio.Mesh(
        np.concatenate(points),
        cells,
        cell_data={"body": body},
        point_sets=point_sets,
        cell_sets=cell_sets,
    )


def as_vtu(drive: meshio.Mesh) -> meshio.Mesh:
    """Return the drive with its node sets as point data, since VTU has no sets."""
    marks = {}
    for name, nodes in drive.point_sets.items():
        marks[name] = np.zeros(len(drive.points), dtype=np.uint8)
        marks[name][nodes] = 1
    return meshio.Mesh(drive.points, drive.cells, point_data=marks, cell_data=dict(drive.cell_data))


def as_msh(drive: meshio.Mesh) -> meshio.Mesh:
    """Return the drive with its bodies as named physical volumes, or surfaces in the plane."""
    dimension = 3 if drive.cells[0].type == "hexahedron" else 2
    tags = [block + 1 for block in drive.cell_data["body"]]
    names = {body: np.array([number + 1, dimension]) for number, body in enumerate(drive.cell_sets)}
    data = {"gmsh:physical": tags, "gmsh:geometrical": [tag.copy() for tag in tags]}
    return meshio.Mesh(drive.points, drive.cells, cell_data=data, field_data=names)
