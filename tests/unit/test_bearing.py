"""Parts of a flexible bearing against closed forms, and designs that are refused."""

from __future__ import annotations

from math import gcd

import numpy as np
import pytest

from support.bearing import BEARING
from support.paths import DESIGN
from support.small_drive import PLANE
from support.three_lobes import MODELS
from swgpar import load_design
from swgpar.checks.remarks import remarks
from swgpar.contact.point_contact import ball_spring, point_contact
from swgpar.contact.smooth_curve import REACH, foot_points, shape_functions, smooth_curve
from swgpar.design.ball_phases import ball_passings
from swgpar.errors import InputError
from swgpar.evaluation.bearing_life import BearingSeries, million_turns
from swgpar.evaluation.bearing_loads import ball_passing_angle
from swgpar.geometry.bearing import ball_lines, depth_of_hollows
from swgpar.geometry.cams import EllipticalCam, HarmonicCam
from swgpar.materials import Isotropic, contact_modulus
from swgpar.model.bearing_model import race_relief

STEEL = contact_modulus(Isotropic(E=210e3, nu=0.3), Isotropic(E=210e3, nu=0.3))


def test_contact_of_spheres() -> None:
    """delta³ = 9 F² / (16 E*² R), p³ = 6 F E*² / (pi³ R²)."""
    radius, force = 2.0, 70.0
    contact = point_contact(1.0 / radius, 1.0 / radius, STEEL)
    approach = (9.0 * force**2 / (16.0 * STEEL**2 * radius)) ** (1.0 / 3.0)
    assert contact.approach * force ** (2.0 / 3.0) == pytest.approx(approach, rel=1e-12)
    pressure = (6.0 * force * STEEL**2 / (np.pi**3 * radius**2)) ** (1.0 / 3.0)
    assert contact.pressure(force) == pytest.approx(pressure, rel=1e-12)
    assert contact.major == pytest.approx(contact.minor, rel=1e-12)


@pytest.mark.parametrize("kind", ["polar", "points", "offset"])
def test_balls_on_curves(kind: str) -> None:
    """An ellipse by an expression, through points, and as the cam inside of the bearing: its balls
    are where those of the ellipse are, or on its parallel curve."""
    given = load_design(DESIGN, PLANE)
    a, b = given.major_semi_axis, given.minor_semi_axis
    keys: dict[str, object] = {
        "polar": {"radius": "1 / sqrt((cos(theta) / a)**2 + (sin(theta) / b)**2)"},
        "points": {"points": EllipticalCam(a, b).outline(90).tolist(), "tolerance": 0.0},
        "offset": {"type": "elliptical", "major_axis": 2 * a - 5, "minor_axis": 2 * b - 5,
                   "offset": 2.5},
    }[kind]  # fmt: skip
    bearing = {"balls": 20, "ball_diameter": 2.0, "race_thickness": 0.5}
    wave = {"type": kind, "face_width": 4.0, "bearing": bearing, **keys}
    design = given.with_values({"wave_generator": wave})
    depth, angle = design.bearing_sizes.centre_depth, np.radians(np.arange(0.0, 360.0, 7.0))
    curve = EllipticalCam(a - 2.5, b - 2.5) if kind == "offset" else EllipticalCam(a, b)
    expected = ball_lines(curve, depth - (2.5 if kind == "offset" else 0.0), angle)
    for value, exact in zip(ball_lines(design.cam(), depth, angle), expected, strict=True):
        assert value == pytest.approx(exact, abs=1e-6)


def surface_displacement(contact, force: float, x: float, y: float) -> float:
    """Displacement of half spaces below the ellipse, by integration of p / r over all chords
    through a point."""
    a, b = contact.minor * np.cbrt(force), contact.major * np.cbrt(force)
    angle = np.pi * (np.arange(20000) + 0.5) / 20000
    c, s = np.cos(angle), np.sin(angle)
    square, linear = (c / a) ** 2 + (s / b) ** 2, x * c / a**2 + y * s / b**2
    chords = (
        0.5 * np.pi * (1.0 - (x / a) ** 2 - (y / b) ** 2 + linear**2 / square) / np.sqrt(square)
    )
    return contact.pressure(force) / (np.pi * STEEL) * float(chords.mean()) * np.pi


