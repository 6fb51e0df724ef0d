"""The planetary gear train: statics, steps and statistics against independent formulations and each
other."""

from __future__ import annotations

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from support.paths import DRIVERS
from swgpar import load_design
from swgpar.errors import ConvergenceError
from swgpar.gear_trains.kernel import PlanetaryStepKernel
from swgpar.gear_trains.planetary.design import PlanetaryDesign
from swgpar.gear_trains.planetary.linearisation import TrainMoments, linearise_train
from swgpar.gear_trains.planetary.monitored import MONITORED_NAMES, RECORDED, monitored
from swgpar.gear_trains.planetary.monte_carlo import simulate
from swgpar.gear_trains.planetary.time_stepping import ModalStates, TimeStepper
from swgpar.gear_trains.planetary.wind_load import WindLoad
from swgpar.gear_trains.planetary_parts.model import (
    PlanetaryModel,
    base_radii,
    carrier_index,
    planet_index,
    ring_index,
    ring_pitch_radius,
)
from swgpar.vibration.backlash import force
from swgpar.vibration.dominant_cycles import dominant_cycles
from swgpar.vibration.sampling import random_stream

DRIVER = DRIVERS / "planetary.toml"

NAMED = slice(len(MONITORED_NAMES))
"""The monitored ones of the recorded quantities: none of them is zero by symmetry."""


@pytest.fixture(scope="module")
def design() -> PlanetaryDesign:
    return load_design(DRIVER)


def changed(design: PlanetaryDesign, section: str, **values: object) -> PlanetaryDesign:
    return design.model_copy(update={section: getattr(design, section).model_copy(update=values)})


@pytest.fixture(scope="module")
def small(design: PlanetaryDesign) -> PlanetaryDesign:
    """Six elements, and stronger turbulence of a shorter memory."""
    return changed(changed(design, "ring", elements=6), "wind", length=2.0)


def physical(train: PlanetaryModel, t: float) -> tuple[np.ndarray, np.ndarray]:
    """Damping (n, n) and ways (m, n) at a time, in the coordinates of the parts."""
    deflection_rows, section = train.deflection_rows(t), train.design.damping
    damping = section.mass * train.mass + section.stiffness * train.constant
    return damping + deflection_rows.T @ (
        train.mesh_damping[:, None] * deflection_rows
    ), deflection_rows


# --- equations


def test_kinematics(design: PlanetaryDesign) -> None:
    """A turn of the carrier and the sun's by 1 + 99/21 of it, in a ring at rest, is no way of any
    mesh or bearing."""
    train = PlanetaryModel(design)
    sun, planets, centres = base_radii(design)
    x = np.zeros(train.size)
    turn, ratio = 1e-3, 1.0 + design.ring.teeth / 21.0
    x[2], x[carrier_index(design) + 2] = sun * ratio * turn, centres * turn
    for k in range(design.planet.count):
        # a planet turns backwards by the ring's teeth over its own, less the carrier's turn
        x[planet_index(k) + 1 : planet_index(k) + 3] = (
            centres * turn,
            -planets * centres / (planets / np.cos(np.pi / 9.0)) * turn,
        )
    assert np.abs(train.deflection_rows(0.7) @ x).max() < 1e-4 * centres * turn
    shaft = x[2] * train.constant[2, 2] * x[2]
    assert x @ train.constant @ x == pytest.approx(shaft, rel=1e-9)
    assert np.abs(train.constant - train.constant.T).max() < 1e-12 * np.abs(train.constant).max()
    assert ratio == pytest.approx(
        2.0 * centres / (1e-3 * 0.5 * design.sun.pitch_diameter), rel=1e-3
    )


def turned(train: PlanetaryModel) -> np.ndarray:
    """Displacements (n,) when the whole train turns by 1 rad as one body."""
    design, x = train.design, np.zeros(train.size)
    sun, planets, centres = base_radii(design)
    x[2], x[carrier_index(design) + 2] = sun, centres
    for k in range(design.planet.count):
        x[planet_index(k) + 1 : planet_index(k) + 3] = centres, planets
    x[ring_index(design) :] = np.tile([0.0, train.ring.section.radius, 1.0], design.ring.elements)
    return x


