"""The cam's surface: distance, normal and curvature against dense searches, joints, perimeters,
pins, derivatives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import ellipe

from support.paths import DRIVERS, REFERENCE
from swgpar import load_design
from swgpar.checks.derived_geometry import derived_geometry
from swgpar.contact.rigid_surface import pin_directions
from swgpar.errors import InputError
from swgpar.geometry.cams import EllipticalCam, HarmonicCam, pin_travel, taut_length
from swgpar.geometry.cams.arcs import arcs
from swgpar.geometry.cams.parabolic import Side, parabolic
from swgpar.geometry.cams.piecewise import Parabola, PiecewiseCam
from swgpar.geometry.cams.rollers import RollerCam, rollers
from swgpar.geometry.cams.simplified import simplified
from swgpar.geometry.micro_geometry import WaveGeneratorSurface, crowning
from swgpar.geometry.rotation import rotated
from swgpar.load.load_sequence import load_sequence, start_state
from swgpar.load.load_states import Stage

A, B, R_FS = 59.2, 57.2, 58.2


@dataclass(frozen=True)
class Curve:
    """A piece x(t) of a reference curve, low <= t <= high, with its first two derivatives:
    functions (n,) to (n, 2)."""

    low: float
    high: float
    x: Callable
    dx: Callable
    ddx: Callable

    def turned(self) -> Curve:
        """The piece after half a turn."""
        return Curve(
            self.low, self.high, *(lambda t, f=f: -f(t) for f in (self.x, self.dx, self.ddx))
        )


def columns(x, y) -> np.ndarray:
    return np.stack(np.broadcast_arrays(x, y), axis=-1)


def arc(cx: float, cy: float, r: float, low: float, high: float) -> Curve:
    return Curve(
        low,
        high,
        lambda t: columns(cx + r * np.cos(t), cy + r * np.sin(t)),
        lambda t: columns(-r * np.sin(t), r * np.cos(t)),
        lambda t: columns(-r * np.cos(t), -r * np.sin(t)),
    )


def ellipse(a: float, b: float) -> list[Curve]:
    whole = Curve(
        0.0,
        2.0 * np.pi,
        lambda t: columns(b * np.cos(t), a * np.sin(t)),
        lambda t: columns(-b * np.sin(t), a * np.cos(t)),
        lambda t: columns(-b * np.cos(t), -a * np.sin(t)),
    )
    return [whole]


def harmonic(a: float, b: float, lobes: int) -> list[Curve]:
    """x = r (cos t, sin t) with r = m + w cos(lobes (t - pi / 2)), by the product rule."""
    m, w = 0.5 * (a + b), 0.5 * (a - b)

    def wave(t):
        phase = lobes * (t - 0.5 * np.pi)
        return m + w * np.cos(phase), -lobes * w * np.sin(phase), -(lobes**2) * w * np.cos(phase)

    def first(t):
        (r, dr, _), c, s = wave(t), np.cos(t), np.sin(t)
        return columns(dr * c - r * s, dr * s + r * c)

    def second(t):
        (r, dr, ddr), c, s = wave(t), np.cos(t), np.sin(t)
        return columns((ddr - r) * c - 2.0 * dr * s, (ddr - r) * s + 2.0 * dr * c)

    return [
        Curve(
            0.0,
            2.0 * np.pi,
            lambda t: columns(wave(t)[0] * np.cos(t), wave(t)[0] * np.sin(t)),
            first,
            second,
        )
    ]


def stadium(a: float, r: float) -> list[Curve]:
    h = a - r
    side = Curve(
        -h,
        h,
        lambda t: columns(r, t),
        lambda t: columns(0.0, 1.0 + 0.0 * t),
        lambda t: columns(0.0, 0.0 * t),
    )
    top = arc(0.0, h, r, 0.0, np.pi)
    return [side, top, side.turned(), top.turned()]


def oval(a: float, b: float, beta: float) -> list[Curve]:
    """Both radii from the joint: the centres lie on its normal, (sin beta, cos beta)."""
    s, c = np.sin(beta), np.cos(beta)
    r, outer = np.linalg.solve([[s, 1.0 - s], [1.0 - c, c]], [b, a])
    side = arc(b - outer, 0.0, outer, beta - 0.5 * np.pi, 0.5 * np.pi - beta)
    top = arc(0.0, a - r, r, 0.5 * np.pi - beta, 0.5 * np.pi + beta)
    return [side, top, side.turned(), top.turned()]


def quarter(
    a: float, b: float, a_p: float, C_p: float, r_c: float, tilt: float, mirror: float
) -> list[Curve]:
    """Right side of a lobe from eqs 3.5 to 3.11, its aperture by a root of the source's equation;
    mirror = -1: left."""
    c, s = np.cos(tilt), np.sin(tilt)

    def placed(x, y):
        return columns(mirror * (c * x - s * y), s * x + c * y)

    end = C_p * b
    curve = Curve(
        0.0,
        end,
        lambda t: placed(t, -a_p * t**2) + [0.0, a],
        lambda t: placed(1.0 + 0.0 * t, -2.0 * a_p * t),
        lambda t: placed(0.0 * t, -2.0 * a_p + 0.0 * t),
    )
    # to the right side: the mirror image of everything at the end
    px, py = curve.x(np.array(end)) * [mirror, 1.0]
    tx, ty = curve.dx(np.array(end)) * [mirror, 1.0]
    theta = np.arctan2(tx, -ty)
    cx, cy = px - r_c * np.cos(theta), py - r_c * np.sin(theta)

    def miss(alpha: float) -> float:
        r_l = r_c + cy / np.sin(alpha)
        return cx - (r_l - r_c) * np.cos(alpha) - (b - r_l)

    alpha = brentq(miss, 1e-6, theta, xtol=1e-15, rtol=1e-15)
    r_l = r_c + cy / np.sin(alpha)
    if mirror > 0.0:
        return [arc(b - r_l, 0.0, r_l, 0.0, alpha), arc(cx, cy, r_c, alpha, theta), curve]
    pi = np.pi
    return [
        curve,
        arc(-cx, cy, r_c, pi - theta, pi - alpha),
        arc(r_l - b, 0.0, r_l, pi - alpha, pi),
    ]


def parabola(a: float, b: float, right: tuple, left: tuple, tilt: float) -> list[Curve]:
    upper = quarter(a, b, *right, tilt, 1.0) + quarter(a, b, *left, -tilt, -1.0)
    return upper + [piece.turned() for piece in upper]


def circles(reach: float, beta: float, r: float) -> list[Curve]:
    x, y = reach * np.sin(beta), reach * np.cos(beta)
    sides = (1, -1) if beta else (1,)
    return [arc(i * x, j * y, r, -np.pi, np.pi) for i in sides for j in (1, -1)]


IMPROVED, OTHER = (0.0097, 0.51, 10.0), (0.0095, 0.45, 12.0)
STEEP = (0.0162, 0.86, 5.0)
LAMBDA = np.radians(0.5)
BETA = np.radians(10.0)
CAMS = {
    "elliptical": (EllipticalCam(A, B), ellipse(A, B)),
    "elliptical-0.5": (EllipticalCam(A, 0.5 * B), ellipse(A, 0.5 * B)),
    "harmonic": (HarmonicCam(A, B, 2), harmonic(A, B, 2)),
    "harmonic-three": (HarmonicCam(A + 0.5, B - 0.5, 3), harmonic(A + 0.5, B - 0.5, 3)),
    "harmonic-three-deep": (HarmonicCam(A, 0.85 * A, 3), harmonic(A, 0.85 * A, 3)),
    "simplified": (simplified(A, 0.97 * B), stadium(A, 0.97 * B)),
    "simplified-0.5": (simplified(A, 0.5 * B), stadium(A, 0.5 * B)),
    "simplified-0.15": (simplified(A, 0.15 * A), stadium(A, 0.15 * A)),
    "arcs": (arcs(A, B, 0.8, "beta"), oval(A, B, 0.8)),
    "arcs-0.5": (arcs(A, 0.5 * B, 0.8, "beta"), oval(A, 0.5 * B, 0.8)),
    "parabolic": (
        parabolic(A, B, Side(*IMPROVED), Side(*IMPROVED)),
        parabola(A, B, IMPROVED, IMPROVED, 0.0),
    ),
    "parabolic-0.5": (
        parabolic(A, 0.5 * B, Side(0.01, 0.5, 10.0), Side(0.01, 0.5, 10.0)),
        parabola(A, 0.5 * B, (0.01, 0.5, 10.0), (0.01, 0.5, 10.0), 0.0),
    ),
    "parabolic-flat": (
        parabolic(A, B, Side(0.005, 0.5, 10.0), Side(0.005, 0.5, 10.0)),
        parabola(A, B, (0.005, 0.5, 10.0), (0.005, 0.5, 10.0), 0.0),
    ),
    "parabolic-steep": (  # its ends lie more than 1 / (2 a_p) below the apex
        parabolic(A, 0.9 * B, Side(*STEEP), Side(*IMPROVED)),
        parabola(A, 0.9 * B, STEEP, IMPROVED, 0.0),
    ),
    "angle-based": (
        parabolic(A, B, Side(*IMPROVED), Side(*IMPROVED), LAMBDA),
        parabola(A, B, IMPROVED, IMPROVED, LAMBDA),
    ),
    "bilateral": (
        parabolic(A, B, Side(*OTHER), Side(*IMPROVED)),
        parabola(A, B, OTHER, IMPROVED, 0.0),
    ),
    "four_roller": (rollers(A - 8.0, BETA, 8.0, "r_4"), circles(A - 8.0, BETA, 8.0)),
    "two_roller": (rollers(A - 9.0, 0.0, 9.0, "r_2"), circles(A - 9.0, 0.0, 9.0)),
}
CHAINS = [name for name, (cam, _) in CAMS.items() if isinstance(cam, PiecewiseCam)]
SIDE, OTHER_SIDE = ({"a_p": a_p, "C_p": C_p, "r_c": r_c} for a_p, C_p, r_c in (IMPROVED, OTHER))


def keys(cam: str, **more) -> dict:
    return {"type": cam, "face_width": 10.0, **more}


SECTIONS = {
    "elliptical": keys("elliptical"),
    "harmonic": keys("harmonic"),
    "simplified": keys("simplified", C=0.97),
    "arcs": keys("arcs", beta=45.0),
    "parabolic": keys("parabolic", **SIDE),
    "angle-based": keys("asymmetric_parabolic", rotational_angle=0.5, right=SIDE, left=SIDE),
    "bilateral": keys("asymmetric_parabolic", right=OTHER_SIDE, left=SIDE),
    "four_roller": keys("four_roller", beta=10.0, r_4=8.0),
    "four_roller-centres": keys("four_roller", beta=10.0, r_4=8.0, centre_radius=51.3),
    "two_roller": keys("two_roller", r_2=9.0),
    "deflection": keys("elliptical", deflection=1.1),
    "polar": keys("polar", radius="a - (a - b) * sin(theta)**2"),
    "points": keys(
        "points",
        coordinates="polar",
        points=[[5.0 * k, 58.2 + np.cos(np.radians(10.0 * k))] for k in range(19)],
        tolerance=1e-6,
    ),
    "narrow": keys("simplified", C=0.15),
    "axes": keys("simplified", major_axis=117.8, minor_axis=115.0),
}


def nearest(pieces: list[Curve], p: np.ndarray) -> tuple[float, np.ndarray, np.ndarray, float]:
    """Distance of p, foot, outward normal and curvature there: a dense search, then the root of (x
    - p) . x'."""
    best = (np.inf,)
    for piece in pieces:
        t = np.linspace(piece.low, piece.high, 1001)
        i = int(np.hypot(*(piece.x(t) - p).T).argmin())
        low, high = t[max(i - 1, 0)], t[min(i + 1, 1000)]

        def slope(t: float, piece: Curve = piece) -> float:
            return float((piece.x(np.array(t)) - p) @ piece.dx(np.array(t)))

        foot = (
            brentq(slope, low, high, xtol=1e-15, rtol=1e-15)
            if slope(low) * slope(high) < 0.0
            else t[i]
        )
        gap = float(np.hypot(*(piece.x(np.array(foot)) - p)))
        if gap < best[0]:
            best = (gap, piece, np.array(foot))
    gap, piece, t = best
    x, dx, ddx = piece.x(t), piece.dx(t), piece.ddx(t)
    bend = (dx[0] * ddx[1] - dx[1] * ddx[0]) / np.hypot(*dx) ** 3
    normal = (
        np.array([dx[1], -dx[0]]) / np.hypot(*dx) * np.sign(bend or dx[1] * x[0] - dx[0] * x[1])
    )
    return gap, x, normal, abs(float(bend))


