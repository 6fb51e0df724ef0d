"""The shape of the bent flexible spline: its length, its place on the cam, and that of an exact
ring on an ellipse."""

from __future__ import annotations

import numpy as np
import pytest

import swgpar
from support.bearing import BEARING
from support.drive_groups import PLANE, cams, table_of
from support.paths import RECIPE, REFERENCE
from swgpar import load_design
from swgpar.analysis.bent_spline import BentSpline, bent_bodies
from swgpar.checks.design_file import make_drive
from swgpar.fem.body import FLEXIBLE_SPLINE, OUTER_RACE
from swgpar.geometry.bent_ring import bent_ring, ring_on_points

CAMS = {name: case for name, case in cams().items() if "wave_generator" in case}
THETA = np.linspace(0.0, 2.0 * np.pi, 3601)


def ring(radius: float) -> np.ndarray:
    """Points (n, 3) of a circle."""
    return radius * np.column_stack([-np.sin(THETA), np.cos(THETA), 0.0 * THETA])


def moved(spline: BentSpline, points: np.ndarray) -> np.ndarray:
    return points + spline.displacement(points)


def test_the_first_harmonic_on_an_elliptical_cam_is_half_of_the_deflection() -> None:
    design = load_design(PLANE)
    shape = bent_ring(
        design.cam(), design.inner_radius, design.inner_radius + 0.5 * design.flexible_spline.rim
    ).amplitudes
    assert shape[1] == pytest.approx(0.5 * design.deflection, rel=1e-3)
    assert np.abs(shape[2:]).max() < 0.005 * abs(shape[1])
    # a ring that bends without stretching shrinks by 3 a² / (4 r)
    radius = design.inner_radius + 0.5 * design.flexible_spline.rim
    assert shape[0].real == pytest.approx(-0.75 * abs(shape[1]) ** 2 / radius, rel=0.02)


@pytest.mark.parametrize("name", list(CAMS))
def test_it_lies_outside_of_every_cam_and_touches_it(name: str) -> None:
    design = make_drive(table_of(PLANE, CAMS[name]))
    spline = BentSpline(design)
    gap, *_ = spline.surface.evaluate(moved(spline, ring(design.inner_radius)))
    assert gap.min() > -5e-5 * design.drive.module
    assert gap.min() < 5e-3 * design.deflection


@pytest.mark.parametrize("name", list(CAMS))
def test_the_middle_line_keeps_its_length(name: str) -> None:
    design = make_drive(table_of(PLANE, CAMS[name]))
    spline = BentSpline(design)
    line = moved(spline, ring(spline.radius))
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    assert length == pytest.approx(2.0 * np.pi * spline.radius, rel=3e-4)


def test_many_points_bend_a_ring_like_the_cam_that_they_lie_on() -> None:
    design = load_design(PLANE)
    radius = design.inner_radius + 0.5 * design.flexible_spline.rim
    points = design.cam().outline(960)
    many = ring_on_points(points, design.inner_radius, radius, 2, shifts=True)
    cam = bent_ring(design.cam(), design.inner_radius, radius, 2)
    assert np.abs(many.amplitudes - cam.amplitudes).max() < 2e-3 * abs(cam.amplitudes[1])


@pytest.mark.parametrize("balls", [20, 21])
def test_spline_and_race_lie_on_the_balls_and_between_them_inside_of_the_cam(balls: int) -> None:
    design = load_design(PLANE, [*BEARING, f"wave_generator.bearing.balls={balls}"])
    bodies, bearing = bent_bodies(design), design.bearing
    race = design.inner_radius - bearing.race_thickness
    inside = ring(race) + bodies[OUTER_RACE].displacement(ring(race))
    centre, *_ = design.grown_ball_lines()(2.0 * np.pi / balls * np.arange(balls))
    distance = np.hypot(*(inside[:, None, :2] - centre).T)
    approach = 0.5 * bearing.ball_diameter - distance.min(axis=1)
    assert 0.5e-3 < approach.max() / bearing.ball_diameter < 2e-3
    bore = moved(bodies[FLEXIBLE_SPLINE], ring(design.inner_radius))
    gap, *_ = design.grown_cam_surface().evaluate(bore)
    assert gap.min() < -0.005 * design.deflection


def test_a_bearing_takes_the_torque_in_one_increment() -> None:
    """Race and spline bent over the cam would press on balls that do not carry."""
    few = [*BEARING, "wave_generator.bearing.balls=14", "load.torque=0.3"]
    run = ["steps.rotation=0", "output.root_stress=false", "output.contact_errors=false"]
    at_once = swgpar.run(load_design(PLANE, [*few, *run]), RECIPE)
    assert len(at_once.history["step"]) == 1


def test_the_cup_is_at_rest_at_its_closed_end_and_its_wall_does_not_shear() -> None:
    design = load_design(REFERENCE)
    spline = BentSpline(design)
    bore = ring(design.cup.inner_radius) + [0.0, 0.0, spline.end]
    assert np.abs(spline.displacement(bore)[:, :2]).max() < 1e-9
    # shear of the wall's middle surface: du_z / (R d theta) + dv / dz
    step, points = 1e-4, ring(spline.radius) + [0.0, 0.0, 20.0]
    u = spline.displacement(points)
    further = spline.displacement(points + [0.0, 0.0, step])
    tangent = np.column_stack([-np.cos(THETA), -np.sin(THETA)])
    around = np.einsum("ij,ij->i", (further - u)[:, :2], tangent) / step
    axial = np.gradient(u[:, 2], THETA) / spline.radius
    assert np.abs(around + axial)[2:-2].max() < 0.02 * np.abs(around).max()


def test_a_thin_rim_takes_its_torque_in_one_increment() -> None:
    """Its teeth travel so far that the contacts have to be searched again on the way."""
    thin = {
        "drive.teeth_fs": 100,
        "drive.teeth_rg": 102,
        "flexible_spline.rim": 0.35,
        "wave_generator": {"type": "simplified", "C": 0.9, "face_width": 10.0},
        "load.torque": 6.7,
        "steps.rotation": 0.0,
        "output.root_stress": False,
    }
    at_once = swgpar.run(swgpar.load_design(PLANE, thin), RECIPE)
    assert len(at_once.history["step"]) == 1 and at_once.history["newton_iterations"][0] < 50
    stepwise = swgpar.run(swgpar.load_design(PLANE, {**thin, "steps.load_increments": 5}), RECIPE)
    assert at_once.history["fs_s1"][-1] == pytest.approx(stepwise.history["fs_s1"][-1], rel=1e-6)
