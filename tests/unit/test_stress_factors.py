"""Factors of windows on nodal averages, and the largest stress of all regions."""

from __future__ import annotations

import pytest

from swgpar.evaluation.stress_factors import stress_factors
from swgpar.largest_stress.places import Place
from swgpar.largest_stress.resolved_places import with_windows
from swgpar.largest_stress.wall_stress import WallStress


def place(value: float, region: str, error: float | None = None) -> Place:
    return Place(value, "flexible_spline", region, 0, 20.0, 5.0, 0.0, "", error=error)


NODAL = {
    "fs_s1": place(500.0, "tooth root", 20.0),
    "fs_vm": place(450.0, "tooth root", 20.0),
    "fs_s1 in tooth root": place(500.0, "tooth root", 20.0),
    "fs_s1 in fillet": place(300.0, "fillet", 10.0),
    "fs_s1 in cup wall": place(250.0, "cup wall", 10.0),
}
LOADED = {name: one.value for name, one in NODAL.items()} | {"fs_s1 in fillet": 240.0}


def wall(fillet: float, error: float | None = 30.0) -> WallStress:
    places = {
        "fs_s1 in fillet": place(fillet, "fillet", error),
        "fs_vm in fillet": place(0.9 * fillet, "fillet", error),
        "fs_s1 in cup wall": place(200.0, "cup wall", error),
    }
    return WallStress(places, {}, {})


def test_factors_of_the_wall_are_those_of_the_largest_tension() -> None:
    found = stress_factors(None, wall(600.0), LOADED)
    assert set(found) == {"fillet", "cup wall"}
    assert found["fillet"].factor == pytest.approx(600.0 / 240.0)
    assert found["fillet"].error == pytest.approx(30.0 / 240.0)
    assert found["cup wall"].factor == 1.0
    assert stress_factors(None, wall(600.0, None), LOADED)["fillet"].error is None
    assert stress_factors(None, wall(600.0), {}) == {} == stress_factors(None, None, LOADED)


def test_the_largest_stress_is_that_of_the_largest_region() -> None:
    found = with_windows(NODAL, LOADED, None, wall(600.0))
    # at another angle the nodal average of the fillet is larger by a quarter
    assert found["fs_s1"].region == "fillet" and found["fs_s1"].value == pytest.approx(750.0)
    assert found["fs_s1"].error == pytest.approx(37.5) and found["fs_s1"].on_mesh == 500.0
    assert found["fs_s1 in fillet"].on_mesh == 300.0


def test_nodal_averages_of_the_wall_have_no_error() -> None:
    found = with_windows(NODAL, LOADED, None, None)
    for name, one in found.items():
        assert one == NODAL[name] if one.region == "tooth root" else one.error is None
        assert one.value == NODAL[name].value


def test_the_error_reaches_as_far_as_another_region_may() -> None:
    close = with_windows(NODAL, LOADED, None, wall(392.0, 40.0))["fs_s1"]
    assert close.region == "tooth root" and close.error == pytest.approx(490.0 + 50.0 - 500.0)
    unknown = with_windows(NODAL, LOADED, None, wall(300.0, None))["fs_s1"]
    assert unknown.region == "tooth root" and unknown.error is None