@pytest.mark.parametrize("name", CAMS)
def test_distance_normal_and_curvature_against_a_dense_search(name: str) -> None:
    cam, pieces = CAMS[name]
    rng = np.random.default_rng(1)
    feet, outward = [], []
    for piece in pieces:
        t = rng.uniform(piece.low, piece.high, 4)
        dx = piece.dx(t)
        n = np.stack([dx[:, 1], -dx[:, 0]], axis=-1) / np.hypot(*dx.T)[:, None]
        feet.append(piece.x(t))
        bend = dx[:, 0] * piece.ddx(t)[:, 1] - dx[:, 1] * piece.ddx(t)[:, 0]
        outside = np.where(np.abs(bend) > 0.0, bend, np.einsum("ij,ij->i", n, feet[-1]))
        outward.append(n * np.sign(outside)[:, None])
    feet, outward = np.concatenate(feet), np.concatenate(outward)
    for height in (-1.5, 0.3, 30.0):
        points = feet + height * outward
        distance, normal, k = cam.evaluate(points)
        for p, d, n, bend in zip(points, distance, normal, k, strict=True):
            gap, foot, expected, curvature = nearest(pieces, p)
            signed = gap * np.sign((p - foot) @ expected)
            assert d == pytest.approx(signed, rel=1e-9)
            assert np.abs(n - expected).max() < 1e-9
            assert bend == pytest.approx(
                curvature / (1.0 + curvature * signed), rel=1e-9, abs=1e-15
            )