@pytest.mark.parametrize("conformity", [0.505, 0.52, 0.6, 1.5])
def test_contact_in_a_groove(conformity: float) -> None:
    """The elliptic pressure closes the gap: w(0) = delta, w(0) - w = kx x² / 2 + ky y² / 2."""
    along, across, force = 2.0 / 3.0 + 1.0 / 17.0, (2.0 - 1.0 / conformity) / 3.0, 120.0
    contact = point_contact(along, across, STEEL)
    approach = contact.approach * force ** (2.0 / 3.0)
    assert surface_displacement(contact, force, 0.0, 0.0) == pytest.approx(approach, rel=1e-6)
    x, y = 0.5 * contact.minor * np.cbrt(force), 0.4 * contact.major * np.cbrt(force)
    for px, py in ((x, 0.0), (0.0, y)):
        gap = 0.5 * (along * px**2 + across * py**2)
        assert approach - surface_displacement(contact, force, px, py) == pytest.approx(
            gap, rel=1e-5
        )


def test_ball_between_two_races() -> None:
    """The approaches of both contacts add up at the same force."""
    spring = ball_spring(3.0, 15.0, 18.0, (0.52, 0.53), STEEL)
    force = 80.0
    approach = (spring.inner.approach + spring.outer.approach) * force ** (2.0 / 3.0)
    assert spring.force(np.array(approach)) == pytest.approx(force, rel=1e-12)
    assert spring.force(np.array(-approach)) == 0.0


def test_smooth_curve_lies_on_the_circle() -> None:
    """The curve through nodes on a circle, at uneven distances, leaves it by less than a thousandth
    of the sagitta."""
    angle = np.array([-0.05, 0.0, 0.04, 0.1])
    nodes = 20.0 * np.column_stack([-np.sin(angle), np.cos(angle)])
    place = np.linspace(0.0, 1.0, 11)
    value, rate, _ = shape_functions(np.repeat(smooth_curve(nodes[None]), 11, axis=0), place)
    points, tangents = value @ nodes, rate @ nodes
    sagitta = 20.0 * 0.04**2 / 8.0
    assert np.abs(np.linalg.norm(points, axis=1) - 20.0).max() < 1e-3 * sagitta
    across = np.abs(np.sum(points * tangents, axis=1)) / (20.0 * np.linalg.norm(tangents, axis=1))
    assert across.max() < 0.02 * 0.04


def test_smooth_curve_is_straight_far_from_its_piece() -> None:
    """In an iteration that has not settled surfaces slide by many pieces. A cubic would carry the
    forces there to the nodes with a lever that grows with the cube of the distance."""
    angle = np.array([-0.05, 0.0, 0.04, 0.1])
    nodes = 20.0 * np.column_stack([-np.sin(angle), np.cos(angle)])
    polynomials = smooth_curve(nodes[None])
    end = 1.0 + REACH
    places = np.array([end - 1e-7, end, end + 1e-7, end + 1.0, end + 100.0])
    value, rate, second = shape_functions(np.repeat(polynomials, 5, axis=0), places)
    assert value[2] - value[1] == pytest.approx(value[1] - value[0], rel=1e-5)
    assert value[4] - value[1] == pytest.approx(100.0 * (value[3] - value[1]), rel=1e-12)
    assert rate[4] == pytest.approx(rate[1], rel=1e-12) and not second[3:].any()
    moved = [[-0.5, 0.3], [0.4, -0.9], [0.1, -0.4], [-0.3, 0.8]], [-2.9, 20.1]
    also = [[0.2, 0.3], [-0.5, -0.5], [-0.6, 0.3], [1.2, 0.1]], [1.4, 21.0]
    for change, point in (moved, also):  # folded nodes: cubics have 2e9 and 5e6
        foot = foot_points(polynomials, (nodes + change)[None], np.array([point]), np.array([0.5]))
        at_foot, _ = foot.shape_functions()
        assert np.abs(at_foot).max() < 1e4


def test_balls_are_inside_of_the_cam() -> None:
    """Centres lie at their angles and at their distance from the cam's curve; a round cam has them
    on a circle."""
    cam, angle = EllipticalCam(21.0, 19.0), np.linspace(-3.0, 3.0, 13)
    centre, normal, _ = ball_lines(cam, 2.5, angle)
    assert np.arctan2(-centre[:, 0], centre[:, 1]) == pytest.approx(angle, abs=1e-12)
    assert cam.evaluate(centre)[0] == pytest.approx(np.full(13, -2.5), abs=1e-12)
    foot = centre + 2.5 * normal
    assert cam.evaluate(foot)[0] == pytest.approx(np.zeros(13), abs=1e-12)
    _, _, curvature = ball_lines(EllipticalCam(20.0, 20.0), 2.5, angle)
    assert curvature == pytest.approx(np.full(13, 1.0 / 17.5), rel=1e-12)


