"""Largest stresses of regions from the windows around several teeth and nodal averages."""

from __future__ import annotations

from dataclasses import replace
from math import nan
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from swgpar.analysis.drive_mesh_error import LEAST_IN_RING, SAFETY, CoarserMesh, region_errors
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.flank_pressure.pair_contact import PairContact
from swgpar.largest_stress.convergence import error_of
from swgpar.largest_stress.local_problem import WindowStress
from swgpar.largest_stress.places import OF_REGION, Place
from swgpar.largest_stress.region_stress import ALIKE, CLOSE_IN_ROOT, RegionStress, WindowReadings
from swgpar.largest_stress.root_stress import BETWEEN, RootStress
from swgpar.meshing import load_recipe
from swgpar.meshing.recipe_counts import coarsened
from swgpar.model.drive_model import DriveModel

ROOT, FLANK = "fs_vm in tooth root", "fs_vm in flank"
RATIO = 2.0


class Layout:
    """What a place asks a layout for."""

    name = FLEXIBLE_SPLINE
    mesh = SimpleNamespace(n_sectors=20, plane=False)

    def sector_angle(self, tooth: np.ndarray) -> np.ndarray:
        return np.pi / 10.0 * tooth


class Model:
    """What the readings ask a model for."""

    class Geometry:
        model = "cup"

    geometry = Geometry()
    partition = SimpleNamespace(layouts={FLEXIBLE_SPLINE: Layout()})


def readings(levels: dict[int, list[float]], name: str = ROOT, skipped: int = 0) -> WindowReadings:
    """Windows around teeth."""
    found = WindowReadings(skipped)
    for tooth, values in levels.items():
        for value in values:
            found.add(tooth, {name: WindowStress(value, tooth, np.zeros(3), "", "", 1)})
    return found


def stress(found: WindowReadings, nodal: np.ndarray, name: str = ROOT) -> RegionStress:
    return found.stresses(cast(DriveModel, Model()), FLEXIBLE_SPLINE, {name: nodal}, RATIO)[name]


def nodal(**values: float) -> np.ndarray:
    """20 sectors with 10 MPa, others by number."""
    found = np.full(20, 10.0)
    for tooth, value in values.items():
        found[int(tooth[1:])] = value
    return found


LEVELS = [80.0, 90.0, 94.0]


def test_the_stress_is_that_of_the_finest_window() -> None:
    one = stress(readings({3: LEVELS}), nodal(t3=70.0))
    assert one.levels == tuple(LEVELS) and one.spread == 1.0
    assert one.place.value == 94.0 and one.place.tooth == 3
    assert one.place.error == pytest.approx(error_of(LEVELS, RATIO))


def test_two_windows_are_taken_to_be_of_first_order() -> None:
    one = stress(readings({3: LEVELS[:2]}), nodal(t3=70.0))
    assert one.place.error == pytest.approx((90.0 - 80.0) / (RATIO - 1.0))


def test_a_window_that_was_not_followed_counts_in_proportion() -> None:
    one = stress(readings({3: LEVELS, 9: [84.0]}), nodal(t3=70.0, t9=72.0))
    assert one.spread == pytest.approx(84.0 / 80.0) and one.place.tooth == 9
    assert one.place.value == pytest.approx(94.0 * 84.0 / 80.0)
    beyond = one.spread * error_of(LEVELS, RATIO) + (one.spread - 1.0) * (94.0 - 70.0)
    assert one.place.error == pytest.approx(beyond)


def test_a_window_that_is_loaded_in_another_way_stands_for_itself() -> None:
    one = stress(readings({3: LEVELS, 9: [150.0, 160.0]}), nodal(t3=70.0, t9=140.0))
    assert one.levels == (150.0, 160.0) and one.place.tooth == 9 and one.spread == 1.0
    assert one.tops == (150.0, 160.0, 94.0)


def test_the_tooth_with_the_largest_stress_is_one_of_the_finest_windows() -> None:
    found = readings({3: LEVELS[:2], 9: [150.0]})
    assert found.tooth_with_largest("fs_vm") == 3
    found.add(9, {ROOT: WindowStress(91.0, 9, np.zeros(3), "", "", 1)})
    assert found.tooth_with_largest("fs_vm") == 9


def test_a_tooth_without_a_window_has_the_stress_in_proportion() -> None:
    one = stress(readings({3: LEVELS}), nodal(t3=70.0, t9=77.0))
    assert one.place.value == pytest.approx(1.1 * 94.0) and one.place.tooth == 9
    assert one.place.error == pytest.approx(1.1 * error_of(LEVELS, RATIO) + 0.1 * (94.0 - 70.0))


def test_a_tooth_that_is_loaded_in_another_way_has_its_nodal_average() -> None:
    beyond = 1.01 * ALIKE * 70.0
    one = stress(readings({3: LEVELS}), nodal(t3=70.0, t9=beyond))
    assert one.nodal and one.place.value == beyond and one.place.tooth == 9
    assert one.place.error == pytest.approx(beyond * (1.0 / CLOSE_IN_ROOT - 1.0))


def test_flanks_of_cups_are_the_same_in_all_windows() -> None:
    one = stress(readings({3: LEVELS}, FLANK), nodal(t3=70.0), FLANK)
    assert one.place.value == 94.0 and one.place.error is None