@pytest.mark.parametrize("name", CHAINS)
def test_chains_are_closed_and_smooth(name: str) -> None:
    cam = CAMS[name][0]
    assert np.abs(np.hypot(*cam.tangents.T) - 1.0).max() < 1e-14
    for joint, tangent, before, after in zip(
        cam.joints, cam.tangents, cam.pieces, cam.pieces[1:], strict=False
    ):
        for piece in (before, after):
            distance, normal, _ = piece.evaluate(joint[None])
            assert abs(distance[0]) < 1e-12 * A
            assert abs(normal[0] @ tangent) < 1e-12
    first, last = (
        cam.pieces[0].evaluate(-cam.outline(2)[1:]),
        cam.pieces[-1].evaluate(cam.outline(2)[1:]),
    )
    assert first[1][0] == pytest.approx([1.0, 0.0], abs=1e-12) and last[1][0] == pytest.approx(
        [-1.0, 0.0], abs=1e-12
    )
    x = cam.outline(3600)
    assert np.abs(cam.evaluate(x)[0]).max() < 1e-11
    edge = np.roll(x, -1, axis=0) - x
    turn = np.angle(np.exp(1j * np.diff(np.arctan2(edge[:, 1], edge[:, 0]))))
    assert turn.min() > -1e-9  # convex


