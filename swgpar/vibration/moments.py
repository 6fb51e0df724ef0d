"""Means and standard deviations over time: of linearised systems, and of samples that are drawn
block by block."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np


class HasMoments(Protocol):
    """mean, deviation : (rows, values) at some moments of time"""

    @property
    def mean(self) -> np.ndarray: ...

    @property
    def deviation(self) -> np.ndarray: ...


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
    mean : (rows, values), sample means;  squares : (rows, values), sums of the squared differences
    from them
    final : (count,), the last value of every sample at the last row
    """

    count: int
    mean: np.ndarray
    squares: np.ndarray
    final: np.ndarray

    @classmethod
    def of(cls, rows: Iterable[np.ndarray]) -> SampleMoments:
        """Moments of the samples of a block. rows : (values, samples) at one moment of time after
        the other"""
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


def largest(moments: HasMoments, names: Iterable[str]) -> dict[str, float]:
    """Largest size of the mean and largest deviation over time, of every value by name."""
    columns = {"mean": np.abs(moments.mean), "deviation": moments.deviation}
    return {
        f"{kind}_{name}": float(c[:, k].max())
        for k, name in enumerate(names)
        for kind, c in columns.items()
    }


def percent_errors(linearised: HasMoments, simulated: HasMoments) -> dict[str, list[float]]:
    """Errors of linearised means and deviations against simulated ones, averaged over the second
    half of the time."""

    def error(of_one: np.ndarray, of_other: np.ndarray) -> list[float]:
        settled = slice(len(of_one) // 2, None)
        return (
            100.0 * (of_one[settled].mean(axis=0) / of_other[settled].mean(axis=0) - 1.0)
        ).tolist()

    return {
        "mean": error(linearised.mean, simulated.mean),
        "deviation": error(linearised.deviation, simulated.deviation),
    }


def columns(
    parts: Sequence[HasMoments],
    names: Iterable[str],
    unit: str,
    scale: float = 1.0,
    method: str = "",
) -> dict[str, np.ndarray]:
    """Columns of a table: means and deviations of every value by name, the parts in blocks below
    each other.

    unit, scale : of the columns;  method : in front of their names
    """
    out = {}
    for k, name in enumerate(names):
        out[f"{method}mean_{name}_{unit}"] = scale * np.concatenate(
            [part.mean[:, k] for part in parts]
        )
        out[f"{method}deviation_{name}_{unit}"] = scale * np.concatenate(
            [part.deviation[:, k] for part in parts]
        )
    return out
