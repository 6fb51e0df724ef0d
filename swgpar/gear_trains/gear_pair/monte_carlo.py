"""Simulations of the nonlinear gear pair, many at once, by the steps of `MeshedSystem`.

The implicit step needs the mesh force at its end, f1. Coordinates at the end are linear in the state, the noise and
f1, so that d1 = d - a f1 with a > 0, and f1 = k / (1 + a k) (d beyond the gap): no iteration. What remains is one
product of a constant matrix with (state, noise, f0, f1) of all samples per step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.gear_trains.backlash import dead_zone, force
from swgpar.gear_trains.gear_pair.model import WAY
from swgpar.gear_trains.meshed_system import MeshedSystem

BLOCK = 2000


@dataclass(frozen=True)
class Sums:
    """Samples of some blocks added up: count; means and squares about them (rows, 4) of y1, y2, z and d.

    Attributes
    ----------
    last : (count,) d at the end, m
    """

    count: int
    mean: np.ndarray
    squares: np.ndarray
    last: np.ndarray

    def with_more(self, other: Sums) -> Sums:
        """Both together (Chan, Golub and LeVeque 1979)."""
        count = self.count + other.count
        apart = other.mean - self.mean
        mean = self.mean + apart * (other.count / count)
        squares = self.squares + other.squares + apart**2 * (self.count * other.count / count)
        return Sums(count, mean, squares, np.concatenate([self.last, other.last]))

    @property
    def deviation(self) -> np.ndarray:
        """Standard deviations (rows, 4), m (eq. 4.66)."""
        return np.sqrt(self.squares / (self.count - 1))


def simulate(
    system: MeshedSystem, start: np.ndarray, h: float, count: int, every: int, samples: int, random: np.random.Generator
) -> Sums:
    """Move `samples` pairs on from rest at `start` (3,) by `count` steps of h s, noting every so many of them."""
    n, half = system.size, float(system.half_backlash[0])
    left, right = system.newmark(system.stiffness, h)
    push = np.concatenate([-0.5 * h * WAY[0], np.zeros(n)])[:, None]
    steady = np.linalg.solve(left, np.concatenate([h * system.force, np.zeros(n)]))
    # columns of (q, v, N1, N2, f0, f1)
    step = np.linalg.solve(left, np.hstack([right, system.noise_of_step(h), push, push]))
    way = WAY[0] @ step[:n]
    give = -way[-1]

    state = np.zeros((2 * n + 4, samples))
    state[:n] = start[:, None]
    q, noise, f0, f1 = state[: 2 * n], state[2 * n : 2 * n + 2], state[-2], state[-1]
    rows = count // every
    mean, squares = np.empty((rows, n + 1)), np.empty((rows, n + 1))
    f0[:] = force(system.mesh_stiffness(0.0)[0], float(WAY[0] @ start), half)
    for number in range(1, count + 1):
        random.standard_normal(out=noise)
        k = system.mesh_stiffness(number * h)[0]
        free = way[:-1] @ state[:-1] + WAY[0] @ steady[:n]
        f1[:] = k / (1.0 + give * k) * dead_zone(free, half)
        q[:] = step @ state + steady[:, None]
        f0[:] = f1
        if number % every == 0:
            values = np.vstack([q[:n], WAY @ q[:n]])
            mean[number // every - 1] = values.mean(axis=1)
            squares[number // every - 1] = values.var(axis=1) * samples
    return Sums(samples, mean, squares, WAY[0] @ q[:n])
