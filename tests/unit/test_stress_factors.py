"""Factors of windows on nodal averages, and the largest stress of all regions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import pytest

from swgpar.answers.answer import NO_LIMIT
from swgpar.evaluation.stress_factors import stress_factors
from swgpar.largest_stress.places import ROLLER, LargestStresses, Place
from swgpar.largest_stress.region_stress import RegionStress
from swgpar.largest_stress.resolved_places import with_windows
from swgpar.largest_stress.root_stress import BETWEEN, RootStress
from swgpar.largest_stress.wall_stress import WallStress
from swgpar.model.regions import AVERAGE, NOTCH


def place(
    value: float, region: str, error: float | None = None, body: str = "flexible_spline"
) -> Place:
    return Place(value, body, region, 0, 20.0, 5.0, 0.0, "", error=error)


NODAL = {
    "fs_s1": place(500.0, "tooth root"),
    "fs_vm": place(450.0, "tooth root"),
    "fs_vm_apart": place(450.0, "tooth root"),
    "fs_s1 in tooth root": place(500.0, "tooth root"),
    "fs_s1 in fillet": place(300.0, "fillet"),
    "fs_s1 in cup wall": place(250.0, "cup wall"),
    "fs_vm in tooth root": place(450.0, "tooth root"),
    "fs_vm in flank under contact": replace(place(200.0, "flank under contact"), warning=AVERAGE),
}
LOADED = {name: one.value for name, one in NODAL.items()} | {"fs_s1 in fillet": 240.0}


def wall(fillet: float, error: float | None = 30.0) -> WallStress:
    places = {
        "fs_s1 in fillet": place(fillet, "fillet", error),
        "fs_vm in fillet": place(0.9 * fillet, "fillet", error),
        "fs_s1 in cup wall": place(200.0, "cup wall", error),
    }
    return WallStress(places, {}, {})


def root(s1: float, regions: Mapping[str, Place] | None = None) -> RootStress:
    """Windows whose root has `s1` ± 5 MPa, and the regions with no further error by the drive."""
    return RootStress(
        s1=s1,
        error=3.0,
        on_mesh=500.0,
        region="tooth root",
        tooth=0,
        radius=59.0,
        z=0.0,
        angle_deg=0.0,
        part=BETWEEN,
        by_part={BETWEEN: (s1,)},
        elements=1,
        drive_error=4.0,
        regions={
            name: RegionStress((one.value,), (one.value,), 1.0, one, drive_error=0.0)
            for name, one in (regions or {}).items()
        },
    )


def test_factors_of_the_wall_are_those_of_the_largest_tension() -> None:
    found = stress_factors(None, wall(600.0), LOADED)
    assert set(found) == {"fillet", "cup wall"}
    assert found["fillet"].factor == pytest.approx(600.0 / 240.0)
    assert found["fillet"].error == pytest.approx(30.0 / 240.0)
    assert found["fillet"].mises is None  # no nodal average of it is known
    assert found["cup wall"].factor == 1.0
    assert stress_factors(None, wall(600.0, None), LOADED)["fillet"].error is None
    assert stress_factors(None, wall(600.0), {}) == {} == stress_factors(None, None, LOADED)


def test_factors_of_the_teeth_are_those_of_their_windows() -> None:
    regions = {"fs_s1 in tooth root": place(600.0, "tooth root", 9.0)}
    regions["fs_s1 in cup wall"] = place(275.0, "cup wall", 10.0)
    regions["fs_s1 in flank"] = place(275.0, "flank", 10.0)
    regions["fs_vm in tooth root"] = place(585.0, "tooth root", 9.0)
    found = stress_factors(root(600.0, regions), None, LOADED | {"fs_s1 in flank": 100.0})
    assert set(found) == {"tooth root", "cup wall"}  # flanks are pressed on
    assert found["tooth root"].factor == pytest.approx(600.0 / 500.0)
    assert found["tooth root"].error == pytest.approx(5.0 / 500.0)
    assert found["tooth root"].mises == pytest.approx(585.0 / 450.0)
    assert found["cup wall"].factor == pytest.approx(275.0 / 250.0)


def test_the_largest_stress_is_that_of_the_largest_region() -> None:
    found = with_windows(NODAL, LOADED, None, wall(600.0))
    # at another angle the nodal average of the fillet is larger by a quarter
    assert found["fs_s1"].region == "fillet" and found["fs_s1"].value == pytest.approx(750.0)
    assert found["fs_s1"].on_mesh == 500.0
    assert found["fs_s1"].error is None  # the root may have twice its nodal average
    assert found["fs_s1 in fillet"].on_mesh == 300.0
    # in proportion, and a quarter of what nodal averages do not show of the loaded state
    assert found["fs_s1 in fillet"].error == pytest.approx(37.5 + 0.25 * (600.0 - 240.0))
    both = with_windows(NODAL, LOADED, root(600.0), wall(600.0))["fs_s1"]
    assert both.value == pytest.approx(750.0) and both.error == pytest.approx(127.5)


def test_nodal_averages_have_no_error() -> None:
    assert with_windows(NODAL, LOADED, None, None) == NODAL
    assert all(one.error is None for one in NODAL.values())


def test_the_error_reaches_as_far_as_another_region_may() -> None:
    close = with_windows(NODAL, LOADED, root(500.0), wall(392.0, 40.0))["fs_s1"]
    assert close.region == "tooth root" and close.error == pytest.approx(490.0 + 88.0 - 500.0)
    unknown = with_windows(NODAL, LOADED, root(500.0), wall(300.0, None))["fs_s1"]
    assert unknown.region == "tooth root" and unknown.error is None


def test_below_a_contact_nothing_is_known() -> None:
    regions = {"fs_vm in tooth root": place(480.0, "tooth root", 12.0)}
    found = with_windows(NODAL, LOADED, root(600.0, regions), wall(10.0))
    assert found["fs_vm"].value == found["fs_vm_apart"].value == 480.0
    assert found["fs_vm"].error is None and found["fs_vm_apart"].error == 12.0
    assert found["fs_vm in flank under contact"].warning == AVERAGE


def test_a_place_without_a_limit_stays_where_it_is_the_largest() -> None:
    name, regions = "fs_s1 in tooth root", {"fs_s1 in tooth end": place(480.0, "tooth end", 9.0)}
    end = "fs_s1 in tooth end"
    for value, kept in ((490.0, True), (400.0, False)):
        nodal = NODAL | {end: replace(place(value, "tooth end"), warning=NOTCH)}
        found = with_windows(nodal, LOADED | {end: value}, root(600.0, regions), None)
        assert (found[end].warning == NOTCH) == kept and found[name].value == 600.0
    nodal = NODAL | {end: replace(place(1.0, "tooth end"), warning=ROLLER)}
    assert with_windows(nodal, LOADED, root(600.0, regions), None)[end].warning == ROLLER


def test_windows_of_the_teeth_see_the_beginning_of_the_wall_only() -> None:
    """Without rings the nodal average of the rest may be the largest of the wall."""
    for value, expected in ((240.0, 250.0), (260.0, 260.0)):
        regions = {"fs_s1 in cup wall": place(value, "cup wall", 9.0)}
        found = with_windows(NODAL, LOADED, root(600.0, regions), None)["fs_s1 in cup wall"]
        assert found.value == expected and found.error is None
    beside = with_windows(NODAL, LOADED, root(600.0, regions), wall(10.0))["fs_s1 in cup wall"]
    assert beside.value == 260.0 and beside.error == 9.0


def test_off_corners_the_largest_stress_has_its_own_error() -> None:
    corner = replace(place(900.0, "corner"), warning="beside a corner")
    nodal = NODAL | {
        "fs_s1": corner,
        "fs_s1 in corner": corner,
        "fs_s1_off_corners": place(500.0, "tooth root"),
    }
    loaded = {name: one.value for name, one in nodal.items()}
    known = wall(392.0, 40.0)
    found = with_windows(nodal, loaded, root(600.0), known)
    assert found["fs_s1"] == replace(corner, on_mesh=900.0)
    off = found["fs_s1_off_corners"]
    assert (off.region, off.value, off.on_mesh) == ("tooth root", 600.0, 500.0)
    assert off.error == pytest.approx(5.0)
    answers = {one.name: one for one in LargestStresses.of(found).answers()}
    assert answers["largest.fs_s1"].no_error == NO_LIMIT
    assert answers["largest.fs_s1"].remark == "beside a corner"
    assert not answers["largest.fs_s1_off_corners"].detail
    assert answers["largest.fs_s1_off_corners"].error == pytest.approx(5.0)
    # without such a corner both are the same, and the second one is a detail
    plain = with_windows(nodal | {"fs_s1": NODAL["fs_s1"]}, loaded, root(1000.0), known)
    answers = {one.name: one for one in LargestStresses.of(plain).answers()}
    assert answers["largest.fs_s1"].value == answers["largest.fs_s1_off_corners"].value == 1000.0
    assert answers["largest.fs_s1_off_corners"].detail


def test_a_tension_at_a_corner_of_the_teeth_stands_beside_the_one_off_it() -> None:
    corner = Place(900.0, "flexible_spline", "notch", 0, 20.0, 5.0, 0.0, "in the notch")
    answers = {one.name: one for one in replace(root(600.0), at_corner=corner).answers()}
    assert answers["root.s1"].value == 900.0 and answers["root.s1"].no_error == NO_LIMIT
    assert (answers["root.s1"].place, answers["root.s1"].remark) == (corner.text, "in the notch")
    off = answers["root.s1_off_corners"]
    assert (off.value, off.error, off.detail) == (600.0, 5.0, False)
    answers = {one.name: one for one in root(600.0).answers()}
    assert answers["root.s1"].value == answers["root.s1_off_corners"].value == 600.0
    assert answers["root.s1_off_corners"].detail and answers["root.s1"].error == 5.0
    found = with_windows(NODAL, LOADED, replace(root(600.0), at_corner=corner), None)
    assert found["fs_s1"].region == "notch" and found["fs_s1"].warning == "in the notch"


def test_the_largest_tension_of_a_period_may_lie_between_its_angles() -> None:
    """Straight up to a kink a quarter of a step behind an angle: the lines meet there. With fewer
    than four angles that is not known."""
    rises = [
        (float(angle), 100.0 + 8.0 * angle - 32.0 * max(angle - 2.25, 0.0)) for angle in range(6)
    ]
    over = replace(root(110.0), period=tuple(rises)).over_period
    assert over is not None
    assert over.maximum == pytest.approx(116.0)
    assert over.maximum_error == pytest.approx(math.hypot(5.0 / 110.0 * 116.0, 2.0))
    few = replace(root(110.0), period=tuple(rises[:3])).over_period
    assert few is not None and few.mean_error is not None and few.maximum_error is None