def shifted(train: PlanetaryModel, t: float) -> np.ndarray:
    """Displacements (n,) at a time in s when the whole train moves by 1 m along x, which turns with
    the carrier."""
    design, x = train.design, np.zeros(train.size)
    x[0] = x[carrier_index(design)] = 1.0
    for k, psi in enumerate(train.design.angles):
        x[planet_index(k) : planet_index(k) + 2] = np.cos(psi), -np.sin(psi)
    count = design.ring.elements
    node = 2.0 * np.pi * np.arange(count) / count - design.carrier.speed * t
    x[ring_index(design) :] = np.stack([np.cos(node), -np.sin(node), 0.0 * node], axis=1).ravel()
    return x


RIMS = [
    ["ring.rim=87"],
    ["ring.rim=128"],
    ["ring.rim=168"],
    ["planet.count=4", "ring.supports=9", "ring.rim=40", "sun.pitch_diameter=215.7"],
]


@pytest.mark.parametrize("overrides", RIMS)
def test_rigid_motions_strain_no_mesh(overrides: list[str]) -> None:
    """Of a train that moves as one body only the springs to the ground hold energy."""
    train = PlanetaryModel(load_design(DRIVER, overrides))
    design, body = train.design, train.ring.elastic
    turn = turned(train)
    for t in (0.0, 0.7, 3.1):
        for motion in (turn, shifted(train, t)):
            assert np.abs(train.deflection_rows(t) @ motion).max() < 1e-12
            elastic = motion[ring_index(design) :] @ body @ motion[ring_index(design) :]
            assert abs(elastic) < 1e-9 * np.abs(body).max()
    ring = design.ring
    held = ring.torsional + ring.tangential * train.ring.section.radius**2
    springs = design.sun.torsional + ring.supports * held
    assert turn @ train.constant @ turn == pytest.approx(springs, rel=1e-9)


@pytest.mark.parametrize("overrides", RIMS)
@pytest.mark.parametrize("torque", [1e5, -3e3])
def test_torques_balance(overrides: list[str], torque: float) -> None:
    """Sun shaft and ring supports carry the torque of the carrier, and the torque's work is twice
    the strain energy, less what the backlash takes."""
    train = PlanetaryModel(load_design(DRIVER, overrides))
    steps = TimeStepper(train, 1e-3, 1)
    start, flanks = steps.static_equilibrium(torque)
    q, turn = train.shapes @ start.q[:, 0], turned(train)
    assert turn @ train.constant @ q == pytest.approx(torque, rel=1e-10)
    stretch, k = train.deflection_rows(0.0) @ q, steps.stiffness[0]
    forces = force(k, stretch, train.half_backlash)
    energy = 0.5 * q @ train.constant @ q + 0.5 * (forces**2 / k).sum()
    taken = train.half_backlash * (flanks * forces).sum()
    work = torque * q[carrier_index(train.design) + 2] / base_radii(train.design)[2]
    assert work == pytest.approx(2.0 * energy + taken, rel=1e-9)


@pytest.mark.parametrize("turned_by", [0.0, 0.3, 0.52])
def test_elements_of_the_ring(turned_by: float) -> None:
    """At rest, with meshes at nodes or between them, 6, 18 and 54 elements give the same."""
    found = []
    for elements in (6, 18, 54):
        train = PlanetaryModel(load_design(DRIVER, [f"ring.elements={elements}"]))
        t, torque, flanks = turned_by / train.design.carrier.speed, 1e5, -np.ones(6)
        steps = TimeStepper(train, max(t, 1e-3), 1)
        step = int(t > 0.0)
        w, k = steps.deflection_rows[step], steps.stiffness[step]
        load = train.torque_vector * torque + w.T @ (k * flanks * train.half_backlash)
        q = np.linalg.solve(np.diag(train.stiffness) + w.T @ (k[:, None] * w), load)
        rows, added = monitored(train, steps, step, flanks)
        values = dict(zip(RECORDED, rows @ q + added, strict=True))
        # the deflection of a mesh is its force over its own stiffness, and the backlash
        own = (k * (w @ q - flanks * train.half_backlash) / train.mesh.at(t))[3]
        assert values["ring_mesh_deflection"] == pytest.approx(own - train.half_backlash)
        del values["ring_node_tangential"]  # of another node
        found.append([values[name] for name in MONITORED_NAMES if name in values])
    for values in found[:2]:
        assert values == pytest.approx(found[2], rel=1e-6)


