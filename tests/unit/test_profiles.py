"""Tooth profiles: smooth, closed, on the circles they must reach, and the envelopes of their
cutters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from swgpar import load_design
from swgpar.errors import InputError
from swgpar.profiles.double_arc import double_arc, straight_length
from swgpar.profiles.flank import Segment, ToothProfile, check_flank
from swgpar.profiles.involute import Cutter, involute
from swgpar.profiles.keys import ProfileKeys
from swgpar.profiles.pitch_point import PitchPointFrame
from swgpar.profiles.quadruple_arc import quadruple_arc

ALPHA = np.radians(20.0)
IMPROVED = {"r_tip": 0.5, "r_addendum": 1.0, "straight_l": 0.0, "r_dedendum": 20.0, "r_root": 0.6}
INITIAL = {"r_tip": 0.3, "r_addendum": 1.0, "straight_l": 0.2, "r_dedendum": 2.0, "r_root": 0.3}
GEARS = [(120, True), (122, False)]
SPLINE = Cutter(120, 1.0, ALPHA, 0.6, 0.8, True, 0.2, 0.0)
RING = Cutter(122, 1.0, ALPHA, 0.6, 0.8, False, 0.2, 0.0, 80)
CUTTERS = {
    "rack": SPLINE,
    "rack-20.4": replace(SPLINE, pressure_angle=np.radians(20.4)),
    "rack-shifted": replace(SPLINE, shift=0.3, tip_radius=0.1),
    "rack-40-teeth": replace(SPLINE, n_teeth=40, addendum=1.0, dedendum=1.25, tip_radius=0.38),
    "rack-thin": replace(SPLINE, c_P=0.9),
    "shaper": RING,
    "shaper-thin": replace(RING, c_P=0.9),
    "shaper-19.8": replace(RING, pressure_angle=np.radians(19.8), tip_radius=0.05),
    "shaper-shifted": replace(RING, shift=0.35),
    "shaper-30-teeth": replace(RING, cutter_teeth=30, tip_radius=0.3),
}


def frame(teeth: int, external: bool, c_P: float = 1.0) -> PitchPointFrame:
    return PitchPointFrame(teeth, 1.0, ALPHA, 0.6, 0.8, external, c_P)


def differences_agree(p: ToothProfile) -> None:
    """Differences of points give tangents, of tangents curvatures."""
    h = 1e-6
    s = np.linspace(0.0, p.length, 4001)
    inner = s[(s > 2 * h) & (s < p.length - 2 * h)]
    inner = inner[np.min(np.abs(inner[:, None] - p.breaks), axis=1) > 2 * h]
    assert np.allclose(
        (p.point(inner + h) - p.point(inner - h)) / (2 * h), p.tangent(inner), atol=1e-8
    )
    bend = np.einsum(
        "ij,ij->i", (p.tangent(inner + h) - p.tangent(inner - h)) / (2 * h), p.normal(inner)
    )
    assert np.allclose(bend, p.curvature(inner), atol=1e-6)


def tangent_at_the_root(p: ToothProfile) -> None:
    assert abs(p.tangent(p.length)[0] @ p.point(p.length)[0]) < 1e-9 * p.r_root_circle


@pytest.mark.parametrize("radii", [IMPROVED, INITIAL])
@pytest.mark.parametrize(("teeth", "external"), GEARS)
def test_quadruple_arc(teeth: int, external: bool, radii: dict[str, float]) -> None:
    p = quadruple_arc(frame(teeth, external), 0.5, **radii)
    sign = 1.0 if external else -1.0
    assert np.hypot(*p.point(0.0)[0]) == pytest.approx(0.5 * teeth + 0.6 * sign, abs=1e-12)
    assert np.hypot(*p.point(p.length)[0]) == pytest.approx(0.5 * teeth - 0.8 * sign, abs=1e-12)
    assert abs(p.tangent(0.0)[0] @ p.point(0.0)[0]) < 1e-9 * teeth
    tangent_at_the_root(p)
    assert p.thickness(0.5 * teeth) == pytest.approx(0.5 * np.pi, rel=1e-12)
    differences_agree(p)


# Tables 6.9 and 6.10: r_d, c_l, l of the flexible spline and of the ring gear. The printed 0.6391
# of the ring gear at r_d = 0.4 is a misprint: it is the value at r_d = 0.3.
TABLES = [
    (0.1, 0.0, 0.7825, 0.7802),
    (0.2, 0.0, 0.7130, 0.7097),
    (0.3, 0.0, None, 0.6391),
    (0.4, 0.0, 0.5742, 0.5684),
    (0.5, 0.0, 0.5049, 0.4977),
    (0.6, 0.0, 0.4357, 0.4268),
    (0.6, 0.1, 0.4842, 0.4743),
    (0.6, 0.3, 0.6225, 0.6098),
    (0.6, 0.5, 0.8715, 0.8537),
]


@pytest.mark.parametrize(("r_d", "c_l", "l_fs", "l_rg"), TABLES)
def test_straight_lengths_of_tables_6_9_and_6_10(
    r_d: float, c_l: float, l_fs: float | None, l_rg: float
) -> None:
    for (teeth, external), printed in zip(GEARS, (l_fs, l_rg), strict=True):
        if printed is not None:
            length = straight_length(frame(teeth, external), c_l, r_d)
            assert f"{length:.4f}" == f"{printed:.4f}"
            straight = double_arc(frame(teeth, external), c_l, 1.0, r_d).segments[1]
            assert (straight.name, straight.length) == ("straight", length)


@pytest.mark.parametrize(("teeth", "external"), GEARS)
@pytest.mark.parametrize(
    ("r_d", "c_l", "c_P"), [(0.5, 0.0, 1.0), (0.6, 0.0, 0.95), (0.6, 0.3, 1.0)]
)
def test_double_arc(teeth: int, external: bool, r_d: float, c_l: float, c_P: float) -> None:
    p = double_arc(frame(teeth, external, c_P), c_l, 1.0, r_d)
    check_flank(p)
    sign = 1.0 if external else -1.0
    assert [segment.name for segment in p.segments] == ["addendum", "straight", "dedendum"]
    assert np.hypot(*p.point(0.0)[0]) == pytest.approx(0.5 * teeth + 0.6 * sign, abs=1e-12)
    assert np.hypot(*p.point(p.length)[0]) == pytest.approx(0.5 * teeth - 0.8 * sign, abs=1e-12)
    tangent_at_the_root(p)
    assert p.thickness(0.5 * teeth) == pytest.approx(0.5 * np.pi * c_P, rel=1e-12)  # eq. 6.2
    # eqs 3.25 and 3.28: the pitch point divides the straight segment, whose inclination is alpha -
    # or + alpha_P
    assert np.hypot(*p.point(p.breaks[1] + c_l * (p.breaks[2] - p.breaks[1]))[0]) == pytest.approx(
        0.5 * teeth
    )
    star = ALPHA - sign * 0.5 * c_P * np.pi / teeth
    assert p.normal(p.breaks[2] - 1e-9)[0] == pytest.approx(
        [np.cos(star), sign * np.sin(star)], abs=1e-8
    )
    middle = 0.5 * (p.breaks[:-1] + p.breaks[1:])
    assert p.curvature(middle) == pytest.approx([-1.0, 0.0, 1.0 / r_d])
    differences_agree(p)


def clockwise(points: np.ndarray, angle: np.ndarray) -> np.ndarray:
    x, y = points
    return np.stack((x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)))


def rounded(flank, tip, beyond, corner, rho: float) -> np.ndarray:
    """Distance to a tooth from those to its flank and tip set back by rho; `corner` where both end,
    `beyond` it."""
    return np.where(beyond, corner, np.maximum(flank, tip)) - rho


def from_rack(cut: Cutter, points: np.ndarray, psi: np.ndarray) -> np.ndarray:
    """Distance (mm) of points (2, n) of the gear to the left half of the rack's tooth at generating
    angles psi."""
    x, y = clockwise(points, psi) - np.array([0.0, cut.r_pitch]).reshape(2, *[1] * psi.ndim)
    x = x - cut.r_pitch * psi
    alpha, rho, m = cut.pressure_angle, cut.tip_radius, cut.module
    half = m * (
        0.25 * np.pi * cut.c_P + cut.shift * np.tan(alpha)
    )  # of the gear's tooth at the pitch line
    depth = cut.dedendum - cut.shift * m
    flank = (half - x) * np.cos(alpha) - y * np.sin(alpha) + rho
    tip = -y - depth + rho
    cy = rho - depth
    cx = half + (rho - cy * np.sin(alpha)) / np.cos(alpha)
    # the corner: left of its centre as seen along the tip, below it along the flank
    beyond = (x < cx) & ((x - cx) * np.sin(alpha) + (cy - y) * np.cos(alpha) > 0.0)
    return rounded(flank, tip, beyond, np.hypot(x - cx, y - cy), rho)


def from_shaper(cut: Cutter, points: np.ndarray, psi: np.ndarray) -> np.ndarray:
    """The same for the left half of a shaper's tooth in the slot beside the ring's tooth."""
    n_g = cut.cutter_teeth
    m = cut.module
    alpha = cut.pressure_angle
    rho = cut.tip_radius
    r_g, r_b = 0.5 * n_g * m, 0.5 * n_g * m * np.cos(alpha)
    centre = np.array([0.0, cut.r_pitch - r_g]).reshape(2, *[1] * psi.ndim)
    x, y = clockwise(clockwise(points, psi) - centre, -psi * cut.n_teeth / n_g)
    # of the ring's tooth; the shaper's tooth fills the slot
    thickness = m * (0.5 * np.pi * cut.c_P - 2.0 * cut.shift * np.tan(alpha))
    half = 0.5 * (np.pi * m - thickness) / r_g
    middle = 0.5 * thickness / r_g + half
    radius, angle = np.hypot(x, y), np.arctan2(x, y) - middle

    def inv(roll):
        return np.tan(roll) - roll

    def flank_of(radius, angle):
        # involutes of one base circle are parallel: their distance is the arc between them
        roll = np.arccos(np.minimum(r_b / radius, 1.0))
        return -r_b * (angle + half + inv(alpha) - inv(roll)) + rho, r_b * np.tan(roll)

    r_c = r_g + cut.dedendum + cut.shift * m - rho
    angle_c = brentq(lambda angle: flank_of(r_c, angle)[0], -1.0, 1.0, xtol=1e-16)
    flank, reach = flank_of(radius, angle)
    beyond = (angle < angle_c) & (reach - flank > np.sqrt(r_c**2 - r_b**2))
    cx, cy = r_c * np.sin(middle + angle_c), r_c * np.cos(middle + angle_c)
    return rounded(flank, radius - r_c, beyond, np.hypot(x - cx, y - cy), rho)


def nearest_passage(cut: Cutter, points: np.ndarray) -> np.ndarray:
    """Smallest distance (n,) of the gear's points (n, 2) to the cutter over all generating angles:
    a dense search."""
    distance = from_rack if cut.external else from_shaper
    best, width = np.zeros((len(points), 1)), 0.2 * 120.0 / cut.n_teeth
    for _ in range(7):
        psi = best + width * np.linspace(-1.0, 1.0, 401)
        gap = distance(cut, points.T[:, :, None], psi)
        best = np.take_along_axis(psi, gap.argmin(axis=1)[:, None], axis=1)
        width *= 0.02
    return gap.min(axis=1)


@pytest.mark.parametrize("name", CUTTERS)
def test_involute_flanks_are_the_envelopes_of_their_cutters(name: str) -> None:
    """The cutter touches each point of the flank once and never enters the tooth (eqs 3.14 and
    3.15)."""
    cut = CUTTERS[name]
    p = involute(cut)
    check_flank(p)
    s = np.concatenate([a + (b - a) * np.linspace(0.01, 0.99, 40) for a, b in pairwise(p.breaks)])
    assert np.abs(nearest_passage(cut, p.point(s))).max() < 1e-9 * cut.module
    # the check has teeth: a point inside the material is not reached, one outside is cut
    for off in (-1e-3, 1e-3):
        assert nearest_passage(cut, p.point(s) + off * p.normal(s)) == pytest.approx(-off, abs=2e-6)


@pytest.mark.parametrize("name", CUTTERS)
def test_involute_profile(name: str) -> None:
    cut = CUTTERS[name]
    p = involute(cut)
    side = 1.0 if cut.external else -1.0
    r, shift = 0.5 * cut.n_teeth * cut.module, cut.shift * cut.module
    assert np.hypot(*p.point(0.0)[0]) == pytest.approx(r + side * cut.addendum + shift, rel=1e-14)
    assert np.hypot(*p.point(p.length)[0]) == pytest.approx(
        r - side * cut.dedendum + shift, rel=1e-14
    )
    tangent_at_the_root(p)
    differences_agree(p)
    # thickness at any radius of the involute, from that at the pitch circle
    alpha, r_form = cut.pressure_angle, np.hypot(*p.point(p.breaks[1])[0])
    pitch = cut.module * (0.5 * np.pi * cut.c_P + 2.0 * side * cut.shift * np.tan(alpha))
    for radius in np.linspace(p.r_tip_circle, r_form, 7)[1:-1]:
        roll = np.arccos(r * np.cos(alpha) / radius)
        spread = np.tan(alpha) - alpha - np.tan(roll) + roll
        assert p.thickness(radius) == pytest.approx(
            2.0 * radius * (0.5 * pitch / r + side * spread), rel=1e-12
        )
    # the normals of the involute are tangents of the base circle (eq. 3.12)
    s = np.linspace(0.0, p.breaks[1], 30)[:-1]
    (x, y), (nx, ny) = p.point(s).T, p.normal(s).T
    lever = np.abs(x * ny - y * nx)
    assert lever == pytest.approx(np.full_like(s, r * np.cos(alpha)), rel=1e-12)


@pytest.mark.parametrize("name", CUTTERS)
def test_curved_segments_run_by_arc_length(name: str) -> None:
    for segment in involute(CUTTERS[name]).segments:
        for t in (0.013, 0.37, 0.991):
            exact = quad(
                lambda x, f=segment.evaluate: f(np.array([x])).speed[0],
                0.0,
                t,
                epsabs=1e-13,
                epsrel=1e-13,
            )[0]
            assert segment.arc_length(np.array([t]))[0] == pytest.approx(exact, rel=1e-11)
            assert segment.parameter(np.array([exact]))[0] == pytest.approx(t, rel=1e-11)


FLANKS = {
    "rack": involute(SPLINE),
    "shaper": involute(RING),
    "external arcs": double_arc(frame(120, True), 0.0, 1.0, 0.6),
    "internal arcs": quadruple_arc(frame(122, False), 0.5, **INITIAL),
}


@pytest.mark.parametrize("name", FLANKS)
def test_flanks_that_break_the_rules_of_their_segments(name: str) -> None:
    p = FLANKS[name]
    assert (p.tip_end > 0.0) == (p.segments[0].name == "tip")
    assert 0.0 < p.root_start == pytest.approx(p.length - p.segments[-1].length, rel=1e-14)
    check_flank(p)
    for circle in ("r_tip_circle", "r_root_circle"):
        with pytest.raises(InputError, match="end has the radius"):
            check_flank(replace(p, **{circle: getattr(p, circle) + 1e-4}))
    straight = Segment("straight", (0.5, 60.0), -1.5, 0.0, 0.5)
    for wrong in ((straight, replace(straight, name="tip")), (replace(straight, name="root"),) * 2):
        with pytest.raises(ValueError, match="allowed is the name tip for the first one only"):
            replace(p, segments=wrong)


@pytest.mark.parametrize("name", FLANKS)
def test_distance_to_the_flank_against_a_dense_search(name: str) -> None:
    p = FLANKS[name]
    rng = np.random.default_rng(3)
    s = rng.uniform(0.0, p.length, 40)
    height = rng.uniform(-0.04, 0.04, 40)
    distance, foot = p.distance(p.point(s) + height[:, None] * p.normal(s))
    assert distance == pytest.approx(height, abs=1e-12) and foot == pytest.approx(s, abs=1e-10)
    away = rng.uniform(-0.4, 0.4, (40, 2)) + p.point(s)
    distance = np.abs(p.distance(away)[0])
    fine = p.point(np.linspace(0.0, p.length, 200001))
    for x, d in zip(away, distance, strict=True):
        sampled = np.hypot(
            *(fine - x).T
        ).min()  # never too small, too large by the samples' distance
        assert sampled - 1e-8 < d < sampled + 1e-13


def rack(**more) -> dict:
    return {"type": "involute", "cutter_radius": 0.2, **more}


def shaper(**more) -> dict:
    return rack(cutter_teeth=80, **more)


def test_backlash_and_turn_of_both_kinds_of_profiles(design_file: Callable) -> None:
    """Table 6.1 and eq. 6.4 for directly defined profiles; the profile shift for involutes."""
    for c_P, printed in (
        (1.0, 0.0),
        (0.95, 0.07854),
        (0.90, 0.15708),
        (0.85, 0.23562),
        (0.80, 0.31416),
    ):
        design = load_design(design_file({"ring_gear.profile": INITIAL}), [f"ring_gear.c_P={c_P}"])
        assert design.backlash == pytest.approx(printed, abs=5e-6)
        assert design.backlash_angle == pytest.approx(
            np.pi * (1.0 - c_P) / (2.0 * 120.0), abs=1e-13
        )
    sections = {
        "flexible_spline.profile": rack(shift=0.1, pressure_angle=20.4),
        "ring_gear.profile": shaper(shift=0.2),
    }
    design = load_design(design_file(sections), ["ring_gear.c_P=1.0"])
    expected = 2.0 * (0.2 * np.tan(ALPHA) - 0.1 * np.tan(np.radians(20.4)))
    assert design.backlash == pytest.approx(expected, rel=1e-11)
    assert design.inner_radius == pytest.approx(
        60.0 - 0.8 + 0.1 - 1.0
    )  # the rim lies below the shifted root circle
    assert design.profile("flexible_spline").r_root_circle - design.inner_radius == pytest.approx(
        1.0
    )


@pytest.mark.parametrize("name", ["rack-shifted", "shaper-shifted"])
def test_thinner_teeth_have_turned_flanks(name: str) -> None:
    """c_P turns a whole flank about the axis, for arcs (eq. 3.22) as for involutes."""
    cut = CUTTERS[name]
    sizes = cut.n_teeth, cut.external
    for plain, thin in (
        (involute(cut), involute(replace(cut, c_P=0.9))),
        (double_arc(frame(*sizes), 0.0, 1.0, 0.6), double_arc(frame(*sizes, 0.9), 0.0, 1.0, 0.6)),
    ):
        s, angle = np.linspace(0.0, plain.length, 50), 0.1 * 0.5 * np.pi / cut.n_teeth
        assert thin.point(s) == pytest.approx(clockwise(plain.point(s).T, -angle).T, abs=1e-10)
        backlash = plain.thickness(0.5 * cut.n_teeth) - thin.thickness(0.5 * cut.n_teeth)
        assert backlash == pytest.approx(0.05 * np.pi, rel=1e-9)


def test_pressure_angles_of_both_gears(design_file: Callable) -> None:
    sections = {"flexible_spline.profile": rack(pressure_angle=20.4), "ring_gear.profile": shaper()}
    design = load_design(design_file(sections), ["ring_gear.c_P=1.0", "drive.pressure_angle=19.8"])
    for gear, teeth, angle in (("flexible_spline", 120, 20.4), ("ring_gear", 122, 19.8)):
        p = design.profile(gear)
        (x, y), (nx, ny) = p.point(0.1)[0], p.normal(0.1)[0]
        lever = abs(x * ny - y * nx)
        assert lever == pytest.approx(0.5 * teeth * np.cos(np.radians(angle)), rel=1e-12)


DCA = {"type": "double_arc", "r_addendum": 1.0, "r_dedendum": 0.6}
REFUSED = [
    ("ring_gear", shaper(), ["ring_gear.c_l=0.0"], "ring_gear.c_l = 0"),
    ("ring_gear", rack(), [], "ring_gear.profile.cutter_teeth is missing"),
    ("flexible_spline", shaper(), [], "flexible_spline.profile.cutter_teeth = 80"),
    ("flexible_spline", rack(r_tip=0.3), [], "flexible_spline.profile.r_tip = 0.3"),
    ("flexible_spline", rack(cutter_radius=0.9), [], "flexible_spline.profile.cutter_radius = 0.9"),
    ("flexible_spline", rack(cutter_radius=0.0), [], "flexible_spline.profile.cutter_radius = 0"),
    (
        "flexible_spline",
        rack(pressure_angle=50.0),
        [],
        "flexible_spline.profile.pressure_angle = 50",
    ),
    (
        "flexible_spline",
        rack(pressure_angle="20"),
        [],
        'flexible_spline.profile.pressure_angle = "20"',
    ),
    ("flexible_spline", rack(shift=2.0), [], "flexible_spline.profile.shift = 2"),
    ("flexible_spline", rack(shift=0.9), [], "flexible_spline.profile.shift = 0.9"),
    ("ring_gear", shaper(shift=0.7), [], "ring_gear.profile.shift = 0.7"),
    (
        "flexible_spline",
        rack(pressure_angle=42.0),
        ["drive.dedendum_coef=1.9"],
        "profile.pressure_angle = 42",
    ),
    (
        "flexible_spline",
        rack(),
        ["drive.teeth_fs=12", "drive.teeth_rg=14", "drive.module=10.0"],
        "undercuts",
    ),
    ("ring_gear", shaper(cutter_radius=0.9), [], "ring_gear.profile.cutter_radius = 0.9"),
    ("ring_gear", {**shaper(), "cutter_teeth": 8}, [], "ring_gear.profile.cutter_teeth = 8"),
    ("ring_gear", {**shaper(), "cutter_teeth": 119}, [], "ring_gear.profile.cutter_teeth = 119"),
    ("ring_gear", {**shaper(), "cutter_teeth": 122}, [], "ring_gear.profile.cutter_teeth = 122"),
    ("ring_gear", DCA, ["ring_gear.c_l=1.0"], "ring_gear.c_l = 1"),
    ("ring_gear", {**DCA, "r_dedendum": 1.5}, [], "ring_gear.profile.r_dedendum = 1.5"),
    (
        "ring_gear",
        {**DCA, "r_dedendum": 0.8},
        ["ring_gear.c_l=0.0"],
        "r_dedendum = 0.8 cannot be built",
    ),
    ("flexible_spline", {**DCA, "r_dedendum": 1.3}, [], "flexible_spline.profile.r_dedendum = 1.3"),
    ("flexible_spline", {**DCA, "r_addendum": 0.1}, [], "flexible_spline.profile.r_addendum"),
    ("flexible_spline", {**DCA, "r_dedendum": 0.0}, [], "flexible_spline.profile.r_dedendum = 0"),
    ("flexible_spline", {**DCA, "straight_l": 0.2}, [], "flexible_spline.profile.straight_l = 0.2"),
    ("flexible_spline", {"type": "arcs"}, [], 'flexible_spline.profile.type = "arcs"'),
]


@pytest.mark.parametrize(
    ("gear", "section", "overrides", "key"), REFUSED, ids=[case[-1] for case in REFUSED]
)
def test_profiles_that_cannot_be_built_are_refused(
    gear: str, section: dict, overrides: list[str], key: str, design_file: Callable
) -> None:
    plain = [f"{gear}.c_P=1.0"] if section["type"] == "involute" else []
    with pytest.raises(InputError) as caught:
        load_design(design_file({f"{gear}.profile": section}), plain + overrides)
    message = str(caught.value)
    assert key in message and gear in message and "\n" not in message, message
    assert any(word in message for word in ("allowed", "missing", "did you mean")), message


@pytest.mark.parametrize("name", ["rack", "shaper"])
def test_a_point_over_a_sharp_tip_is_outside(name: str) -> None:
    """Also where it lies behind the flank's tangent at the tip end."""
    profile = FLANKS[name]
    away = 1.0 if profile.external else -1.0
    angle = np.linspace(-0.9, 0.9, 19) * profile.polar_angle(0.0)[0]
    over = (profile.r_tip_circle + away * 0.15) * np.stack([np.sin(angle), np.cos(angle)], axis=-1)
    inside = (profile.r_tip_circle - away * 0.15) * np.stack(
        [np.sin(angle), np.cos(angle)], axis=-1
    )
    assert (profile.distance(over)[0] > 0.0).all()
    assert (profile.distance(inside)[0] < 0.0).all()


def test_keys_that_are_lists_tell_profiles_apart() -> None:
    """Profiles are kept by their keys, see `make_profile`."""

    class Points(ProfileKeys):
        points: list[list[float]]

    one, same, other = (Points(points=[[0.0, y]]) for y in (1.0, 1.0, 2.0))
    assert one == same and hash(one) == hash(same) and one != other
    assert len({one, same, other}) == 2