@pytest.mark.parametrize("name", CAMS)
def test_a_turn_by_a_lobe_changes_nothing(name: str) -> None:
    cam = CAMS[name][0]
    x = 1.01 * cam.outline(400)
    x = x[np.abs(x[:, 1]) > 1e-9]  # on the minor axis the curvature may jump
    turn = 2.0 * np.pi / (3 if "three" in name else 2)
    here, there = cam.evaluate(x), cam.evaluate(rotated(x, turn))
    assert np.allclose(here[0], there[0], atol=1e-12) and np.allclose(
        rotated(here[1], turn), there[1], atol=1e-12
    )
    assert np.allclose(here[2], there[2], atol=1e-12)


def perimeter(pieces: list[Curve]) -> float:
    return sum(
        quad(lambda t, f=piece.dx: np.hypot(*f(np.array(t))), piece.low, piece.high)[0]
        for piece in pieces
    )


@pytest.mark.parametrize("name", CAMS)
def test_taut_length(name: str) -> None:
    cam, pieces = CAMS[name]
    exact = perimeter(pieces)
    if isinstance(cam, RollerCam):
        x, y = cam.center
        exact = 2.0 * np.pi * cam.radius + 4.0 * (x + y)
    assert taut_length(cam) == pytest.approx(exact, rel=1e-6)