def test_statics(design: PlanetaryDesign) -> None:
    """The carrier's torque is that of all mesh forces; the sun's shaft takes its part, the ring's
    supports the rest."""
    train = PlanetaryModel(design)
    steps, torque = TimeStepper(train, 1e-3, 1), 1e5
    start, flanks = steps.static_equilibrium(torque)
    q = train.shapes @ start.q[:, 0]
    f = force(steps.stiffness[0], train.deflection_rows(0.0) @ q, train.half_backlash)
    sun, _, centres = base_radii(design)
    cosine = np.cos(np.radians(design.mesh.pressure_angle))
    assert (flanks == -1.0).all()
    np.testing.assert_allclose(
        f, -torque / (2.0 * design.planet.count * centres * cosine), rtol=1e-9
    )
    # three planets in phase between six supports: the sun stays in the middle, on a bearing of 100
    # N/m
    assert np.abs(q[:2]).max() < 1e-9 * abs(q[2])
    turn = q[2] / sun
    assert design.sun.torsional * turn == pytest.approx(-3.0 * f[0] * sun, rel=1e-9)
    # virtual work of a turn of the ring: what its supports hold
    first = ring_index(design)
    held = turned(train)[first:] @ train.ring.stiffness @ q[first:]
    expected = -design.planet.count * f[3] * cosine * ring_pitch_radius(design)
    assert held == pytest.approx(expected, rel=1e-9)
    # flanks load apart: forces on the sun away from planet 1, on planet 1 outward by the sun, on
    # the ring outward
    deflection_rows, outward = train.deflection_rows(0.0), first
    assert -f[0] * deflection_rows[0, 0] < 0.0 < -f[0] * deflection_rows[0, planet_index(0)]
    assert -f[3] * deflection_rows[3, planet_index(0)] < 0.0 < -f[3] * deflection_rows[3, outward]


def test_planets_out_of_phase(design: PlanetaryDesign) -> None:
    """Four planets, 21 and 99 teeth: at the ring a planet is where the one before it was a quarter
    turn ago."""
    train = PlanetaryModel(changed(design, "planet", count=4))
    quarter = 0.5 * np.pi / design.carrier.speed
    for t in (0.0, 0.1, 0.37):
        now, later = train.mesh.at(t), train.mesh.at(t + quarter)
        np.testing.assert_allclose(now[5:8], later[4:7], rtol=1e-12)
        # the sun has turned by 99/21 quarter turns more than the carrier: 21 teeth apart, 99 teeth
        # on, a whole number
        np.testing.assert_allclose(now[1:4], later[:3], rtol=1e-12)
        assert np.ptp(now[4:]) > 0.01 * now[4]
    together = PlanetaryModel(design).mesh.at(0.1)
    np.testing.assert_allclose(together[:3], together[0], rtol=1e-12)
    np.testing.assert_allclose(together[3:], together[3], rtol=1e-12)


def test_modes_hold_the_matrices(small: PlanetaryDesign) -> None:
    train = PlanetaryModel(small)
    s = train.shapes
    np.testing.assert_allclose(s.T @ train.mass @ s, np.eye(train.size), atol=1e-8)
    np.testing.assert_allclose(
        s.T @ train.constant @ s,
        np.diag(train.stiffness),
        atol=1e-9 * np.abs(train.stiffness).max(),
    )


# --- steps


def states_of(
    train: PlanetaryModel,
    h: float,
    q: np.ndarray,
    v: np.ndarray,
    steps: TimeStepper,
    forces: np.ndarray,
) -> ModalStates:
    modal = np.linalg.solve(train.shapes, np.column_stack([q, v]))
    y = 2.0 / h * modal[:, :1] + modal[:, 1:]
    return ModalStates(modal[:, :1].copy(), y, steps.mesh_term(0, modal[:, :1], y, forces[:, None]))


