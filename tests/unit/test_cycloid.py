"""Cycloid teeth: flanks of the same rolling circles touch while the pitch circles roll on each
other."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from support.smooth_flank import is_smooth
from support.toothed_drive import refuse_profile, run_with_teeth
from swgpar.profiles import Teeth, ToothProfile, make_profile
from swgpar.profiles.keys import Cycloid

MODULE = 1.0
CIRCLES = {"equal": (1.0, 1.0), "small and large": (0.7, 1.6), "radial": (0.8, 10.0)}
"""Radii of the rolling circles, mm; 10 mm is half the pitch radius of the external gear."""


def gears(name: str) -> tuple[ToothProfile, ToothProfile]:
    """Flanks of 40 external and 46 internal teeth."""
    outside, inside = CIRCLES[name]
    keys = Cycloid(r_epicycloid=outside, r_hypocycloid=inside, r_root=0.15)
    spline, ring = (
        make_profile(keys, Teeth(n, MODULE, np.radians(20.0), 0.6, 0.8, external))
        for n, external in ((40, True), (46, False))
    )
    return spline, ring


def distances(name: str, rolled: float) -> np.ndarray:
    """Signed distances (n,) mm of places on the external flank from the internal one.

    rolled : mm, arc by which both pitch circles have passed the point where they touch
    """
    spline, ring = gears(name)
    small, large = (0.5 * MODULE * each.n_teeth for each in (spline, ring))
    x, y = spline.point(np.linspace(0.0, spline.length, 2001)).T
    # its pitch point from +y, beside the axis of the ring gear by the distance of the axes
    points = (x + 1j * y) * np.exp(1j * (0.5 * np.pi / spline.n_teeth - rolled / small))
    points += 1j * (large - small)
    # into the frame of the internal tooth, mirrored so that its left flank is the one at x > 0
    points *= np.exp(1j * (rolled / large + 0.5 * np.pi / ring.n_teeth))
    return ring.distance(np.column_stack([-points.real, points.imag]))[0]


@pytest.mark.parametrize("name", CIRCLES)
def test_flanks_touch_while_the_pitch_circles_roll(name: str) -> None:
    outside, inside = CIRCLES[name]
    for rho, height, side in ((outside, 0.55, 1.0), (inside, 0.55, -1.0)):
        # the point of a rolling circle that is at about this height, clear of the cubics
        for share in (0.25, 0.5, 0.75, 1.0):
            rolled = side * rho * np.arccos(1.0 - share * height / rho)
            # the nearest of 2001 places is off the point of contact by half their distance, 4e-4
            # mm, whose square times half of curvatures up to 5 / mm is the distance that is left;
            # cubics overlap by 1.3e-7 mm at most
            assert -1e-6 < distances(name, rolled).min() < 1e-6, rolled
    # where the pitch points meet, the cubics do
    assert abs(distances(name, 0.0).min()) < 1e-4


@pytest.mark.parametrize("name", CIRCLES)
def test_the_flank_is_smooth_and_as_thick_as_the_space(name: str) -> None:
    for flank in gears(name):
        is_smooth(flank)
        pitch_radius = 0.5 * MODULE * flank.n_teeth
        # the cubic crosses the pitch circle beside the pitch point by up to 1e-4 mm
        assert flank.thickness(pitch_radius) == pytest.approx(0.5 * np.pi * MODULE, abs=2e-4)


def test_a_hypocycloid_of_half_the_pitch_radius_is_radial() -> None:
    spline, _ = gears("radial")
    begin, end = spline.breaks[-3:-1]
    along = spline.point(np.linspace(begin, end, 9))
    assert spline.segments[-2].name == "flank"
    assert np.ptp(np.arctan2(*along.T)) < 1e-12


C = {"type": "cycloid", "r_epicycloid": 1.0, "r_hypocycloid": 1.0, "r_root": 0.2}
REFUSED = [
    ({**C, "r_root": 2.0}, [], "make ring_gear.profile.r_root smaller"),
    ({**C, "r_epicycloid": 0.3}, [], "ring_gear.profile.r_epicycloid = 0.3 .* mm and more"),
    ({**C, "r_hypocycloid": 31.0}, [], r"r_hypocycloid = 31 .* to 30.5 mm \(half of"),
    (C, ["ring_gear.c_l=0.3"], "ring_gear.c_l = 0.3"),
]


@pytest.mark.parametrize(("section", "values", "words"), REFUSED)
def test_what_gives_no_flank_is_refused(
    section: dict, values: list[str], words: str, design_file: Callable
) -> None:
    refuse_profile(design_file, section, values, words)


def test_a_drive_runs_on_them() -> None:
    """A plane drive with cycloid teeth on both gears, one of them with rounded tips."""
    run_with_teeth("type = 'cycloid', r_epicycloid = 1.0, r_hypocycloid = 1.0, r_root = 0.2", 0.9)
