"""The mesh as an input file of CalculiX or Abaqus: a job without supports, loads and steps.

Nodes, elements, node sets, element-face surfaces for contact, the material and the sections: a job
names the file by *INCLUDE and goes on with its *BOUNDARY and *STEP.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import meshio
import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.arrays import Ints
from swgpar.materials import Isotropic, Material
from swgpar.meshing.sector import SectorMesh

HEX_FACES = np.array(
    [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]
)
QUAD_FACES = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
"""Nodes of the faces S1, S2, ... of these programs, a hexahedron's clockwise from outside."""


def element_faces(mesh: SectorMesh, quads: Ints) -> Ints:
    """Element and face (n, 2), both from 0, of surface quadrilaterals (n, 4) of one sector.

    In the plane a quadrilateral spans both layers of nodes; the face is an element's edge.
    """
    if mesh.plane:
        quads = mesh.lower_nodes[quads]
        quads = np.array([np.unique(quad) for quad in quads], dtype=np.int32).reshape(-1, 2)
    table = HEX_FACES if not mesh.plane else QUAD_FACES
    faces = np.sort(mesh.elements[:, table], axis=-1)
    face_of = {
        tuple(nodes): (k, f) for k, row in enumerate(faces.tolist()) for f, nodes in enumerate(row)
    }
    return np.array(
        [face_of[tuple(quad)] for quad in np.sort(quads, axis=1).tolist()], dtype=np.int32
    ).reshape(-1, 2)


def number_lines(numbers: Ints) -> Iterator[str]:
    """Yield the 1-based `numbers`, 16 to a line."""
    for start in range(0, len(numbers), 16):
        yield ", ".join(str(n) for n in numbers[start : start + 16] + 1)


def _constants(material: Material, plane_stress: bool) -> str:
    """What follows *ELASTIC. plane_stress : without transverse contraction along z"""
    if isinstance(material, Isotropic) and not plane_stress:
        return f"\n{material.E:.12g}, {material.nu:.12g}"
    s = material.compliance()
    alike = np.diag([s[0, 0], s[0, 0], s[2, 2], 2.0 * (s[0, 0] - s[0, 1]), s[4, 4], s[4, 4]])
    alike[0, 1] = alike[1, 0] = s[0, 1]
    alike[:2, 2] = alike[2, :2] = s[0, 2]
    if not np.allclose(s, alike, rtol=1e-9, atol=1e-9 * s[0, 0]):
        raise InputError(
            "the axes of a material have no place in the format inp: allowed a law that is the "
            "same in all directions across z"
        )
    e, shear, shear_z = 1.0 / s[0, 0], 1.0 / s[3, 3], 1.0 / s[4, 4]
    nu, nu_z = -s[0, 1] * e, 0.0 if plane_stress else -s[0, 2] * e
    constants = (e, e, 1.0 / s[2, 2], nu, nu_z, nu_z, shear, shear_z)
    return (
        f", TYPE=ENGINEERING CONSTANTS\n{', '.join(f'{c:.12g}' for c in constants)}\n{shear_z:.12g}"
    )


def _density(material: Material) -> str:
    """Lines of the density, in t/mm³ with lengths in mm and forces in N; empty where it is not
    given."""
    return "" if material.density is None else f"*DENSITY\n{1e-12 * material.density:.12g}\n"


def _expansion(material: Material, plane_stress: bool) -> str:
    """Lines of the thermal expansion, 1/K; empty where it is not given. plane_stress : none along
    z, where nothing moves"""
    growth = material.thermal_growth(1.0)
    if growth is None:
        return ""
    along = 0.0 if plane_stress else growth.along
    if growth.across == along:
        return f"*EXPANSION\n{growth.across:.12g}\n"
    across = f"{growth.across:.12g}"
    return f"*EXPANSION, TYPE=ORTHO\n{across}, {across}, {along:.12g}\n"


def write_inp(
    path: Path,
    drive: meshio.Mesh,
    surfaces: dict[str, Ints],
    materials: Mapping[str, Material],
    thickness: float,
    *,
    plane_stress: bool = False,
) -> None:
    """Write bodies that are the cell sets of `drive`: C3D8I elements, or CPS4 in the plane.

    path : Path
    drive : its point sets are written as node sets, in capitals
    surfaces : (n, 2) element and face of every facet, both from 0
    materials : of every body
    thickness : mm, of the plane model
    plane_stress : gives hexahedra a material without transverse contraction and expansion along
        z. With no displacement along z they are then in plane stress.

    Raises InputError for materials that differ by direction across z: the file has no axes.

    meshio's own writer of this format has neither these element types nor surfaces.
    """
    solid = drive.cells[0].type == "hexahedron"
    with path.open("w", encoding="ascii") as file:
        file.write("*HEADING\nstrain wave gear drive; lengths as in the design file\n")
        if not solid:
            file.write(
                "** the elements of swgpar have incompatible modes: CPS4I of Abaqus; CalculiX has "
                "CPS4 only\n"
            )
        file.write("*NODE, NSET=ALL_NODES\n")
        numbers = np.arange(1, len(drive.points) + 1)
        # CalculiX reads the first 20 characters of a field
        np.savetxt(file, np.column_stack((numbers, drive.points)), fmt="%d, %.12e, %.12e, %.12e")
        first = 1
        for body, block in zip(drive.cell_sets, drive.cells, strict=True):
            file.write(f"*ELEMENT, TYPE={'C3D8I' if solid else 'CPS4'}, ELSET={body.upper()}\n")
            table = np.column_stack((np.arange(first, first + len(block.data)), block.data + 1))
            np.savetxt(file, table, fmt="%d", delimiter=", ")
            first += len(block.data)
        for name, nodes in drive.point_sets.items():
            file.write(f"*NSET, NSET={name.upper()}\n")
            file.writelines(f"{line}\n" for line in number_lines(nodes))
        for name, faces in surfaces.items():
            file.write(f"*SURFACE, NAME={name.upper()}, TYPE=ELEMENT\n")
            np.savetxt(file, faces + 1, fmt="%d, S%d")
        for body in drive.cell_sets:
            file.write(
                f"*MATERIAL, NAME={body.upper()}_MATERIAL\n"
                f"*ELASTIC{_constants(materials[body], plane_stress)}\n"
                f"{_density(materials[body])}{_expansion(materials[body], plane_stress)}"
            )
        for body in drive.cell_sets:
            file.write(f"*SOLID SECTION, ELSET={body.upper()}, MATERIAL={body.upper()}_MATERIAL\n")
            if not solid:
                file.write(f"{thickness:.12g}\n")