def rooted(regions: dict[str, RegionStress]) -> RootStress:
    return RootStress(
        s1=100.0,
        error=None,
        on_mesh=0.0,
        region="tooth root",
        tooth=0,
        radius=59.0,
        z=0.0,
        angle_deg=0.0,
        part=BETWEEN,
        by_part={BETWEEN: (nan, 100.0)},
        elements=1,
        regions=regions,
    )


def test_the_error_by_the_drive_is_that_of_the_compared_window() -> None:
    fine_recipe = load_recipe("forces")
    coarse_recipe = coarsened(fine_recipe)
    coarse = stress(readings({3: [85.0]}, skipped=1), nodal(t3=60.0))
    assert coarse.levels[1:] == (85.0,) and np.isnan(coarse.levels[0])
    fine = stress(readings({3: LEVELS}), nodal(t3=70.0))
    root = rooted({ROOT: fine})
    meshes = [CoarserMesh(coarse_recipe, root.by_part, regions={ROOT: coarse})]
    found = region_errors(meshes, fine_recipe, root, 0.001, ())[ROOT]
    assert found.drive_error is not None
    share = found.drive_error / 94.0
    # of second order, by the smallest ratio of counts: four elements along the root over three
    assert share == pytest.approx(SAFETY * (5.0 / 90.0) / ((4 / 3) ** 2 - 1.0))
    assert region_errors(meshes, fine_recipe, root, 0.5, ())[ROOT].drive_error == 47.0
    unknown = [replace(meshes[0], regions={})]
    assert region_errors(unknown, fine_recipe, root, 0.5, ())[ROOT].drive_error is None
    assert region_errors([], fine_recipe, root, 0.5, ())[ROOT].resolved.error is None


def region(name: str, value: float) -> RegionStress:
    kind, _, where = name.partition(OF_REGION)
    body = FLEXIBLE_SPLINE if kind.startswith("fs") else "ring_gear"
    place = Place(value, body, where, 0, 20.0, 0.0, 0.0, "", error=0.0)
    return RegionStress((value,), (value,), 1.0, place)


def pair(edge: int, force: float = 10.0, tooth: int = 0) -> PairContact:
    return PairContact(tooth, "clockwise", tooth, 0.0, force, 1.0, 0.0, edge=edge)


@pytest.mark.parametrize(("model", "mesh"), [("plane", "plane_coarse"), ("cup", "forces")])
def test_small_stresses_are_as_uncertain_as_the_largest_one_of_their_body(
    model: str, mesh: str
) -> None:
    """Elements in the ring gear's rim, of which there is one, change all of its stresses."""
    values = {"rg_s1 in tooth root": 50.0, "rg_s1 in rim": 2.0, "fs_s1 in tip": 1.0}
    regions = {name: region(name, value) for name, value in values.items()}
    regions |= {"fs_s1 in tooth root": region("fs_s1 in tooth root", 100.0)}
    # what lies under a contact has no limit and is no measure
    regions |= {"fs_s1 in flank under contact": region("fs_s1 in flank under contact", 900.0)}
    fine = load_recipe(mesh)
    meshes = [CoarserMesh(coarsened(fine), {}, [pair(0)], regions)]
    found = region_errors(meshes, fine, rooted(regions), 0.004, [pair(0)])
    assert found["rg_s1 in rim"].drive_error == pytest.approx(LEAST_IN_RING[model] * 50.0)
    root = 0.004 if model == "plane" else LEAST_IN_RING[model]
    assert found["rg_s1 in tooth root"].drive_error == pytest.approx(root * 50.0)
    assert found["fs_s1 in tip"].drive_error == pytest.approx(0.004 * 100.0)


def test_a_contact_on_an_edge_leaves_no_estimate_in_the_tips() -> None:
    names = "rg_vm in tip", "rg_vm in tooth root", "fs_vm in tip"
    regions = {name: region(name, 50.0) for name in names}
    fine = load_recipe("plane_coarse")
    meshes = [CoarserMesh(coarsened(fine), {}, regions=regions)]
    found = region_errors(meshes, fine, rooted(regions), 0.02, [pair(0), pair(1)])
    without = {name for name, one in found.items() if one.resolved.error is None}
    assert without == {"rg_vm in tip", "fs_vm in tip"}


def test_the_ring_gear_is_as_uncertain_as_the_forces_of_its_pairs() -> None:
    regions = {"rg_s1 in tooth root": region("rg_s1 in tooth root", 50.0)}
    fine = load_recipe("plane_fine")
    coarse = coarsened(fine)
    # the third pair carries too little
    before = [pair(0, 9.0), pair(0, 4.0, 1), pair(0, 0.1, 2)]
    meshes = [CoarserMesh(coarse, {}, before, regions)]
    after = [pair(0, 10.0), pair(0, 5.0, 1), pair(0, 0.9, 2)]
    found = region_errors(meshes, fine, rooted(regions), 0.004, after)["rg_s1 in tooth root"]
    assert found.drive_error == pytest.approx(50.0 * SAFETY * 0.2 / (1.5**2 - 1.0))
