"""Rings on cams of any deflection and on two rollers, against the theory of rings."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

import swgpar
from plain_ring import PlainRingDesign, RingCounts, RingModel
from support.cam_ring import INNER, STEEL, THICKNESS, closed_form, tight_ring
from support.drive_groups import PLANE
from swgpar.design.negligible_torque import RING_FLEXIBILITY
from swgpar.geometry.cams import EllipticalCam

HALF_ANGLE = np.radians(15.0)


LONG_ARCS = {"r_tip": 0.02, "r_addendum": 20.0, "r_dedendum": 20.0, "r_root": 0.1}


def design_on(**wave_generator: object) -> swgpar.DriveDesign:
    """The plane drive of module 1 mm on a cam with these keys, with low teeth that leave room for
    other deflections."""
    return swgpar.load_design(
        PLANE,
        {
            "drive.addendum_coef": 0.15,
            "drive.pressure_angle": 10.0,
            "flexible_spline.profile": LONG_ARCS,
            "ring_gear.profile": LONG_ARCS,
            "wave_generator": {"face_width": 10.0, **wave_generator},
        },
    )


def mounted(design: swgpar.DriveDesign, counts: RingCounts) -> tuple[float, float]:
    """Largest tensile stress (MPa) and integrated contact pressure (N) of a ring of 1 mm width."""
    assert design.inner_radius == INNER
    ring = PlainRingDesign(2.0 * (INNER + THICKNESS), THICKNESS, 1.0, True, STEEL)
    model = RingModel(ring, counts, design.cam(), HALF_ANGLE, MPI.COMM_SELF)
    model.mount()
    values = model.stresses()["s1"], model.contact_force()
    model.destroy()
    return values


@pytest.mark.parametrize("modules", [0.8, 1.5])
def test_a_ring_on_a_cam_of_another_deflection(modules: float) -> None:
    """Stress within 0.5 %, radial force within 1 %: what the elements reach at 1 module."""
    design = design_on(type="elliptical", deflection=modules)
    exact = closed_form(2.0 * modules)
    stress, force = mounted(design, RingCounts(240, 4, 1))
    assert stress == pytest.approx(exact["s1"], rel=5e-3)
    assert force == pytest.approx(exact["contact force"], rel=1e-2)


def test_a_ring_on_a_cam_longer_than_its_bore() -> None:
    """By 1.5 %: the largest tension is inside, at the minor axis, within what radial stress and
    Poisson's ratio change, t / R of it."""
    a, b = 1.020 * INNER, 1.010 * INNER
    ring = PlainRingDesign(2.0 * (INNER + THICKNESS), THICKNESS, 1.0, True, STEEL)
    cam, counts = EllipticalCam(a, b), RingCounts(240, 4, 1)
    model = RingModel(ring, counts, cam, HALF_ANGLE, MPI.COMM_SELF)
    model.mount()
    found = model.stresses()["s1"]
    model.destroy()
    exact = tight_ring(a, b, INNER, THICKNESS, STEEL.E)["s1"]
    assert found == pytest.approx(exact, rel=THICKNESS / INNER)
    assert exact > 0.015 * STEEL.E


def test_kinematics_of_a_published_drive() -> None:
    """240 and 242 teeth on a cosine cam (after Dong 2011): deflection of 0.41713 mm (0.824 modules)
    on a neutral line of 60.31 mm.

    The line deflects by w0 cos 2 phi, and its normal turns by 3/2 w0 / r sin 2 phi. Both are of
    first order: what is left out is of second order, (w0 / r)^2.
    """
    module, neutral, w0, rim = 121.46 / 240.0, 60.31, 0.41713, 0.3
    bore = neutral - 0.5 * rim
    drive = {
        "drive.teeth_fs": 240,
        "drive.teeth_rg": 242,
        "drive.module": module,
        "drive.dedendum_coef": (0.5 * 121.46 - rim - bore) / module,
        "drive.addendum_coef": 0.3,
    }
    arcs = {**LONG_ARCS, "r_root": 0.05}
    design = swgpar.load_design(
        PLANE,
        {
            **drive,
            "flexible_spline.profile": arcs,
            "ring_gear.profile": arcs,
            "flexible_spline.rim": rim,
            "wave_generator": {"type": "harmonic", "face_width": 10.0, "deflection": w0},
        },
    )
    line = design.tooth_motion().line
    assert (line.radius, design.inner_radius) == pytest.approx((neutral, bore))
    assert 0.5 * design.deflection / module == pytest.approx(0.824, abs=5e-4)
    phi, ratio = np.radians(np.arange(0.0, 181.0, 5.0)), w0 / neutral
    outward = np.abs(line.position(phi)) - neutral
    assert outward == pytest.approx(w0 * np.cos(2.0 * phi), abs=2.0 * w0 * ratio)
    normal = line.tilt(phi)[0]
    assert normal == pytest.approx(1.5 * w0 / neutral * np.sin(2.0 * phi), abs=2.0 * ratio**2)


def test_a_ring_on_two_rollers() -> None:
    """Force and shape of a ring between two opposed forces, which hold for small deflections.

    The outward deflections are (pi / 4 - 2 / pi) / 2 and (2 / pi - 1 / 2) / 2 times
    P R^3 / (E I) at the forces and between them (Timoshenko).
    """
    deflection, radius = 0.05, INNER + 0.5 * THICKNESS
    design = design_on(type="two_roller", r_2=9.0, deflection=deflection)
    inertia = THICKNESS**3 / 12.0
    exact = 2.0 * deflection * STEEL.E * inertia / (RING_FLEXIBILITY * radius**3)
    _, force = mounted(design, RingCounts(240, 4, 1))
    assert force == pytest.approx(2.0 * exact, rel=1e-2)
    lobe, between = design.tooth_motion().line.deflections
    assert lobe == pytest.approx(deflection, rel=1e-3)
    assert -between / lobe == pytest.approx((2.0 / np.pi - 0.5) / RING_FLEXIBILITY, rel=2e-3)