def test_a_step_is_the_trapezoidal_rule(small: PlanetaryDesign) -> None:
    """Against the whole matrices of all parts, meshes without backlash, from a random state; linear
    and simulated."""
    design = changed(small, "mesh", half_backlash=0.0)
    train, h = PlanetaryModel(design), 2e-3
    steps, random = TimeStepper(train, h, 1), np.random.default_rng(0)
    q, v, torque = (
        1e-5 * random.standard_normal(train.size),
        1e-4 * random.standard_normal(train.size),
        3e4,
    )
    (c0, w0), (c1, w1) = (physical(train, t) for t in (0.0, h))
    k0, k1 = (
        train.constant + w.T @ (k[:, None] * w)
        for w, k in zip((w0, w1), steps.stiffness, strict=True)
    )
    load = np.linalg.solve(train.shapes.T, train.torque_vector) * torque
    # M (v1 - v0) + h/2 (C0 v0 + C1 v1 + K0 q0 + K1 q1) = h F with q1 = q0 + h/2 (v0 + v1)
    left = train.mass + 0.5 * h * c1 + 0.25 * h * h * k1
    right = train.mass @ v - 0.5 * h * (c0 @ v + k0 @ q + k1 @ (q + 0.5 * h * v)) + h * load
    v1 = np.linalg.solve(left, right)
    q1 = q + 0.5 * h * (v + v1)
    for backlash in (False, True):
        states = states_of(train, h, q, v, steps, steps.stiffness[0] * (w0 @ q))
        torques = np.array([2.0 * torque])
        if backlash:
            # one state of many, that do not fill the kernel's lanes; all on the wrong flank at
            # first
            states = ModalStates(
                *(np.repeat(part, 19, axis=1) for part in (states.q, states.y, states.mesh_term))
            )
            flanks = -np.sign(w1 @ q1)
            assert steps.simulate(0, states, np.repeat(torques[None], 19, axis=1), flanks) == 19
            assert (states.q == states.q[:, :1]).all()
        else:
            steps.linear(1, states, torques, steps.law(1, steps.stiffness[1]))
        moved = train.shapes @ states.q[:, 0]
        velocities = train.shapes @ (states.y - 2.0 / h * states.q)[:, 0]
        np.testing.assert_allclose(moved, q1, atol=1e-8 * np.abs(q1).max())
        np.testing.assert_allclose(velocities, v1, atol=1e-6 * np.abs(v1).max())
    # forces that are given, as those of the linearised mean are
    states, forces = (
        states_of(train, h, q, v, steps, steps.stiffness[0] * (w0 @ q)),
        steps.stiffness[1] * (w1 @ q1),
    )
    free = steps.free_deflections(1, states, torques)[:, 0]
    np.testing.assert_allclose(
        steps.damped[1] @ (w1 @ q1) + steps.compliance[1] @ forces,
        free,
        atol=1e-8 * np.abs(free).max(),
    )
    steps.linear(1, states, torques, steps.law(1, np.zeros_like(forces), forces))
    np.testing.assert_allclose(train.shapes @ states.q[:, 0], q1, atol=1e-8 * np.abs(q1).max())


def test_a_step_that_does_not_converge() -> None:
    """One mode and one mesh that pulls where it should push: d = 1.5 in contact asks for 0.5, in
    the gap, and back."""
    one, zero = np.ones(1), np.zeros(1)
    kernel = PlanetaryStepKernel(
        1e-3, 1.0, one, zero, zero, zero, np.ones((2, 1, 1)), np.full((2, 1, 1), -2.0), zero
    )
    train = SimpleNamespace(half_backlash=1.0)
    steps = SimpleNamespace(
        h=1e-3,
        kernel=kernel,
        train=train,
        stiffness=np.ones((2, 1)),
        contact_inverse=np.ones((2, 1, 1)),
    )
    states = ModalStates(np.full((1, 1), 1.5), np.zeros((1, 1)), np.zeros((1, 1)))
    with pytest.raises(ConvergenceError, match=r"did not converge at 0\.001 s"):
        TimeStepper.simulate(steps, 0, states, np.zeros((1, 1)), -one)


