"""The motion of a tooth and conjugate flanks against programs of their own.

A ring that is as long as its cam lies on it all around: its line is the cam's offset, which is made
here from points of the curve. The envelope is found from finite differences of that motion. A ring
on rollers is an elastica.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

import swgpar
from support.drive_groups import PLANE

Curve = Callable[[np.ndarray], np.ndarray]

STEP = 1e-5
"""Of finite differences, rad and mm."""

ARCSECONDS = np.degrees(1.0) * 3600.0

LONG_ARCS = {
    "type": "quadruple_arc",
    "r_tip": 0.2,
    "r_addendum": 8.0,
    "straight_l": 0.0,
    "r_dedendum": 8.0,
    "r_root": 0.2,
}
"""Flanks whose whole envelope exists at deflections other than the module."""

DRIVES: dict[str, dict[str, Any]] = {
    "ellipse": {"ring_gear.profile": {"type": "conjugate", "r_root": 0.2}},
    "cosine": {
        "drive.teeth_fs": 140,
        "drive.teeth_rg": 142,
        "drive.module": 0.8,
        "drive.pressure_angle": 25.0,
        "ring_gear.profile": {"type": "conjugate", "r_root": 0.1},
        "wave_generator": {"type": "harmonic", "face_width": 10.0},
    },
    "less deflection": {
        "drive.pressure_angle": 30.0,
        "flexible_spline.profile": LONG_ARCS,
        "ring_gear.profile": {"type": "conjugate", "r_root": 0.1},
        "wave_generator.deflection": 0.8,
    },
    "more deflection": {
        "drive.addendum_coef": 0.45,
        "flexible_spline.profile": LONG_ARCS,
        "ring_gear.profile": {"type": "conjugate", "r_root": 0.1},
        "wave_generator.deflection": 1.2,
    },
}


def cam_curve(design: swgpar.DriveDesign) -> Curve:
    """Points x + i y of the cam at a parameter that grows counter-clockwise from the tip."""
    a, b = design.major_semi_axis, design.minor_semi_axis
    if design.wave_generator.type == "elliptical":
        return lambda t: -b * np.sin(t) + 1j * a * np.cos(t)
    return lambda t: (0.5 * (a + b) + 0.5 * (a - b) * np.cos(2.0 * t)) * 1j * np.exp(1j * t)


class OwnMotion:
    """A tooth on the offset of a cam, by series of points around it."""

    def __init__(self, design: swgpar.DriveDesign, count: int = 512) -> None:
        t = 2.0 * np.pi * np.arange(count) / count
        order = np.fft.fftfreq(count, 1.0 / count)

        def rate(values: np.ndarray) -> np.ndarray:
            return np.fft.ifft(1j * order * np.fft.fft(values))

        cam, half = cam_curve(design)(t), 0.5 * design.flexible_spline.rim
        tangent = rate(cam) / np.abs(rate(cam))
        line = cam - 1j * half * tangent
        speed = np.abs(rate(line))
        length = np.fft.fft(speed)
        swing = np.divide(length, 1j * order, out=np.zeros_like(length), where=order != 0.0)
        around = 2.0 * np.pi * speed.mean()
        wave = np.fft.ifft(swing).real
        turned = (2.0 * np.pi / around) * (speed.mean() * t + wave - wave[0])
        self.coefficients = np.fft.fft(np.stack([line, tangent]) * np.exp(-1j * t)) / count
        self.order, self.radius = order, design.inner_radius + half
        self.wave = np.fft.fft(turned - t) / count
        self.slip = design.drive.teeth_fs / design.drive.teeth_rg

    def moved(self, psi: float, points: np.ndarray) -> np.ndarray:
        """Points of the tooth at the material angle psi, in the frame of its slot."""
        t = self.parameter(psi)
        line, tangent = self.coefficients @ np.exp(1j * self.order * t) * np.exp(1j * t)
        # the tooth's +x is clockwise, its +y outward
        place = line - tangent * points.real - 1j * tangent * (points.imag - self.radius)
        return place * np.exp(-1j * self.slip * psi)

    def parameter(self, psi: float) -> float:
        """Of the curve at a material angle."""
        t = psi
        for _ in range(30):
            terms = self.wave * np.exp(1j * self.order * t)
            wave, slope = terms.sum().real, 1.0 + (1j * self.order * terms).sum().real
            step = (t + wave - psi) / slope
            t -= step
            if abs(step) < 1e-15:
                break
        return t


def to_line(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Signed distances (n,) from a smooth line of many points (m,), by the arc through three of
    them: above 0 on its left, from the first to the last. inf beyond its ends."""
    index = np.clip(np.abs(points[:, None] - line).argmin(axis=1), 1, len(line) - 2)
    before, here, after = line[index - 1], line[index], line[index + 1]
    chord, first, second = after - before, here - before, after - here
    area = (np.conj(first) * second).imag
    curvature = 2.0 * area / np.abs(chord * first * second)
    tangent = first / np.abs(first) + second / np.abs(second)
    tangent *= np.exp(0.25j * curvature * (np.abs(first) - np.abs(second)))
    local = (points - here) * np.conj(tangent / np.abs(tangent))
    square = np.abs(local) ** 2
    bent = np.sqrt(1.0 - 2.0 * curvature * local.imag + curvature**2 * square)
    distance = (2.0 * local.imag - curvature * square) / (1.0 + bent)
    return np.where(np.abs(local.real) < np.abs(chord), distance, np.inf)


