"""Full drives in the files of other programs: VTU (ParaView), MSH (gmsh), INP (Abaqus, CalculiX).

The plane model is written as quadrilaterals at z = 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import meshio
import numpy as np

from swgpar.errors import InputError, OutputError
from swgpar.geometry.arrays import Floats, Ints
from swgpar.materials import Material
from swgpar.meshing.inp import element_faces, write_inp
from swgpar.meshing.quality import hex_volumes
from swgpar.meshing.sector import SectorMesh
from swgpar.meshing.sweep import grid_quads
from swgpar.whole_files import whole_files

FORMATS = ("vtu", "msh", "inp")

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


def whole_body(mesh: SectorMesh) -> tuple[Floats, Ints]:
    """Nodes (n, 3), mm, and elements (m, 8 or 4) of all sectors; numbers of `sector_numbers`."""
    numbers = sector_numbers(mesh)
    angle = mesh.sector_angle(np.arange(mesh.n_sectors))[:, None]
    x, y, z = mesh.coords.T
    coords = np.empty((int(numbers.max()) + 1, 3))
    coords[numbers, 0] = x * np.cos(angle) - y * np.sin(angle)
    coords[numbers, 1] = x * np.sin(angle) + y * np.cos(angle)
    coords[numbers, 2] = z if not mesh.plane else 0.0
    elements = mesh.elements
    return coords, numbers[:, elements].reshape(-1, elements.shape[1])


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


def _as_vtu(drive: meshio.Mesh) -> meshio.Mesh:
    """Return the drive with its node sets as point data, since VTU has no sets."""
    marks = {}
    for name, nodes in drive.point_sets.items():
        marks[name] = np.zeros(len(drive.points), dtype=np.uint8)
        marks[name][nodes] = 1
    return meshio.Mesh(drive.points, drive.cells, point_data=marks, cell_data=dict(drive.cell_data))


def _as_msh(drive: meshio.Mesh) -> meshio.Mesh:
    """Return the drive with its bodies as named physical volumes, or surfaces in the plane."""
    dimension = 3 if drive.cells[0].type == "hexahedron" else 2
    tags = [block + 1 for block in drive.cell_data["body"]]
    names = {body: np.array([number + 1, dimension]) for number, body in enumerate(drive.cell_sets)}
    data = {"gmsh:physical": tags, "gmsh:geometrical": [tag.copy() for tag in tags]}
    return meshio.Mesh(drive.points, drive.cells, cell_data=data, field_data=names)


def write_mesh(
    meshes: dict[str, SectorMesh],
    materials: Mapping[str, Material],
    thickness: float,
    directory: str | Path,
    formats: Sequence[str] = FORMATS,
    *,
    overwrite: bool = False,
) -> list[Path]:
    """Write all sectors of all bodies as ``drive_120_122.vtu``, ``.msh`` and ``.inp``.

    meshes : by gear;  materials : of every body and of a housing
    thickness : mm, of the plane model
    directory : made when it does not exist;  formats : any of ``vtu``, ``msh``, ``inp``
    overwrite : whether files that are there are replaced

    Returns the files, in the order of `formats`.
    """
    for name in formats:
        if name not in FORMATS:
            raise InputError(
                f'mesh format = "{name}" is not available: allowed {", ".join(FORMATS)}'
            )
    drive = whole_drive(meshes)
    teeth = "_".join(str(meshes[gear].n_sectors) for gear in ("flexible_spline", "ring_gear"))
    folder = Path(directory)
    try:
        with whole_files(folder, overwrite=overwrite) as made:
            for name in formats:
                path = made / f"drive_{teeth}.{name}"
                if name == "vtu":
                    meshio.vtu.write(path, _as_vtu(drive), compression="zlib")
                elif name == "msh":
                    meshio.gmsh.write(path, _as_msh(drive), fmt_version="2.2", binary=True)
                else:
                    write_inp(path, drive, named_surfaces(meshes), materials, thickness)
    except OSError as error:
        raise OutputError(
            f"the mesh cannot be written to {folder}: {error.strerror or error}"
        ) from None
    return [folder / f"drive_{teeth}.{name}" for name in formats]


def mesh_report(meshes: dict[str, SectorMesh]) -> dict[str, dict[str, float]]:
    """Return counts and worst quality of every body.

    ``nodes`` and ``elements`` (all sectors), ``sector_elements``, ``volume`` (mm³), the quality.
    """
    report = {}
    for body, mesh in meshes.items():
        own = (len(mesh.coords) - len(mesh.ccw_nodes)) // (1 if not mesh.plane else 2)
        report[body] = {
            "nodes": own * mesh.n_sectors,
            "elements": len(mesh.hexes) * mesh.n_sectors,
            "sector_elements": len(mesh.hexes),
            "volume": float(hex_volumes(mesh.coords, mesh.hexes).sum()) * mesh.n_sectors,
            **mesh.quality,
        }
    return report
