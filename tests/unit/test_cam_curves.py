"""Cams from expressions and from points: against closed forms, files, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, DRIVERS, RECIPE
from support.small_drive import PLANE as SMALL_PLANE
from support.small_drive import SHORT
from swgpar.checks.derived_geometry import derived_geometry
from swgpar.checks.remarks import remarks
from swgpar.errors import InputError
from swgpar.geometry.cams import EllipticalCam, HarmonicCam, make_cam, taut_length
from swgpar.geometry.cams.expression import PolarExpression
from swgpar.geometry.cams.keys import Polar
from swgpar.geometry.cams.simplified import simplified
from swgpar.input.curve_file import read_curve

PLANE = DRIVERS / "plane_half_turn.toml"
EXAMPLES = sorted((DRIVERS / "wave_generators").glob("*.toml"))
A, B = 59.2, 57.2
COSINE = "(a + b) / 2 + (a - b) / 2 * cos(2 * theta)"
POLYNOMIAL = "s = theta / (pi / 2); a - (a - b) * (10 * s**3 - 15 * s**4 + 6 * s**5)"


def on(kind: str, **keys: Any) -> swgpar.DriveDesign:
    return swgpar.load_design(PLANE, {"wave_generator": {"type": kind, "face_width": 10.0, **keys}})


def near(cam: Any, count: int = 997) -> np.ndarray:
    """Points up to 1.5 mm beside a cam."""
    outline = cam.outline(count)
    return outline * np.linspace(0.975, 1.025, count)[:, None]


def assert_same(given: Any, expected: Any, tolerance: float) -> None:
    """Distances (mm) within the tolerance, normals and Hessians as they follow from it."""
    for x in (near(expected), expected.outline(500)):
        distance, normal, k = given.evaluate(x)
        distance0, normal0, k0 = expected.evaluate(x)
        assert np.abs(distance - distance0).max() <= tolerance
        assert np.abs(normal - normal0).max() <= tolerance
        assert np.abs(k - k0).max() <= tolerance


def test_an_expression_of_the_harmonic_cam() -> None:
    assert_same(on("polar", radius=COSINE).cam(), HarmonicCam(A, B, 2), 1e-9)


def test_an_expression_with_three_lobes() -> None:
    keys = Polar(type="polar", face_width=10.0, lobes=3, radius=COSINE.replace("2 * t", "3 * t"))
    assert_same(make_cam(keys, A, B), HarmonicCam(A, B, 3), 1e-9)


def test_the_polynomial_of_fifth_degree() -> None:
    """Radius against the polynomial at angles between those of the table, curvature against that
    of its derivatives."""
    cam = on("polar", radius=POLYNOMIAL).cam()
    theta = np.random.default_rng(5).uniform(-np.pi, np.pi, 400)
    s = np.abs(np.angle(np.exp(2j * theta))) / np.pi
    radius = np.polynomial.Polynomial([A, 0.0, 0.0, -20.0, 30.0, -12.0])
    rate = 2.0 / np.pi
    r, r1, r2 = (radius.deriv(k)(s) * rate**k for k in range(3))
    foot = r[:, None] * np.column_stack([-np.sin(theta), np.cos(theta)])
    distance, _, k = cam.evaluate(foot)
    assert np.abs(distance).max() < 1e-9
    assert k == pytest.approx((r**2 + 2.0 * r1**2 - r * r2) / np.hypot(r, r1) ** 3, abs=1e-8)


def test_derivatives_of_an_expression() -> None:
    """Every function and operation, by central differences."""
    text = (
        "u = sin(theta) + cos(2 * theta) / 7; v = exp(-u) * log(3 + theta) + tan(theta / 3)\n"
        "w = abs(theta - 5) ** 1.5 - sqrt(v + 4)\nw - -u if 0 < theta < 1 and theta > 0.5 "
        "or theta >= 2 else +v ** 3"
    )
    theta, h = np.array([0.2, 0.7, 1.5, 2.3]), 1e-4
    expression = PolarExpression(text, {}, "radius")
    low, here, high = (expression(theta + step) for step in (-h, 0.0, h))
    assert here.first == pytest.approx((high.value - low.value) / (2.0 * h), rel=1e-6)
    assert here.second == pytest.approx((high.first - low.first) / (2.0 * h), rel=1e-6)
    u = np.sin(0.7) + np.cos(1.4) / 7.0
    v = np.exp(-u) * np.log(3.7) + np.tan(0.7 / 3.0)
    assert here.value[1] == pytest.approx(4.3**1.5 - np.sqrt(v + 4.0) + u, rel=1e-14)


def test_circle_and_ellipse() -> None:
    """Of the example: the points lie on the circle up to the joint, and beyond on one ellipse
    that has its tangent there."""
    design = swgpar.load_design(DRIVERS / "wave_generators" / "circle_and_ellipse.toml")
    cam, rho, t = design.cam(), *design.wave_generator.parameters.values()
    outline = cam.outline(7200)
    theta = np.abs(np.arctan2(-outline[:, 0], outline[:, 1]))
    theta = np.minimum(theta, np.pi - theta)
    x, y = np.abs(outline[theta < t]).T
    assert np.hypot(x, y - (A - rho)) == pytest.approx(rho, abs=1e-9)
    x, y = outline[theta > t].T ** 2
    inverse = np.linalg.lstsq(np.column_stack([x, y]), np.ones(len(x)), rcond=None)[0]
    assert np.abs(np.column_stack([x, y]) @ inverse - 1.0).max() < 1e-9
    joint = cam.evaluate(np.array([[np.sin(t + d), np.cos(t + d)] for d in (-1e-7, 1e-7)]) * 58.9)
    assert joint[1][0] == pytest.approx(joint[1][1], abs=1e-6)
    assert cam.deviation < 1e-7


@pytest.mark.parametrize("part", [360, 180, 90])
@pytest.mark.parametrize("coordinates", ["cartesian", "polar"])
def test_points_of_an_ellipse(part: int, coordinates: str) -> None:
    """Of the whole cam, of one lobe, of half a lobe; exact points, one degree apart."""
    expected = EllipticalCam(A, B)
    theta = np.radians(np.arange(-part // 2 if part == 180 else 0, part // (1 + (part == 180)) + 1))
    radius = 1.0 / np.hypot(np.cos(theta) / A, np.sin(theta) / B)
    points = np.column_stack([np.degrees(theta), radius])
    if coordinates == "cartesian":
        points = radius[:, None] * np.column_stack([-np.sin(theta), np.cos(theta)])
    keys = {"points": points.tolist(), "coordinates": coordinates}
    assert_same(on("points", tolerance=0.0, **keys).cam(), expected, 1e-8)
    design = on("points", **keys)
    assert design.cam().deviation < 0.0025
    values = derived_geometry(design)
    assert values["largest deviation of the cam from what is given (mm)"] == design.cam().deviation
    assert values["radial deflection at the major axis (mm)"] == pytest.approx(1.0, abs=0.002)


def test_polar_points_across_the_full_turn() -> None:
    """Angles from 300 over 360 to 295 degrees, clockwise in the file."""
    angle = np.arange(0.0, 360.0, 5.0) + 300.0
    radius = 0.5 * (A + B) + 0.5 * (A - B) * np.cos(2.0 * np.radians(angle))
    points = np.column_stack([angle % 360.0, radius])[::-1].tolist()
    cam = on("points", points=points, coordinates="polar", tolerance=0.0).cam()
    assert_same(cam, HarmonicCam(A, B, 2), 1e-6)


def test_points_of_a_curve_whose_curvature_jumps() -> None:
    cam = on("points", points=simplified(A, B).outline(1440).tolist()).cam()
    assert cam.deviation < 0.0025
    x = near(cam)
    distance = simplified(A, B).evaluate(x)[0]
    assert np.abs(cam.evaluate(x)[0] - distance).max() < 0.003


def test_points_with_different_sides() -> None:
    side, other = (
        {"a_p": a, "C_p": c, "r_c": r} for a, c, r in ((0.0095, 0.45, 12.0), (0.0097, 0.51, 10.0))
    )
    whole = on("asymmetric_parabolic", right=side, left=other).cam()
    points = whole.outline(1440).tolist()
    with pytest.raises(InputError, match=r"with equal lobes and sides.*symmetric = false"):
        on("points", points=points)
    design = on("points", points=points, symmetric=False)
    assert design.cam().deviation < 0.0025 and not design.is_mirror_symmetric
    with pytest.raises(InputError, match="whose sides differ"):
        design.with_values({"ring_gear.profile": {"type": "conjugate", "r_root": 0.2}})


def test_a_file_is_found_beside_the_design(tmp_path: Path) -> None:
    """The design keeps the points, so that its own file stands alone."""
    theta = np.radians(np.arange(0.0, 91.0, 2.0))
    points = np.column_stack([-np.sin(theta), np.cos(theta)]) * A
    points[:, 0] *= B / A
    (tmp_path / "cam.csv").write_text(
        "x (mm); y (mm)\n" + "".join(f"{x:.5f}; {y:.5f}\n".replace(".", ",") for x, y in points),
        encoding="utf-8",
    )
    text = PLANE.read_text(encoding="utf-8")
    path = tmp_path / "design.toml"
    path.write_text(
        text.replace('type = "elliptical"\nC = 1.0', 'type = "points"\nfile = "cam.csv"'), "utf-8"
    )
    design = swgpar.load_design(path)
    assert design.wave_generator.file is None
    assert np.allclose(design.wave_generator.points, points, atol=1e-5)
    (tmp_path / "cam.csv").unlink()
    again = swgpar.load_design(design.model_dump(exclude_unset=True))
    assert again == design and again.with_values({"load.torque": 1.0}).cam().deviation < 0.002


@pytest.mark.parametrize("kind", ["dxf", "csv"])
def test_an_exported_cam_comes_back(kind: str, tmp_path: Path) -> None:
    """The same distances within 0.1 micrometres, and the same stress of a run within 1e-4."""
    file, *_ = swgpar.export(DESIGN, tmp_path, formats=[kind])
    keys = {"type": "points", "face_width": 4.0, "file": str(file)}
    if kind == "dxf":
        keys["layer"] = "wave_generator"
    keys["pin_half_angle"] = 15.0  # the default of an ellipse
    given = swgpar.load_design(DESIGN, [*SMALL_PLANE, *SHORT])
    again = given.with_values({"wave_generator": {**keys, "tolerance": 1e-6}})
    assert_same(again.cam(), given.cam(), 1e-4)
    runs = [swgpar.run(each, RECIPE, plain=True, progress=False) for each in (given, again)]
    stresses = [run.history["fs_s1"] for run in runs]
    assert stresses[1] == pytest.approx(stresses[0], rel=1e-4)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_have_teeth_that_fit(path: Path) -> None:
    assert not remarks(swgpar.load_design(path))


def test_a_curve_of_lines_and_arcs_in_inches(tmp_path: Path) -> None:
    """A stadium whose parts are drawn in any order and direction."""
    document = ezdxf.new("R2010", units=1)
    space = document.modelspace()
    for x in (-1, 1):
        space.add_line((x, 1), (x, -1), dxfattribs={"layer": "cam"})
    space.add_arc((0, -1), 1, 180, 360, dxfattribs={"layer": "cam"})
    space.add_arc((0, 1), 1, 0, 180, dxfattribs={"layer": "cam"})
    space.add_circle((9, 9), 1, dxfattribs={"layer": "hole"})
    path = tmp_path / "cam.dxf"
    document.saveas(path)
    points = read_curve(path, "cam")
    distance = simplified(50.8, 25.4).evaluate(points)[0]
    assert np.abs(distance).max() < 1e-9
    step = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    assert step.sum() == pytest.approx(25.4 * (4.0 + 2.0 * np.pi), rel=1e-6)
    for layer, words in (("saw", '"cam", "hole"'), (None, "more than one curve")):
        with pytest.raises(InputError, match=words):
            read_curve(path, layer)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1, 2\n3, 4, 5\n", "line 2"),
        ("1, 2\nx, 5\n", "line 2"),
        ("a\nb\n", "line 2"),
        ("x, y\n1, nan\n", "line 2"),
        ("# nothing\n", "has no points"),
    ],
)
def test_lines_that_are_no_points(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        read_curve(path)
    with pytest.raises(InputError, match="allowed .csv"):
        read_curve(tmp_path / "points.xyz")


@pytest.mark.parametrize(
    ("radius", "words"),
    [
        ("", "no expression at its end"),
        ("a +", "cannot be read"),
        ("c = a", "no expression at its end"),
        ("__import__('os').getcwd()", "is refused"),
        ("a.real", "is refused"),
        ("[a for a in b]", "is refused"),
        ("(lambda: a)()", "is refused"),
        ("'a'", "is refused"),
        ("True * a", "is refused"),
        ("a if a else b", "comparisons"),
        ("a // b", "allowed \\+ - "),
        ("a ** theta", "exponents that do not depend"),
        ("a + 0 * 9 ** 9 ** 9 ** 9", "allowed finite exponents"),
        ("sin(a, b)", "one argument"),
        ("foo", "allowed a, b, theta, pi"),
        ("pi = 3; a", "another name"),
        ("x, y = a; a", "is refused"),
        ("-" * 400 + "a", "parts"),
        ("9 ** 9 ** 9", "finite values"),
        ("1" * 400 + " * a", "numbers up to"),
        ("a / theta", "finite values"),
        ("b", "the major semi-axis is 59.2"),
        ("a - 0.1 * theta", "kink"),
        ("a - 0.1 * abs(theta - 0.3) + 0.03", "kink"),
        ("a if theta < 1 else b", "step"),
        ("a * (1 + 0.7 * (cos(2 * theta) - 1) / 2)", "has the radius 17.76 mm at"),
        ("a - 0.4 * a * sin(theta) ** 8", "is concave with the radius"),
    ],
)
def test_expressions_that_give_no_cam(radius: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        on("polar", radius=radius)


def test_a_parallel_curve() -> None:
    """Its points are 6 mm away from many points of the ellipse, and it is longer by a circle of
    that radius (Steiner); a point between the curves is as far from both as it should be."""
    design = on("elliptical", major_axis=2.0 * A - 12.0, minor_axis=2.0 * B - 12.0, offset=6.0)
    cam, curve = design.cam(), EllipticalCam(A - 6.0, B - 6.0)
    assert (design.deflection, design.minor_semi_axis) == (pytest.approx(2.0), pytest.approx(B))
    dense = curve.outline(100_000)
    for point in cam.outline(12):
        assert np.hypot(*(dense - point).T).min() == pytest.approx(6.0, abs=1e-6)
    exact = taut_length(curve, 20_000) + 12.0 * np.pi
    assert taut_length(cam, 20_000) == pytest.approx(exact, rel=1e-7)
    assert cam.evaluate(np.array([[0.0, A - 2.0]]))[0][0] == pytest.approx(-2.0, abs=1e-12)
    x, h = near(cam, 50), 1e-5
    for k in range(2):
        step = h * np.eye(2)[k]
        slope = (cam.evaluate(x + step)[0] - cam.evaluate(x - step)[0]) / (2.0 * h)
        assert slope == pytest.approx(cam.evaluate(x)[1][:, k], abs=1e-8)


def test_a_cam_within_a_bearing() -> None:
    """Points of the cam's own contour, 3.2 mm inside of the bore, with a clearance of 0.05 mm."""
    points = EllipticalCam(A - 3.2, B - 3.2).outline(180).tolist()
    design = on("points", points=points, offset=3.2 - 0.05, tolerance=1e-5)
    assert design.deflection == pytest.approx(2.0 * (1.0 - 0.05), abs=2e-4)
    assert design.tooth_motion().line.deflections[0] == pytest.approx(0.95, abs=2e-4)
    assert derived_geometry(design)["largest deviation of the cam from what is given (mm)"] < 1e-4


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"type": "two_roller", "r_2": 9.0, "offset": 1.0}, "not available with"),
        ({"type": "elliptical", "offset": 40.0}, "offset = 40 is out of range"),
        ({"type": "simplified", "C": 0.9, "major_axis": 90.0, "offset": -42.0}, "major_axis = 90"),
        ({"type": "points", "points": EllipticalCam(0.9 * A, 0.9 * B).outline(60).tolist(),
          "offset": 3.0}, r"the bore less wave_generator.offset"),
    ],
)  # fmt: skip
def test_offsets_that_do_not_fit(keys: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        on(keys.pop("type"), **keys)


def test_parameters() -> None:
    text = "a - k * sin(theta)**2"
    assert on("polar", radius=text, parameters={"k": 2.0}).cam().outline(4)[1] == pytest.approx(
        [-B, 0.0]
    )
    for name in ("sin", "theta", "2k"):
        with pytest.raises(InputError, match=f"parameters.{name}"):
            on("polar", radius=text, parameters={"k": 2.0, name: 1.0})


AROUND = np.radians(np.arange(0.0, 360.0, 5.0))
CIRCLE = [[-A * np.sin(t), A * np.cos(t)] for t in AROUND]
WAVE = 0.5 * (A + B) + 0.5 * (A - B) * np.cos(2.0 * AROUND)
COSINES = [[-r * np.sin(t), r * np.cos(t)] for r, t in zip(WAVE, AROUND, strict=True)]


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"points": COSINES[:5]}, "has 5 points"),
        ({"points": COSINES[:16]}, "cover 75 degrees: allowed are 360, or 180"),
        ({"points": COSINES[:19], "symmetric": False}, "cover 90 degrees"),
        ({"points": COSINES[::6]}, "30 degrees apart"),
        ({"points": [*COSINES[:40], *COSINES[30:]]}, "points.40 and its neighbour.*go back"),
        ({"points": [[*point, 0.0] for point in COSINES]}, "points.1 has 3 numbers"),
        ({"points": [[0.0, 0.0], *COSINES]}, "points.1 has the radius 0"),
        (
            {"points": COSINES, "rotation": 80.0},
            "rotation = 80 leaves .* 80 .* example 0",
        ),
        (
            {"points": [*COSINES[:40], *COSINES[30:]][::-1]},
            "points.43 and its neighbour.*go back",
        ),
        ({"points": COSINES, "deflection": 1.0}, "deflection = 1 is given beside points"),
        ({"points": [[0.9 * x, 0.9 * y] for x, y in COSINES]}, "53.28.* mm at the major axis"),
        ({"points": [*COSINES[:30], *CIRCLE[30:]]}, "scatter about a smooth curve"),
        ({"points": COSINES, "file": "cam.csv"}, "are both given"),
        ({"file": "no_such_file.csv"}, "cannot be read"),
        ({}, "has 0 points"),
        ({"points": "ellipse"}, "not a list"),
    ],
)
def test_points_that_give_no_cam(keys: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        on("points", **keys)
