"""Means and standard deviations of samples that are drawn block by block."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class SampleMoments:
    """Moments of some blocks of samples.

    Attributes
    ----------
    count : number of samples
    mean : (rows, values), sample means;  squares : (rows, values), sums of the squared differences from them
    final : (count,), one value of every sample at the last row
    """

    count: int
    mean: np.ndarray
    squares: np.ndarray
    final: np.ndarray

    def merged_with(self, other: SampleMoments) -> SampleMoments:
        """Moments of both sets of samples (Chan, Golub and LeVeque 1979)."""
        count = self.count + other.count
        difference = other.mean - self.mean
        mean = self.mean + difference * (other.count / count)
        squares = self.squares + other.squares + difference**2 * (self.count * other.count / count)
        return SampleMoments(count, mean, squares, np.concatenate([self.final, other.final]))

    @property
    def deviation(self) -> np.ndarray:
        """Standard deviations (rows, values)."""
        return np.sqrt(self.squares / (self.count - 1))
