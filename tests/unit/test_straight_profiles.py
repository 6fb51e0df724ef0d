"""Trapezoids, and double arcs given by the centres of their arcs: independent constructions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import swgpar
from support.paths import DESIGN
from support.small_drive import PLANE
from support.smooth_flank import is_smooth
from swgpar.errors import InputError
from swgpar.profiles import Teeth, make_profile
from swgpar.profiles.flank import Segment
from swgpar.profiles.keys import CommonTangent, QuadrupleArc, Trapezoid

GEARS = [(120, True), (122, False)]
QCA = {"r_tip": 0.3, "r_addendum": 1.0, "straight_l": 0.2, "r_dedendum": 2.0, "r_root": 0.3}


def sizes(n: int, external: bool, **changes: float) -> Teeth:
    return replace(Teeth(n, 1.0, np.radians(20.0), 0.6, 0.8, external), **changes)


def center(segment: object) -> np.ndarray:
    """Centre of an arc of a flank, mm."""
    assert isinstance(segment, Segment)
    normal = np.array([-np.sin(segment.direction), np.cos(segment.direction)])
    return np.asarray(segment.start) + normal / segment.curvature


@pytest.mark.parametrize(("n", "external"), GEARS)
@pytest.mark.parametrize("r_tip", [0.0, 0.05])
def test_trapezoid(n: int, external: bool, r_tip: float) -> None:
    keys = Trapezoid(r_tip=r_tip, r_root=0.25)
    flank = make_profile(keys, sizes(n, external), 0.95)
    names = ["straight", "root"] if r_tip == 0.0 else ["tip", "straight", "root"]
    assert [segment.name for segment in flank.segments] == names
    is_smooth(flank)
    assert flank.thickness(0.5 * n) == pytest.approx(0.95 * 0.5 * np.pi, rel=1e-12)
    # the straight flank has the pressure angle where it crosses the pitch circle
    s = brentq(lambda s: np.hypot(*flank.point(s)[0]) - 0.5 * n, 0.0, flank.length, xtol=1e-14)
    (x, y), (nx, ny) = flank.point(s)[0], flank.normal(s)[0]
    assert abs(x * ny - y * nx) == pytest.approx(0.5 * n * np.cos(np.radians(20.0)), rel=1e-12)
    if r_tip:
        assert abs(flank.tangent(0.0)[0] @ flank.point(0.0)[0]) < 1e-9 * n
        assert flank.curvature(0.0)[0] == pytest.approx(-1.0 / r_tip)
    assert flank.curvature(flank.length)[0] == pytest.approx(1.0 / 0.25)


@pytest.mark.parametrize(("n", "external"), GEARS)
def test_flank_angle_is_that_to_the_centre_line(n: int, external: bool) -> None:
    keys = Trapezoid(flank_angle=25.0, r_root=0.2)
    flank = make_profile(keys, sizes(n, external))
    across, height = np.abs(flank.normal(0.1)[0])
    assert np.degrees(np.arctan2(height, across)) == pytest.approx(25.0)
    assert flank.thickness(0.5 * n) == pytest.approx(0.5 * np.pi, rel=1e-12)


def test_addendum_of_a_trapezoid_may_be_zero() -> None:
    for n, external in GEARS:
        flank = make_profile(Trapezoid(r_root=0.2), sizes(n, external, addendum=0.0))
        assert flank.top_land == pytest.approx(0.5 * np.pi, rel=1e-12)


@pytest.mark.parametrize(("n", "external"), GEARS)
def test_common_tangent_is_the_double_arc_with_these_centres(n: int, external: bool) -> None:
    """Centres are read off a quadruple arc; tangent, straight length and arcs come back."""
    teeth, side = sizes(n, external), 1.0 if external else -1.0
    arcs = make_profile(QuadrupleArc(**QCA), teeth, 0.97, 0.3)
    by_name = {segment.name: segment for segment in arcs.segments}
    (xa, ya), (xd, yd) = center(by_name["addendum"]), center(by_name["dedendum"])
    keys = CommonTangent(
        r_addendum=1.0,
        c_addendum=-xa,
        e_addendum=side * (0.5 * n - ya),
        r_dedendum=2.0,
        c_dedendum=xd - 0.5 * np.pi,
        e_dedendum=side * (yd - 0.5 * n),
        r_root=0.3,
    )
    flank = make_profile(keys, teeth)
    is_smooth(flank)
    for name in ("straight", "dedendum", "root"):
        segment = next(one for one in flank.segments if one.name == name)
        for key in ("start", "direction", "curvature", "length"):
            given = getattr(by_name[name], key)
            assert getattr(segment, key) == pytest.approx(given, abs=1e-10), (name, key)
    # the convex arc goes on to the addendum circle, where the quadruple arc has its tip arc
    assert flank.segments[0].name == "addendum"
    assert np.hypot(*flank.point(0.0)[0]) == pytest.approx(arcs.r_tip_circle, rel=1e-13)
    thin = make_profile(keys, teeth, 0.9)
    lost = flank.thickness(0.5 * n) - thin.thickness(0.5 * n)
    assert lost == pytest.approx(0.05 * np.pi, rel=1e-9)


TANGENT = {"type": "common_tangent", "r_addendum": 1.0, "c_addendum": 0.22, "e_addendum": 0.14}
TANGENT |= {"r_dedendum": 1.3, "c_dedendum": 0.51, "e_dedendum": 0.24, "r_root": 0.3}
REFUSED = [
    ({"type": "trapezoid", "r_root": 2.0}, "ring_gear.profile.*r_root smaller"),
    ({"type": "trapezoid", "r_root": 0.2, "r_tip": 1.5}, "ring_gear.profile.*smaller"),
    ({"type": "trapezoid", "r_root": 0.2, "flank_angle": 61.0}, "flank_angle = 61"),
    ({**TANGENT, "r_addendum": 2.0}, "no common tangent: allowed are radii whose sum is up to"),
    ({**TANGENT, "r_root": 2.5}, "r_root = 2.5 with r_dedendum = 1.3 does not meet"),
    ({**QCA, "r_tip": 1.0}, 'r_tip = 1 equals r_addendum.*"trapezoid"'),
    ({**QCA, "r_root": 2.0}, 'r_root = 2 equals r_dedendum.*"trapezoid"'),
]


@pytest.mark.parametrize(("section", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_what_gives_no_flank_is_refused(section: dict, words: str, design_file: Callable) -> None:
    with pytest.raises(InputError, match=words) as caught:
        swgpar.load_design(design_file({"ring_gear.profile": section}), [])
    assert "\n" not in str(caught.value)


def test_a_drive_runs_on_them() -> None:
    """A plane drive with trapezoids on one gear, and arcs by their centres on the other."""
    gear = {"tip": 2, "layers": 1, "flank": 4, "root": 3, "under": 1, "rim": 1}
    keys = "{type = 'trapezoid', r_tip = 0.05, r_root = 0.2}"
    arcs = ", ".join(f"{key} = {value!r}".replace('"', "'") for key, value in TANGENT.items())
    design = swgpar.load_design(
        DESIGN,
        [
            *PLANE,
            f"flexible_spline.profile={keys}",
            f"ring_gear.profile={{{arcs}}}",
            "ring_gear.c_P=0.9",
            "steps.rotation=0",
            "output.figures=false",
        ],
    )
    recipe = {"flexible_spline": gear, "ring_gear": gear}
    result = swgpar.run(design, mesh=recipe, progress=False)
    assert np.isfinite(result.history["fs_s1"]).all()