def test_the_ellipse_is_longer_than_the_inner_circumference() -> None:
    """An interference of 7.4e-5, 4.3 micrometres of radius."""
    exact = 4.0 * A * ellipe(1.0 - (B / A) ** 2)
    excess = taut_length(EllipticalCam(A, B)) / (2.0 * np.pi * R_FS) - 1.0
    assert excess == pytest.approx(exact / (2.0 * np.pi * R_FS) - 1.0, abs=1e-6)
    assert excess == pytest.approx(7.4e-5, abs=1e-6)


def test_positive_rotational_angle_raises_the_right_side() -> None:
    cam = CAMS["angle-based"][0]
    right, left = cam.evaluate(np.array([[10.0, 58.2], [-10.0, 58.2]]))[0]
    assert right < CAMS["parabolic"][0].evaluate(np.array([[10.0, 58.2]]))[0][0] < left
    assert np.hypot(*cam.outline(3600).T).max() > A  # section 5.7.1: beyond the circle of radius a
    assert cam.evaluate(np.array([[0.0, A]]))[0][0] == pytest.approx(0.0, abs=1e-12)


def test_deflection_and_axes(design_file: Callable) -> None:
    """Of the reference drive: bore of the radius 58.2 mm, module 1 mm."""
    for name, deflection, minor in (
        ("elliptical", 1.0, 57.2),
        ("simplified", 1.0, 0.97 * 57.2),
        ("deflection", 1.1, 57.1),
        ("axes", 0.7, 57.5),
        ("four_roller", 1.0, None),
        ("four_roller-centres", 1.1, None),
        ("two_roller", 1.0, None),
    ):
        design = load_design(design_file({"wave_generator": SECTIONS[name]}))
        assert design.deflection == pytest.approx(2.0 * deflection, abs=1e-12)
        assert design.major_semi_axis == pytest.approx(R_FS + deflection, abs=1e-12)
        assert design.minor_semi_axis == (None if minor is None else pytest.approx(minor))
        outline = design.cam().outline(7200)
        assert np.hypot(*outline.T).max() == pytest.approx(R_FS + deflection, abs=1e-4)
        if minor is not None:
            assert np.abs(outline[:, 0]).max() == pytest.approx(minor, abs=1e-6)


