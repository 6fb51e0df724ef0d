"""Simulations of the nonlinear gear pair, many at once, by the steps of `GearMeshSystem`.

The implicit step needs the mesh force at its end, f1. Coordinates at the end are linear in the
state, the noise and f1, so that d1 = d - a f1 with a > 0, and f1 = k / (1 + a k) (d beyond the
gap): no iteration. What remains is one product of a constant matrix with (state, noise, f0, f1) of
all samples per step.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from swgpar.gear_trains.gear_pair.model import DEFLECTION_ROW
from swgpar.vibration.backlash import dead_zone, force
from swgpar.vibration.gear_mesh_system import GearMeshSystem
from swgpar.vibration.moments import SampleMoments

BLOCK_SIZE = 2000


def simulate(
    system: GearMeshSystem,
    start: np.ndarray,
    h: float,
    count: int,
    every: int,
    samples: int,
    random: np.random.Generator,
) -> SampleMoments:
    """Moments of `samples` pairs from rest at `start` (3,) after each `every` of `count` steps."""
    n, half_backlash = system.size, float(system.half_backlash[0])
    left, right = system.newmark(system.stiffness, h)
    force_column = np.concatenate([-0.5 * h * DEFLECTION_ROW[0], np.zeros(n)])[:, None]
    steady = np.linalg.solve(left, np.concatenate([h * system.force, np.zeros(n)]))
    # columns of (q, v, N1, N2, f0, f1)
    step = np.linalg.solve(
        left, np.hstack([right, system.noise_of_step(h), force_column, force_column])
    )
    deflection_of = DEFLECTION_ROW[0] @ step[:n]
    compliance = -deflection_of[-1]

    state = np.zeros((2 * n + 4, samples))
    state[:n] = start[:, None]
    q, noise, (f0, f1) = state[: 2 * n], state[2 * n : 2 * n + 2], state[-2:]
    f0[:] = force(system.mesh_stiffness(0.0)[0], float(DEFLECTION_ROW[0] @ start), half_backlash)

    def rows() -> Iterator[np.ndarray]:
        for number in range(1, count + 1):
            random.standard_normal(out=noise)
            k = system.mesh_stiffness(number * h)[0]
            free_deflection = deflection_of[:-1] @ state[:-1] + DEFLECTION_ROW[0] @ steady[:n]
            f1[:] = k / (1.0 + compliance * k) * dead_zone(free_deflection, half_backlash)
            q[:] = step @ state + steady[:, None]
            f0[:] = f1
            if number % every == 0:
                yield np.vstack([q[:n], DEFLECTION_ROW @ q[:n]])

    return SampleMoments.of(rows())
