"""S-shaped teeth: both flanks touch on the path of racks, which the test has from the bending of a
ring."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import swgpar
from support.paths import DRIVERS
from support.smooth_flank import is_smooth
from support.toothed_drive import refuse_profile, run_with_teeth
from swgpar.profiles import RackPath, Teeth, ToothProfile, make_profile
from swgpar.profiles.keys import SShaped

PATHS = {
    "standard": RackPath(1.0, 2, 1.0, 1.0),
    "less": RackPath(1.0, 2, 1.0, 0.85),
    "least": RackPath(1.0, 2, 1.0, 0.7),
    "three lobes": RackPath(0.8, 3, 1.2, 1.1),
    "four teeth": RackPath(0.5, 2, 1.0, 1.0),
}
ADDENDUM, DEDENDUM = {"four teeth": 0.3}, {"four teeth": 0.38, "least": 0.5}
"""Heights over the distance of the pitch circles, where they are not 0.6 and 0.75."""


def gears(name: str) -> tuple[ToothProfile, ToothProfile]:
    """Flanks of both gears, of 100 teeth and more."""
    path, apart = PATHS[name], PATHS[name].apart
    more = round(2.0 * apart / path.module)
    heights = ADDENDUM.get(name, 0.6) * apart, DEDENDUM.get(name, 0.75) * apart
    spline, ring = (
        Teeth(n, path.module, np.radians(20.0), *heights, external)
        for n, external in ((100, True), (100 + more, False))
    )
    keys = SShaped(r_root=0.1 * path.module)
    return make_profile(keys, spline, path=path), make_profile(keys, ring, path=path)


def overlaps(name: str, theta: float) -> np.ndarray:
    """Signed distances (n,) mm of places on the spline's flank from the ring gear's, on racks.

    The ring's displacements are w0 cos theta outwards and -w0 / lobes sin theta along it. The
    gears have pitches in common: the tooth stays back by a pitch each time that the cam has passed
    as many teeth.
    """
    path, (spline, ring) = PATHS[name], gears(name)
    m, n, w = path.module, path.lobes, path.deflection
    (fs, rg), lag = (0.5 * m * spline.n_teeth, 0.5 * m * ring.n_teeth), theta / n
    across = (rg - fs) * lag - w / n * np.sin(theta)
    x, y = spline.point(np.linspace(0.0, spline.length, 2001)).T
    outwards = (y - fs) + w * np.cos(theta) - (rg - fs)
    # in the frame of the ring gear's tooth, half a pitch away, whose flank faces to the other side
    places = np.column_stack([0.5 * np.pi * m - (x + across), rg + outwards])
    return ring.distance(places)[0]


@pytest.mark.parametrize("name", PATHS)
def test_flanks_touch_along_the_path(name: str) -> None:
    """From near the major axis to where the tips part, without overlap."""
    path = PATHS[name]
    last = np.arccos((1.0 - 2.0 * ADDENDUM.get(name, 0.6)) / path.kappa)
    for theta in np.linspace(0.35 * path.steepest, 0.95 * last, 6):
        distance = overlaps(name, theta).min()
        if abs(theta - path.steepest) > 0.25:
            # the nearest of 2001 places is off the point of contact by half their distance, 4e-4
            # mm, whose square times half of curvatures up to 10 / mm is the distance that is left
            assert -1e-9 < distance < 1e-6 * path.apart, theta
        else:  # the cubic between both curves
            assert -2e-6 < distance < 2e-5 * path.apart, theta


@pytest.mark.parametrize("name", ["standard", "less"])
def test_nothing_overlaps_nearer_to_the_major_axis(name: str) -> None:
    for theta in np.linspace(-0.5, 0.0, 6):
        assert overlaps(name, theta).min() > -1e-9


@pytest.mark.parametrize("name", PATHS)
def test_the_flank_is_smooth(name: str) -> None:
    for flank in gears(name):
        is_smooth(flank)
        assert [segment.name for segment in flank.segments] == ["face", "middle", "flank", "root"]


def test_the_flank_is_the_image_of_the_face() -> None:
    """With a deflection of the distance of the pitch circles."""
    for flank in gears("standard"):
        inflection = 0.5 * (flank.point(flank.breaks[1]) + flank.point(flank.breaks[2]))
        away = np.linspace(0.0, 0.4, 9)
        upper = flank.point(flank.breaks[1] - away) - inflection
        lower = flank.point(flank.breaks[2] + away) - inflection
        assert upper == pytest.approx(-lower, abs=1e-9)


def test_the_path_is_that_of_the_drive_or_of_a_key() -> None:
    teeth = {"ring_gear.profile": {"type": "s_shaped", "r_root": 0.25}}
    plane = DRIVERS / "plane_half_turn.toml"
    drive = swgpar.load_design(plane, teeth)
    assert drive.rack_path() == RackPath(1.0, 2, 1.0, 1.0)
    given = {"type": "s_shaped", "r_root": 0.25, "deflection": 0.93}
    own = swgpar.load_design(plane, {"ring_gear.profile": given}).profile("ring_gear")
    less = swgpar.load_design(plane, {**teeth, "wave_generator.deflection": 0.93})
    s = np.linspace(0.0, own.length, 50)
    assert own.point(s) == pytest.approx(less.profile("ring_gear").point(s), abs=1e-12)
    assert own.length != pytest.approx(drive.profile("ring_gear").length, rel=1e-3)


S = {"type": "s_shaped", "r_root": 0.25}
REFUSED = [
    ({**S, "r_root": 2.0}, [], "ring_gear.profile.r_root smaller: "),
    ({**S, "r_tip": 0.9}, [], "ring_gear.profile with r_tip = 0.9"),
    ({**S, "deflection": 0.5}, [], "ring_gear.profile.deflection = 0.5 .* 0.6 to 1 mm"),
    (S, ["wave_generator.deflection=1.1"], "wave_generator.deflection = 1.1 .* 0.6 to 1 mm"),
    (S, ["ring_gear.dedendum_coef=1.1"], "ring_gear.dedendum_coef = 1.1"),
    (S, ["ring_gear.c_l=0.3"], "ring_gear.c_l = 0.3"),
]


@pytest.mark.parametrize(("section", "values", "words"), REFUSED)
def test_what_gives_no_flank_is_refused(
    section: dict, values: list[str], words: str, design_file: Callable
) -> None:
    refuse_profile(design_file, section, values, words)


def test_a_drive_runs_on_them() -> None:
    """A plane drive with S-shaped teeth on both gears, one of them with rounded tips."""
    run_with_teeth("type = 's_shaped', r_root = 0.25", 0.87)
