"""Largest stresses of regions from the windows around several teeth and nodal averages."""

from __future__ import annotations

import math
from dataclasses import replace
from math import nan
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from swgpar.analysis.drive_mesh_error import (
    LEAST_FORCE,
    LEAST_IN_RING,
    SAFETY,
    CoarserMesh,
    region_errors,
)
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.flank_pressure.pair_contact import PairContact
from swgpar.largest_stress.convergence import ASSUMED_ORDER, error_of
from swgpar.largest_stress.local_problem import WindowStress
from swgpar.largest_stress.places import OF_REGION, Place
from swgpar.largest_stress.region_stress import (
    ALIKE,
    BESIDE_ROOT,
    CLOSE_IN_ROOT,
    RegionStress,
    WindowReadings,
)
from swgpar.largest_stress.root_stress import BETWEEN, RootStress
from swgpar.meshing import load_recipe
from swgpar.meshing.recipe_counts import coarsened
from swgpar.model.drive_model import DriveModel

ROOT, FLANK = "fs_vm in tooth root", "fs_vm in flank"
RATIO = 2.0
END_OF_ROOT = np.array([-1.0, 20.0])


class Profile:
    """What the readings ask a profile for: the end of the root."""

    root_start = 3.0

    def point(self, s: np.ndarray) -> np.ndarray:
        assert s == [self.root_start]
        return END_OF_ROOT[None]


class Layout:
    """What a place asks a layout for."""

    name = FLEXIBLE_SPLINE
    mesh = SimpleNamespace(n_sectors=20, plane=False, profile=Profile())

    def sector_angle(self, tooth: np.ndarray) -> np.ndarray:
        return np.pi / 10.0 * tooth


class Model:
    """What the readings ask a model for."""

    def __init__(self, model: str = "cup") -> None:
        self.geometry = SimpleNamespace(model=model, module=0.5)

    partition = SimpleNamespace(layouts={FLEXIBLE_SPLINE: Layout()})


def readings(levels: dict[int, list[float]], name: str = ROOT, skipped: int = 0) -> WindowReadings:
    """Windows around teeth."""
    found = WindowReadings(skipped)
    for tooth, values in levels.items():
        for level, value in enumerate(values, skipped):
            found.add(tooth, level, {tooth: {name: window_stress(value, tooth)}})
    return found


def window_stress(value: float, tooth: int) -> WindowStress:
    return WindowStress(value, tooth, np.zeros(3), "", "", 1)


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


def test_two_windows_have_the_order_that_is_taken_where_none_is_seen() -> None:
    one = stress(readings({3: LEVELS[:2]}), nodal(t3=70.0))
    assert one.place.error == pytest.approx((90.0 - 80.0) / (RATIO**ASSUMED_ORDER - 1.0))


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


def test_a_nodal_average_below_the_stress_of_a_window_does_not_replace_it() -> None:
    """Windows around one tooth have a small nodal average beside a contact; elsewhere it is 1.8
    times that, and less than what the windows give."""
    one = stress(readings({3: LEVELS}), nodal(t3=45.0, t9=81.0))
    assert one.place.value == LEVELS[-1] and not one.nodal
    assert one.place.error == pytest.approx(81.0 / CLOSE_IN_ROOT - LEVELS[-1])


def test_the_window_with_the_largest_stress_is_one_of_the_finest() -> None:
    found = readings({3: LEVELS[:2], 9: [150.0]})
    assert found.window_with_largest("fs_vm") == (3, window_stress_of(found, 3))
    found.add(9, 1, {9: {ROOT: window_stress(80.0, 9)}, 10: {ROOT: window_stress(91.0, 10)}})
    assert found.window_with_largest("fs_vm") == (9, window_stress_of(found, 10))


def window_stress_of(found: WindowReadings, tooth: int) -> WindowStress:
    return found.levels[tooth][ROOT][-1]


def test_teeth_that_a_narrow_window_does_not_read_count_in_proportion() -> None:
    found = WindowReadings(0)
    for level, value in enumerate(LEVELS[:2]):
        read = {3: value, 4: 1.1 * value}
        found.add(3, level, {k: {ROOT: window_stress(v, k)} for k, v in read.items()})
    found.add(3, 2, {3: {ROOT: window_stress(LEVELS[2], 3)}})
    one = stress(found, nodal(t3=70.0, t4=70.0))
    assert one.levels == tuple(LEVELS) and one.place.tooth == 4
    assert one.place.value == pytest.approx(1.1 * LEVELS[2])


