"""Stiffness of all sizes of a ratio from one curve of torque over rotation.

Drives whose lengths are all in proportion are similar: under torques in proportion to the third
power of the size they have the same angles, stresses and contacts.
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

PUBLISHED = tomllib.loads(Path("scripts/bench/catalogue_published.toml").read_text("utf-8"))
"""Published figures, by size."""

SIZES: list[int] = PUBLISHED["break_points"]["size"]
FITTED_SIZE, FITTED_RATIO = 17, 50
NAMES = ("K1", "K2", "K3")

TOP = 2.0
"""Torque at which the chord K3 ends, over T2: catalogues do not say where it ends."""

LOST_MOTION = 0.04
"""Share of T2 at which the lost motion is taken. Catalogues take it of the rated torque."""

ROUNDED = 1e-3
"""By which the last torque of a run may be below the one asked for."""

ARC_MINUTE = np.pi / 10800.0


def break_points(size: int) -> tuple[float, float]:
    """Published T1 and T2 of a size, N·m."""
    k, table = SIZES.index(size), PUBLISHED["break_points"]
    return table["T1"][k], table["T2"][k]


def largest_torque() -> float:
    """Torque (N·m) of size 17 up to which a curve serves all sizes."""
    return max(TOP * break_points(size)[1] * (FITTED_SIZE / size) ** 3 for size in SIZES)


def published(group: str, ratio: int, name: str, size: int) -> float:
    """A published figure; nan where none is."""
    values = PUBLISHED[group].get(f"ratio_{ratio}", {}).get(name)
    return float(values[SIZES.index(size)]) if values else np.nan


@dataclass(frozen=True)
class Curve:
    """Rotation of the output over its torque, of the drive of size 17.

    torque : (n,) N·m, ascending from nearly none;  rotation : (n,) rad
    """

    torque: np.ndarray
    rotation: np.ndarray

    @classmethod
    def of(cls, rows: Sequence[dict[str, Any]]) -> Curve:
        """From rows with torque_Nm and rotation_arcmin."""
        torque = np.array([row["torque_Nm"] for row in rows])
        rotation = ARC_MINUTE * np.array([row["rotation_arcmin"] for row in rows])
        order = np.argsort(torque)
        return cls(torque[order], rotation[order])

    def at(self, torque: float) -> float:
        """Rotation (rad) at a torque, without torque on the line through the first two points; nan
        beyond the last one."""
        (a, b), (u, v) = self.torque[:2], self.rotation[:2]
        if torque < a:
            return float(u + (torque - a) * (v - u) / (b - a))
        reached = torque <= self.torque[-1] * (1.0 + ROUNDED)
        return float(PchipInterpolator(self.torque, self.rotation)(torque)) if reached else np.nan

    def stiffness(self, size: int) -> dict[str, float]:
        """K1, K2, K3 (N·m/rad) and lost motion (arc minutes) of a similar drive."""
        scale = (FITTED_SIZE / size) ** 3
        T1, T2 = break_points(size)
        ends = [0.0, T1, T2, TOP * T2]
        turns = np.diff([self.at(scale * end) for end in ends])
        found = dict(zip(NAMES, np.diff(ends) / turns, strict=True))
        lost = 2.0 * self.at(scale * LOST_MOTION * T2) / ARC_MINUTE
        return {key: float(value) for key, value in found.items()} | {"lost_motion": lost}
