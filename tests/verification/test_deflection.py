"""Rings on cams of any deflection and on two rollers, against the theory of rings."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

import swgpar
from plain_ring import PlainRingDesign, RingCounts, RingModel
from support.cam_ring import INNER, STEEL, THICKNESS, closed_form
from support.drive_groups import PLANE
from swgpar.load.negligible_torque import RING_FLEXIBILITY

HALF_ANGLE = np.radians(15.0)


def design_on(**wave_generator: object) -> swgpar.DriveDesign:
    """The plane drive of module 1 mm on a cam with these keys."""
    return swgpar.load_design(PLANE, {"wave_generator": {"face_width": 10.0, **wave_generator}})


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
