"""Hard contact by augmented multipliers: the pressure is p = max(0, lambda - epsilon g).

epsilon is a stiffness per area near E / h; lambda, one number per quadrature point, starts at zero
in every increment and is set to p until the remaining penetration is below a tolerance, so that
neither shows in the results. Friction acts at the same points (see friction.py).
"""

from __future__ import annotations

import numpy as np


class PressedPoints:
    """Gaps, pressures and multipliers of quadrature points that stay the same in all evaluations.

    Parameters
    ----------
    shape : (n_face, n_q);  penalty : MPa / mm, the full one

    Attributes
    ----------
    multiplier, gap, pressure : (n_face, n_q) MPa, mm, MPa
    """

    def __init__(self, shape: tuple[int, ...], penalty: float) -> None:
        self.full_penalty = self.penalty = penalty
        self.multiplier = np.zeros(shape)
        self.gap = np.full(shape, np.inf)
        self.pressure = np.zeros(shape)

    def reset(self) -> None:
        """Forget multipliers, gaps and pressures."""
        self.multiplier = np.zeros_like(self.multiplier)
        self.gap = np.full_like(self.gap, np.inf)
        self.pressure = np.zeros_like(self.pressure)

    def scale_penalty(self, share: float) -> None:
        """Use this share of the full penalty."""
        self.penalty = share * self.full_penalty

    def augment(self) -> None:
        """Take the pressures of the last evaluation as multipliers."""
        self.multiplier = self.pressure.copy()

    def set_gap(self, gap: np.ndarray, reachable: np.ndarray) -> None:
        """Set gaps (mm; negative is penetration) and their pressures; points out of reach (bool) do
        not touch."""
        self.gap = np.where(reachable, gap, np.inf)
        trial = np.maximum(0.0, self.multiplier - self.penalty * np.where(reachable, gap, 0.0))
        self.pressure = np.where(reachable, trial, 0.0)

    def penetration(self) -> float:
        """Largest penetration (mm) of the last evaluation on this rank."""
        return penetration(self.gap, self.pressure)

    def active_sets(self) -> list[np.ndarray]:
        """Quadrature points with pressure of the last evaluation on this rank."""
        return [self.pressure > 0.0]

    def touching_faces(self) -> np.ndarray:
        """Faces (n,) with pressure in the last evaluation on this rank."""
        return np.flatnonzero((self.pressure > 0.0).any(axis=1))


def penetration(gap: np.ndarray, pressure: np.ndarray) -> float:
    """Largest penetration (mm) where there is pressure."""
    touching = pressure > 0.0
    return float(max(0.0, -gap[touching].min())) if touching.any() else 0.0
