"""Regions of the nodes of tooth sectors, and the places that a run reports."""

from __future__ import annotations

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, RECIPE, REFERENCE
from support.small_drive import PLANE
from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.rotation import GEAR_STRESSES
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.largest_stress.local_problem import window_sector
from swgpar.largest_stress.places import (
    APART,
    OFF_CORNERS,
    inside_teeth,
    near_contact,
    root_nodes,
    working_flanks,
)
from swgpar.largest_stress.window_recipes import window_recipe
from swgpar.largest_stress.window_regions import tooth_nodes
from swgpar.meshing import SectorMesh, load_recipe
from swgpar.meshing.tooth_sector import build_sector
from swgpar.model.regions import (
    AVERAGE,
    BACK,
    CAM_EDGE,
    EDGE,
    NOTCH,
    WITHOUT_LIMIT,
    regions_of,
    warning_of,
)


@pytest.fixture(scope="module")
def cup() -> tuple[DriveDesign, SectorMesh]:
    design = swgpar.load_design(REFERENCE)
    return design, build_sector(design.geometry, load_recipe("coarse"), "flexible_spline")


def regions(
    cup: tuple[DriveDesign, SectorMesh], nodes: np.ndarray, touched: bool = False
) -> set[str]:
    return set(regions_of(cup[0].geometry, cup[1], nodes, touched))


def test_regions_of_the_cup(cup: tuple[DriveDesign, SectorMesh]) -> None:
    design, mesh = cup
    half, z = 0.5 * design.drive.face_width, mesh.coords[:, 2]
    radius = np.hypot(*mesh.coords[:, :2].T)
    assert regions(cup, mesh.node_sets["bore"]) == {"bore"}
    inner = np.unique(mesh.faces["inner"])
    at_edge = np.abs(np.abs(z[inner]) - half) < 1e-9
    assert regions(cup, inner[~at_edge]) == {"rim inside"}
    assert regions(cup, inner[at_edge]) == {"rim at the edge of the cam"}
    assert warning_of(design.geometry, CAM_EDGE, mesh.coords[inner[at_edge][0]]) == EDGE
    wall = np.flatnonzero((z > half + 1.0) & (z < half + 20.0))
    assert regions(cup, wall) == {"cup wall"}
    end = half + design.cup.length
    behind = regions(cup, np.flatnonzero(z > half))
    assert behind - {"corner"} == {"cup wall", "fillet", "closed end", "bore"}
    assert regions(cup, np.flatnonzero((z == z.max()) & (radius > 40.0) & (radius < 50.0))) == {
        "closed end"
    }
    assert z.max() == pytest.approx(end)


def test_regions_of_a_tooth(cup: tuple[DriveDesign, SectorMesh]) -> None:
    design, mesh = cup
    grid = mesh.flanks[0]
    middle = len(grid.z) // 2
    flank = np.flatnonzero(grid.s < mesh.profile.root_start - 1e-9)
    assert regions(cup, grid.nodes[flank, middle]) == {"flank"}
    assert regions(cup, grid.nodes[flank, middle], touched=True) == {"flank under contact"}
    assert regions(cup, grid.nodes[-1:, middle]) == {"tooth root"}
    assert regions(cup, grid.nodes[:, 0]) == {"tooth end"}
    on_back = np.abs(mesh.coords[:, 2] - grid.z[-1]) < 1e-9
    at_root = np.abs(np.hypot(*mesh.coords[:, :2].T) - mesh.profile.r_root_circle) < 1e-9
    assert "notch" in regions(cup, np.flatnonzero(on_back & at_root))


@pytest.mark.parametrize(("thickness", "expected"), [(0.8, "tooth end"), (0.95, "notch")])
def test_roots_that_end_at_the_corner_have_no_limit_there(thickness: float, expected: str) -> None:
    """The corner between teeth and wall is where a wall as thick as the rim meets the roots."""
    design = swgpar.load_design(REFERENCE, [f"cup.thickness_coef={thickness}"])
    mesh = build_sector(design.geometry, load_recipe("coarse"), "flexible_spline")
    grid = mesh.flanks[0]
    end, front = (regions((design, mesh), grid.nodes[-1:, k]) for k in (-1, 0))
    assert end == {expected} and front == {"tooth end"}
    warning = warning_of(design.geometry, *end, mesh.coords[grid.nodes[-1, -1]])
    assert warning.startswith(NOTCH) == (expected == "notch")


def test_a_fillet_takes_the_place_of_the_notch() -> None:
    design = swgpar.load_design(REFERENCE, ["cup.back_fillet=0.2"])
    mesh = build_sector(design.geometry, load_recipe("full"), "flexible_spline")
    r, z = np.hypot(*mesh.coords[:, :2].T), mesh.coords[:, 2]
    wall = design.inner_radius + design.cup_sizes.thickness
    on = np.flatnonzero(
        (np.abs(np.hypot(r - wall - 0.2, z - 5.2) - 0.2) < 1e-9) & (r <= wall + 0.2) & (z <= 5.2)
    )
    assert len(on) > 10
    assert regions((design, mesh), on) == {BACK}
    assert set(on) <= set(tooth_nodes(mesh, design.geometry, ends=True))
    assert "notch" not in regions((design, mesh), np.arange(len(z)))


