"""Statistical linearisation of the planetary train: mean and covariance over time (3.4 and 3.5).

Force-based, as in `swgpar/vibration/linearisation.py`, with the steps of `TimeStepper`. A step of
the covariance S is the step of the linear train applied to the columns of S, and then to the
columns of the transposed result. Mean, covariance and equivalent stiffnesses of a step are solved
together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.errors import ConvergenceError
from swgpar.gear_trains.planetary.monitored import monitored
from swgpar.gear_trains.planetary.time_stepping import MeshLaw, ModalStates, TimeStepper
from swgpar.gear_trains.planetary.wind_load import WindLoad
from swgpar.vibration.backlash import mean_force_and_stiffness, mean_stiffness
from swgpar.vibration.moments import Moments

TOLERANCE, MAX_ITERATIONS = 1e-6, 50
"""Relative change of mean forces and equivalent stiffnesses in a step's last iteration; limit."""

MEAN_TOLERANCE = 1e-9
"""Relative change in the last Newton iteration of the mean deflections."""

CHECKS = 100
"""Number of times at which the covariance is checked, or the number of rows if there are fewer."""


@dataclass(frozen=True)
class TrainMoments(Moments):
    """Results of the linearisation: moments of the recorded quantities, m, and

    force, square : (steps, 2) N and N², mean and mean square of the linearised forces of both
        meshes of planet 1, after every step: the rows may not resolve the tooth cycle
    smallest_eigenvalue, asymmetry : worst values of `_covariance_errors` over the checks of the
        covariance of all 2 n + 2 unknowns, before it is made symmetric
    """

    force: np.ndarray
    square: np.ndarray
    smallest_eigenvalue: float
    asymmetry: float


class _LinearTrain:
    """Steps of the linear train with its wind on columns (q, y, c, c') of shape (2 n + 2, any)."""

    def __init__(self, stepper: TimeStepper, wind: WindLoad) -> None:
        self.stepper, self.wind, self.n = stepper, wind, stepper.train.size

    def advance(
        self, step: int, columns: np.ndarray, before: np.ndarray, after: MeshLaw
    ) -> np.ndarray:
        """Columns after a step with mesh stiffnesses `before` (m,) at its start, a law at its
        end."""
        n, stepper, wind = self.n, self.stepper, self.wind
        q, y, turbulence = columns[:n], columns[n : 2 * n], columns[2 * n :]
        forces = before[:, None] * (stepper.deflection_rows[step - 1] @ q)
        states = ModalStates(q.copy(), y.copy(), stepper.mesh_term(step - 1, q, y, forces))
        ahead = wind.transition @ turbulence
        stepper.linear(step, states, wind.turbulent @ (turbulence + ahead), after)
        return np.vstack([states.q, states.y, ahead])

    def noise(self, step: int, after: MeshLaw) -> np.ndarray:
        """Contribution of the noise of a step, (2 n + 2, 2), per standard normal number."""
        states, root = ModalStates(*np.zeros((3, self.n, 2))), self.wind.noise_root
        self.stepper.linear(step, states, self.wind.turbulent @ root, after)
        return np.vstack([states.q, states.y, root])