@pytest.mark.parametrize("modules", [0.82, 0.93, 0.98, 1.05, 1.19, 1.5, 1.67, 2.25])
def test_published_deflections(modules: float) -> None:
    """With heights that leave room at the major axis, `check` prints each as it is given."""
    arcs = {"r_tip": 0.02, "r_addendum": 20.0, "r_dedendum": 20.0, "r_root": 0.1}
    values = {
        "drive.addendum_coef": 0.15,
        "drive.dedendum_coef": max(0.8, modules - 0.75),
        "drive.pressure_angle": 10.0,
        "flexible_spline.profile": arcs,
        "ring_gear.profile": arcs,
        "wave_generator.deflection": modules,
    }
    design = load_design(DRIVERS / "plane_half_turn.toml").with_values(values)
    printed = derived_geometry(design)
    assert printed["radial deflection at the major axis (modules)"] == pytest.approx(
        modules, rel=1e-5
    )
    room = 1.0 + design.drive.dedendum_coef - 0.15 - modules
    for name in ("tip of spline to root of ring", "tip of ring to root of spline"):
        assert printed[f"{name}, major axis (mm)"] == pytest.approx(room, abs=1e-5)
    # an ellipse with a + b = 2 r is longer than the bore by a quarter of (w0 / r)^2
    stretch = 0.25 * (modules / design.inner_radius) ** 2 * design.inner_radius
    radius = design.inner_radius + 0.5 * design.flexible_spline.rim
    assert printed["stretch of the neutral line"] == pytest.approx(stretch / radius, rel=0.01)


def test_rollers_reach_to_the_circle_of_radius_a() -> None:
    distance = CAMS["four_roller"][0].evaluate(A * np.array([[np.sin(BETA), np.cos(BETA)]]))[0]
    assert distance[0] == pytest.approx(0.0, abs=1e-12)
    assert np.hypot(*CAMS["four_roller"][0].outline(4000).T).max() == pytest.approx(A, rel=1e-6)


def test_foot_on_the_parabola_by_its_cubic() -> None:
    tilted = Parabola(A, 0.0097, 0.1)
    point, normal = tilted.at(17.0)
    distance, n, k = tilted.evaluate(point + 2.5 * normal[None])
    assert distance[0] == pytest.approx(2.5, rel=1e-12) and n[0] == pytest.approx(normal, abs=1e-13)
    radius = (1.0 + (2.0 * 0.0097 * 17.0) ** 2) ** 1.5 / (2.0 * 0.0097)
    assert 1.0 / k[0] == pytest.approx(radius + 2.5, rel=1e-12)


@pytest.mark.parametrize("name", SECTIONS)
def test_pins_fit_into_the_spline_and_end_at_the_cam(name: str, design_file: Callable) -> None:
    design = load_design(design_file({"wave_generator": SECTIONS[name]}))
    cam = design.cam()
    travel = pin_travel(cam, R_FS)
    angle = np.radians(np.linspace(-60.0, 60.0, 20001))
    inner = R_FS * np.stack([np.sin(angle), np.cos(angle)], axis=-1) + [0.0, travel]
    gap = cam.evaluate(inner)[0]
    assert abs(gap.min()) < 1e-5
    assert travel >= 0.5 * design.deflection - 1e-12
    if name == "points":
        assert travel == pytest.approx(1.0, abs=1e-5)
    if name not in ("angle-based", "four_roller", "four_roller-centres"):
        assert travel == pytest.approx(0.5 * design.deflection, abs=1e-12)
    if name.startswith("four_roller"):
        x, y = cam.center
        assert travel == pytest.approx(y - np.sqrt((R_FS - cam.radius) ** 2 - x**2), rel=1e-5)
    assert start_state(design).pin_inset == travel
    assert [i.pin_inset for i in load_sequence(design).states if i.stage == Stage.DEFLECT][
        -1
    ] == 0.0


def assert_derivatives(surface: WaveGeneratorSurface, x: np.ndarray) -> None:
    """Gradient and Hessian at points x (n, 3) mm against central differences."""
    _, gradient, hessian = surface.evaluate(x)
    h = 1e-5
    for k in range(3):
        step = np.zeros(3)
        step[k] = h
        up, down = surface.evaluate(x + step), surface.evaluate(x - step)
        assert np.allclose((up[0] - down[0]) / (2 * h), gradient[:, k], atol=1e-8)
        assert np.allclose((up[1] - down[1]) / (2 * h), hessian[:, :, k], atol=1e-7)