@pytest.mark.parametrize("name", list(DRIVES))
def test_the_line_is_the_offset_of_the_cam(name: str) -> None:
    design = swgpar.load_design(PLANE, DRIVES[name])
    own, motion = OwnMotion(design), design.tooth_motion()
    tooth = np.array([0.3 + 1j * design.teeth("flexible_spline").r_pitch, 1j * own.radius])
    for psi in np.linspace(-2.0, 2.0, 21):
        pose = motion.pose(np.array([psi]))
        assert np.abs(pose.moved(tooth) - own.moved(psi, tooth)).max() < 2e-5


@pytest.mark.parametrize("name", list(DRIVES))
def test_conjugate_flanks_are_the_envelope(name: str) -> None:
    """Within 0.05 micrometres."""
    design = swgpar.load_design(PLANE, DRIVES[name])
    own = OwnMotion(design)
    given, made = design.profile("flexible_spline"), design.profile("ring_gear")
    half_pitch = np.exp(1j * np.pi / design.drive.teeth_rg)
    line = made.point(np.linspace(0.0, made.root_start, 6000)) @ (1.0, 1j)
    compared = 0
    for s in np.linspace(given.tip_end, given.root_start, 60)[1:-1]:
        point = given.point(s) @ (1.0, 1j)
        tangent = given.tangent(s) @ (1.0, 1j)

        def across(
            psi: float, point: np.ndarray = point, step: np.ndarray = STEP * tangent
        ) -> float:
            velocity = own.moved(psi + STEP, point) - own.moved(psi - STEP, point)
            direction = own.moved(psi, point + step) - own.moved(psi, point - step)
            return float((np.conj(direction) * velocity).imag[0]) / STEP**2

        samples = np.radians(np.linspace(-12.0, 12.0, 49))
        values = np.array([across(psi) for psi in samples])
        crossings = np.flatnonzero(values[1:] * values[:-1] < 0.0)
        if not crossings.size:
            continue
        k = crossings[np.abs(samples[crossings]).argmin()]
        psi = brentq(across, samples[k], samples[k + 1], xtol=1e-10)
        contact = -np.conj(own.moved(psi, point) * half_pitch)
        if made.r_tip_circle < abs(contact[0]) < abs(line[-1]):
            compared += 1
            assert abs(to_line(contact, line)[0]) < 5e-5
    assert compared > 15


