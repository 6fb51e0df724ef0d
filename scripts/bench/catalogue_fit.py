"""The proportions of size 17, ratio 50, that give its published stiffness, and how well they are
determined."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from catalogue_curves import FITTED_RATIO, FITTED_SIZE, NAMES, published
from catalogue_designs import Proportions

from swgpar.checks.starter_cam import rounded

START = Proportions()
"""Those of a starter design."""

VARIED = ("rim", "clearance", "backlash")
"""Proportions that are fitted. All others are those of the start."""

SOFTER = replace(START, rim=0.008, end=0.667, hub=0.25)
"""Thinner, with an end as thick as the wall and a smaller hub."""

NEAR = replace(SOFTER, clearance=0.0002, backlash=0.025)
"""Close enough to the published stiffness for its derivatives."""

FITTED = replace(NEAR, rim=0.0073, clearance=0.000141)
"""What all drives of the tables have: the least squares of the logarithms of K1, K2, K3 by rim and
clearance, `step` from `NEAR`."""


def bent_alike(ratio: int) -> Proportions:
    """The fitted proportions with the rim that the cam bends by the same strain at every ratio.

    The deflection is so many modules, a module a diameter over twice the ratio, and the strain half
    of the rim's thickness times a curvature in proportion to the deflection over the square of the
    diameter. So the rim over the diameter is in proportion to the ratio. Wall and closed end are
    in proportion to the rim.
    """
    return replace(FITTED, rim=rounded(FITTED.rim * ratio / FITTED_RATIO))


WITH_PLAY = replace(START, clearance=0.000144, backlash=0.02)
"""The starter's structure with the play that the fit needs."""

CASES: dict[str, Proportions] = {
    "starter": START,
    "clearance 0.00014": replace(START, clearance=0.000144),
    "clearance 0.00038": replace(START, clearance=0.000384),
    "wall 0.5": replace(START, wall=0.5),
    "rim 0.009": replace(START, rim=0.009),
    "backlash 0.02": replace(START, backlash=0.02),
    "rim 0.009, clearance 0.00038, backlash 0.02": replace(
        START, rim=0.009, clearance=0.000384, backlash=0.02
    ),
    "softer: rim 0.008, end 0.667, hub 0.25": SOFTER,
    "near: softer, clearance 0.0002, backlash 0.025": NEAR,
    "near, clearance 0.00013": replace(NEAR, clearance=0.00013),
    "near, clearance 0.00013, backlash 0.04": replace(NEAR, clearance=0.00013, backlash=0.04),
    "near, rim 0.0086": replace(NEAR, rim=0.0086),
}
"""Runs of the fit -> their proportions."""

AROUND = tuple(name for name in CASES if name.startswith("near"))
"""Runs from which the derivatives at the fit are taken."""


def residuals(row: Mapping[str, Any]) -> np.ndarray:
    """Logarithms (3,) of the computed K1, K2, K3 over the published ones."""
    target = [published("stiffness", FITTED_RATIO, name, FITTED_SIZE) for name in NAMES]
    return np.log([row[name] / value for name, value in zip(NAMES, target, strict=True)])


def logarithms(row: Mapping[str, Any]) -> np.ndarray:
    """Logarithms (3,) of the varied proportions."""
    return np.log([row[name] for name in VARIED])


def sensitivity(rows: Sequence[Mapping[str, Any]]) -> np.ndarray:
    """Jacobian (3, 3) of the logarithms of K1, K2, K3 by those of the varied proportions.

    rows : of `AROUND`, one more than there are proportions
    """
    first, *others = [next(row for row in rows if row["case"] == name) for name in AROUND]
    steps = np.array([logarithms(row) - logarithms(first) for row in others])
    changes = np.array([residuals(row) - residuals(first) for row in others])
    return np.linalg.solve(steps, changes).T


def step(rows: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """Rim and clearance of the least squares from `NEAR`. The backlash has no effect there."""
    first = next(row for row in rows if row["case"] == AROUND[0])
    jacobian = sensitivity(rows)[:, :2]
    change = np.linalg.lstsq(jacobian, -residuals(first), rcond=None)[0]
    return dict(zip(VARIED, np.exp(logarithms(first)[:2] + change).tolist()))