@pytest.mark.parametrize("name", SECTIONS)
@pytest.mark.parametrize("shape", ["parabolic", "circular"])
def test_derivatives_of_the_modified_surface(shape: str, name: str, design_file: Callable) -> None:
    path = design_file({"wave_generator": SECTIONS[name]})
    design = load_design(path, [f"micro_geometry.crowning_shape={shape}"])
    surface = design.cam_surface()
    rng = np.random.default_rng(2)
    angle, radius = rng.uniform(0, 2 * np.pi, 50), rng.uniform(57.0, 60.0, 50)
    x = np.column_stack([radius * np.sin(angle), radius * np.cos(angle), rng.uniform(-5, 5, 50)])
    assert_derivatives(surface, x)


def test_derivatives_of_the_slope_on_three_lobes() -> None:
    surface = WaveGeneratorSurface(HarmonicCam(59.9, 56.7, 3), 10.0, 0.1, 0.09, lobes=3)
    rng = np.random.default_rng(3)
    angle, radius = rng.uniform(0, 2 * np.pi, 50), rng.uniform(57.0, 60.0, 50)
    x = np.column_stack([-radius * np.sin(angle), radius * np.cos(angle), rng.uniform(-5, 5, 50)])
    level, *_ = surface.evaluate(x)
    expected = HarmonicCam(59.9, 56.7, 3).evaluate(x[:, :2])[0]
    expected += 0.1 * (x[:, 2] / 5.0) ** 2 + 0.09 * x[:, 2] / 5.0 * np.cos(3.0 * angle)
    assert np.allclose(level, expected, atol=1e-13)
    assert_derivatives(surface, x)


def test_each_lobe_has_a_pin() -> None:
    """Three circles of the spline's inner radius, each drawn out by the travel, touch the cam at
    its tips."""
    cam = HarmonicCam(59.9, 56.7, 3)
    travel = pin_travel(cam, 58.4, 3)
    assert travel == pytest.approx(1.5, abs=1e-12)
    for out in pin_directions(3):
        around = np.arctan2(-out[0], out[1]) + np.radians(np.linspace(-59.0, 59.0, 201))
        inner = 58.4 * np.column_stack([-np.sin(around), np.cos(around)]) + travel * out
        assert cam.evaluate(inner)[0].min() == pytest.approx(0.0, abs=1e-12)


def test_slope_raises_the_open_end_at_the_major_axis() -> None:
    surface = load_design(REFERENCE, ["micro_geometry.wg_crowning=0"]).cam_surface()
    open_end, closed_end = surface.evaluate(np.array([[0.0, 59.2, -5.0], [0.0, 59.2, 5.0]]))[0]
    assert open_end == pytest.approx(-0.09) and closed_end == pytest.approx(0.09)


@pytest.mark.parametrize("shape", ["parabolic", "circular"])
def test_crowning_is_the_amount_at_the_edges_and_nothing_in_the_middle(shape: str) -> None:
    value, slope, _ = crowning(0.1, np.array([-5.0, 0.0, 5.0]), 10.0, shape)
    assert value == pytest.approx([0.1, 0.0, 0.1], abs=1e-12)
    assert slope[0] == -slope[2] and slope[1] == 0.0