def test_load_reversal(small: PlanetaryDesign) -> None:
    """The torque reverses: all meshes cross their backlash. Against SciPy's Radau, second order in
    the step."""
    train, end, torque = PlanetaryModel(small), 0.6, 1e5
    torque_row = np.linalg.solve(train.shapes.T, train.torque_vector)
    inverse = np.linalg.inv(train.mass)

    def torque_at(t: float) -> float:
        return torque * np.cos(np.pi * t / end)

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        q, v = np.split(y, 2)
        damping, deflection_rows = physical(train, t)
        internal = (
            train.constant @ q
            + damping @ v
            + deflection_rows.T
            @ force(
                train.mesh_stiffness(np.array([t]))[0], deflection_rows @ q, train.half_backlash
            )
        )
        return np.concatenate([v, inverse @ (torque_row * torque_at(t) - internal)])

    def jacobian(t: float, y: np.ndarray) -> np.ndarray:
        damping, deflection_rows = physical(train, t)
        in_contact = np.abs(deflection_rows @ y[: train.size]) > train.half_backlash
        k = train.constant + deflection_rows.T @ (
            (train.mesh_stiffness(np.array([t]))[0] * in_contact)[:, None] * deflection_rows
        )
        return np.block(
            [[np.zeros_like(k), np.eye(train.size)], [-inverse @ k, -inverse @ damping]]
        )

    start, _ = TimeStepper(train, 1e-3, 1).static_equilibrium(torque)
    q = train.shapes @ start.q[:, 0]
    exact = solve_ivp(
        rates,
        (0.0, end),
        np.concatenate([q, 0.0 * q]),
        method="Radau",
        rtol=1e-7,
        atol=1e-12,
        jac=jacobian,
    )
    expected = np.linalg.solve(train.shapes, exact.y[: train.size, -1])
    off = []
    for count in (150, 300, 600):
        h = end / count
        steps = TimeStepper(train, h, count)
        states, flanks = steps.static_equilibrium(torque)
        lost = 0
        for step in range(1, count + 1):
            torques = np.array([[torque_at((step - 1) * h) + torque_at(step * h)]])
            lost += steps.simulate(step - 1, states, torques, flanks)
        values = monitored(train, steps, count, flanks)[0][NAMED]
        off.append(np.abs(values @ states.q[:, 0] / (values @ expected) - 1.0).max())
    assert lost > count / 4
    assert off[-1] < 0.01
    assert off[0] / off[1] > 2.5 and off[1] / off[2] > 2.5


# --- wind


def test_wind(design: PlanetaryDesign) -> None:
    h, section = 0.1, design.wind
    wind = WindLoad.of(design, h)
    spread = np.zeros((2, 2))
    for _ in range(3000):
        spread = wind.transition @ spread @ wind.transition.T + wind.noise_root @ wind.noise_root.T
    # dT = factor V0 dV, and the steady part is factor V0² / 2
    deviation = np.sqrt(wind.turbulent @ spread @ wind.turbulent)
    assert deviation == pytest.approx(2.0 * section.turbulence * wind.steady, rel=1e-6)
    half_step = WindLoad.of(design, 0.5 * h)
    twice = (
        half_step.transition
        @ half_step.noise_root
        @ half_step.noise_root.T
        @ half_step.transition.T
        + half_step.noise_root @ half_step.noise_root.T
    )
    np.testing.assert_allclose(twice, wind.noise_root @ wind.noise_root.T, rtol=1e-9)
    v0, area = section.speed / 3.6, np.pi * section.rotor_radius**2
    ratio = design.carrier.speed * section.rotor_radius / v0
    torque = (
        0.5
        * section.air_density
        * area
        * section.rotor_radius
        * section.power_coefficient
        / ratio
        * v0**2
    )
    assert wind.steady == pytest.approx(torque)


# --- statistics


def moments(
    design: PlanetaryDesign, h: float, count: int, every: int
) -> tuple[TimeStepper, WindLoad, TrainMoments]:
    steps, wind = TimeStepper(PlanetaryModel(design), h, count), WindLoad.of(design, h)
    return steps, wind, linearise_train(steps, wind, every)


