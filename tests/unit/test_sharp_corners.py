"""Corners without a radius: exponents of their stress, where they are, and how far it reaches."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import swgpar
from support.cup_shapes import DIAPHRAGM, DISHED, shaped
from support.paths import DRIVERS, REFERENCE
from swgpar.meshing import load_recipe
from swgpar.meshing.tooth_sector import build_sector
from swgpar.meshing.wall_sector import WallCounts, wall_sector
from swgpar.model.regions import CORNER, NO_RADIUS, regions_of, warning_of
from swgpar.model.sharp_corners import (
    REACH,
    SharpCorner,
    reach_of,
    sharp_corners,
    singular_exponent,
)

STEP = ["cup.contour=[{distance=8, thickness=0.8}, {distance=8.5, thickness=0.5}]"]
"""A wall that becomes thinner outside: at the second point its surface is concave."""

ROUNDED_BACK = "cup.back_fillet=0.15"


def wall_corners(overrides: list[str]) -> list[SharpCorner]:
    geometry = swgpar.load_design(REFERENCE, overrides).geometry
    return list(sharp_corners(geometry, "flexible_spline"))


def test_exponents_are_those_of_williams() -> None:
    """Values of the table of his paper's equation: 0.5445 at a right corner, 0.5 at a crack."""
    known = {30.0: 0.7520, 45.0: 0.6736, 60.0: 0.6157, 90.0: 0.5445, 120.0: 0.5122, 179.9: 0.5}
    for degrees, exponent in known.items():
        assert singular_exponent(np.radians(degrees)) == pytest.approx(exponent, abs=1e-4)


def test_the_reach_is_where_the_stress_is_raised_alike() -> None:
    raised = REACH ** (singular_exponent(0.5 * np.pi) - 1.0)
    for degrees in (20.0, 45.0, 90.0, 120.0):
        turn = np.radians(degrees)
        share = reach_of(turn, 1.0)
        assert share ** (singular_exponent(turn) - 1.0) == pytest.approx(raised)
        assert reach_of(turn, 3.0) == pytest.approx(3.0 * share)
    assert reach_of(0.5 * np.pi, 1.0) == REACH
    # convex corners have none, and one of 5 degrees is not felt
    assert (
        reach_of(-0.5 * np.pi, 1.0) == reach_of(0.0, 1.0) == reach_of(np.radians(5.0), 1.0) == 0.0
    )


def test_corners_of_the_wall_are_those_that_nothing_rounds() -> None:
    design = swgpar.load_design(REFERENCE)
    [notch] = wall_corners([])
    radius = design.inner_radius + design.cup_sizes.thickness
    assert notch.at == pytest.approx((radius, 0.5 * design.drive.face_width))
    assert notch.reach == pytest.approx(REACH * design.cup_sizes.thickness)
    assert wall_corners([ROUNDED_BACK]) == []
    [corner] = wall_corners([*STEP, ROUNDED_BACK])
    assert corner.at == pytest.approx((design.inner_radius + 0.5, 5.0 + 8.5))
    slope = np.arctan(0.3 / 0.5)
    assert corner.reach == pytest.approx(reach_of(slope, 0.5))
    rounded = STEP[0].replace("0.5}", "0.5, rounding=0.1}")
    assert wall_corners([rounded, ROUNDED_BACK]) == []


@pytest.mark.parametrize("name", ["plane_half_turn", "three_lobes"])
def test_generated_teeth_have_no_corners(name: str) -> None:
    geometry = swgpar.load_design(DRIVERS / f"{name}.toml").geometry
    assert all(
        corner.of_tooth is False
        for body in geometry.gears
        for corner in sharp_corners(geometry, body)
    )


