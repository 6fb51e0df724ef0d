"""The gear pair: expectations, linearisation and simulation against quadrature, closed forms and
each other."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh, expm, solve_continuous_lyapunov

from support.paths import DRIVERS
from swgpar import load_design
from swgpar.gear_trains.gear_pair.design import GearPairDesign
from swgpar.gear_trains.gear_pair.model import (
    DEFLECTION_ROW,
    combined_mass,
    gear_pair_system,
    pair_modes,
    static_equilibrium,
)
from swgpar.gear_trains.gear_pair.monte_carlo import simulate
from swgpar.vibration import backlash
from swgpar.vibration.linearisation import CoordinateMoments, linearise
from swgpar.vibration.mesh_stiffness import MeshStiffness
from swgpar.vibration.moments import SampleMoments
from swgpar.vibration.sampling import random_stream

DRIVER = DRIVERS / "gear_pair.toml"
STEP, STEPS, EVERY = 1e-5, 300, 30
NODES, WEIGHTS = np.polynomial.legendre.leggauss(200)
STATES = [
    (m, s, b) for m in (-3.0, -0.4, 0.0, 1.0, 2.5) for s in (0.05, 0.7, 3.0) for b in (0.0, 1.0)
]


@pytest.fixture(scope="module")
def design() -> GearPairDesign:
    return load_design(DRIVER)


@pytest.fixture(scope="module")
def moments(design: GearPairDesign) -> dict[tuple[int, str], CoordinateMoments]:
    return {
        (case, method): linearise(
            gear_pair_system(design, case),
            static_equilibrium(design, case),
            STEP,
            STEPS,
            EVERY,
            method,
        )
        for case in range(3)
        for method in ("energy", "force")
    }


@pytest.fixture(scope="module")
def sums(design: GearPairDesign) -> list[SampleMoments]:
    return [run(design, case, 8000) for case in range(3)]


def run(
    design: GearPairDesign, case: int, samples: int, h: float = STEP, *, seed: int = 3
) -> SampleMoments:
    ratio = round(STEP / h)
    grid = h, STEPS * ratio, EVERY * ratio
    return simulate(
        gear_pair_system(design, case),
        static_equilibrium(design, case),
        *grid,
        samples,
        random_stream(seed, case),
    )


# --- expectations


def normal(mean: float, deviation: float, half_backlash: float) -> tuple[np.ndarray, np.ndarray]:
    """Points and weights of an integral over a normal density, ten deviations to both sides, cut
    where f has kinks."""
    ends = [mean - 10.0 * deviation, mean + 10.0 * deviation]
    cuts = sorted([*ends, *(b for b in {half_backlash, -half_backlash} if ends[0] < b < ends[1])])
    x = np.concatenate([0.5 * (a + b + (b - a) * NODES) for a, b in itertools.pairwise(cuts)])
    w = np.concatenate([0.5 * (b - a) * WEIGHTS for a, b in itertools.pairwise(cuts)])
    return x, w * np.exp(-0.5 * ((x - mean) / deviation) ** 2) / (deviation * np.sqrt(2.0 * np.pi))


@pytest.mark.parametrize(("mean", "deviation", "half_backlash"), STATES)
def test_expectations(mean: float, deviation: float, half_backlash: float) -> None:
    d, w = normal(mean, deviation, half_backlash)
    force, energy = backlash.force(2.0, d, half_backlash), backlash.energy(2.0, d, half_backlash)
    assert backlash.mean_force(2.0, mean, deviation, half_backlash) == pytest.approx(
        w @ force, abs=1e-9
    )
    assert backlash.mean_energy(2.0, mean, deviation, half_backlash) == pytest.approx(
        w @ energy, abs=1e-9
    )
    slope = w @ (force * (d - mean)) / deviation**2
    assert backlash.mean_stiffness(2.0, mean, deviation, half_backlash) == pytest.approx(
        slope, abs=1e-9
    )
    # least squares of the energy counted from that of the mean deflection
    rise = energy - backlash.energy(2.0, mean, half_backlash)
    terms = np.stack([d - mean, 0.5 * (d - mean) ** 2], axis=1)
    root = np.sqrt(w)[:, None]
    best = np.linalg.lstsq(root * terms, root[:, 0] * rise, rcond=None)[0]
    assert backlash.mean_force(2.0, mean, deviation, half_backlash) == pytest.approx(
        best[0], abs=1e-8
    )
    assert backlash.energy_stiffness(2.0, mean, deviation, half_backlash) == pytest.approx(
        best[1], abs=1e-8
    )


def test_a_mesh_in_contact_keeps_its_stiffness() -> None:
    """As printed, eq. 4.43 would multiply it by 1 + (m - b)² / (3 s²), here 34."""
    for stiffness in (backlash.energy_stiffness, backlash.mean_stiffness):
        assert stiffness(5.0, 20.0, 1.0, 10.0) == pytest.approx(5.0, rel=1e-12)
        assert stiffness(5.0, 20.0, 0.0, 10.0) == 5.0
        assert stiffness(5.0, 2.0, 0.0, 10.0) == 0.0
    energy = backlash.mean_energy(5.0, 20.0, 1.0, 10.0)
    assert 2.0 / 3.0 * (5.0 + energy) == pytest.approx(5.0 * (1.0 + 100.0 / 3.0), rel=1e-12)


def test_energy_and_force_belong_together() -> None:
    d, h = np.array([-3.0, -1.5, -0.5, 0.0, 0.7, 1.6]), 1e-6
    slope = (backlash.energy(2.0, d + h, 1.0) - backlash.energy(2.0, d - h, 1.0)) / (2.0 * h)
    np.testing.assert_allclose(slope, backlash.force(2.0, d, 1.0), atol=1e-8)


# --- equations of motion


def test_one_rotation_for_two(design: GearPairDesign) -> None:
    """Natural frequencies of y1, y2 and both rotations: those of the pair, and the rigid turning at
    zero."""
    g1, g2, k = design.gear_1, design.gear_2, design.mesh.stiffness
    way = np.array([1.0, -1.0, 1e-3 * g1.radius, -1e-3 * g2.radius])
    stiffness = np.diag([g1.bearing, g2.bearing, 0.0, 0.0]) + k * np.outer(way, way)
    squares = eigh(
        stiffness, np.diag([g1.mass, g2.mass, g1.inertia, g2.inertia]), eigvals_only=True
    )
    assert abs(squares[0]) < 1e-9 * squares[1]
    np.testing.assert_allclose(np.sqrt(squares[1:]), pair_modes(design)[0], rtol=1e-10)
    pair = gear_pair_system(design, 0)
    rest = static_equilibrium(design, 0)
    pull = backlash.force(pair.mesh_stiffness(0.0), DEFLECTION_ROW @ rest, pair.half_backlash)
    np.testing.assert_allclose(
        pair.stiffness @ rest + DEFLECTION_ROW.T @ pull, pair.force, atol=1e-8 * pair.force[2]
    )
    assert pair.mass[2, 2] == combined_mass(design) == pytest.approx(15.4736, rel=1e-5)


def test_mesh_stiffness_is_a_rectangular_wave() -> None:
    wave = MeshStiffness(
        np.array([10.0]), np.array([1.0]), np.array([1.6]), 2.0 * np.pi, 4000, np.array([0.5])
    )
    phase = 0.5 / (2.0 * np.pi)
    for t, value in ((0.0, 11.2 - 0.4), (0.29, 10.8), (0.31, 8.8), (0.69, 8.8), (0.71, 10.8)):
        assert wave.at(t + phase)[0] == pytest.approx(value, abs=5e-3)


# --- covariance


def exact_covariance(design: GearPairDesign, t: float) -> np.ndarray:
    """Of the pair in contact at constant stiffness, after t from rest: the stationary one less what
    is left of it."""
    pair = gear_pair_system(design, 0)
    n, inverse = pair.size, np.linalg.inv(pair.mass)
    stiffness = pair.linear_stiffness(0.0, np.array([design.mesh.stiffness]))
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ pair.damping]])
    b = np.vstack([np.zeros_like(pair.noise), inverse @ pair.noise])
    stationary, turned = solve_continuous_lyapunov(a, -b @ b.T), expm(t * a)
    return (stationary - turned @ stationary @ turned.T)[:n, :n]


def steady(design: GearPairDesign) -> GearPairDesign:
    return design.model_copy(update={"mesh": design.mesh.model_copy(update={"variation": 0.0})})


@pytest.mark.parametrize("method", ["energy", "force"])
def test_covariance_in_contact(design: GearPairDesign, method: str) -> None:
    """Second order in the step, to the exact covariance; both criteria leave the linear system as
    it is."""
    pair, end = steady(design), 1e-3
    expected = exact_covariance(pair, end)
    off = []
    for count in (100, 200, 400):
        found = linearise(
            gear_pair_system(pair, 0),
            static_equilibrium(pair, 0),
            end / count,
            count,
            count,
            method,
        )
        off.append(np.abs(found.covariance[-1, :3, :3] - expected).max() / np.abs(expected).max())
        np.testing.assert_allclose(found.mean[-1], static_equilibrium(pair, 0), rtol=1e-9)
    assert off[-1] < 1e-4
    for coarse, fine in itertools.pairwise(off):
        assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.1)


def test_covariance_stays_positive(moments: dict[tuple[int, str], CoordinateMoments]) -> None:
    """Of coordinates and velocities at all rows, each over its deviation, as computed: symmetric,
    no negative one."""
    for found in moments.values():
        size = np.sqrt(np.einsum("tii->ti", found.covariance[1:]))
        scaled = found.covariance[1:] / size[:, :, None] / size[:, None, :]
        assert scaled.shape == (STEPS // EVERY, 6, 6)
        assert np.abs(scaled - scaled.transpose(0, 2, 1)).max() < 1e-13
        assert np.linalg.eigvalsh(scaled)[:, 0].min() > -1e-14


@pytest.mark.parametrize("method", ["energy", "force"])
def test_linearisation_does_not_depend_on_the_step(design: GearPairDesign, method: str) -> None:
    """With impacts and tooth cycles: second order, by three steps."""
    end, ends = 5e-4, []
    for count in (50, 100, 200):
        found = linearise(
            gear_pair_system(design, 1),
            static_equilibrium(design, 1),
            end / count,
            count,
            count,
            method,
        )
        ends.append(np.concatenate([found.mean[-1], np.sqrt(np.diag(found.covariance[-1]))[:3]]))
    steps = [np.abs(fine / coarse - 1.0).max() for coarse, fine in itertools.pairwise(ends)]
    assert steps[-1] < 4e-3
    assert np.log2(steps[-2] / steps[-1]) == pytest.approx(2.0, abs=0.3)


# --- simulation


def test_simulation_without_noise(design: GearPairDesign) -> None:
    """Against SciPy with impacts on both sides: the error falls by more than three from step to
    step."""
    soft = design.damping.model_copy(update={"stiffness": 2e-6})
    quiet = steady(design).model_copy(
        update={"damping": soft, "load": design.load.model_copy(update={"noise": 0.0})}
    )
    pair, start, end = (
        gear_pair_system(quiet, 2),
        static_equilibrium(quiet, 2) + np.array([0.0, 0.0, 6e-4]),
        1.5e-3,
    )

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        q, v = y[:3], y[3:]
        pull = backlash.force(pair.mesh_stiffness(0.0), DEFLECTION_ROW @ q, pair.half_backlash)
        rest = pair.force - pair.damping @ v - pair.stiffness @ q - DEFLECTION_ROW.T @ pull
        return np.concatenate([v, np.linalg.solve(pair.mass, rest)])

    def crosses(half_backlash: float):
        return lambda _, y: DEFLECTION_ROW[0] @ y[:3] - half_backlash

    half_backlash = float(pair.half_backlash[0])
    events = [crosses(half_backlash), crosses(-half_backlash)]
    grid = np.linspace(0.0, end, 11)
    exact = solve_ivp(
        rates,
        (0.0, end),
        np.concatenate([start, np.zeros(3)]),
        method="LSODA",
        t_eval=grid,
        rtol=1e-10,
        atol=1e-14,
        events=events,
        max_step=1e-6,
    )
    assert all(len(times) > 0 for times in exact.t_events)
    off = []
    for count in (600, 1200, 2400):
        found = simulate(pair, start, end / count, count, count // 10, 3, random_stream(1))
        assert found.squares.max() < 1e-28
        off.append(np.abs(found.mean[:, :3] - exact.y[:3, 1:].T).max())
    assert off[-1] < 5e-7
    assert off[0] / off[1] > 3.0 and off[1] / off[2] > 3.0


def statistics(found: CoordinateMoments) -> tuple[np.ndarray, np.ndarray]:
    """Means and deviations of the coordinates and the mesh's way over the second half of the
    time."""
    ways = np.vstack([np.eye(3), DEFLECTION_ROW])
    later = len(found.time) // 2
    variance = np.einsum("ki,tij,kj->tk", ways, found.covariance[later:, :3, :3], ways)
    return (found.mean[later:] @ ways.T).mean(axis=0), np.sqrt(variance).mean(axis=0)


@pytest.mark.parametrize("method", ["energy", "force"])
def test_linearisation_without_impact(
    moments: dict[tuple[int, str], CoordinateMoments], sums: list[SampleMoments], method: str
) -> None:
    """Mean and deviation within 2 % of Monte Carlo; 8000 samples know a deviation to 0.8 %."""
    mean, deviation = statistics(moments[0, method])
    later = len(sums[0].mean) // 2
    np.testing.assert_allclose(mean, sums[0].mean[later:].mean(axis=0), rtol=0.02)
    np.testing.assert_allclose(deviation, sums[0].deviation[later:].mean(axis=0), rtol=0.02)
    assert (sums[0].final > 20e-6).all()


def test_errors_grow_towards_impacts(
    moments: dict[tuple[int, str], CoordinateMoments], sums: list[SampleMoments]
) -> None:
    """Single-sided, then double-sided impact: the deviation of the mesh's way is missed by more and
    more."""
    assert 0.1 < (sums[1].final < 20e-6).mean() < 0.5 and (sums[1].final > -20e-6).all()
    assert (sums[2].final < 20e-6).mean() > 0.6 and (sums[2].final < -20e-6).any()
    for method in ("energy", "force"):
        off = []
        for case in range(3):
            later = len(sums[case].mean) // 2
            there = sums[case].deviation[later:].mean(axis=0)
            off.append(np.abs(statistics(moments[case, method])[1] / there - 1.0))
        assert off[0][3] < 0.02 < off[1][3] < off[2][3]
        assert off[0][2] < off[1][2] < off[2][2]
        # the bearings hardly notice
        assert max(o[:2].max() for o in off) < 0.05


def test_simulation_does_not_depend_on_the_step(
    design: GearPairDesign, sums: list[SampleMoments]
) -> None:
    """Half the step and other samples, with impacts: means and deviations agree within four
    sampling errors."""
    for case in (1, 2):
        fine, coarse = run(design, case, 4000, STEP / 2.0, seed=8), sums[case]
        noise = np.sqrt(1.0 / fine.count + 1.0 / coarse.count)
        assert (np.abs(fine.mean[-1] - coarse.mean[-1]) < 4.0 * noise * coarse.deviation[-1]).all()
        # squares of distributions with long tails scatter by more than those of normal ones
        assert (np.abs(fine.deviation[-1] / coarse.deviation[-1] - 1.0) < 4.0 * noise).all()


def test_blocks_add_up() -> None:
    random = np.random.default_rng(0)
    values = 5.0 + random.standard_normal((7, 4, 3))

    def of(part: np.ndarray) -> SampleMoments:
        return SampleMoments(
            len(part), part.mean(axis=0), part.var(axis=0) * len(part), part[:, 0, 0]
        )

    both = of(values[:3]).merged_with(of(values[3:]))
    np.testing.assert_allclose(both.mean, values.mean(axis=0))
    np.testing.assert_allclose(both.deviation, values.std(axis=0, ddof=1))
    assert (both.final == values[:, 0, 0]).all()
