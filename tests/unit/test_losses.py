"""Losses against closed forms."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pytest
from mpi4py import MPI

import swgpar
from plain_ring import PlainRingDesign, RingCounts, RingModel
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.design.bearing_drag import BearingDrag
from swgpar.design.losses_section import Losses
from swgpar.errors import InputError
from swgpar.evaluation.losses import bearing_drag, energy_coordinates, force_without_sliding
from swgpar.fem.masses import mass_matrices
from swgpar.geometry.cams.simplified import simplified
from swgpar.materials import Isotropic

E, NU = 210e3, 0.29


def test_coordinates_of_the_strain_energy() -> None:
    rng = np.random.default_rng(2)
    stress = rng.normal(size=(3, 4, 6)) + 1j * rng.normal(size=(3, 4, 6))
    compliance = np.zeros((6, 6))
    compliance[:3, :3] = -NU / E
    np.fill_diagonal(compliance, [1.0 / E] * 3 + [2.0 * (1.0 + NU) / E] * 3)
    expected = 0.5 * np.einsum("knc,cd,knd->n", stress.conj(), compliance, stress).real
    assert (energy_coordinates(stress, Isotropic(E=E, nu=NU)) ** 2).sum(axis=1) == pytest.approx(
        expected, rel=1e-12
    )


def test_mass_matrices_of_a_box() -> None:
    box = np.array(
        [[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0], [0, 0, 4], [2, 0, 4], [2, 3, 4], [0, 3, 4]],
        dtype=float,
    )
    solid = mass_matrices(box, np.arange(8)[None], None)[0]
    flat = mass_matrices(box, np.arange(4)[None], 10.0)[0]
    assert solid.sum() == pytest.approx(24.0) and flat.sum() == pytest.approx(60.0)
    for matrix, volume, d in ((solid, 24.0, 3), (flat, 60.0, 2)):
        assert np.diag(matrix) == pytest.approx(np.full(2**d, volume / 3.0**d))
        x = box[: 2**d, 0]
        assert x @ matrix @ x == pytest.approx(volume * 4.0 / 3.0)


def test_share_of_the_force_without_a_known_contact() -> None:
    pairs = [
        {"increment": 3, "force_N": 30.0, "sliding_mm_s": 5.0},
        {"increment": 4, "force_N": 10.0, "sliding_mm_s": float("nan")},
        {"increment": 5, "force_N": 99.0, "sliding_mm_s": float("nan")},
    ]
    assert force_without_sliding(pairs, (3, 4)) == 0.25
    assert force_without_sliding(pairs, (1,)) == 0.0


def test_drag_of_the_lubricant_by_hand() -> None:
    """f0 = 2, 100 mm²/s at 1000/min in a bearing of 40 mm: 1e-7 · 2 · 1e5^(2/3) · 64000 N·mm.

    Below 2000 mm²/s/min it is 160e-7 f0 d³. The torque at the input of races whose relative speed
    is higher has the same power.
    """
    drag = BearingDrag(factor=2.0, viscosity=100.0, diameter=40.0)
    omega = 1000.0 * np.pi / 30.0
    assert drag.torque(omega) == pytest.approx(27.577, rel=1e-4)
    assert drag.torque(0.0) == pytest.approx(160e-7 * 2.0 * 40.0**3, rel=0.01)
    assert drag.torque(0.02 * omega) == pytest.approx(drag.torque(0.0), rel=1e-12)
    faster = BearingDrag(factor=2.0, viscosity=100.0, diameter=40.0, relative=1.02)
    assert faster.torque(omega) == pytest.approx(1.02 * drag.torque(1.02 * omega), rel=1e-12)


def test_friction_at_rest_and_at_low_speeds() -> None:
    """1.8 at rest, 1 + 0.8 / e at the given speed, 1 where it is high or without a speed."""
    losses = Losses(static_friction=1.8, stribeck_speed=60.0, input_drag=0.01, output_drag=0.5)
    omega = 2.0 * np.pi
    assert losses.dry_friction(0.0) == 1.8
    assert losses.dry_friction(omega) == pytest.approx(1.0 + 0.8 / np.e)
    assert losses.dry_friction(100.0 * omega) == 1.0
    assert losses.drag_at_input(0.0, -50.0) == pytest.approx(1.8 * 0.02)
    without = Losses(static_friction=1.8)
    assert (without.dry_friction(0.0), without.dry_friction(1e-9)) == (1.8, 1.0)


def test_hysteresis_of_a_ring_between_two_forces() -> None:
    """A thin ring of radius R under two opposite forces P bends by P R / 2 (2 / pi - |sin|).

    Harmonic n of the moment is 2 P R / pi / (n^2 - 1), so that the torque is 4 P^2 R^3 / (pi E I)
    times the sum of n / (n^2 - 1)^2 over even n. The stress is averaged at the nodes of four
    elements through the thickness.
    """
    design = PlainRingDesign(136.0, 2.0, 10.0, plane=True, material=Isotropic(E=E, nu=NU))
    radius = 67.0
    cam = simplified(design.inner_radius, 0.5 * 65.0)
    model = RingModel(design, RingCounts(120, 4, 1), cam, np.radians(30.0), MPI.COMM_SELF)
    model.spread(1e-3)
    n = np.arange(2.0, 2000.0, 2.0)
    inertia = 10.0 * 2.0**3 / 12.0
    force = 0.5 * model.contact_force()
    expected = 4.0 * force**2 * radius**3 / (np.pi * E * inertia) * np.sum(n / (n**2 - 1.0) ** 2)
    assert model.hysteresis_torque() == pytest.approx(expected, rel=0.02)
    model.destroy()


def test_losses_of_a_run() -> None:
    """They add up, follow their coefficients, and need a sampled period."""
    sampled = [*PLANE, "steps.samples=2", "steps.rotation=9"]
    less = ["losses.loss_factor=1e-3", "losses.input_drag=1e-3", "losses.output_drag=0.01"]
    less += ["losses.lubricant_viscosity=100"]
    one = swgpar.run(swgpar.load_design(DESIGN, [*sampled, *less]), RECIPE).summary.losses
    more = ["losses.loss_factor=2e-3", "losses.bearing_friction=0.003", "losses.flank_friction=0.1"]
    more += ["losses.input_drag=2e-3", "losses.output_drag=0.02"]
    more += ["losses.lubricant_viscosity=100", "losses.lubrication_factor=2"]
    other = swgpar.run(swgpar.load_design(DESIGN, [*sampled, *more]), RECIPE).summary.losses
    assert one.loss_torque_Nmm == pytest.approx(sum(asdict(one.parts_Nmm).values()))
    assert min(asdict(one.parts_Nmm).values()) > 0.0
    for name, value in asdict(one.parts_Nmm).items():
        assert getattr(other.parts_Nmm, name) == pytest.approx(2.0 * value, rel=1e-6), name
    assert one.parts_Nmm.seals == pytest.approx(1.0 + 10.0 * 2.0 / 40.0)
    useful = 200.0 * 2.0 / 40.0
    assert one.efficiency == pytest.approx(useful / (useful + one.loss_torque_Nmm))
    assert one.no_load_torque_Nmm is None
    free = swgpar.run(
        swgpar.load_design(DESIGN, [*sampled, "load.torque=0", *more]), RECIPE
    ).summary.losses
    assert free.efficiency is None and free.no_load_torque_Nmm == free.loss_torque_Nmm > 0.0
    # seals have only the torque that does not depend on the speed
    lubricant = bearing_drag(swgpar.load_design(DESIGN, [*sampled, *more])).torque(0.0)
    parts = free.parts_Nmm
    dry = parts.flank_friction + parts.bearing + parts.seals
    assert free.starting_torque_Nmm == pytest.approx(dry + parts.hysteresis + lubricant)
    assert one.starting_torque_Nmm is None
    with pytest.raises(InputError, match=r"\[losses\] is not available with steps.samples = 0"):
        swgpar.run(swgpar.load_design(DESIGN, [*PLANE, *more]), RECIPE, plain=True)


def test_friction_of_the_flanks_is_what_the_input_torque_gains() -> None:
    """The work of friction by forces and sliding speeds, against the energy balance of a run with
    friction.

    The ring gear is the output: its torque is conjugate to its rotation. Eight angles change either
    mean by 3 %, less where the input torque of a run without friction is subtracted.
    """
    sampled = [
        *PLANE,
        "drive.layout=spline_fixed",
        "steps.samples=8",
        "steps.rotation=18",
        "losses.flank_friction=0.1",
    ]
    means = {}
    for friction in (0.0, 0.1):
        found = swgpar.run(
            swgpar.load_design(DESIGN, [*sampled, f"contact.friction={friction}"]), RECIPE
        ).summary
        means[friction] = found["mean.wg_torque_Nmm"].value
        assert found.losses.flank_friction_coefficient == 0.1
    assert found.losses.parts_Nmm.flank_friction == pytest.approx(means[0.1] - means[0.0], rel=0.03)
