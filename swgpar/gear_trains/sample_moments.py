"""Means and deviations of samples that come block by block."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class SampleMoments:
    """Samples of some blocks added up.

    Attributes
    ----------
    count : of the samples
    mean, squares : (rows, values), means, and sums of the squares about them
    last : (count,), one value of every sample at the end
    """

    count: int
    mean: np.ndarray
    squares: np.ndarray
    last: np.ndarray

    def merged_with(self, other: SampleMoments) -> SampleMoments:
        """Both together (Chan, Golub and LeVeque 1979)."""
        count = self.count + other.count
        apart = other.mean - self.mean
        mean = self.mean + apart * (other.count / count)
        squares = self.squares + other.squares + apart**2 * (self.count * other.count / count)
        return SampleMoments(count, mean, squares, np.concatenate([self.last, other.last]))

    @property
    def deviation(self) -> np.ndarray:
        """Standard deviations (rows, values)."""
        return np.sqrt(self.squares / (self.count - 1))
