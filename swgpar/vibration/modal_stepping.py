"""Exact time steps of separate modes under forces that are linear in a step, and white noise."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.linalg import expm


class ModalStepper:
    """Separate unit masses with stiffness k and damping c (modes,), advanced by steps of h seconds.

    The force is linear in a step; white noise has unit intensity, one and the same for all modes.
    """

    def __init__(self, k: np.ndarray, c: np.ndarray, h: float) -> None:
        self.k, self.h, n = k, h, len(k)
        rates = np.zeros((n, 2, 2))
        rates[:, 0, 1], rates[:, 1, 0], rates[:, 1, 1] = 1.0, -k, -c
        # of the state (q, v), the force at the start and its growth
        big = np.zeros((n, 4, 4))
        big[:, :2, :2] = rates
        big[:, 1, 2] = 1.0
        big[:, 2, 3] = 1.0 / h
        transition = expm(h * big)
        self.of_state = transition[:, :2, :2].transpose(1, 2, 0)  # (2, 2, modes)
        self.of_start = (transition[:, :2, 2] - transition[:, :2, 3]).T
        self.of_end = transition[:, :2, 3].T
        self.rates = rates

    @cached_property
    def noise(self) -> np.ndarray:
        """Covariance (2, 2, modes, modes) by the noise of a step: A X + X A^T = E Q E^T - Q."""
        rates = self.rates
        n, eye = len(rates), np.eye(2)
        left = (
            np.einsum("iab,cd->iacbd", rates, eye)[:, None]
            + np.einsum("ab,jcd->jacbd", eye, rates)[None]
        )
        e = self.of_state[:, 1]  # (2, modes): what becomes of a unit of velocity
        right = np.einsum("ai,bj->ijab", e, e)
        right[:, :, 1, 1] -= 1.0
        solved = np.linalg.solve(left.reshape(n, n, 4, 4), right.reshape(n, n, 4, 1))
        return solved.reshape(n, n, 2, 2).transpose(2, 3, 0, 1)

    def step(
        self, q: np.ndarray, v: np.ndarray, start: np.ndarray, end: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """State (..., modes) after a step in which the forces (modes,) go from `start` to `end`."""
        (qq, qv), (vq, vv) = self.of_state
        p = self.of_start * start + self.of_end * end
        return qq * q + qv * v + p[0], vq * q + vv * v + p[1]

    def spread(self, old: np.ndarray, noises: np.ndarray) -> np.ndarray:
        """Covariance (2, 2, modes, modes) of states after a step with noises (modes, loads)."""
        e, common = self.of_state, noises @ noises.T
        new = np.empty_like(old)
        for a in (0, 1):
            rows = [e[a, 0][:, None] * old[0, c] + e[a, 1][:, None] * old[1, c] for c in (0, 1)]
            for c in (0, 1):
                new[a, c] = rows[0] * e[c, 0] + rows[1] * e[c, 1] + common * self.noise[a, c]
        return new

    def noise_root(self) -> np.ndarray:
        """(2 modes, r): displacements and velocities by unit noise per standard normal number."""
        n = len(self.k)
        values, vectors = np.linalg.eigh(self.noise.transpose(0, 2, 1, 3).reshape(2 * n, 2 * n))
        kept = values > 1e-12 * values[-1]
        return vectors[:, kept] * np.sqrt(values[kept])