@pytest.mark.parametrize(("size", "factor"), [(0.05, 46.7), (0.1, 55.5), (0.2, 59.9)])
def test_load_rating_of_iso_281(size: float, factor: float) -> None:
    """f_c of table 2 of ISO 281 for deep groove ball bearings, with conformities of 0.52."""
    series = BearingSeries(9, 10.0, 10.0 / size, 0.52, 0.52)
    assert series.load_rating() == pytest.approx(
        1.3 * factor * 9 ** (2.0 / 3.0) * 10.0**1.8, rel=0.002
    )


def test_life_by_equal_loads() -> None:
    """Equal loads: the mean load is that load, and life falls with its third power."""
    series = BearingSeries(20, 2.0, 34.0, 0.52, 0.53)
    rating = series.load_rating()
    inner, outer = series.contact_capacities(rating)
    expected = ((inner / 30.0) ** (-10.0 / 3.0) + (outer / 30.0) ** (-10.0 / 3.0)) ** -0.9
    assert million_turns(series, rating, np.full((4, 20), 30.0)) == pytest.approx(
        expected, rel=1e-12
    )
    assert million_turns(series, rating, np.full((4, 20), 60.0)) == pytest.approx(
        expected / 8.0, rel=1e-12
    )
    assert million_turns(series, rating, np.zeros((4, 20))) == np.inf


def test_one_loaded_ball_in_turn() -> None:
    """A race that rotates relative to the load has the mean of power 3, the other one that of power
    10 / 3."""
    series = BearingSeries(20, 2.0, 34.0, 0.52, 0.53)
    rating, loads = series.load_rating(), np.zeros(20)
    loads[3] = 30.0
    inner, outer = series.contact_capacities(rating)
    means = 30.0 / 20.0**0.3, 30.0 / 20.0 ** (1.0 / 3.0)
    expected = ((inner / means[0]) ** (-10.0 / 3.0) + (outer / means[1]) ** (-10.0 / 3.0)) ** -0.9
    assert million_turns(series, rating, loads) == pytest.approx(expected, rel=1e-12)


BAD = [
    ("balls=2", "balls", "3 to 2000"),
    ("balls=60", "balls", "3 to 53"),
    ("ball_diameter=0", "ball_diameter", "above 0"),
    ("ball_diameter=18", "ball_diameter", "smallest radius of curvature"),
    ("race_thickness=-1", "race_thickness", "above 0"),
    ("race_thickness=1e-6", "race_thickness", "0.01 modules"),
    ("race_thickness=17", "race_thickness", "smallest radius of curvature"),
    ("race_width=9", "race_width", "drive.face_width"),
    ("clearance=-1.0", "clearance", "half the deflection"),
    ("clearance=1.0", "clearance", "half the deflection"),
    ("inner_conformity=0.5", "inner_conformity", "above 0.5"),
    ("outer_conformity=3", "outer_conformity", "2"),
    ("cage_speed=1.2", "cage_speed", "0 to 1"),
    ("material={E=210e3, nu=0.5}", "material.nu", "0.499"),
    ("E=210e3", "E", "did you mean wave_generator.bearing.material.E"),
    ("stiffness_factor=0", "stiffness_factor", "above 0"),
    ("load_rating=-5", "load_rating", "above 0"),
    ("colour=1", "colour", "not a key"),
]


@pytest.mark.parametrize(("override", "key", "words"), BAD)
def test_bad_bearing(override: str, key: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        load_design(DESIGN, [*PLANE, *BEARING, f"wave_generator.bearing.{override}"])
    message = str(caught.value)
    assert f"wave_generator.bearing.{key}" in message and words in message and "\n" not in message


BEARING_KEYS = "wave_generator.bearing"
CUP = ("micro_geometry.wg_slope=0", *BEARING)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ((*PLANE, *BEARING, "wave_generator.bearing.race_taper=0.01"), "which has no open end"),
        ((*CUP, "wave_generator.bearing.race_taper=-1.2"), "allowed -1 to 1 mm"),
        (BEARING, "micro_geometry.wg_slope = 0.1 is out of range: allowed only 0 with wave_gen"),
    ],
)
def test_bad_tapers(overrides: tuple[str, ...], words: str) -> None:
    with pytest.raises(InputError, match=words):
        load_design(DESIGN, overrides)