def test_teeth_have_corners_where_their_segments_join_with_an_angle() -> None:
    geometry = swgpar.load_design(DRIVERS / "plane_half_turn.toml").geometry
    gear = geometry.gears["flexible_spline"]
    last = gear.profile.segments[-1]
    bent = replace(last, direction=last.direction + 0.5)  # turns outwards: concave
    profile = replace(gear.profile, segments=(*gear.profile.segments[:-1], bent))
    gears = {**geometry.gears, "flexible_spline": replace(gear, profile=profile)}
    found = sharp_corners(replace(geometry, gears=gears), "flexible_spline")
    assert found and all(corner.of_tooth for corner in found)
    assert found[0].at == pytest.approx(tuple(gear.profile.point(gear.profile.root_start)[0]))
    mirrored = np.array([[-found[0].at[0], found[0].at[1], 3.0]])
    assert found[0].near(mirrored).all()


def test_nodes_within_the_reach_are_in_a_region_of_their_own() -> None:
    geometry = swgpar.load_design(REFERENCE, [*STEP, ROUNDED_BACK]).geometry
    [corner] = sharp_corners(geometry, "flexible_spline")
    mesh = wall_sector(geometry, WallCounts(8, 4), 0.15).mesh
    found = regions_of(geometry, mesh, np.arange(len(mesh.coords)), False)
    near = corner.near(mesh.coords)
    assert near.any() and set(found[near]) == {CORNER} and CORNER not in set(found[~near])
    text = warning_of(geometry, CORNER, mesh.coords[np.flatnonzero(near)[0]])
    assert corner.text in text and text.endswith(NO_RADIUS)


def test_the_corner_behind_the_teeth_reaches_into_the_wall_alone() -> None:
    """The edges of the roots above it are in its shadow."""
    geometry = swgpar.load_design(REFERENCE).geometry
    [corner] = sharp_corners(geometry, "flexible_spline")
    mesh = build_sector(geometry, load_recipe("coarse"), "flexible_spline")
    z = mesh.coords[:, 2]
    ends = [int(grid.nodes[-1, -1]) for grid in mesh.flanks]  # of the roots, above the corner
    node = int(np.flatnonzero(z > corner.at[1] + corner.reach)[0])
    points = mesh.coords.copy()
    for near, away, expected in ((0.1, 0.2, CORNER), (0.1, 0.5, "cup wall")):
        points[node] = (0.0, corner.at[0] - near, corner.at[1] + away)
        moved = replace(mesh, coords=points)
        assert regions_of(geometry, moved, [node], False)[0] == expected
    assert corner.near(mesh.coords[ends]).all()
    assert CORNER not in set(regions_of(geometry, mesh, ends, False))


def test_corners_of_closed_ends_are_those_on_the_concave_sides() -> None:
    """A cone between two rings: the face towards the teeth is concave where it begins, the far one
    where it ends."""
    found = sharp_corners(shaped(DISHED | {"back_fillet": 0.1}).geometry, "flexible_spline")
    expected = np.array([[11.0, 11.5], [12.337, 13.5]])
    assert np.array([corner.at for corner in found]) == pytest.approx(expected)
    rounded = [{**point, "rounding": 0.2} for point in DISHED["end_contour"]]
    changes = DISHED | {"back_fillet": 0.1, "end_contour": rounded}
    assert not sharp_corners(shaped(changes).geometry, "flexible_spline")
    assert not sharp_corners(shaped(DIAPHRAGM | {"back_fillet": 0.1}).geometry, "flexible_spline")


@pytest.mark.parametrize(("thickness", "corners"), [(3.0, [[17.08, 13.52]]), (0.9, []), (0.1, [])])
def test_an_end_that_grows_from_its_fillet_on_has_a_corner_there(
    thickness: float, corners: list[list[float]]
) -> None:
    """By 12.8 degrees; by 2 none is felt, and a thinner one is convex."""
    end = {"end_contour": [{"radius": 6.0, "thickness": thickness}], "back_fillet": 0.1}
    found = sharp_corners(shaped(end).geometry, "flexible_spline")
    assert [corner.at for corner in found] == [pytest.approx(at) for at in corners]