@pytest.mark.parametrize("name", [name for name in DRIVES if name != "more deflection"])
def test_conjugate_teeth_transmit_without_error(name: str) -> None:
    """Within 0.05 arc seconds, with the own motion and the flanks of the program.

    With more deflection a pair is in contact over 0.7 pitches: at times none is.
    """
    design = swgpar.load_design(PLANE, DRIVES[name])
    own, teeth = OwnMotion(design), design.drive.teeth_fs
    given, made = design.profile("flexible_spline"), design.profile("ring_gear")
    half_pitch = np.exp(1j * np.pi / design.drive.teeth_rg)
    flank = given.point(np.linspace(0.0, given.root_start, 700)) @ (1.0, 1j)
    line = made.point(np.linspace(0.0, made.root_start, 3000)) @ (1.0, 1j)
    least = []
    for phase in np.arange(6) / 6.0:
        gaps = []
        for k in range(-3, 4):
            place = -np.conj(own.moved(2.0 * np.pi * (k + phase) / teeth, flank) * half_pitch)
            # the flank at x > 0 of an internal tooth has its space on the right, from tip to root
            gaps.append(to_line(place, line[::-1]).min())
        least.append(min(gaps))
    normal = np.cos(np.radians(design.drive.pressure_angle))
    arm = normal * design.teeth("ring_gear").r_pitch
    assert np.ptp(least) / arm * ARCSECONDS < 0.05
    assert np.abs(least).max() < 5e-5


def test_a_ring_on_four_rollers_is_an_elastica() -> None:
    """A quarter of it by shooting: two free divided, whose inner force changes along the normal at
    the roller."""
    rollers = {"type": "four_roller", "beta": 25.0, "r_4": 15.0, "face_width": 10.0}
    design = swgpar.load_design(PLANE, {"wave_generator": rollers})
    line, cam = design.tooth_motion().line, design.cam()
    center = np.array([-1.0, 1.0]) * cam.center
    reach, quarter = cam.radius + line.radius - design.inner_radius, 0.5 * np.pi * line.radius

    def piece(start: np.ndarray, length: float, force: tuple[float, float]) -> Any:
        """x, y, angle of the tangent and curvature from a start, with a constant inner force."""

        def rates(_: float, state: np.ndarray) -> np.ndarray:
            cosine, sine = np.cos(state[2]), np.sin(state[2])
            bend = force[0] * sine - force[1] * cosine
            return np.array([cosine, sine, state[3], bend])

        return solve_ivp(rates, (0.0, length), start, rtol=1e-11, atol=1e-13, dense_output=True).sol

    def divided(unknown: np.ndarray) -> tuple[Any, Any]:
        height, bend, across, along, contact = unknown
        first = piece(np.array([0.0, height, np.pi, bend]), contact, (across, 0.0))
        return first, piece(first(contact), quarter - contact, (0.0, along))

    def missed(unknown: np.ndarray) -> np.ndarray:
        first, second = divided(unknown)
        _, _, across, along, contact = unknown
        touching, end = first(contact), second(quarter - contact)
        away = touching[:2] - center
        tangent = np.array([np.cos(touching[2]), np.sin(touching[2])])
        return np.array(
            [
                np.hypot(*away) - reach,
                away @ tangent,
                1e3 * (tangent @ (-across, along)),
                end[1],
                end[2] - 1.5 * np.pi,
            ]
        )

    begin = np.array([abs(line.position(np.zeros(1))[0]), 1.0 / line.radius, 0.0, 0.0, 0.0])
    begin[4] = np.radians(25.0) * line.radius
    solution, _, found, text = fsolve(missed, begin, xtol=1e-12, full_output=True)
    assert found == 1, text
    first, second = divided(solution)
    theta = np.linspace(0.0, 0.5 * np.pi, 91)
    s = np.minimum(theta * line.radius, quarter)
    early = s < solution[4]
    exact = np.where(
        early, first(np.where(early, s, 0.0)), second(np.where(early, 0.0, s - solution[4]))
    )
    assert np.abs(line.position(theta) - exact[0] - 1j * exact[1]).max() < 1e-3