@pytest.mark.parametrize(
    ("section", "key"),
    [
        (keys("parabolic", a_p=0.05, C_p=0.51, r_c=10.0), "wave_generator.a_p = 0.05"),
        (keys("parabolic", a_p=0.0097, C_p=1.0, r_c=10.0), "wave_generator.C_p = 1"),
        (keys("parabolic", a_p=0.0097, C_p=0.9, r_c=60.0), "wave_generator.r_c = 60"),
        (keys("parabolic", a_p=0.0097, C_p=0.51), "wave_generator.r_c is missing"),
        (keys("parabolic", beta=10.0), "wave_generator.beta = 10"),
        (
            keys("asymmetric_parabolic", right=SIDE, left={**SIDE, "r_c": 900.0}),
            "wave_generator.left.r_c = 900",
        ),
        (
            keys("asymmetric_parabolic", right={**SIDE, "r_c": -1.0}, left=SIDE),
            "wave_generator.right.r_c = -1",
        ),
        (keys("asymmetric_parabolic", right=SIDE), "wave_generator.left is missing"),
        (
            keys("asymmetric_parabolic", rotational_angle=20.0, right=SIDE, left=SIDE),
            "wave_generator.rotational_angle = 20",
        ),
        (keys("four_roller", beta=10.0, r_4=9.0), "wave_generator.r_4 = 9"),
        (keys("four_roller", beta=10.0, r_4=8.0, C=1.0), "wave_generator.C = 1"),
        (keys("four_roller", beta=70.0, r_4=8.0), "wave_generator.beta = 70"),
        (keys("two_roller", r_2=30.0, centre_radius=29.3), "wave_generator.r_2 = 30"),
        (keys("two_roller", r_2=9.0, beta=10.0), "wave_generator.beta = 10"),
        (keys("two_roller", r_2=9.0, centre_radius=49.0), "wave_generator.centre_radius = 49"),
        (
            keys("two_roller", r_2=9.0, centre_radius=50.0, deflection=1.0),
            "wave_generator.deflection and wave_generator.centre_radius",
        ),
        (
            keys("elliptical", deflection=1.0, major_axis=118.4),
            "wave_generator.deflection and wave_generator.major_axis",
        ),
        (
            keys("elliptical", C=0.9, minor_axis=110.0),
            "wave_generator.C and wave_generator.minor_axis",
        ),
        (keys("elliptical", deflection=0.0), "wave_generator.deflection = 0"),
        (keys("elliptical", deflection=30.0), "to below 29.1 mm"),
        (keys("elliptical", major_axis=116.0), "wave_generator.major_axis = 116 is out of range"),
        (keys("elliptical", minor_axis=40.0), "wave_generator.minor_axis = 40 is out of range"),
        (keys("elliptical", minor_axis=119.0), "to below 118.4 mm (the major axis)"),
        (keys("harmonic", minor_axis=50.0), "(a concave cam near the spline) to below 118.4 mm"),
        (keys("simplified", C=0.09), "wave_generator.C = 0.09"),
        (keys("elliptical", C=0.2), "wave_generator.C = 0.2"),
        (keys("arcs", beta=1.5), "wave_generator.beta = 1.5 is out of range: allowed above 1.97"),
        (keys("arcs"), "wave_generator.beta is missing"),
        (keys("elliptical", lobes=3), "wave_generator.lobes = 3"),
        (keys("four_roller", lobes=3, beta=10.0, r_4=8.0), "wave_generator.lobes = 3"),
        (keys("harmonic", lobes=3), "drive.teeth_rg - drive.teeth_fs = 2"),
        (
            keys(
                "harmonic",
                bearing={"balls": 20, "ball_diameter": 4.0, "race_thickness": 1.0},
                lobes=3,
            ),
            "drive.teeth_rg - drive.teeth_fs = 2",
        ),
        (keys("harmonic", lobes=4), "wave_generator.lobes = 4"),
        (keys("round"), 'wave_generator.type = "round"'),
    ],
)
def test_cams_that_cannot_be_built_are_refused(
    section: dict, key: str, design_file: Callable
) -> None:
    with pytest.raises(InputError) as caught:
        load_design(design_file({"wave_generator": section}))
    message = str(caught.value)
    assert (
        key in message and ("allowed" in message or "missing" in message) and "\n" not in message
    ), message


@pytest.mark.parametrize(("lobes", "least"), [(2, "0.5386"), (3, "0.6797")])
def test_a_cam_so_concave_that_feet_are_not_unique_is_refused(lobes: int, least: str) -> None:
    path = DRIVERS / ("three_lobes.toml" if lobes == 3 else "plane_half_turn.toml")
    design = load_design(path).with_values(
        {"wave_generator": {"type": "harmonic", "lobes": lobes, "face_width": 10.0}}
    )
    design.with_values({"wave_generator.C": 0.7})
    with pytest.raises(
        InputError,
        match=rf"wave_generator.C = 0.5 is out of range: allowed {least} \(a concave cam",
    ):
        design.with_values({"wave_generator.C": 0.5})