def test_covariance_by_whole_matrices(small: PlanetaryDesign) -> None:
    """Without backlash the linearisation is the linear train: S = T S T^T + B B^T with whole
    matrices."""
    design = changed(small, "mesh", half_backlash=0.0)
    h, count = 2e-3, 8
    steps, wind, found = moments(design, h, count, count)
    train = steps.train
    n = train.size
    load = np.linalg.solve(train.shapes.T, train.torque_vector)[:, None]
    spread = np.zeros((2 * n + 2, 2 * n + 2))
    for step in range(1, count + 1):
        (c0, w0), (c1, w1) = (physical(train, t) for t in ((step - 1) * h, step * h))
        k0, k1 = (
            train.constant + w.T @ (steps.stiffness[s][:, None] * w)
            for w, s in ((w0, step - 1), (w1, step))
        )
        turbulent = load @ wind.turbulent[None]
        eye = np.eye(n)
        left = np.block([[0.5 * h * k1, train.mass + 0.5 * h * c1], [eye, -0.5 * h * eye]])
        right = np.block([[-0.5 * h * k0, train.mass - 0.5 * h * c0], [eye, 0.5 * h * eye]])
        of_state = np.linalg.solve(left, right)
        of_wind = np.linalg.solve(left, np.vstack([0.5 * h * turbulent, 0.0 * turbulent]))
        of_wind, of_noise = of_wind @ (np.eye(2) + wind.transition), of_wind @ wind.noise_root
        transition = np.block([[of_state, of_wind], [np.zeros((2, 2 * n)), wind.transition]])
        added = np.vstack([of_noise, wind.noise_root])
        spread = transition @ spread @ transition.T + added @ added.T
    rows, _ = monitored(train, steps, count, -np.ones(6))
    values = np.linalg.solve(train.shapes.T, rows[NAMED].T).T
    expected = np.sqrt(np.einsum("pi,ij,pj->p", values, spread[:n, :n], values))
    np.testing.assert_allclose(found.deviation[-1, NAMED], expected, rtol=1e-5)