def test_a_taper_raises_the_race_under_the_open_end() -> None:
    """By its amount at the ends of the race's width, beside crowning and interference."""
    design = load_design(
        DESIGN,
        [*CUP, "wave_generator.bearing.race_taper=0.03", "wave_generator.bearing.race_width=3"],
    )
    z = np.array([-1.5, 0.0, 1.5])  # the closed end is at z > 0
    crowned = 0.1 * (z / 2.0) ** 2
    assert race_relief(design)(z) - crowned == pytest.approx([-0.03, 0.0, 0.03], abs=1e-15)


SIDE = {"a_p": 0.0315, "C_p": 0.6, "r_c": 5.0}
CAMS = {
    "elliptical": {},
    "harmonic": {},
    "simplified": {"C": 0.97},
    "arcs": {"beta": 45.0},
    "parabolic": SIDE,
    "asymmetric_parabolic": {"right": SIDE, "left": {**SIDE, "r_c": 6.0}},
    "polar": {"radius": "a - (a - b) * sin(0.5 * n * theta)**2"},
    "points": {"coordinates": "polar"},
    "four_roller": {"beta": 10.0, "r_4": 2.5},
    "two_roller": {"r_2": 6.0},
}
FOLLOWED = "with cams whose curve an inner race can follow"
REFUSED = {
    2: {"four_roller": FOLLOWED, "two_roller": FOLLOWED},
    3: dict.fromkeys(
        ("elliptical", "simplified", "arcs", "parabolic", "asymmetric_parabolic")
        + ("four_roller", "two_roller"),
        'allowed with "harmonic", "polar" or "points"',
    ),
}
"""Words of refusals by lobes and types of cams; those that are not named take a bearing."""


@pytest.mark.parametrize("lobes", [2, 3])
@pytest.mark.parametrize("kind", CAMS)
def test_every_cam_with_a_bearing(kind: str, lobes: int) -> None:
    """A bearing works on all cams that are no rollers, with the lobes that they may have."""
    design = load_design(DESIGN, PLANE if lobes == 2 else MODELS["plane"])
    keys = dict(CAMS[kind])
    if kind == "polar":
        keys["parameters"] = {"n": lobes}
    if kind == "points":
        wave = 0.5 * lobes * design.drive.module
        angles = np.linspace(0.0, 180.0 / lobes, 19)
        radii = design.inner_radius + wave * np.cos(lobes * np.radians(angles))
        keys["points"] = np.column_stack([angles, radii]).tolist()
    bearing = {"balls": 12, "ball_diameter": 2.0, "race_thickness": 0.5}
    wave_generator = {"type": kind, "lobes": lobes, "face_width": 4.0, "bearing": bearing, **keys}
    words = REFUSED[lobes].get(kind)
    if words:
        with pytest.raises(InputError, match=words):
            design.with_values({"wave_generator": wave_generator})
        return
    found = design.with_values({"wave_generator": wave_generator})
    assert found.copies == lobes
    centre, _, _ = found.grown_ball_lines()(np.zeros(1))
    assert centre[0, 1] == pytest.approx(found.major_semi_axis - 1.5, abs=1e-3)


@pytest.mark.parametrize("depth", [0.0, 2.0])
def test_hollows_of_a_cam(depth: float) -> None:
    """A straight line that touches two lobes leaves the place between them by the support of the
    curve in that direction less its radius."""
    for b, hollow in ((25.5, False), (22.0, True)):
        cam = HarmonicCam(30.0, b, 3)
        curve = cam.outline(20000)
        curve = curve - depth * cam.evaluate(curve)[1]
        expected = float(-curve[:, 1].min() - (b - depth))  # midway between two lobes is at -y
        assert (expected > 0.1) == hollow
        assert depth_of_hollows(cam, depth) == pytest.approx(expected, abs=1e-4)


def test_a_hollow_cam_is_refused() -> None:
    """The inner race cannot lie in a hollow between two lobes. A rigid cam may have one."""
    words = "hollow by 0.* mm at the inner race, which is pressed on it and spans hollows"
    curve = "0.5 * (a + b) + 0.5 * (a - b) * (0.8 * cos(3 * theta) + 0.2 * cos(9 * theta))"
    bearing = {"balls": 12, "ball_diameter": 2.0, "race_thickness": 0.5}
    keys = {"type": "polar", "lobes": 3, "face_width": 4.0, "radius": curve}
    design = load_design(DESIGN, MODELS["plane"]).with_values({"wave_generator": keys})
    with pytest.raises(InputError, match=words):
        design.with_values({"wave_generator.bearing": bearing})


