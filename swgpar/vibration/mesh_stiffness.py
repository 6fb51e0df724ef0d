"""Mesh stiffness over the tooth cycle: the Fourier series of a wave of one and two pairs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class MeshStiffness:
    """k(t) = mean + 2 amplitude sum_j 2 / (j pi) sin(j pi s) cos(j (w t - phase)) (eqs 3.1, 3.56,
    3.57).

    s = contact ratio - 1 is the part of the cycle with two pairs in contact, whose middle is at the
    phase. The source gives the contact ratio itself as the angle of its coefficients; with a minus
    sign there, its wave starts elsewhere.

    mean, amplitude : N/m, the wave is 2 amplitude high;  contact_ratio : 1 to 2;  frequency : rad/s
    harmonics : terms that are kept;  phase : (m,) rad of each mesh
    overlap : (m,) overlap ratio of helical teeth, over which the wave is averaged
    """

    mean: np.ndarray
    amplitude: np.ndarray
    contact_ratio: np.ndarray
    frequency: float
    harmonics: int
    phase: np.ndarray
    overlap: np.ndarray | float = 0.0

    def at(self, t: float) -> np.ndarray:
        """Stiffness of all meshes, (m,) N/m, at a time in s."""
        j = np.arange(1, self.harmonics + 1)[:, None]
        two_pairs = self.contact_ratio - 1.0
        coefficients = 2.0 / (j * np.pi) * np.sin(j * np.pi * two_pairs) * np.sinc(j * self.overlap)
        terms = coefficients * np.cos(j * (self.frequency * t - self.phase))
        return self.mean + 2.0 * self.amplitude * terms.sum(axis=0)
