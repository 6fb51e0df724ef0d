"""Forces of inertia of a ring through which a wave passes, against closed forms, and in drives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from plain_ring import PlainRingDesign, RingCounts, RingModel
from support.bearing import BEARING
from support.cam_ring import DEFLECTION, HALF_ANGLE, INNER, STEEL, THICKNESS
from support.stepping import WORLD, assert_agree, loaded, small
from swgpar.constraints.wave_inertia import WaveInertia
from swgpar.contact.rigid_surface import RigidContact
from swgpar.design.drive_design import DriveDesign
from swgpar.fem.masses import sector_masses
from swgpar.geometry.cams import EllipticalCam

LOBES, DENSITY, SPEED = 2, 7850.0, 150.0
MASS = 1e-12 * DENSITY * THICKNESS
"""Of 1 mm² of the middle line of a ring 1 mm wide, t."""

MIDDLE = INNER + 0.5 * THICKNESS


def ring_on_cam(plane: bool) -> RingModel:
    """The ring of `support.cam_ring` on its cam, which it touches all round."""
    design = PlainRingDesign(
        2.0 * (INNER + THICKNESS),
        THICKNESS,
        1.0,
        plane,
        STEEL.model_copy(update={"density": DENSITY}),
    )
    design = replace(design, solver=design.solver.model_copy(update={"rtol": 1e-9}))
    cam = EllipticalCam(INNER + 0.5 * DEFLECTION, INNER - 0.5 * DEFLECTION)
    model = RingModel(design, RingCounts(60, 1, 1), cam, HALF_ANGLE, WORLD)
    model.mount()
    return model


def contact_forces(contact: RigidContact, copies: int) -> tuple[float, float]:
    """Mean and wave of two lobes of the cam's force on the whole ring, N: sums of the force, and of
    the force times cos 2 theta."""
    owned = contact.owned
    force = (contact.pressure * contact.weight)[owned]
    x = np.einsum("qa,fai->fqi", contact.shape, contact.coords)[owned]
    along = (x[..., 1] ** 2 - x[..., 0] ** 2) / (x[..., :2] ** 2).sum(axis=-1)
    sums = np.array([force.sum(), (force * along).sum()])
    mean, wave = copies * WORLD.allreduce(sums, op=MPI.SUM)
    return float(mean), float(wave)


def change_of_contact(model: RingModel, speed: float, wave: float) -> tuple[float, float]:
    """Change of `contact_forces` by inertia. speed, wave : rad/s, of ring and cam in space"""
    before = contact_forces(model.surface, model.ring.copies)
    term = WaveInertia(model.body, LOBES, speed, wave)
    model.problem.force_terms.append(term)
    model.mount()
    after = contact_forces(model.surface, model.ring.copies)
    return after[0] - before[0], after[1] - before[1]


@pytest.mark.parallel([1, 2])
@pytest.mark.parametrize("plane", [True, False])
def test_a_wave_takes_its_inertia_from_the_cam(plane: bool) -> None:
    """The ring follows the cam all round: its shape, with u cos 2 theta outward and -(u / 2) sin 2
    theta along, does not depend on the speed w. Hoop force and pressure of the cam carry rho A
    times the acceleration: the pressure falls by (n² + 1) rho A w² u cos n theta."""
    model = ring_on_cam(plane)
    mean, wave = change_of_contact(model, 0.0, SPEED)
    amplitude = 0.5 * DEFLECTION
    expected = -(LOBES**2 + 1) * MASS * SPEED**2 * amplitude * np.pi * MIDDLE
    print(f"{wave:.4f} N, closed form {expected:.4f} N; mean {mean:.2e} N")
    parallel_assert(abs(wave / expected - 1.0) < 0.01)
    # of second order in the deflection
    parallel_assert(abs(mean) < 0.03 * abs(expected))
    model.destroy()


@pytest.mark.parallel(1)
def test_a_rotating_ring_under_a_standing_wave_has_a_hoop_force_alone() -> None:
    """It flows along its own curve: a tension rho A v² carries its inertia, and the cam loses that
    of a ring, 2 pi rho A v² in all, as if nothing were deflected."""
    model = ring_on_cam(True)
    mean, wave = change_of_contact(model, SPEED, 0.0)
    expected = -2.0 * np.pi * MASS * (MIDDLE * SPEED) ** 2
    # the tension on the curvature 1 / R + (n² - 1) u cos n theta / R²
    bent = -MASS * (MIDDLE * SPEED) ** 2 * (LOBES**2 - 1) * np.pi * 0.5 * DEFLECTION / MIDDLE
    print(f"{mean:.4f} N, closed form {expected:.4f} N; wave {wave:.4f} N, {bent:.4f} N")
    parallel_assert(abs(mean / expected - 1.0) < 0.01)
    parallel_assert(abs(wave / bent - 1.0) < 0.03)
    model.destroy()


FAST = ("material.density=7850.0", "load.inertia=true")


def share(design: DriveDesign) -> float:
    """Of the forces that bend the rim, that inertia makes."""
    return design.rim_inertia.share_of_bending(*design.speeds)


def at_share(model: str, wanted: float, *overrides: str) -> DriveDesign:
    """The small drive at the input speed at which inertia has that share."""
    one = small(model, "material.density=7850.0", "load.input_speed=1000", *overrides)
    speed = 1000.0 * np.sqrt(wanted / share(one))
    return small(model, *FAST, f"load.input_speed={speed}", *overrides)


NAMES = ("fs_s1", "fs_vm", "wg_torque_Nmm", "tooth_torque_Nmm", "output_angle_deg")


@pytest.mark.parametrize("model", ["plane", "cup"])
def test_a_slow_drive_is_one_without_inertia(model: str) -> None:
    """Far teeth of a cup are whole elements where they have mass: the rim is stiffer by what the
    condensed ones leave out, nothing."""
    stepper, slow = loaded(at_share(model, 1e-9))
    assert not stepper.model.design.condenses_teeth
    _, still = loaded(small(model, "solver.far_teeth=modelled"))
    assert_agree(slow, still, NAMES, 2e-5)


@pytest.mark.parallel([1, 2])
@pytest.mark.parametrize(("model", "others"), [("plane", ()), ("plane", BEARING), ("cup", ())])
def test_inertia_keeps_the_balance_on_any_ranks(model: str, others: tuple[str, ...]) -> None:
    """At a tenth of the bending, half of the drive on all ranks and the whole on one."""
    design = at_share(model, 0.1, *others)
    _, half = loaded(design)
    parallel_assert(half["torque_balance_Nmm"] < 1e-6 * abs(half["output_torque_Nmm"]))
    if others or model == "cup":
        return
    _, full = loaded(at_share(model, 0.1, "solver.symmetry=false", *others), MPI.COMM_SELF)
    assert_agree(half, full, NAMES, 1e-6)
    _, still = loaded(small(model, "material.density=7850.0"), MPI.COMM_SELF)
    changed = half["wg_torque_Nmm"] / still["wg_torque_Nmm"] - 1.0
    print(f"change of the input torque {changed:.2e}, of s1 {half['fs_s1'] - still['fs_s1']:.2f}")
    parallel_assert(abs(half["fs_s1"] / still["fs_s1"] - 1.0) > 1e-4)


def test_the_cam_of_a_drive_loses_the_inertia_of_rim_and_teeth() -> None:
    """On a cam that touches all round: (n² + 1) M w² u / 2 with the mass M of the flexible spline.
    Tips of teeth move less along than the rim does."""
    forces = []
    for part in (1e-9, 0.1):
        stepper, _ = loaded(at_share("plane", part, "load.torque=0"))
        model = stepper.model
        forces.append(contact_forces(model.problem.wave_generator.cam, model.copies)[1])
    body = model.elements.bodies["flexible_spline"].layout
    mass, speed = sector_masses(body.body).sum() * body.mesh.n_sectors, model.design.speeds[1]
    amplitude = 0.5 * model.design.deflection
    expected = -0.5 * (LOBES**2 + 1) * mass * speed**2 * amplitude
    print(f"{forces[1] - forces[0]:.2f} N of {forces[0]:.2f} N, closed form {expected:.2f} N")
    assert forces[1] - forces[0] == pytest.approx(expected, rel=0.05)
