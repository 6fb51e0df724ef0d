"""Stresses on the surface of teeth beside a contact."""

from __future__ import annotations

import numpy as np
import pytest

import swgpar
from support.paths import DRIVERS
from swgpar.fem.body import FLEXIBLE_SPLINE, RING_GEAR
from swgpar.flank_pressure.flank_loads import tributary
from swgpar.flank_pressure.pressed_cells import PressedCells
from swgpar.geometry.rotation import rotated
from swgpar.largest_stress.local_problem import window_sector
from swgpar.largest_stress.places import APART_DISTANCE, TOUCHED
from swgpar.largest_stress.surface_stress import BesideContact, surface_mises
from swgpar.largest_stress.window_loads import WindowLoads
from swgpar.largest_stress.window_recipes import window_recipe
from swgpar.meshing.sector import SectorMesh

COUNT = 3


def sector(level: int, gear: str = RING_GEAR) -> SectorMesh:
    design = swgpar.load_design(DRIVERS / "plane_half_turn.toml")
    return window_sector(design.geometry, window_recipe("plane", level), gear)


def cells(mesh: SectorMesh, share: float) -> dict[tuple[int, int], PressedCells]:
    """One cell on the clockwise flank of the middle tooth, at this share of its length."""
    low = np.array([share * mesh.profile.length])
    return {(1, 1): PressedCells(low, low + 0.005, np.array([1.0]))}


def distances(mesh: SectorMesh, share: float) -> np.ndarray:
    """Distances (COUNT, n_node) mm of nodes from both ends of that cell."""
    ends = cells(mesh, share)[1, 1].ends
    x, y = mesh.profile.point(ends).T
    points = np.column_stack([x, y, 0.0 * x])
    turned = np.array([rotated(mesh.coords, np.array((k - 1) * mesh.pitch)) for k in range(COUNT)])
    return np.linalg.norm((turned[:, :, None] - points)[..., :2], axis=-1).min(axis=-1)


@pytest.mark.parametrize("level", [0, 1, 2])
@pytest.mark.parametrize(("share", "distance"), [(0.5, 0.12), (0.8, 0.12), (0.99, 0.3)])
def test_a_stress_is_read_as_far_as_the_distance_on_any_mesh(
    level: int, share: float, distance: float
) -> None:
    """One that falls with the distance from the contact, also on the tooth beside it."""
    mesh = sector(level)
    far = distances(mesh, share)
    loaded = np.zeros(far.shape, dtype=bool)
    beside = BesideContact.of_cells(mesh, COUNT, cells(mesh, share), distance, loaded)
    read = beside.read(-far, np.arange(COUNT))
    surface = np.unique(mesh.surface_edges)
    assert read[:, surface].max() == pytest.approx(-distance)
    assert np.where(beside.near, -np.inf, -far)[:, surface].max() < -1.005 * distance
    # the node between two teeth is near in both, or in none
    ccw, cw = mesh.ccw_nodes, mesh.cw_nodes
    assert np.array_equal(beside.near[:-1, ccw], beside.near[1:, cw])
    assert beside.near[::2].any() == (share > 0.9)
    # a node with a force has the stress of the contact
    loaded[beside.sector, beside.within] = True
    nodes_alone = BesideContact.of_cells(mesh, COUNT, cells(mesh, share), distance, loaded)
    assert nodes_alone.read(-far, np.arange(COUNT))[:, surface].max() < -1.005 * distance


@pytest.mark.parametrize("gear", [FLEXIBLE_SPLINE, RING_GEAR])
def test_the_surface_is_that_of_tooth_and_root(gear: str) -> None:
    """From cut to cut, with the land between two root arcs."""
    mesh = sector(1, gear)
    edges = mesh.surface_edges
    nodes, times = np.unique(edges, return_counts=True)
    on_cuts = np.isin(nodes, [mesh.ccw_nodes, mesh.cw_nodes])
    assert sorted(times[on_cuts]) == [1, 1] and set(times[~on_cuts]) == {2}
    assert {node for grid in mesh.flanks for node in grid.nodes[:, 0]} < set(nodes)
    radius = np.hypot(*mesh.coords[nodes, :2].T)
    roots = mesh.profile.r_root_circle, mesh.profile.r_tip_circle
    assert min(roots) - 1e-9 < radius.min() and radius.max() < max(roots) + 1e-9


def test_a_surface_without_a_load_has_no_stress_across_it() -> None:
    stress = np.array([100.0, 8.0]), np.array([-8.0, -100.0]), np.array([104.2, 104.2])
    assert surface_mises(*stress, np.array([True, True])).tolist() == [100.0, 100.0]
    assert surface_mises(*stress, np.array([False, False])).tolist() == [104.2, 104.2]


@pytest.fixture(scope="module")
def cup() -> tuple[float, SectorMesh]:
    """Module (mm) of a cup drive, and the sector of its ring gear in a window."""
    design = swgpar.load_design(DRIVERS / "cup_45deg.toml")
    return design.drive.module, window_sector(design.geometry, window_recipe("cup", 1), RING_GEAR)


def near_in_a_cup(module: float, mesh: SectorMesh, forces: np.ndarray) -> np.ndarray:
    """Stations (n_z,) bool in the middle of a flank that are not read, with forces (n_z,) N
    there."""
    grid, along = mesh.flanks[0], len(mesh.flanks[0].s) // 2
    nodal = np.zeros((*grid.nodes.shape, 3))
    nodal[along, :, 0] = forces
    loads = WindowLoads(mesh, 1, {(0, grid.side): nodal.reshape(-1, 3)}, {})
    return loads.beside(module).near[0, grid.nodes[along]]


def test_the_stations_beside_a_loaded_one_are_not_read_in_a_cup(
    cup: tuple[float, SectorMesh],
) -> None:
    """A contact may be shorter than the elements along the face width."""
    module, mesh = cup
    z = mesh.flanks[0].z
    station, forces = len(z) // 2, np.zeros(len(z))
    forces[station] = 1.0
    near = near_in_a_cup(module, mesh, forces)
    reach, length = np.abs(np.arange(len(z)) - station), np.abs(z - z[station])
    assert near[reach <= 1].all()
    beyond = length > np.max(length[reach == 1]) + APART_DISTANCE * module
    assert beyond.any() and not near[beyond].any()


def test_a_small_force_on_short_elements_is_a_load_in_a_cup(cup: tuple[float, SectorMesh]) -> None:
    """Elements are shortest at the ends of the face width. A load of 3 % of the largest one has
    less than 2 % of its force there."""
    module, mesh = cup
    lengths = tributary(mesh.flanks[0].z)
    middle, forces = len(lengths) // 2, np.zeros(len(lengths))
    forces[middle], forces[0] = lengths[middle], 0.03 * lengths[0]
    assert forces[0] < TOUCHED * forces.max()
    assert near_in_a_cup(module, mesh, forces)[0]
