"""The INP file: its surfaces are the boundary, and CalculiX solves with it what the project's
elements solve."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from support.element_mesh import ElementMesh
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar import load_design
from swgpar.materials import Isotropic
from swgpar.meshing import SectorMesh, build_sector_meshes, load_recipe
from swgpar.meshing.drive_mesh import DriveMesh
from swgpar.meshing.export import named_surfaces, whole_body, whole_drive
from swgpar.meshing.inp import HEX_FACES, QUAD_FACES

needs_calculix = pytest.mark.skipif(
    shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed"
)


HOUSING = (
    "ring_gear.housing.thickness=3",
    "ring_gear.housing.material={E=70e3, nu=0.33, density=2700.0, expansion=2.3e-5}",
)


def small(
    model: str, directory: Path, housing: tuple[str, ...] = ()
) -> tuple[dict[str, SectorMesh], Path]:
    """Meshes of the small drive, and its file as `swgpar mesh` writes it."""
    design = load_design(DESIGN, [*(PLANE if model == "plane" else ()), *housing])
    meshes = build_sector_meshes(design.geometry, load_recipe(RECIPE))
    mesh = DriveMesh(meshes, design.materials, design.drive.face_width)
    return meshes, mesh.write(directory, ("inp",))[0]


def solved(path: Path, lines: list[str]) -> dict[int, np.ndarray]:
    """Displacements (3,) mm by node, from 0, that CalculiX prints for a job made of the file and
    further lines."""
    job = path.with_name("job.inp")
    job.write_text("\n".join([f"*INCLUDE, INPUT={path.name}", *lines]) + "\n")
    run = subprocess.run(
        ["ccx", "job"], cwd=job.parent, capture_output=True, text=True, timeout=300, check=False
    )
    assert run.returncode == 0 and "*ERROR" not in run.stdout, run.stdout[-2000:]
    rows = [line.split() for line in job.with_suffix(".dat").read_text().splitlines()]
    return {
        int(row[0]) - 1: np.array(row[1:], dtype=float)
        for row in rows
        if len(row) == 4 and row[0].isdigit()
    }


@pytest.mark.parametrize("housing", [(), HOUSING])
@pytest.mark.parametrize("model", ["cup", "plane"])
def test_surfaces_are_faces_of_one_element_each(
    model: str, housing: tuple[str, ...], tmp_path: Path
) -> None:
    meshes, path = small(model, tmp_path, housing)
    drive, surfaces = whole_drive(meshes), named_surfaces(meshes)
    named = {
        "flexible_spline_inner",
        "flexible_spline_flanks",
        "ring_gear_outer",
        "ring_gear_flanks",
    }
    assert set(surfaces) == named | ({"flexible_spline_end"} if model == "cup" else set())
    table = HEX_FACES if model == "cup" else QUAD_FACES
    elements = np.concatenate([block.data for block in drive.cells])
    faces = np.sort(elements[:, table], axis=-1)
    _, place, count = np.unique(
        faces.reshape(-1, table.shape[1]), axis=0, return_inverse=True, return_counts=True
    )
    shared = count[place].reshape(len(elements), -1) > 1
    text = path.read_text()
    for name, pairs in surfaces.items():
        assert len(np.unique(pairs, axis=0)) == len(pairs) > 0
        assert not shared[tuple(pairs.T)].any()
        nodes = drive.point_sets.get(name, drive.point_sets.get(name.replace("inner", "bore")))
        if nodes is not None:  # the faces of the closed end have no set of nodes
            assert np.array_equal(np.unique(faces[tuple(pairs.T)]), nodes)
        assert (
            f"*SURFACE, NAME={name.upper()}, TYPE=ELEMENT\n{pairs[0, 0] + 1}, S{pairs[0, 1] + 1}\n"
            in text
        )
    assert (
        "NAME=HOUSING_MATERIAL\n*ELASTIC\n70000, 0.33\n*DENSITY\n2.7e-09\n*EXPANSION\n2.3e-05\n"
        in text
    ) == bool(housing)
    assert ("ELSET=HOUSING, MATERIAL=HOUSING_MATERIAL" in text) == bool(housing)


@needs_calculix
@pytest.mark.parametrize("model", ["cup", "plane"])
def test_a_turned_bore_turns_the_whole_spline(model: str, tmp_path: Path) -> None:
    """A turn by 1e-4 rad about z with the ring gear held: the spline follows it rigidly."""
    meshes, path = small(model, tmp_path)
    drive = whole_drive(meshes)
    deck = ["*BOUNDARY", "RING_GEAR_OUTER, 1, 3", "*STEP", "*STATIC", "*BOUNDARY"]
    for node in drive.point_sets["flexible_spline_bore"]:
        x, y, _ = drive.points[node]
        deck += [
            f"{node + 1}, 1, 1, {-1e-4 * y:.12e}",
            f"{node + 1}, 2, 2, {1e-4 * x:.12e}",
            f"{node + 1}, 3, 3",
        ]
    found = solved(path, [*deck, "*NODE PRINT, NSET=FLEXIBLE_SPLINE_FLANKS", "U", "*END STEP"])
    nodes = np.array(sorted(found))
    assert np.array_equal(nodes, drive.point_sets["flexible_spline_flanks"])
    x, y, _ = drive.points[nodes].T
    exact = 1e-4 * np.stack((-y, x, np.zeros_like(x)), axis=-1)
    assert np.abs(np.array([found[k] for k in nodes]) - exact).max() < 1e-4 * np.abs(exact).max()


@needs_calculix
def test_the_cup_under_inner_pressure(tmp_path: Path) -> None:
    """A small pressure on the surface of the wave generator, the bore held: linear, without
    contact."""
    pressure = 0.01
    meshes, path = small("cup", tmp_path)
    drive = whole_drive(meshes)
    deck = ["*BOUNDARY", "RING_GEAR_OUTER, 1, 3", "FLEXIBLE_SPLINE_BORE, 1, 3", "*STEP", "*STATIC"]
    deck += ["*DSLOAD", f"FLEXIBLE_SPLINE_INNER, P, {pressure}"]
    found = solved(path, [*deck, "*NODE PRINT, NSET=FLEXIBLE_SPLINE_INNER", "U", "*END STEP"])
    points, elements = whole_body(meshes["flexible_spline"])
    pairs = named_surfaces(meshes)["flexible_spline_inner"]
    corner = elements[pairs[:, :1], HEX_FACES[pairs[:, 1]]]
    load = np.zeros_like(points)
    for k, weights in _facet_forces(points[corner]):
        np.add.at(load, corner[:, k], pressure * weights)
    fixed = np.zeros(points.shape, dtype=bool)
    fixed[drive.point_sets["flexible_spline_bore"]] = True
    u = ElementMesh(points, elements, Isotropic(E=210e3, nu=0.29)).solve(
        fixed, np.zeros_like(points), load
    )
    nodes = np.array(sorted(found))
    assert np.array_equal(nodes, np.unique(corner))
    off = np.abs(np.array([found[k] for k in nodes]) - u[nodes]).max()
    # on elements that are no parallelepipeds the incompatible modes of the two differ: by 2.3 % on
    # this mesh, by 0.05 % with all elements halved
    assert off < 0.03 * np.abs(u[nodes]).max()


def _facet_forces(corners: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
    """Corner and its area vectors (n, 3) mm2, into the element, of bilinear facets (n, 4, 3)."""
    point = np.array([-1.0, 1.0]) / np.sqrt(3.0)
    corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    areas = np.zeros(corners.shape)
    for a in point:
        for b in point:
            shape = 0.25 * (1 + a * corner[:, 0]) * (1 + b * corner[:, 1])
            da = np.einsum("q,fqi->fi", 0.25 * corner[:, 0] * (1 + b * corner[:, 1]), corners)
            db = np.einsum("q,fqi->fi", 0.25 * corner[:, 1] * (1 + a * corner[:, 0]), corners)
            areas += shape[:, None] * np.cross(da, db)[:, None]
    return enumerate(areas.transpose(1, 0, 2))
