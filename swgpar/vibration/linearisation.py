"""Statistical linearisation: mean and covariance over time of a gear-mesh system.

Each mesh is replaced by the linear law f_0 + k_e (d - E[d]) with f_0 = E[f] and an equivalent
stiffness k_e. Both follow from mean and standard deviation of the mesh deflection d at the same
time. The mean q of the coordinates obeys

    M q'' + C q' + K q + sum_j w_j f_0j = F

and the covariance is that of the linear system with the stiffnesses k_ej. Both are integrated by
the Newmark scheme of `GearMeshSystem`, so that the covariance stays symmetric and positive
semi-definite. Mean and covariance of a step are solved together, to convergence. In print (eq.
4.51) k_e acts on the mean as well, beside f_0: then the mesh counts twice.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from swgpar.errors import ConvergenceError
from swgpar.vibration.backlash import (
    energy_stiffness,
    mean_force,
    mean_force_and_stiffness,
    mean_stiffness,
)
from swgpar.vibration.gear_mesh_system import GearMeshSystem
from swgpar.vibration.moments import Moments

Criterion = Literal["energy", "force"]
EQUIVALENT: dict[Criterion, Callable[..., np.ndarray]] = {
    "energy": energy_stiffness,
    "force": mean_stiffness,
}
"""Equivalent stiffness of a mesh by criterion."""

TOLERANCE, MAX_ITERATIONS = 1e-10, 60
"""Relative change of mean forces and equivalent stiffnesses in a step's last iteration; limit."""

MEAN_TOLERANCE = 1e-8
"""Relative change in the last Newton iteration of the mean; convergence is quadratic."""


@dataclass(frozen=True)
class CoordinateMoments:
    """time : (rows,) s;  mean : (rows, n) of the coordinates, m

    covariance : (rows, 2 n, 2 n) of coordinates and velocities; symmetric up to round-off
    """

    time: np.ndarray
    mean: np.ndarray
    covariance: np.ndarray

    def of(self, rows: np.ndarray) -> Moments:
        """Moments, without the start, of values with so much per coordinate, `rows` (values, n)."""
        n = self.mean.shape[1]
        variances = np.einsum("ki,tij,kj->tk", rows, self.covariance[1:, :n, :n], rows)
        return Moments(self.mean[1:] @ rows.T, np.sqrt(np.maximum(variances, 0.0)))


@dataclass
class _MeshState:
    """Meshes at the end of a step.

    stiffness : (m,) N/m;  rows : (m, n), deflections per coordinate;  deviation : (m,) m, of them
    forces : (m,) N, expected forces;  equivalent : (m,) N/m, equivalent stiffnesses
    """

    stiffness: np.ndarray
    rows: np.ndarray
    deviation: np.ndarray
    forces: np.ndarray
    equivalent: np.ndarray


def linearise(
    system: GearMeshSystem,
    start: np.ndarray,
    h: float,
    count: int,
    every: int,
    criterion: Criterion,
) -> CoordinateMoments:
    """Moments of a system from rest at `start` (n,) after each `every` of `count` steps of h s."""
    n, half_backlash, equivalent = system.size, system.half_backlash, EQUIVALENT[criterion]
    q, v, covariance = start.astype(float), np.zeros(n), np.zeros((2 * n, 2 * n))
    saved = [(0.0, q, covariance)]
    stiffness, rows = system.mesh_stiffness(0.0), system.deflection_rows(0.0)
    deviation = np.zeros(len(half_backlash))
    law = stiffness, rows @ q, deviation, half_backlash
    meshes = _MeshState(stiffness, rows, deviation, mean_force(*law), equivalent(*law))
    for step in range(1, count + 1):
        t = step * h
        q, v, new = _step(system, t, h, (q, v, covariance), meshes, criterion)
        covariance = 0.5 * (new + new.T)
        if step % every == 0:
            saved.append((t, q, new))
    time, mean, covariances = (np.array(column) for column in zip(*saved, strict=True))
    return CoordinateMoments(time, mean, covariances)


def _step(
    system: GearMeshSystem,
    t: float,
    h: float,
    moments: tuple[np.ndarray, np.ndarray, np.ndarray],
    meshes: _MeshState,
    criterion: Criterion,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean coordinates (n,), velocities (n,) and covariance (2 n, 2 n) at t, h s after `moments`.

    Updates `meshes`, which belong to the start of the step, to its end.
    """
    n, half_backlash, equivalent = system.size, system.half_backlash, EQUIVALENT[criterion]
    q, v, covariance = moments
    _, right = system.newmark(system.linear_stiffness(t - h, meshes.equivalent), h)
    known = (
        system.mass @ (2.0 / h * q + 2.0 * v)
        + system.damping @ q
        + 0.5 * h * (2.0 * system.force - system.stiffness @ q - meshes.rows.T @ meshes.forces)
    )
    meshes.stiffness, meshes.rows = system.mesh_stiffness(t), system.deflection_rows(t)
    left_of_mean = 2.0 / h * system.mass + system.damping + 0.5 * h * system.stiffness
    noise, new_q = system.noise_of_step(h), q + h * v
    for _ in range(MAX_ITERATIONS):
        old_forces, old_equivalent = meshes.forces, meshes.equivalent
        new_q = _mean(left_of_mean, known, 0.5 * h, new_q, meshes, half_backlash)
        left, _ = system.newmark(system.linear_stiffness(t, meshes.equivalent), h)
        transfer = np.linalg.solve(left, np.hstack([right, noise]))
        of_state, of_noise = transfer[:, : 2 * n], transfer[:, 2 * n :]
        new = of_state @ covariance @ of_state.T + of_noise @ of_noise.T
        variances = np.einsum("mi,ij,mj->m", meshes.rows, new[:n, :n], meshes.rows)
        meshes.deviation = np.sqrt(np.maximum(variances, 0.0))
        law = meshes.stiffness, meshes.rows @ new_q, meshes.deviation, half_backlash
        meshes.forces, meshes.equivalent = mean_force(*law), equivalent(*law)
        change = np.abs(meshes.forces - old_forces).max()
        change /= (np.abs(meshes.stiffness) * half_backlash + np.abs(meshes.forces)).max()
        softened = np.abs((meshes.equivalent - old_equivalent) / meshes.stiffness).max()
        if max(change, softened) < TOLERANCE:
            return new_q, 2.0 / h * (new_q - q) - v, new
    raise ConvergenceError(f"the linearisation did not converge at {t:g} s")


def _mean(
    left: np.ndarray,
    known: np.ndarray,
    weight: float,
    q: np.ndarray,
    meshes: _MeshState,
    half_backlash: np.ndarray,
) -> np.ndarray:
    """Solve left q + weight sum_j w_j E[f_j](w_j . q) = known by Newton's method."""
    rows = meshes.rows
    for _ in range(MAX_ITERATIONS):
        forces, slope = mean_force_and_stiffness(
            meshes.stiffness, rows @ q, meshes.deviation, half_backlash
        )
        residual = left @ q + weight * rows.T @ forces - known
        change = np.linalg.solve(left + weight * rows.T @ (slope[:, None] * rows), residual)
        q = q - change
        if np.abs(change).max() <= MEAN_TOLERANCE * np.abs(q).max():
            return q
    raise ConvergenceError("the mean of the linearised system did not converge")
