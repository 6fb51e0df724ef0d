"""Tables of the page on catalogue drives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from catalogue_curves import (
    ARC_MINUTE,
    FITTED_RATIO,
    FITTED_SIZE,
    NAMES,
    PUBLISHED,
    SIZES,
    TOP,
    Curve,
    break_points,
    published,
)
from catalogue_fit import AROUND, VARIED, sensitivity
from page import markdown

Row = Mapping[str, Any]
LOSS_RATIO = 100
"""Ratio of which losses are published."""

ARC_SECOND = ARC_MINUTE / 60.0

SPEED = 2000.0
"""Speed (1/min) at which the published losses are assumed to hold."""


def number(value: float, digits: int = 3) -> str:
    """A number of so many digits, without an exponent; empty for nan."""
    if np.isnan(value):
        return ""
    shown = float(f"{value:.{digits}g}")
    return f"{shown:,.0f}" if abs(shown) >= 100.0 else f"{shown:g}"


def two_digits(value: float) -> str:
    """A number with two decimals; no sign before zero."""
    return f"{round(value, 2) + 0.0:.2f}"


def over(value: float, other: float) -> str:
    """A ratio; empty for nan."""
    return "" if np.isnan(value / other) else f"{value / other:.2f}"


def fit(rows: Sequence[Row]) -> str:
    """Runs of the fit beside the published stiffness."""
    target = {name: published("stiffness", FITTED_RATIO, name, FITTED_SIZE) for name in NAMES}
    found = [["case", *NAMES, "K3 / K1", "lost motion"]]
    found.append(_sizes("published", target, np.nan))
    found.extend(_sizes(str(row["case"]), row, row["lost_motion"]) for row in rows)
    return markdown(found)


def determined(rows: Sequence[Row]) -> str:
    """Derivatives at the fit, and its singular values with their directions; empty without the
    runs."""
    if not set(AROUND) <= {row["case"] for row in rows}:
        return ""
    jacobian = sensitivity(rows)
    _, values, directions = np.linalg.svd(jacobian)
    found = [["", *VARIED]]
    found += [[f"of {name}", *map(two_digits, row)] for name, row in zip(NAMES, jacobian)]
    found += [
        [f"singular value {value:.2g}", *map(two_digits, direction)]
        for value, direction in zip(values, directions)
    ]
    return markdown(found)


def _sizes(name: str, row: Row, lost: float) -> list[str]:
    ratio = f"{row['K3'] / row['K1']:.2f}"
    return [name, *(number(row[key]) for key in NAMES), ratio, number(lost, 2)]


def stiffness(rows: Sequence[Row]) -> str:
    """Stiffness of all sizes and ratios beside the published one."""
    head = ["ratio", "size", *(f"{name}: computed" for name in NAMES)]
    found = [[*head, *(f"{name} over published" for name in NAMES), "K3 / K1", "published",
              "lost motion"]]  # fmt: skip
    for ratio in sorted({int(row["ratio"]) for row in rows}):
        curve = Curve.of([row for row in rows if row["ratio"] == ratio])
        for size in SIZES:
            here, printed = (
                curve.stiffness(size),
                {name: published("stiffness", ratio, name, size) for name in NAMES},
            )
            fitted = (ratio, size) == (FITTED_RATIO, FITTED_SIZE)
            cells = [f"{ratio}", f"{size}" + (", fitted" if fitted else "")]
            cells += [number(here[name]) for name in NAMES]
            cells += [over(here[name], printed[name]) for name in NAMES]
            cells += [over(here["K3"], here["K1"]), over(printed["K3"], printed["K1"])]
            found.append([*cells, number(here["lost_motion"], 2)])
    return markdown(found)


def rotations(rows: Sequence[Row]) -> str:
    """Rotation of size 17 from no torque to the break points, as published and as computed, beside
    the published play of the coupling at the input; arc seconds at the output."""
    ends = [0.0, *break_points(FITTED_SIZE)]
    ends.append(TOP * ends[-1])
    head = ["ratio", *(f"{end:g} N·m: {what}" for end in ends[1:] for what in
                       ("published", "computed"))]  # fmt: skip
    found = [[*head, "play of the coupling"]]
    for ratio in sorted({int(row["ratio"]) for row in rows}):
        curve = Curve.of([row for row in rows if row["ratio"] == ratio])
        printed = [published("stiffness", ratio, name, FITTED_SIZE) for name in NAMES]
        turns = np.cumsum(np.diff(ends) / printed) / ARC_SECOND
        here = [(curve.at(end) - curve.at(0.0)) / ARC_SECOND for end in ends[1:]]
        cells = [number(value) for pair in zip(turns, here) for value in pair]
        play = PUBLISHED["coupling"][f"ratio_{ratio}"][SIZES.index(FITTED_SIZE)]
        found.append([f"{ratio}", *cells, f"{play:g}"])
    return markdown(found)


def held(rows: Sequence[Row]) -> str:
    """Size 17 at several ratios with a compliance at the input, found at one ratio, that the output
    sees over the square of the ratio."""
    fitted = next((row for row in rows if row["ratio"] == FITTED_RATIO), None)
    if fitted is None:
        return ""
    printed = published("stiffness", FITTED_RATIO, "K3", FITTED_SIZE)
    compliance = FITTED_RATIO**2 * (1.0 / printed - 1.0 / fitted["K3"])
    head = ["ratio", *(f"{name}: rigid input" for name in NAMES)]
    head += [*(f"{name}: {1.0 / compliance:.0f} N·m/rad at the input" for name in NAMES)]
    found = [[*head, *(f"{name} over published" for name in NAMES)]]
    for row in rows:
        ratio = int(row["ratio"])
        yields = {name: 1.0 / (1.0 / row[name] + compliance / ratio**2) for name in NAMES}
        cells = [f"{ratio}", *(number(row[name]) for name in NAMES)]
        cells += [number(yields[name]) for name in NAMES]
        found.append(
            cells
            + [
                over(yields[name], published("stiffness", ratio, name, FITTED_SIZE))
                for name in NAMES
            ]
        )
    return markdown(found)


@dataclass(frozen=True)
class FittedLosses:
    """Loss torque of a drive of size 17 at the input, N·mm: a part without a load, and one in
    proportion to the load, both from its published figures.

    idle : at `SPEED`;  by_load : N·mm over N·m on the output;  ratio, rated : of that drive, N·m
    """

    idle: float
    by_load: float
    ratio: int
    rated: float

    @classmethod
    def of(cls, ratio: int) -> FittedLosses:
        """From no-load torque and efficiency of size 17."""
        idle, efficiency, rated = (
            published("losses", ratio, name, FITTED_SIZE)
            for name in ("no_load", "efficiency", "rated_torque")
        )
        lost = 1000.0 * rated / ratio * (1.0 / efficiency - 1.0)
        return cls(idle, (lost - idle) / rated, ratio, rated)

    def efficiency(self, load: float, speed: float = SPEED) -> float:
        """Efficiency under a load (N·m) on the output of size 17. speed : 1/min"""
        useful = 1000.0 * load / self.ratio
        return useful / (useful + self.free(speed) + self.by_load * load)

    def free(self, speed: float) -> float:
        """No-load torque at a speed (1/min), as if all of it were drag of the lubricant."""
        return self.idle * (speed / SPEED) ** (2.0 / 3.0)


def losses() -> str:
    """No-load torque and efficiency of all sizes from those of size 17."""
    fitted = FittedLosses.of(LOSS_RATIO)
    head = ["size", "no load: predicted", "published", "over it", "efficiency: predicted"]
    found = [[*head, "published"]]
    for size in SIZES:
        free, efficiency, rated = (
            published("losses", fitted.ratio, name, size)
            for name in ("no_load", "efficiency", "rated_torque")
        )
        if np.isnan(free):
            continue
        scale = (size / FITTED_SIZE) ** 3
        here, load = scale * fitted.idle, rated / scale
        cells = [f"{size}" + (", given" if size == FITTED_SIZE else ""), number(here)]
        cells += [number(free), over(here, free)]
        found.append([*cells, percent(fitted.efficiency(load)), percent(efficiency)])
    return markdown(found)


def operation() -> str:
    """No-load torque and efficiency of size 17 over speed and load."""
    fitted = FittedLosses.of(LOSS_RATIO)
    shares = (0.25, 0.5, 1.0, 1.5)
    found = [["speed, 1/min", "no-load torque", *(f"efficiency at {x:g} rated" for x in shares)]]
    for speed in (500.0, 1000.0, 2000.0, 3500.0):
        loads = [share * fitted.rated for share in shares]
        cells = [percent(fitted.efficiency(load, speed)) for load in loads]
        found.append([f"{speed:g}", number(fitted.free(speed)), *cells])
    return markdown(found)


def percent(value: float) -> str:
    """A share in percent."""
    return f"{100.0 * value:.0f} %"