def test_linearisation_does_not_depend_on_the_step(small: PlanetaryDesign) -> None:
    """With backlash and tooth cycles: second order; the covariance is positive semi-definite to
    round-off."""
    end, results = 0.4, []
    for count in (50, 100, 200):
        _, _, found = moments(small, end / count, count, count // 10)
        results.append(np.concatenate([found.mean[-1, NAMED], found.deviation[-1, NAMED]]))
        # of all rows: displacements, velocities and wind together, before the covariance is made
        # symmetric
        assert found.smallest_eigenvalue > -1e-12 and found.asymmetry < 1e-10
    steps = [np.abs(fine / coarse - 1.0).max() for coarse, fine in itertools.pairwise(results)]
    assert steps[1] < 2e-3
    assert np.log2(steps[0] / steps[1]) > 1.6


def test_linearised_against_simulated(small: PlanetaryDesign) -> None:
    """No impact: means and deviations within 2 %; 16,000 samples know a deviation to 0.6 %."""
    steps, wind, found = moments(changed(small, "wind", turbulence=0.05), 8e-3, 100, 50)
    sums, lost = simulate(steps, wind, 50, 16_000, random_stream(5))
    assert lost == 0
    for kind in ("mean", "deviation"):
        ours, theirs = getattr(found, kind)[:, NAMED], getattr(sums, kind)[:, NAMED]
        np.testing.assert_allclose(ours, theirs, rtol=0.02)


def test_linearised_against_simulated_on_the_driver(design: PlanetaryDesign) -> None:
    """The driver's own train over a revolution, by 1000 steps: within 2 %; 16,000 samples know a
    deviation to 0.6 %."""
    count = 1000
    steps, wind, found = moments(design, design.end / count, count, 20)
    sums, lost = simulate(steps, wind, 20, 16_000, random_stream(7))
    assert lost == 0
    later = slice(25, None)
    for kind in ("mean", "deviation"):
        ours, theirs = getattr(found, kind)[later], getattr(sums, kind)[later]
        named = ours[:, NAMED].mean(axis=0), theirs[:, NAMED].mean(axis=0)
        np.testing.assert_allclose(*named, rtol=0.02)
        # all coordinates at all times, over their largest values; less than 1e-11 m is round-off
        off = np.abs(ours - theirs).max(axis=0) / np.maximum(np.abs(theirs).max(axis=0), 1e-9)
        assert off.max() < 0.05
    # round-off adds up over the steps in stiff modes, which the trapezoidal rule hardly damps
    assert found.smallest_eigenvalue > -1e-9 and found.asymmetry < 1e-10


def test_impacts_spoil_the_mesh(small: PlanetaryDesign) -> None:
    """With strong turbulence meshes lose contact: the ways' deviations go wrong, the turns'
    hardly."""
    steps, wind, found = moments(changed(small, "wind", turbulence=0.6), 5e-3, 200, 50)
    sums, lost = simulate(steps, wind, 50, 2000, random_stream(6))
    assert lost > 0.02 * 200 * 2000
    off = np.abs(found.deviation[-1, NAMED] / sums.deviation[-1, NAMED] - 1.0)
    mesh, turn = (
        MONITORED_NAMES.index("sun_mesh_deflection"),
        MONITORED_NAMES.index("carrier_rotation"),
    )
    assert off[mesh] > 0.1 > off[turn]


def test_patterns_and_rims(design: PlanetaryDesign) -> None:
    """Six cycles under a planet (six supports), three at a node (three planets); rims move all but
    the sun."""
    count, largest = 400, {}
    for rim in (87.0, 168.0):
        steps, wind, found = moments(changed(design, "ring", rim=rim), design.end / count, count, 2)
        largest[rim] = np.concatenate([np.abs(found.mean).max(axis=0), found.deviation.max(axis=0)])
        assert (
            dominant_cycles(found.mean[:, MONITORED_NAMES.index("ring_contact_radial")], 1.0) == 6.0
        )
        assert (
            dominant_cycles(found.mean[:, MONITORED_NAMES.index("ring_node_tangential")], 1.0)
            == 3.0
        )
        assert steps.train.size == 69 and wind.steady > 0.0
    change = dict(
        zip(
            MONITORED_NAMES,
            largest[168.0][: len(MONITORED_NAMES)] / largest[87.0][: len(MONITORED_NAMES)],
            strict=True,
        )
    )
    assert change["ring_contact_radial"] < 0.5 and change["ring_node_tangential"] < 0.8
    assert 0.95 < change["carrier_rotation"] < 1.0 and 0.95 < change["planet_tangential"] < 1.0
    assert change["sun_rotation"] == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("overrides", [[], ["ring.supports=2"]])
def test_coordinates(overrides: list[str]) -> None:
    """The recorded coordinates are those of the parts. Sun and carrier stay in the middle if
    planets and supports repeat every third of a turn, and only then."""
    train = PlanetaryModel(load_design(DRIVER, overrides))
    design, first = train.design, ring_index(train.design)
    steps = TimeStepper(train, 0.7 / design.carrier.speed, 1)
    start, flanks = steps.static_equilibrium(1e5)
    rows, added = monitored(train, steps, 0, flanks)
    found = dict(zip(RECORDED, rows @ start.q[:, 0] + added, strict=True))
    x, carrier, planet = train.shapes @ start.q[:, 0], carrier_index(design), planet_index(0)
    for name, value in {
        "sun_x": x[0],
        "sun_y": x[1],
        "planet_radial": x[planet],
        "planet_rotation": x[planet + 2],
        "carrier_x": x[carrier],
        "carrier_y": x[carrier + 1],
        "ring_node_1_radial": x[first],
        "ring_node_1_rotation": x[first + 2] * train.ring.section.radius,
        "ring_node_2_tangential": x[first + 4],
        "ring_node_3_radial": x[first + 6],
        "ring_node_3_rotation": x[first + 8] * train.ring.section.radius,
    }.items():
        assert found[name] == pytest.approx(value, rel=1e-12, abs=1e-18)
    middle = [found[name] for name in ("sun_x", "sun_y", "carrier_x", "carrier_y")]
    if overrides:
        assert np.abs(middle).max() > 1e-8
    else:
        assert np.abs(middle).max() < 1e-12
