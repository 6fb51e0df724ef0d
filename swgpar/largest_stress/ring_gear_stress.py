"""The largest stresses of a ring gear, resolved by windows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from swgpar.fem.body import STRESS_PREFIXES
from swgpar.largest_stress.candidate_teeth import ROUND_OFF, first_of_largest
from swgpar.largest_stress.local_problem import WindowStress
from swgpar.largest_stress.places import OF_REGION
from swgpar.largest_stress.region_stress import (
    CLOSE_IN_ROOT,
    RegionStress,
    WindowReadings,
    nodal_averages,
    nodal_by_sector,
)
from swgpar.largest_stress.solved_window import States, solved_window
from swgpar.largest_stress.window_recipes import RATIO, RING_LEVELS, window_recipe
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel
from swgpar.model.regions import TOOTH_ROOT

LOOKED_AT, MOST_PEAKS = CLOSE_IN_ROOT, 6
"""Share of the largest nodal average in a root from which a tooth with more than those beside it is
looked at, and most of these teeth."""

FOLLOWED = (0.8, 0.96)
"""Shares of the largest stress in a root with which a tooth is followed after the first window,
which changes the ratio of two roots by up to a fifth, and after later ones: these change it by up
to 3 % (docs/verification/effectivity.md)."""


def ring_gear_stresses(
    model: DriveModel, state: LoadState, gear: str, levels: int, skipped: int
) -> dict[str, RegionStress]:
    """Largest stresses of a ring gear by windows; collective.

    A root lies between two teeth, and its middle has the same nodal average in both. Nodal averages
    lose much beside a contact near the root, so that of two loaded roots the one with less may have
    the larger stress. Hence all teeth with a peak of the tension in their root, and those beside
    them, get the coarsest window; in the plane those with a peak of the von Mises stress as well.
    These windows tell the teeth that are followed.
    """
    kind, averages = model.geometry.model, nodal_averages(model, gear)
    nodal = nodal_by_sector(model, state, gear, averages)
    stresses = ("s1", "vm") if kind == "plane" else ("s1",)
    prefix = STRESS_PREFIXES[gear][0]
    roots = [f"{prefix}_{stress}{OF_REGION}{TOOTH_ROOT}" for stress in stresses]
    peaks = [tooth for root in roots for tooth in _peaks(nodal[root], kind)]
    teeth = {(tooth + beside) % len(nodal[roots[0]]) for tooth in peaks for beside in (-1, 0, 1)}
    readings, states = WindowReadings(skipped), States()
    for level in range(min(levels, RING_LEVELS[kind])):
        found = {}
        for tooth in sorted(teeth):
            recipe = window_recipe(kind, level)
            with solved_window(model, state, tooth, recipe, states, gear) as window:
                (found[tooth],) = window.by_region().values()
            if level >= skipped:
                readings.add(tooth, level, {tooth: found[tooth]})
        share = FOLLOWED[min(level, 1)] if kind == "plane" else 1.0
        teeth = {tooth for root in roots for tooth in _followed(found, root, share)}
    return readings.stresses(model, gear, nodal, RATIO[kind])


def _peaks(nodal: np.ndarray, kind: str) -> list[int]:
    """Teeth with the largest nodal averages (n,) MPa beside them, the largest first; in a cup
    drive, where windows cost more, one. Equal ones differ by round-off."""
    if kind != "plane":
        return [first_of_largest(nodal)]
    least = nodal * (1.0 + ROUND_OFF)
    peak = (least >= np.roll(nodal, 1)) & (least >= np.roll(nodal, -1))
    peaks = np.flatnonzero(peak & (nodal > LOOKED_AT * nodal.max()))
    # of equal ones the first, on any number of ranks
    order = np.argsort(-np.round(nodal[peaks] / nodal.max(), 6), kind="stable")
    return [int(tooth) for tooth in peaks[order][:MOST_PEAKS]]


def _followed(
    found: Mapping[int, Mapping[str, WindowStress]], name: str, share: float
) -> Iterator[int]:
    """Teeth around which windows give this share of the largest stress of a name, or more."""
    values = {tooth: of[name].value if name in of else 0.0 for tooth, of in found.items()}
    largest = max(values, key=lambda tooth: values[tooth])
    for tooth, value in values.items():
        if tooth == largest or (share < 1.0 and value > share * values[largest]):
            yield tooth
