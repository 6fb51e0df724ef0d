"""Statistical linearisation of the planetary gear train: mean and covariance over time (sections 3.4 and 3.5).

Force-based, as `linearisation.py`, by the steps of `Steps`: a step of the covariance S is that of the linear train on
the columns of S and, transposed, on the columns of what comes out. Mean, covariance and equivalent stiffnesses of a
step are solved together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.errors import ConvergenceError
from swgpar.gear_trains.backlash import mean_force_and_stiffness, mean_stiffness
from swgpar.gear_trains.planetary.steps import Law, States, Steps
from swgpar.gear_trains.planetary.watched import watched
from swgpar.gear_trains.planetary.wind import Wind

TOLERANCE, MAX_ITERATIONS = 1e-6, 50
"""Change of mean forces and equivalent stiffnesses in the last iteration of a step, relative; how many it may take."""


CHECKS = 100
"""Moments of time at which the covariance is examined, at least where there are as many rows."""


@dataclass(frozen=True)
class Moments:
    """mean, deviation : (rows, watched);  force, square : (steps, 2) mean and mean square of the linearised forces of
    the watched meshes, N and N²: rows may be too few for the tooth cycle

    least, skew : the worst `_flaws` of the covariance of all 2 n + 2 unknowns before it is made symmetric, CHECKS times
    """

    mean: np.ndarray
    deviation: np.ndarray
    force: np.ndarray
    square: np.ndarray
    least: float
    skew: float


class _Linear:
    """Steps of the linear train with its wind on columns (q, y, c, c'), (2 n + 2, any)."""

    def __init__(self, steps: Steps, wind: Wind) -> None:
        self.steps, self.wind, self.n = steps, wind, steps.train.size

    def __call__(self, step: int, columns: np.ndarray, before: np.ndarray, after: Law) -> np.ndarray:
        """Columns after a step whose meshes have stiffnesses (m,) at its start, and a law at its end."""
        n, steps, wind = self.n, self.steps, self.wind
        q, y, turbulence = columns[:n], columns[n : 2 * n], columns[2 * n :]
        push = steps.push(step - 1, q, y, before[:, None] * (steps.ways[step - 1] @ q))
        moved = wind.moved @ turbulence
        return self._end(step, States(q.copy(), y.copy(), push), wind.turbulent @ (turbulence + moved), moved, after)

    def noise(self, step: int, after: Law) -> np.ndarray:
        """What the noise of a step adds: (2 n + 2, 2) per standard normal number."""
        rest = States(*np.zeros((3, self.n, 2)))
        return self._end(step, rest, self.wind.turbulent @ self.wind.root, self.wind.root, after)

    def _end(self, step: int, states: States, torques: np.ndarray, turbulence: np.ndarray, after: Law) -> np.ndarray:
        self.steps.linear(step, states, torques, after)
        return np.vstack([states.q, states.y, turbulence])


def linearised(steps: Steps, wind: Wind, every: int) -> Moments:
    """Moments from rest under the steady wind, at every so many steps."""
    train, n, half = steps.train, steps.train.size, steps.train.half
    linear = _Linear(steps, wind)
    states, _ = steps.at_rest(wind.steady)
    mean = steps.ways[0] @ states.q[:, 0]
    spread = np.zeros((2 * n + 2, 2 * n + 2))
    deviation = np.zeros(len(steps.stiffness[0]))
    spring = mean_stiffness(steps.stiffness[0], mean, deviation, half)
    torque, rows, forces, least, skew = np.array([2.0 * wind.steady]), [], [], np.inf, 0.0
    meshes = [0, train.design.planet.count]
    for step in range(1, steps.count + 1):
        k, ways = steps.stiffness[step], steps.ways[step]
        free, before = steps.free_ways(step, states, torque)[:, 0], spring
        for _ in range(MAX_ITERATIONS):
            mean, used_pull, used = _mean_ways(steps, step, free, mean, deviation)
            law = steps.law(step, used)
            half_way = linear(step, spread, before, law)
            added = linear.noise(step, law)
            new = linear(step, np.ascontiguousarray(half_way.T), before, law) + added @ added.T
            deviation = np.sqrt(np.maximum(((ways @ new[:n, :n]) * ways).sum(axis=1), 0.0))
            pull, spring = mean_force_and_stiffness(k, mean, deviation, half)
            change = np.abs(pull - used_pull).max() / (k * half + np.abs(pull)).max()
            if max(np.abs((spring - used) / k).max(), change) < TOLERANCE:
                break
        else:
            raise ConvergenceError(f"the linearisation did not converge at {step * steps.h:g} s")
        steps.linear(step, states, torque, steps.law(step, np.zeros_like(pull), pull))
        if step % (every * max(1, steps.count // every // CHECKS)) == 0:
            lowest, turned = _flaws(new)
            least, skew = min(least, lowest), max(skew, turned)
        spread = 0.5 * (new + new.T)
        if step % every == 0:
            values = watched(train, steps, step)
            variance = np.einsum("pi,ij,pj->p", values, spread[:n, :n], values)
            rows.append((values @ states.q[:, 0], np.sqrt(np.maximum(variance, 0.0))))
        forces.append((pull[meshes], (pull**2 + (spring * deviation) ** 2)[meshes]))
    columns = (np.array(column) for table in (rows, forces) for column in zip(*table, strict=True))
    return Moments(*columns, least, skew)


def _flaws(covariance: np.ndarray) -> tuple[float, float]:
    """Smallest eigenvalue of a covariance over the largest, and its largest difference from its transpose: round-off.

    Displacements q, their y and the wind's c and c', (2 n + 2) in all, each over the largest deviation of its kind.
    """
    n, variances = len(covariance) // 2 - 1, np.diag(covariance)
    kinds = [slice(0, n), slice(n, 2 * n), slice(2 * n, 2 * n + 1), slice(2 * n + 1, 2 * n + 2)]
    size = (
        np.concatenate([np.full(len(part), max(part.max(), 1e-300)) for part in (variances[k] for k in kinds)]) ** 0.5
    )
    scaled = covariance / size / size[:, None]
    eigenvalues = np.linalg.eigvalsh(0.5 * (scaled + scaled.T))
    return float(eigenvalues[0] / eigenvalues[-1]), float(np.abs(scaled - scaled.T).max())


def _mean_ways(
    steps: Steps, step: int, right: np.ndarray, ways: np.ndarray, deviation: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean ways (m,) at the end of a step by Newton's method, with the mean forces and stiffnesses there."""
    k, half, give, damped = steps.stiffness[step], steps.train.half, steps.give[step], steps.damped[step]
    for _ in range(MAX_ITERATIONS):
        pull, slope = mean_force_and_stiffness(k, ways, deviation, half)
        change = np.linalg.solve(damped + give * slope, damped @ ways + give @ pull - right)
        if np.abs(change).max() <= 1e-9 * np.abs(ways).max():
            return ways, pull, slope
        ways = ways - change
    raise ConvergenceError("the mean of the linearised gear train did not converge")
