"""Statistical linearisation: mean and covariance of a meshed system in time, for normally distributed coordinates.

Each mesh is replaced by f_0 + k_e (d - E[d]), with f_0 = E[f] and an equivalent stiffness k_e that follows from mean
and deviation of its way at the same moment. The mean then obeys

    M q'' + C q' + K q + sum_j w_j f_0j = F

and the covariance is that of the linear system with the k_ej. Both go by the Newmark scheme of `MeshedSystem`, so that
the covariance stays symmetric and positive semi-definite. In print (eq. 4.51) k_e acts on the mean as well, beside f_0:
then the mesh counts twice. Mean and covariance of a step are solved together, to convergence.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from swgpar.errors import ConvergenceError
from swgpar.gear_trains.backlash import energy_stiffness, mean_force, mean_force_and_stiffness, mean_stiffness
from swgpar.gear_trains.meshed_system import MeshedSystem

Criterion = Literal["energy", "force"]
EQUIVALENT: dict[Criterion, Callable[..., np.ndarray]] = {"energy": energy_stiffness, "force": mean_stiffness}

TOLERANCE, MAX_ITERATIONS = 1e-10, 60
"""Change of mean forces and equivalent stiffnesses in the last iteration of a step, relative; how many it may take."""


@dataclass(frozen=True)
class Moments:
    """time : (rows,) s;  mean : (rows, n) of the coordinates, m

    covariance : (rows, 2 n, 2 n) of coordinates and velocities, m and m/s, symmetric but for round-off
    """

    time: np.ndarray
    mean: np.ndarray
    covariance: np.ndarray


def linearised(
    system: MeshedSystem, start: np.ndarray, h: float, count: int, every: int, criterion: Criterion
) -> Moments:
    """Moments of a system that starts at rest at `start` (n,), at every so many of `count` steps of h seconds."""
    n, half, equivalent = system.size, system.half_backlash, EQUIVALENT[criterion]
    q, v, covariance = start.astype(float), np.zeros(n), np.zeros((2 * n, 2 * n))
    noise = system.noise_of_step(h)
    rows = [(0.0, q, covariance)]
    stiffness, ways = system.mesh_stiffness(0.0), system.ways(0.0)
    deviation = np.zeros(len(half))
    pull = mean_force(stiffness, ways @ q, deviation, half)
    spring = equivalent(stiffness, ways @ q, deviation, half)
    for step in range(1, count + 1):
        t = step * h
        _, right = system.newmark(system.linear_stiffness(t - h, spring), h)
        known = (
            system.mass @ (2.0 / h * q + 2.0 * v)
            + system.damping @ q
            + 0.5 * h * (2.0 * system.force - system.stiffness @ q - ways.T @ pull)
        )
        stiffness, ways = system.mesh_stiffness(t), system.ways(t)
        left_of_mean = 2.0 / h * system.mass + system.damping + 0.5 * h * system.stiffness
        before, moved = q, q + h * v
        for _ in range(MAX_ITERATIONS):
            old_pull, old_spring = pull, spring
            moved = _mean(left_of_mean, known, 0.5 * h, moved, ways, stiffness, deviation, half)
            left, _ = system.newmark(system.linear_stiffness(t, spring), h)
            transfer = np.linalg.solve(left, np.hstack([right, noise]))
            old, shaken = transfer[:, : 2 * n], transfer[:, 2 * n :]
            new = old @ covariance @ old.T + shaken @ shaken.T
            deviation = np.sqrt(np.maximum(np.einsum("mi,ij,mj->m", ways, new[:n, :n], ways), 0.0))
            pull = mean_force(stiffness, ways @ moved, deviation, half)
            spring = equivalent(stiffness, ways @ moved, deviation, half)
            change = np.abs(pull - old_pull).max() / (np.abs(stiffness) * half + np.abs(pull)).max()
            change = max(change, np.abs((spring - old_spring) / stiffness).max())
            if change < TOLERANCE:
                break
        else:
            raise ConvergenceError(f"the linearisation did not converge at {t:g} s")
        q, v = moved, 2.0 / h * (moved - before) - v
        covariance = 0.5 * (new + new.T)
        if step % every == 0:
            rows.append((t, q, new))
    time, mean, covariances = (np.array(column) for column in zip(*rows, strict=True))
    return Moments(time, mean, covariances)


def _mean(
    left: np.ndarray,
    known: np.ndarray,
    weight: float,
    q: np.ndarray,
    ways: np.ndarray,
    stiffness: np.ndarray,
    deviation: np.ndarray,
    half: np.ndarray,
) -> np.ndarray:
    """Solve left q + weight sum_j w_j E[f_j](w_j . q) = known by Newton's method; E[df/dd] is the derivative."""
    for _ in range(MAX_ITERATIONS):
        pull, slope = mean_force_and_stiffness(stiffness, ways @ q, deviation, half)
        residual = left @ q + weight * ways.T @ pull - known
        change = np.linalg.solve(left + weight * ways.T @ (slope[:, None] * ways), residual)
        q = q - change
        # quadratic convergence: the next change would be round-off
        if np.abs(change).max() <= 1e-8 * np.abs(q).max():
            return q
    raise ConvergenceError("the mean of the linearised system did not converge")