def test_few_balls_for_the_lobes() -> None:
    """Small balls that are pi / Z from one of n lobes lie w0 (1 - cos(n pi / Z)) lower: 0.109 w0
    with 20 balls on three lobes, 0.115 w0 with 13 on two, and less than 0.1 w0 with one more."""
    thin = (f"{BEARING_KEYS}.ball_diameter=0.3", f"{BEARING_KEYS}.race_thickness=0.05")
    cam = ("wave_generator.type=harmonic", "wave_generator.C=1")
    for keys, few in ((PLANE, 13), (MODELS["plane"], 20)):
        first, second = (
            remarks(load_design(DESIGN, [*keys, *cam, *thin, f"{BEARING_KEYS}.balls={balls}"]))
            for balls in (few, few + 1)
        )
        (said,) = set(first) - set(second)
        assert f"{BEARING_KEYS}.balls = {few} are few for" in said
        assert "they lie 11 % of half the deflection lower than its tip" in said


def test_balls_that_differ_from_lobe_to_lobe() -> None:
    """Where lobes do not divide the balls, all of the drive is modelled. The second lobe reaches
    the teeth of the first one after half of a period. The balls have gone on by half of a place
    then, if they pass, and a number that is odd has them at this place at the second lobe."""
    sampled = ("steps.rotation=9.0", "drive.teeth_fs=41", "drive.teeth_rg=43")
    fixed = "wave_generator.bearing.cage_speed=1"
    for balls, keys, repeats in ((20, (), 1), (19, (), 2), (20, (fixed,), 2), (19, (fixed,), 1)):
        given = (*PLANE, *BEARING, *sampled, *keys, f"wave_generator.bearing.balls={balls}")
        kinematics = load_design(DESIGN, [*given, "steps.samples=4"]).kinematics
        assert kinematics.repeats(4) == repeats
        assert kinematics.apart(4) == (4 if repeats == 1 else 3)
    for balls, copies in ((20, 1), (21, 3)):
        given = (*MODELS["plane"], *BEARING, f"wave_generator.bearing.balls={balls}")
        assert load_design(DESIGN, given).copies == copies


def test_cage_speed() -> None:
    """Rolling balls: the cage has the mean of the speeds of both races, weighted by their radii."""
    design = load_design(DESIGN, [*PLANE, *BEARING])
    inner, outer = 18.6 - 0.5 - 2.0, 18.6 - 0.5
    assert design.cage_speed == pytest.approx((inner - outer / 20.0) / (inner + outer), rel=1e-12)
    assert (
        load_design(DESIGN, [*PLANE, *BEARING, "wave_generator.bearing.cage_speed=0.4"]).cage_speed
        == 0.4
    )
    period = (*PLANE, *BEARING, "steps.samples=4", "steps.rotation=9.0")
    sampled, pitch = load_design(DESIGN, period), 2.0 * np.pi / 42
    assert sampled.rolling_speed == design.rolling_speed
    # a ball has the place of its neighbour after one period
    assert (sampled.cage_speed - 1.0) * pitch == pytest.approx(2.0 * np.pi / 20, rel=1e-12)
    fixed = load_design(DESIGN, [*period, "wave_generator.bearing.cage_speed=1"])
    assert fixed.cage_speed == 1.0 and np.isinf(ball_passing_angle(fixed.cage_speed, 20))


@pytest.mark.parametrize("samples", range(2, 17))
def test_angles_of_a_period_show_all_places_of_balls(samples: int) -> None:
    """Teeth and balls take evenly spaced places each, and no wave in which both move together by
    their first orders is taken for the mean, where there are angles enough."""
    for teeth_per_ball, pitches in ((2.0, 1), (4.5, 1), (7.3, 1), (2.0, 7)):
        if gcd(samples, pitches) > 1:
            continue
        number = np.arange(samples)
        balls = ball_passings(samples, teeth_per_ball, pitches) * number % samples
        teeth = pitches * number % samples
        assert sorted(balls) == sorted(teeth) == list(number)
        if samples > 3:
            assert len(set((teeth + balls) % samples)) > 1


def test_one_angle_has_no_passing() -> None:
    assert ball_passings(1, 4.5) == 0
