"""A condensed sector against the elements it stands for."""

from __future__ import annotations

import numpy as np
import pytest

from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar import load_design
from swgpar.fem.condensed_parts import CondensedPart, condense_sector, relative_end_rotation
from swgpar.fem.element_matrices import element_matrices
from swgpar.kernel import ReferenceElements, assemble_elements
from swgpar.meshing import build_sector_meshes, load_recipe
from swgpar.meshing.sector import SectorMesh

ANGLE = np.array([0.7])
Sector = tuple[SectorMesh, ReferenceElements, CondensedPart]


@pytest.fixture(scope="module", params=["flexible_spline", "ring_gear"])
def sector(request) -> Sector:
    design = load_design(DESIGN, PLANE)
    mesh = build_sector_meshes(design.geometry, load_recipe(RECIPE))[request.param]
    elements = element_matrices(
        mesh.coords[mesh.elements], design.material, design.drive.face_width
    )
    return mesh, elements, condense_sector(mesh, elements)


def forces(
    reference: ReferenceElements, conn: np.ndarray, u: np.ndarray, values: np.ndarray | None = None
) -> tuple[float, np.ndarray]:
    """Energy and forces (n, 3) of elements in a sector turned by ANGLE; adds the tangent to blocks
    (n * n, 3, 3)."""
    residual, turn = np.zeros_like(u), np.tile([np.cos(ANGLE[0]), np.sin(ANGLE[0])], (len(conn), 1))
    ref = np.arange(len(conn), dtype=np.int32)
    conn = np.ascontiguousarray(conn, dtype=np.int32)
    slot = (
        None
        if values is None
        else (conn[:, :, None] * len(u) + conn[:, None, :]).reshape(len(conn), -1)
    )
    slot = None if slot is None else slot.astype(np.int64)
    energy = assemble_elements(
        reference, ref, turn, conn, np.zeros(conn.shape, np.uint8), u, residual, slot, values
    )
    return energy, residual


def moved(
    sector: Sector, turn: float, strain: float, seed: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Outer nodes' displacement (m, 3) mm under a turn and a random deformation, and their rows in
    `coords`."""
    mesh, _, condensed = sector
    place = turned(mesh.coords[condensed.outer], ANGLE[0])
    scatter = strain * np.random.default_rng(seed).uniform(-1.0, 1.0, place.shape)
    scatter[:, 2] = 0.0
    return turned(place + scatter, turn) + [3.0, -2.0, 0.0] - place, condensed.outer


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def test_the_inside_is_in_equilibrium_and_the_outer_forces_are_those_of_the_elements(
    sector: Sector,
) -> None:
    mesh, elements, condensed = sector
    outer, rows = moved(sector, 0.4, 1e-7)
    u = np.zeros_like(mesh.coords)
    u[rows], u[condensed.inner] = outer, condensed.inner_displacement(ANGLE, outer[None])[0]
    energy, every = forces(elements, mesh.elements, u)
    own, kept = forces(condensed.reference, np.arange(len(rows))[None], outer)
    largest = np.abs(kept).max()
    assert largest > 1e-4
    assert np.abs(every[condensed.inner]).max() < 1e-5 * largest
    assert np.abs(every[rows] - kept).max() < 1e-5 * largest
    assert own == pytest.approx(energy, rel=1e-5)


def test_rigid_motion_gives_no_force(sector: Sector) -> None:
    mesh, _, condensed = sector
    outer, rows = moved(sector, 2.5, 0.0)
    _, kept = forces(condensed.reference, np.arange(len(rows))[None], outer)
    assert (
        np.abs(kept).max()
        < 1e-12 * np.abs(condensed.reference.stiffness).max() * np.abs(mesh.coords).max()
    )
    place = turned(mesh.coords[condensed.inner], ANGLE[0])
    exact = turned(place, 2.5) + [3.0, -2.0, 0.0] - place
    assert (
        np.abs(condensed.inner_displacement(ANGLE, outer[None])[0] - exact).max()
        < 1e-12 * np.abs(mesh.coords).max()
    )


def test_the_tangent_is_the_derivative_of_the_forces(sector: Sector) -> None:
    outer, rows = moved(sector, 0.4, 1e-3)
    m, step, conn = len(rows), 1e-6, np.arange(len(rows))[None]
    values = np.zeros((m * m, 3, 3))
    forces(sector[2].reference, conn, outer, values)
    tangent = values.reshape(m, m, 3, 3).transpose(0, 3, 1, 2).reshape(3 * m, 3 * m)
    free = np.arange(3 * m) % 3 < 2
    assert np.abs(tangent - tangent.T).max() < 1e-12 * np.abs(tangent).max()
    for k in np.random.default_rng(1).choice(np.flatnonzero(free), 6, replace=False):
        change = np.zeros(3 * m)
        change[k] = step
        ahead, back = (
            forces(sector[2].reference, conn, outer + sign * change.reshape(m, 3))[1].ravel()
            for sign in (1.0, -1.0)
        )
        derivative = (ahead - back) / (2.0 * step)
        assert np.abs(derivative - tangent[:, k])[free].max() < 1e-6 * np.abs(tangent).max()


def test_no_sectors_have_no_inside(sector: Sector) -> None:
    """Where there are more ranks than teeth."""
    _, _, condensed = sector
    nothing = condensed.inner_displacement(np.zeros(0), np.zeros((0, len(condensed.outer), 3)))
    assert nothing.shape == (0, len(condensed.inner), 3)


def test_relative_end_rotation(sector: Sector) -> None:
    """Cuts that turn by different angles about their middles, in sectors at different places."""
    mesh, angle, turns = sector[0], np.array([0.7, 2.0]), (0.03, 0.01)
    u = np.zeros((2, len(mesh.coords), 3))
    for k, place in enumerate(angle):
        for nodes, turn in zip((mesh.ccw_nodes, mesh.cw_nodes), turns):
            x = turned(mesh.coords[nodes], place)
            u[k, nodes] = turned(x - x.mean(axis=0), turn) - x + x.mean(axis=0) + [0.1, 0.2, 0.0]
    assert relative_end_rotation(mesh, angle, u) == pytest.approx(turns[0] - turns[1])
