"""A bearing on a cam with three lobes: loads of balls on a thin ring against theory, symmetry,
work, clearances."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from support.bearing import BEARING
from support.paths import DESIGN
from support.stepping import WORLD, Row, assert_agree, load_stepper, rotate, row
from support.three_lobes import MODELS
from swgpar import load_design
from swgpar.analysis.bent_start import bend
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.bearing_loads import ball_rows
from swgpar.geometry.cams import make_cam
from swgpar.geometry.neutral_line import neutral_line
from swgpar.load.load_sequence import load_sequence
from swgpar.load.load_states import LoadState, Stage
from swgpar.model.bearing_model import build_balls

ON_BALLS = (*BEARING, "wave_generator.bearing.balls=21", "micro_geometry.wg_slope=0")
STATE = ("fs_s1", "fs_s3", "fs_vm", "rg_vm", "race_vm", "output_angle_deg")
SAMPLES = 12


def small(model: str, *overrides: str) -> DriveDesign:
    return load_design(DESIGN, [*MODELS[model], *ON_BALLS, *overrides])


def jumped(design: DriveDesign, comm: MPI.Comm = WORLD) -> LoadStepper:
    """The loaded drive, from the bent shape at once."""
    stepper = load_stepper(design, comm)
    bend(stepper.model)
    stepper.jump(load_sequence(design).loaded)
    return stepper


def loads(stepper: LoadStepper) -> np.ndarray:
    """Loads (n,) N of all balls."""
    return np.array([ball["load_N"] for ball in ball_rows(stepper.model, stepper.load_state, 1, 3)])


def loads_of_a_thin_ring(design: DriveDesign) -> np.ndarray:
    """Loads (n,) N of balls on a thin ring around a harmonic cam.

    Radial forces bend it by the waves k = 2, 3, …, each with the compliance R³ / (pi E I (k² -
    1)²), and stretch it. Bent by the amplitudes a_k its mean radius is smaller by the sum of (k² -
    1) a_k² / (4 R). Nothing holds it across the axis.
    """
    bearing, keys = design.bearing, design.wave_generator
    depth, modulus = bearing.race_thickness, design.materials["bearing"].modulus
    radius = design.inner_radius - 0.5 * depth
    bending, stretching = (modulus * design.race_width * x for x in (depth**3 / 12.0, depth))
    angle = np.radians(bearing.first_ball) + 2.0 * np.pi * np.arange(bearing.balls) / bearing.balls
    order, apart = np.arange(2.0, 400.0), angle[:, None] - angle
    wave = radius**3 / (np.pi * bending * (order**2 - 1.0) ** 2)
    compliance = np.cos(apart[..., None] * order) @ wave + radius / (2.0 * np.pi * stretching)
    compliance += 1e3 * wave[0] * np.cos(apart)  # a motion as a whole takes next to no force
    a, b = design.major_semi_axis, design.minor_semi_axis
    outward = 0.5 * (a + b) + 0.5 * (a - b) * np.cos(keys.lobes * angle)
    outward -= design.inner_radius + bearing.clearance
    stiffness, approach, shorter = build_balls(design).spring.stiffness, 0.01 * outward, 0.0
    for _ in range(100):
        pressed = np.maximum(approach, 0.0)
        force = stiffness * pressed**1.5
        amplitudes = np.abs(np.exp(1j * np.outer(order, angle)) @ force) * wave
        shorter = np.sum((order**2 - 1.0) * amplitudes**2) / (4.0 * radius)
        miss = approach + compliance @ force - outward - shorter
        tangent = np.eye(len(angle)) + compliance * (1.5 * stiffness * np.sqrt(pressed))
        approach = approach - np.linalg.solve(tangent, miss)
    assert np.abs(miss).max() < 1e-12
    return force


@pytest.mark.parametrize(
    ("balls", "first", "clearance"),
    [(3, 4.0, 0.0), (21, 0.0, 0.0), (20, 4.0, 0.0), (20, 4.0, -0.01)],
)
def test_loads_of_balls_on_a_thin_ring(balls: int, first: float, clearance: float) -> None:
    """The race in a spline that is too soft to carry: static loads of its balls are those of a
    thin ring to 1.5 %, a little less than its thickness over its radius. With the preload, which
    stretches the ring more than it bends it, they are so to all of this thickness, 1.7 %."""
    design = small(
        "plane",
        f"wave_generator.bearing.balls={balls}",
        f"wave_generator.bearing.first_ball={first}",
        f"wave_generator.bearing.clearance={clearance}",
        "wave_generator.bearing.stiffness_factor=0.02",
        "wave_generator.deflection=0.05",
        "wave_generator.C=1",
        "flexible_spline.material={E=1.0, nu=0.3}",
        "drive.addendum_coef=0.5",
        "load.torque=0",
    )
    stepper = load_stepper(design)
    bend(stepper.model)
    stepper.advance(LoadState(Stage.DEFLECT, 1, cam_clearance=0.0))
    found, expected = loads(stepper), loads_of_a_thin_ring(design)
    stepper.model.destroy()
    thin = 0.015 if clearance == 0.0 else design.bearing.race_thickness / design.inner_radius
    assert found == pytest.approx(expected, abs=thin * expected.max())
    assert (expected > 0.0).all() == (balls == 3 or clearance < 0.0)
    if balls % 3 == 0:
        assert found == pytest.approx(np.roll(found, balls // 3), rel=1e-6, abs=1e-9)


@lru_cache
def base(model: str) -> tuple[np.ndarray, Row]:
    """Loads and row of the loaded drive, a third of which is modelled."""
    stepper = jumped(small(model, "solver.rtol=1e-11"))
    assert stepper.model.copies == 3
    found = loads(stepper), row(stepper)
    stepper.model.destroy()
    return found


@pytest.mark.parallel([1, 2])
@pytest.mark.parametrize("model", list(MODELS))
def test_a_third_on_any_ranks_equals_the_whole(model: str) -> None:
    """So the loads of the whole ring repeat after 120 degrees; torques balance."""
    found, values = base(model)
    alone = jumped(small(model, "solver.rtol=1e-11", "solver.symmetry=false"), MPI.COMM_SELF)
    whole, expected = loads(alone), row(alone)
    parallel_assert(alone.model.copies == 1)
    alone.model.destroy()
    parallel_assert(np.abs(whole - np.roll(whole, 7)).max() < 1e-6 * whole.max())
    parallel_assert(np.abs(found - whole).max() < 1e-6 * whole.max())
    parallel_assert(whole.argmax() % 7 in (6, 0, 1))
    assert_agree(values, expected, [*STATE, "wg_torque_Nmm", "tooth_torque_Nmm"], rel=1e-6)
    parallel_assert(values["torque_balance_Nmm"] < 1e-6 * values["output_torque_Nmm"])


def test_period_and_work() -> None:
    """With balls that are fixed to the cam the state repeats after a pitch of the ring gear, and
    the work of input and output agree: the torque of the input swings by four times its mean on
    this mesh, and its mean over twelve angles is good to 2 %."""
    fixed = "wave_generator.bearing.cage_speed=1"
    design = small("plane", "steps.samples=8", "wave_generator.C=0.98", fixed)
    stepper = jumped(design)
    before, first = loads(stepper), row(stepper)
    step = design.kinematics.period_angle / SAMPLES
    rows = [rotate(stepper, step * k) for k in range(1, SAMPLES + 1)]
    after, last = loads(stepper), rows[-1]
    stepper.model.destroy()
    assert after == pytest.approx(before, abs=1e-5 * before.max())
    assert_agree(last, first, (*STATE[:-1], "tooth_torque_Nmm"), 1e-5)
    torques = np.array([one["wg_torque_Nmm"] for one in rows])
    assert np.ptp(torques) > 30.0
    assert torques.mean() == pytest.approx(200.0 / 20.0, rel=0.02)


def end_of_contact(design: DriveDesign) -> float:
    """Angle (degrees) from a lobe at which a thin ring leaves the cam, smaller by the clearance of
    the balls."""
    loose, thickness = design.bearing.clearance, design.bearing.race_thickness
    keys = design.wave_generator.model_copy(update={"bearing": None, "offset": -loose})
    axes = design.major_semi_axis - loose, design.minor_semi_axis - loose
    radius = design.inner_radius - 0.5 * thickness
    points = neutral_line(keys, *axes, design.inner_radius, radius, 1.0).position(
        np.linspace(0.0, np.pi / 3.0, 400)
    )
    xy = np.column_stack([points.real, points.imag])
    gaps = make_cam(keys, *axes).evaluate(xy)[0] + 0.5 * thickness
    x, y = xy[np.argmax(gaps > 1e-4)]
    return float(np.degrees(np.arctan2(-x, y)))


@pytest.mark.parametrize(("clearance", "fit"), [(0.0, 0.0), (0.1, -0.04)])
def test_a_loose_bearing_touches_where_a_thin_ring_does(clearance: float, fit: float) -> None:
    """The cam is shorter than the bore. All balls carry within the arc at a lobe on which a ring of
    least bending energy lies, and at most one beyond each end of it; a race that is loose in the
    spline too."""
    design = small(
        "plane",
        "load.torque=0",
        "wave_generator.C=0.98",
        "wave_generator.bearing.balls=63",
        f"wave_generator.bearing.clearance={clearance}",
        f"wave_generator.bearing.race_interference={fit}",
    )
    stepper = jumped(design)
    carry = loads(stepper) > 0.0
    stepper.model.destroy()
    spacing = 360.0 / 63.0
    from_lobe = np.abs((spacing * np.arange(63) + 60.0) % 120.0 - 60.0)
    end = end_of_contact(design)
    print(f"a thin ring leaves the cam at {end:.1f}, balls at {from_lobe[carry].max():.1f} degrees")
    assert end < from_lobe[~carry].min()
    assert from_lobe[carry].max() < end + spacing
