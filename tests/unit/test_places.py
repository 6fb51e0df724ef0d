"""Regions of the nodes of tooth sectors, and the places that a run reports."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, RECIPE, REFERENCE
from support.small_drive import PLANE
from swgpar.checks.design_file import load_design
from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.rotation import GEAR_STRESSES
from swgpar.largest_stress.local_problem import tooth_nodes
from swgpar.largest_stress.place_errors import CoarseStresses, with_errors
from swgpar.largest_stress.places import APART, Place, inside_teeth, root_nodes
from swgpar.largest_stress.root_stress import BETWEEN, RootStress
from swgpar.meshing import SectorMesh, load_recipe
from swgpar.meshing.tooth_sector import build_sector
from swgpar.model.regions import AVERAGE, BACK, region_of


@pytest.fixture(scope="module")
def cup() -> tuple[DriveDesign, SectorMesh]:
    design = load_design(REFERENCE)
    return design, build_sector(design.geometry, load_recipe("coarse"), "flexible_spline")


def regions(
    cup: tuple[DriveDesign, SectorMesh], nodes: np.ndarray, touched: bool = False
) -> set[str]:
    geometry = cup[0].geometry
    return {region_of(geometry, cup[1], int(node), touched) for node in nodes}


def test_regions_of_the_cup(cup: tuple[DriveDesign, SectorMesh]) -> None:
    design, mesh = cup
    half, z = 0.5 * design.drive.face_width, mesh.coords[:, 2]
    radius = np.hypot(*mesh.coords[:, :2].T)
    assert regions(cup, mesh.node_sets["bore"]) == {"bore"}
    assert regions(cup, np.unique(mesh.faces["inner"])) == {"rim inside"}
    wall = np.flatnonzero((z > half + 1.0) & (z < half + 20.0))
    assert regions(cup, wall) == {"cup wall"}
    end = half + design.cup.length
    assert regions(cup, np.flatnonzero(z > half)) == {"cup wall", "fillet", "closed end", "bore"}
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


def test_a_fillet_takes_the_place_of_the_notch() -> None:
    design = load_design(REFERENCE, ["cup.back_fillet=0.2"])
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
    design = load_design(REFERENCE)
    mesh = build_sector(design.geometry, load_recipe("coarse"), "ring_gear")
    found = {
        region_of(design.geometry, mesh, int(node), False)
        for node in np.unique(mesh.faces["outer"])
    }
    assert found == {"outer surface"}


def test_a_run_says_where_its_largest_stresses_are() -> None:
    design = load_design(DESIGN, [*PLANE, "steps.rotation=4", "steps.increment=2"])
    result = swgpar.run(design, RECIPE)
    places, loaded = result.summary.stresses.places, result.history["step"] >= 3
    apart = {f"{name}{APART}" for name in GEAR_STRESSES if not name.endswith("s1")}
    assert set(places) == set(GEAR_STRESSES) | apart
    for name in apart:
        assert 0.0 < places[name].value <= places[name.removesuffix(APART)].value
        assert places[name].region != "flank under contact"
    places = {name: place for name, place in places.items() if name not in apart}
    for name, place in places.items():
        assert place.value == pytest.approx(result.history[name][loaded].max(), rel=1e-12)
        assert place.body == ("flexible_spline" if name.startswith("fs") else "ring_gear")
        assert (place.warning == AVERAGE) == (place.region == "flank under contact")
    assert places["fs_s1"].region in ("tooth root", "rim inside")
    assert design.inner_radius - 0.1 < places["fs_s1"].radius < 0.5 * design.drive.teeth_rg


def test_the_error_of_a_stress_follows_from_two_meshes() -> None:
    """Errors of first order are found; a stress that depends on the mesh has none."""
    place = Place(300.0, "flexible_spline", "tooth root", 0, 59.0, 0.0, 0.0, "")
    under = replace(place, region="flank under contact", warning=AVERAGE)
    coarse = CoarseStresses({"fs_s1": replace(place, value=300.0 - 15.0), "fs_s3": under}, 1.5)
    # the coarser mesh has no node in the fillet
    fine = {"fs_s1": replace(place, value=300.0 - 10.0), "fs_s3": under, "fs_s1 in fillet": place}
    found = coarse.errors(fine)
    assert found == {"fs_s1": pytest.approx(10.0 / 290.0)}


def resolved(s1: float, on_mesh: float, region: str = "tooth root") -> RootStress:
    return RootStress(
        s1=s1,
        error=3.0,
        on_mesh=0.0,
        region=region,
        warning="",
        tooth=0,
        radius=59.0,
        z=0.0,
        angle_deg=0.0,
        part=BETWEEN,
        by_part={BETWEEN: (s1,)},
        elements=1,
        in_root=on_mesh,
        drive_error=4.0,
    )


def test_errors_in_roots_are_those_of_the_tension_there() -> None:
    """What nodal averages lose in the roots by the windows is lost by all stresses there."""
    root = Place(
        100.0,
        "flexible_spline",
        "tooth root",
        0,
        59.0,
        0.0,
        0.0,
        "",
        in_root=100.0,
        root_spacing=0.1,
    )
    inside = replace(root, value=110.0, region="rim inside")
    ring = replace(root, body="ring_gear", root_spacing=0.2)
    flank = replace(ring, region="flank", in_root=10.0)
    places = {
        "fs_s1": root,
        "fs_s3_apart": inside,
        "rg_s1": ring,
        "rg_vm": flank,
        "fs_vm": replace(root, warning=AVERAGE),
    }
    shares = dict.fromkeys(places, 0.02)
    lost = (250.0 - 200.0 + 5.0) / 200.0
    found = {
        name: place.error
        for name, place in with_errors(places, shares, resolved(250.0, 200.0)).items()
    }
    assert found["fs_s1"] == pytest.approx(100.0 * lost)
    assert found["fs_s3_apart"] == pytest.approx(
        100.0 * (1.0 + lost) - 110.0
    )  # the root may have the largest one
    assert found["rg_s1"] == pytest.approx(100.0 * 2.0 * lost)  # twice as long elements
    assert found["rg_vm"] == pytest.approx(2.0)
    assert found["fs_vm"] is None
    close = {
        name: place.error
        for name, place in with_errors(places, shares, resolved(201.0, 200.0)).items()
    }
    assert close["fs_s3_apart"] == pytest.approx(2.2)
    unknown = replace(resolved(250.0, 200.0), error=None)  # a single window
    for root_stress in (None, resolved(250.0, 200.0, "rim inside"), unknown):
        errors = with_errors(places, shares, root_stress)
        assert errors["fs_s1"].error is None  # nothing says what nodal averages lose there
        assert errors["rg_vm"].error == pytest.approx(2.0)
    assert with_errors(places, {}, None)["fs_s1"].error is None


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
    assert {region_of(design.geometry, mesh, int(node), False) for node in inside} <= {
        "inside the tooth",
        "tooth end",
    }


def test_roots_are_where_the_region_says_it(cup: tuple[DriveDesign, SectorMesh]) -> None:
    assert regions(cup, root_nodes(cup[0].geometry, cup[1])) == {"tooth root"}


def test_a_start_on_a_coarser_mesh_gives_errors() -> None:
    values = [
        *PLANE,
        "steps.rotation=4",
        "steps.increment=2",
        "steps.start_levels=1",
        "steps.bent_start=true",
    ]
    summary = swgpar.run(
        load_design(DESIGN, values), swgpar.load_mesh("plane_coarse"), plain=True
    ).summary
    errors = {name: place.error for name, place in summary.stresses.places.items()}
    for name, place in summary.stresses.places.items():
        in_root = 2.0 * place.in_root > place.value  # without windows
        assert (errors[name] is None) == bool(place.warning or in_root), name
        assert errors[name] is None or 0.0 < errors[name] < 0.5 * place.value
    for name, error in summary.rotation.mesh_error.items():
        share = errors[name] / summary.stresses.places[name].value
        assert error == pytest.approx(share * summary.rotation.means[name])