def test_regions_of_the_ring_gear() -> None:
    design = swgpar.load_design(REFERENCE)
    mesh = build_sector(design.geometry, load_recipe("coarse"), "ring_gear")
    found = regions((design, mesh), np.unique(mesh.faces["outer"]))
    assert found == {"outer surface", "attachment"}  # its edges are held
    housed = swgpar.load_design(REFERENCE, ["ring_gear.housing.thickness=6"])
    mesh = build_sector(housed.geometry, load_recipe("coarse"), "ring_gear")
    assert "attachment" not in set(
        regions_of(housed.geometry, mesh, np.arange(len(mesh.coords)), False)
    )


def test_a_run_says_where_its_largest_stresses_are() -> None:
    design = swgpar.load_design(DESIGN, [*PLANE, "steps.rotation=4", "steps.increment=2"])
    result = swgpar.run(design, RECIPE)
    places, loaded = result.summary.stresses.places, result.history["step"] >= 3
    apart = {f"{name}{APART}" for name in GEAR_STRESSES if not name.endswith("s1")}
    off_corners = {f"{name}{OFF_CORNERS}" for name in GEAR_STRESSES}
    assert set(places) == set(GEAR_STRESSES) | apart | off_corners
    for name in off_corners:
        of_gear = name.removesuffix(OFF_CORNERS)
        assert places[name].value == places.get(of_gear + APART, places[of_gear]).value
    for name in apart:
        assert 0.0 < places[name].value <= places[name.removesuffix(APART)].value
        assert places[name].region != "flank under contact"
    places = {name: place for name, place in places.items() if name in GEAR_STRESSES}
    for name, place in places.items():
        assert place.value == pytest.approx(result.history[name][loaded].max(), rel=1e-12)
        assert place.body == ("flexible_spline" if name.startswith("fs") else "ring_gear")
        assert (place.warning == AVERAGE) == (place.region == "flank under contact")
    assert places["fs_s1"].region in ("tooth root", "rim inside")
    assert design.inner_radius - 0.1 < places["fs_s1"].radius < 0.5 * design.drive.teeth_rg


@pytest.mark.parametrize("body", ["flexible_spline", "ring_gear"])
def test_nodes_inside_of_teeth_are_on_no_surface(
    cup: tuple[DriveDesign, SectorMesh], body: str
) -> None:
    design = cup[0]
    mesh = build_sector(design.geometry, load_recipe("coarse"), body)
    inside = np.flatnonzero(inside_teeth(design.geometry, mesh))
    assert len(inside) > 50
    faces = {node for name in mesh.faces for node in np.unique(mesh.faces[name])}
    assert not faces & set(inside.tolist())
    assert regions((design, mesh), inside) <= {"inside the tooth", "tooth end"}


def test_roots_are_where_the_region_says_it(cup: tuple[DriveDesign, SectorMesh]) -> None:
    assert regions(cup, root_nodes(cup[0].geometry, cup[1])) == {"tooth root"}


def test_windows_read_no_rim_as_close_to_the_edge_of_the_cam_as_its_stress_reaches() -> None:
    """The elements of windows are shorter than that: the next node rises with every window too."""
    geometry = swgpar.load_design(REFERENCE).geometry
    mesh = window_sector(geometry, window_recipe("cup", 2))
    inner = np.unique(mesh.faces["inner"])
    inner = inner[np.abs(mesh.coords[inner, 2]) < 0.5 * geometry.face_width]
    below = 0.5 * geometry.cam_width - np.abs(mesh.coords[inner, 2])
    close = below < 0.5 * geometry.gears[FLEXIBLE_SPLINE].rim
    found = regions_of(geometry, mesh, inner, False)
    assert np.unique(below[close].round(9)).size > 1
    assert set(found[close]) == {CAM_EDGE} and CAM_EDGE not in found[~close]


def test_roots_on_elements_of_the_wall_are_at_the_corner() -> None:
    """A wall nearly as thick as the rim continues the layers below the root: its elements go up the
    root arc, and so does the corner behind the teeth in the mesh."""
    for thickness, at_the_corner in ((0.95, True), (0.8, False)):
        design = swgpar.load_design(REFERENCE, [f"cup.thickness_coef={thickness}"])
        mesh = window_sector(design.geometry, window_recipe("cup", 2))
        found = regions_of(design.geometry, mesh, range(len(mesh.coords)), False)
        z, back = mesh.coords[:, 2], 0.5 * design.drive.face_width
        behind = z[mesh.hexes].max(axis=1) > back + 1e-9
        shared = np.intersect1d(mesh.hexes[behind], np.flatnonzero(np.abs(z - back) < 1e-9))
        on_flanks = np.intersect1d(shared, mesh.flanks[0].nodes)
        assert (len(on_flanks) > 3) == at_the_corner
        assert set(found[on_flanks]) <= {"notch"}
        front = np.isin(found, WITHOUT_LIMIT) & (z < -0.5 * back)
        assert set(found[front]) <= {CAM_EDGE}


def test_a_contact_on_the_root_is_a_contact_too(cup: tuple[DriveDesign, SectorMesh]) -> None:
    """A tip may reach the root of the other gear. Nodes on other surfaces are left
    out."""
    design, mesh = cup
    distance, grid = design.geometry.module, mesh.flanks[0]
    on_root = grid.nodes[grid.s > mesh.profile.root_start][0, 0]
    inside = int(mesh.node_sets["bore"][0])
    touched = np.zeros((3, len(mesh.coords)), dtype=bool)
    touched[0, on_root] = touched[1, inside] = True
    near = near_contact(mesh, touched, distance)
    within = np.linalg.norm(mesh.coords - mesh.coords[on_root], axis=1) <= distance
    assert within.sum() > 1
    np.testing.assert_array_equal(near[0], within)
    assert not near[1:].any()
    assert not working_flanks(mesh)[on_root]