class _Linearisation:
    """Mean and covariance of the train, advanced step by step from rest under the steady wind.

    Attributes
    ----------
    states : modal displacements of the mean, one column;  flanks : (m,) that carry the steady wind
    covariance : (2 n + 2, 2 n + 2)
    unsymmetrised : the covariance of the last step before it is made symmetric
    mean, deviation : (m,) m, of the mesh deflections
    forces, equivalent : (m,) N and N/m, mean forces and stiffnesses
    """

    def __init__(self, stepper: TimeStepper, wind: WindLoad) -> None:
        train, n = stepper.train, stepper.train.size
        self.stepper, self.linear = stepper, _LinearTrain(stepper, wind)
        self.states, self.flanks = stepper.static_equilibrium(wind.steady)
        self.torque = np.array([2.0 * wind.steady])
        self.covariance = np.zeros((2 * n + 2, 2 * n + 2))
        self.unsymmetrised = self.covariance
        self.mean = stepper.deflection_rows[0] @ self.states.q[:, 0]
        self.deviation = np.zeros(len(stepper.stiffness[0]))
        self.forces = np.zeros_like(self.deviation)
        self.equivalent = mean_stiffness(
            stepper.stiffness[0], self.mean, self.deviation, train.half_backlash
        )

    def advance(self, step: int) -> None:
        """Go on to the end of step number `step`."""
        stepper, n = self.stepper, self.stepper.train.size
        k, rows = stepper.stiffness[step], stepper.deflection_rows[step]
        half_backlash, before = stepper.train.half_backlash, self.equivalent
        free = stepper.free_deflections(step, self.states, self.torque)[:, 0]
        for _ in range(MAX_ITERATIONS):
            self.mean, used_forces, used_k = _mean_deflections(
                stepper, step, free, self.mean, self.deviation
            )
            law = stepper.law(step, used_k)
            half_step = self.linear.advance(step, self.covariance, before, law)
            turned, added = np.ascontiguousarray(half_step.T), self.linear.noise(step, law)
            new = self.linear.advance(step, turned, before, law) + added @ added.T
            self.deviation = np.sqrt(np.maximum(((rows @ new[:n, :n]) * rows).sum(axis=1), 0.0))
            self.forces, self.equivalent = mean_force_and_stiffness(
                k, self.mean, self.deviation, half_backlash
            )
            change = np.abs(self.forces - used_forces).max()
            change /= (k * half_backlash + np.abs(self.forces)).max()
            if max(np.abs((self.equivalent - used_k) / k).max(), change) < TOLERANCE:
                break
        else:
            raise ConvergenceError(f"the linearisation did not converge at {step * stepper.h:g} s")
        steady = stepper.law(step, np.zeros_like(self.forces), self.forces)
        stepper.linear(step, self.states, self.torque, steady)
        self.unsymmetrised, self.covariance = new, 0.5 * (new + new.T)

    def monitored(self, step: int) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard deviation (recorded,) of the recorded quantities after a step, m."""
        train = self.stepper.train
        rows, added = monitored(train, self.stepper, step, self.flanks)
        n = train.size
        variance = ((rows @ self.covariance[:n, :n]) * rows).sum(axis=1)
        return rows @ self.states.q[:, 0] + added, np.sqrt(np.maximum(variance, 0.0))

    def mesh_forces(self) -> tuple[np.ndarray, np.ndarray]:
        """Mean (2,) N and mean square (2,) N² of the linearised forces of planet 1's meshes."""
        meshes = [0, self.stepper.train.design.planet.count]
        squares = self.forces**2 + (self.equivalent * self.deviation) ** 2
        return self.forces[meshes], squares[meshes]


def linearise_train(stepper: TimeStepper, wind: WindLoad, every: int) -> TrainMoments:
    """Moments from rest under the steady wind, after every `every` steps."""
    state, rows, forces, errors = _Linearisation(stepper, wind), [], [], []
    for step in range(1, stepper.count + 1):
        state.advance(step)
        if step % (every * max(1, stepper.count // every // CHECKS)) == 0:
            errors.append(_covariance_errors(state.unsymmetrised))
        if step % every == 0:
            rows.append(state.monitored(step))
        forces.append(state.mesh_forces())
    mean, deviation = (np.array(column) for column in zip(*rows, strict=True))
    force, square = (np.array(column) for column in zip(*forces, strict=True))
    eigenvalues, asymmetries = zip(*errors, strict=True)
    return TrainMoments(mean, deviation, force, square, min(eigenvalues), max(asymmetries))


def _covariance_errors(covariance: np.ndarray) -> tuple[float, float]:
    """Smallest eigenvalue of a covariance over the largest, and its difference from its transpose.

    Both show round-off. The covariance is that of displacements q, their y, and the wind's c and
    c', (2 n + 2) in all; each is divided by the largest standard deviation of its kind.
    """
    n, variances = len(covariance) // 2 - 1, np.diag(covariance)
    largest = [max(part.max(), 1e-300) for part in np.split(variances, [n, 2 * n, 2 * n + 1])]
    size = np.sqrt(np.repeat(largest, [n, n, 1, 1]))
    scaled = covariance / size / size[:, None]
    eigenvalues = np.linalg.eigvalsh(0.5 * (scaled + scaled.T))
    return float(eigenvalues[0] / eigenvalues[-1]), float(np.abs(scaled - scaled.T).max())


def _mean_deflections(
    stepper: TimeStepper,
    step: int,
    right: np.ndarray,
    deflections: np.ndarray,
    deviation: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean mesh deflections (m,) after a step by Newton's method, with mean forces and
    stiffnesses."""
    k, half_backlash = stepper.stiffness[step], stepper.train.half_backlash
    compliance, damped = stepper.compliance[step], stepper.damped[step]
    for _ in range(MAX_ITERATIONS):
        forces, slope = mean_force_and_stiffness(k, deflections, deviation, half_backlash)
        residual = damped @ deflections + compliance @ forces - right
        change = np.linalg.solve(damped + compliance * slope, residual)
        if np.abs(change).max() <= MEAN_TOLERANCE * np.abs(deflections).max():
            return deflections, forces, slope
        deflections = deflections - change
    raise ConvergenceError("the mean of the linearised gear train did not converge")