def test_a_stress_that_finer_windows_do_not_read_changes_as_the_nearest_one() -> None:
    """The ends of teeth have two peaks; the one that falls is at tooth 4 and, less high, at 3."""
    found = WindowReadings(0)
    falls, rises = np.array([1.1, 53.0, 4.1]), np.array([1.3, 52.9, 3.7])

    def read(level: int, *of: tuple[int, float, np.ndarray]) -> None:
        stresses = {k: {ROOT: WindowStress(v, k, at, "", "", 1)} for k, v, at in of}
        found.add(3, level, stresses)

    read(0, (2, 1060.0, rises), (3, 1080.0, falls), (4, 1081.0, falls))
    read(1, (2, 1100.0, rises), (3, 1050.0, falls))
    one = stress(found, nodal())
    assert one.place.tooth == 2 and one.place.value == 1100.0
    # with one peak tooth 4 would be the largest
    found = WindowReadings(0)
    read(0, (2, 1060.0, rises), (3, 1080.0, falls), (4, 1081.0, rises))
    read(1, (2, 1100.0, rises), (3, 1050.0, falls))
    one = stress(found, nodal())
    assert one.place.tooth == 4 and one.place.value == pytest.approx(1081.0 / 1060.0 * 1100.0)


def at(tooth: int, value: float, position: np.ndarray) -> dict[int, dict[str, WindowStress]]:
    return {tooth: {ROOT: WindowStress(value, tooth, position, "", "", 1)}}


def test_the_change_of_a_far_smaller_stress_tells_nothing() -> None:
    """It may double where the largest ones rise by a percent."""
    found, here, there = WindowReadings(0), np.array([1.1, 53.0, 4.1]), np.array([1.3, 52.9, 3.7])
    found.add(3, 0, at(3, 100.0, here) | at(2, 2.0, there) | at(8, 96.0, there))
    found.add(3, 1, at(3, 102.0, here) | at(2, 4.0, there))
    one = stress(found, nodal())
    assert one.place.tooth == 3 and one.place.value == 102.0
    # the largest stress of the finest windows may hardly be there in a coarser one
    found = WindowReadings(0)
    found.add(3, 0, at(3, 0.001, here) | at(8, 10.0, there))
    found.add(3, 1, at(3, 50.0, here))
    one = stress(found, nodal())
    assert one.place.tooth == 3 and one.place.value == 50.0


def test_a_stress_is_where_its_own_tooth_has_it() -> None:
    """The ends of teeth have several peaks."""
    found, here, there = WindowReadings(0), np.array([1.1, 53.0, 4.1]), np.array([1.3, 52.9, 3.7])
    found.add(3, 0, at(3, 100.0, here) | at(8, 105.0, there))
    found.add(3, 1, at(3, 102.0, here))
    one = stress(found, nodal())
    assert one.place.tooth == 8 and one.place.z == 3.7


def test_of_two_windows_that_read_a_tooth_the_larger_stress_counts() -> None:
    found = WindowReadings(0)
    for middle, value in ((3, 80.0), (5, 84.0), (4, 82.0)):
        found.add(middle, 0, {4: {ROOT: window_stress(value, 4)}})
    assert [one.value for one in found.levels[4][ROOT]] == [84.0]


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


