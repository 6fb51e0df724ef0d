"""Means and deviations over time: of linearised systems, and of samples drawn block by block."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

SCALES = {"m": 1.0, "um": 1e6}
"""Of columns, by their unit."""


@dataclass(frozen=True)
class Moments:
    """mean, deviation : (rows, values) at some moments of time"""

    mean: np.ndarray
    deviation: np.ndarray


@dataclass(frozen=True)
class SampleMoments:
    """Moments of some blocks of samples.

    Attributes
    ----------
    count : number of samples
    mean : (rows, values), sample means
    squares : (rows, values), sums of the squared differences from them
    final : (count,), the last value of every sample at the last row
    """

    count: int
    mean: np.ndarray
    squares: np.ndarray
    final: np.ndarray

    @classmethod
    def of(cls, rows: Iterable[np.ndarray]) -> SampleMoments:
        """Moments of a block. rows : (values, samples) at one moment of time after the other"""
        means, squares = [], []
        for values in rows:
            means.append(values.mean(axis=1))
            squares.append(values.var(axis=1) * values.shape[1])
        return cls(values.shape[1], np.array(means), np.array(squares), values[-1].copy())

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


HasMoments = Moments | SampleMoments


def deviation_error(count: int) -> float:
    """Standard error of a standard deviation of `count` normal samples, in % of it."""
    return float(100.0 / np.sqrt(2.0 * count))


def largest_moments(moments: HasMoments, names: Iterable[str]) -> dict[str, float]:
    """Largest size of the mean and largest deviation over time, of every value by name."""
    columns = {"mean": np.abs(moments.mean), "deviation": moments.deviation}
    return {
        f"{kind}_{name}": float(c[:, k].max())
        for k, name in enumerate(names)
        for kind, c in columns.items()
    }


def percent_errors(
    linearised: HasMoments, simulated: HasMoments, names: Sequence[str]
) -> dict[str, float]:
    """Errors of linearised means and deviations, averaged over the second half of the time, of the
    first values, which have names."""
    errors: dict[str, float] = {}
    settled = slice(len(linearised.mean) // 2, None), slice(len(names))
    for kind in ("mean", "deviation"):
        ours, theirs = (getattr(one, kind)[settled].mean(axis=0) for one in (linearised, simulated))
        percent = (100.0 * (ours / theirs - 1.0)).tolist()
        errors |= {f"error_{kind}_{name}": error for name, error in zip(names, percent)}
    return errors


def columns(
    parts: Sequence[HasMoments], names: Iterable[str], unit: str, method: str = ""
) -> dict[str, np.ndarray]:
    """Columns of means and deviations of every value by name, the parts below each other.

    unit : of the columns, of `SCALES`;  method : in front of their names
    """
    table = {}
    for k, name in enumerate(names):
        for kind in ("mean", "deviation"):
            rows = np.concatenate([getattr(part, kind)[:, k] for part in parts])
            table[f"{method}{kind}_{name}_{unit}"] = SCALES[unit] * rows
    return table
