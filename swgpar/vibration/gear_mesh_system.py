"""Masses, springs and dampers with gear meshes under a steady load and white noise, in time.

    M q'' + C q' + K q + sum_j w_j f_j(w_j . q) = F + B W(t)

f_j is the force of mesh j (backlash.py), w_j its deflection per coordinate, W a vector of
independent white noises of unit intensity. Time steps are those of the stochastic Newmark scheme
(eq. 4.52; P. Bernard, G. Fleury, Stochastic Newmark scheme, Probabilistic Engineering Mechanics 17
(2002) 45-61), the trapezoidal rule with the exact covariance of the noise's integrals over a step
h:

    M (v1 - v0) + C (q1 - q0) + h/2 (p0 + p1) = h F + sqrt(h) B N1,    p = K q + sum_j w_j f_j,
    M (q1 - q0) - h/2 M (v0 + v1) = h sqrt(h/12) B N2,

with standard normal N1 and N2. They are of second order and stable for any step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class GearMeshSystem:
    """A system of n coordinates, m meshes and r noises.

    Attributes
    ----------
    mass, damping, stiffness : (n, n) symmetric; the stiffness without that of the meshes
    deflection_rows : function of the time, (m, n)
    mesh_stiffness : function of the time, (m,) N/m
    half_backlash : (m,) m
    force : (n,) N
    noise : (n, r)
    """

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    deflection_rows: Callable[[float], np.ndarray]
    mesh_stiffness: Callable[[float], np.ndarray]
    half_backlash: np.ndarray
    force: np.ndarray
    noise: np.ndarray

    @property
    def size(self) -> int:
        """n"""
        return len(self.mass)

    def linear_stiffness(self, t: float, equivalent: np.ndarray) -> np.ndarray:
        """K with meshes of given stiffness (m,), (n, n)."""
        deflection_rows = self.deflection_rows(t)
        return self.stiffness + deflection_rows.T @ (equivalent[:, None] * deflection_rows)

    def newmark(self, stiffness: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray]:
        """Left and right matrix (2 n, 2 n) of the scheme with p = K q.

        stiffness : K (n, n), for the left matrix at the end of a step, for the right at its start
        """
        m, c, k = self.mass, self.damping, 0.5 * h * stiffness
        return np.block([[c + k, m], [m, -0.5 * h * m]]), np.block([[c - k, m], [m, 0.5 * h * m]])

    def noise_of_step(self, h: float) -> np.ndarray:
        """What multiplies (N1, N2) on the right side, (2 n, 2 r)."""
        zero = np.zeros_like(self.noise)
        return np.sqrt(h) * np.block([[self.noise, zero], [zero, h / np.sqrt(12.0) * self.noise]])