@pytest.mark.parametrize(
    ("distance", "side", "beside"), [(0.9, 1.0, True), (0.9, -1.0, True), (1.1, 1.0, False)]
)
def test_a_flank_beside_its_root_has_the_errors_of_the_root(
    distance: float, side: float, beside: bool
) -> None:
    """Coarser windows have no node between the root and the contact. The end of the root is at most
    the root's largest."""
    flank, at_root = [1.0, 2.0, 93.0], [side * END_OF_ROOT[0], END_OF_ROOT[1], 0.3]
    position = np.array(at_root) + [0.0, distance * BESIDE_ROOT * 0.5, 0.0]
    found = WindowReadings(0)
    for level, (in_root, on_flank) in enumerate(zip(LEVELS, flank, strict=True)):
        places = {ROOT: (in_root, np.zeros(3)), FLANK: (on_flank, position)}
        read = {name: WindowStress(v, 3, at, "", "", 1) for name, (v, at) in places.items()}
        found.add(3, level, {3: read})
    model = cast(DriveModel, Model("plane"))
    one = found.stresses(model, FLEXIBLE_SPLINE, {}, RATIO)[FLANK]
    of_root = error_of(LEVELS, RATIO) + LEVELS[-1] - 93.0
    expected = of_root if beside else error_of(flank, RATIO)
    assert one.place.value == 93.0
    assert one.place.error == pytest.approx(expected)


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
    coarser = CoarserMesh(coarse_recipe, root.by_part, regions={ROOT: coarse})
    found = region_errors(coarser, fine_recipe, root, 0.001, (), 20)[ROOT]
    assert found.drive_error is not None
    share = found.drive_error / 94.0
    # of second order, by the smallest ratio of counts: four elements along the root over three
    assert share == pytest.approx(SAFETY * (5.0 / 90.0) / ((4 / 3) ** 2 - 1.0))
    assert region_errors(coarser, fine_recipe, root, 0.5, (), 20)[ROOT].drive_error == 47.0
    unknown = replace(coarser, regions={})
    assert region_errors(unknown, fine_recipe, root, 0.5, (), 20)[ROOT].drive_error is None
    assert region_errors(None, fine_recipe, root, 0.5, (), 20)[ROOT].resolved.error is None


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
    coarser = CoarserMesh(coarsened(fine), {}, [pair(0)], regions)
    found = region_errors(coarser, fine, rooted(regions), 0.004, [pair(0)], 20)
    assert found["rg_s1 in rim"].drive_error == pytest.approx(LEAST_IN_RING[model] * 50.0)
    # forces have errors that no mesh shows
    root = LEAST_FORCE["plane"] if model == "plane" else LEAST_IN_RING[model]
    assert found["rg_s1 in tooth root"].drive_error == pytest.approx(root * 50.0)
    assert found["fs_s1 in tip"].drive_error == pytest.approx(0.004 * 100.0)
    assert found["fs_s1 in tooth root"].drive_error == pytest.approx(0.004 * 100.0)


def test_a_contact_on_an_edge_leaves_no_estimate_in_the_tips() -> None:
    names = "rg_vm in tip", "rg_vm in tooth root", "fs_vm in tip"
    regions = {name: region(name, 50.0) for name in names}
    fine = load_recipe("plane_coarse")
    coarser = CoarserMesh(coarsened(fine), {}, regions=regions)
    found = region_errors(coarser, fine, rooted(regions), 0.02, [pair(0), pair(1)], 20)
    without = {name for name, one in found.items() if one.resolved.error is None}
    assert without == {"rg_vm in tip", "fs_vm in tip"}


@pytest.mark.parametrize(
    ("tooth", "change"),
    [(0, math.hypot(1.0, 2.0) / 15.0), (19, math.hypot(1.0, 0.8) / 10.9), (3, 0.4), (10, 0.0)],
)
def test_the_ring_gear_is_as_uncertain_as_the_forces_beside_the_stress(
    tooth: int, change: float
) -> None:
    """Those on the tooth and on the teeth beside it, of 20 in a closed chain."""
    name = "rg_s1 in tooth root"
    known = region(name, 50.0)
    regions = {name: replace(known, place=replace(known.place, tooth=tooth))}
    fine = load_recipe("plane_fine")
    coarse = coarsened(fine)
    # errors of the pairs beside the stress are independent, and count by the sum of their forces
    before = [pair(0, 9.0), pair(0, 3.0, 1), pair(0, 0.1, 18), pair(0, 7.0, 4)]
    coarser = CoarserMesh(coarse, {}, before, regions)
    after = [pair(0, 10.0), pair(0, 5.0, 1), pair(0, 0.9, 18), pair(0, 5.0, 4)]
    found = region_errors(coarser, fine, rooted(regions), 0.004, after, 20)[name]
    expected = max(SAFETY * change / (1.5**2 - 1.0), LEAST_FORCE["plane"])
    assert found.drive_error == pytest.approx(50.0 * expected)


def test_stresses_of_the_ring_gear_follow_the_counts_of_the_contact() -> None:
    """Root and rim of the flexible spline, of which four elements become three, are no part of
    it."""
    name = "rg_s1 in tooth root"
    fine = load_recipe("forces")
    coarser = CoarserMesh(coarsened(fine), {}, [pair(0)], {name: region(name, 20.0)})
    regions = {name: region(name, 50.0)}
    found = region_errors(coarser, fine, rooted(regions), 0.004, [pair(0)], 20)[name]
    assert found.drive_error == pytest.approx(SAFETY * 30.0 / (1.5**2 - 1.0))
