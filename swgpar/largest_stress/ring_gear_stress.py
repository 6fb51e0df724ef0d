"""The largest stresses of the ring gear, resolved by windows."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from swgpar.fem.body import RING_GEAR
from swgpar.largest_stress.candidate_teeth import first_of_largest
from swgpar.largest_stress.local_problem import WindowState, WindowStress
from swgpar.largest_stress.places import OF_REGION
from swgpar.largest_stress.region_stress import (
    RegionStress,
    WindowReadings,
    nodal_averages,
    nodal_by_sector,
)
from swgpar.largest_stress.solved_window import solved_window
from swgpar.largest_stress.window_recipes import RATIO, RING_LEVELS, window_recipe
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel
from swgpar.model.regions import TOOTH_ROOT


def ring_gear_stresses(
    model: DriveModel, state: LoadState, levels: int, skipped: int
) -> dict[str, RegionStress]:
    """Largest stresses of the ring gear by windows; collective.

    A root lies between two teeth, and its middle has the same nodal average in both: of the tooth
    with the largest tension there and those beside it the coarsest window tells the one that is
    followed. In the plane so it is with the von Mises stress, where the tension may be larger:
    nodal averages lose much beside a contact near the root.
    """
    kind, averages = model.geometry.model, nodal_averages(model, RING_GEAR)
    nodal = nodal_by_sector(model, state, RING_GEAR, averages)
    stresses = ("s1", "vm") if kind == "plane" else ("s1",)
    roots = [f"rg_{stress}{OF_REGION}{TOOTH_ROOT}" for stress in stresses]
    first, count = [first_of_largest(nodal[root]) for root in roots], len(nodal[roots[0]])
    teeth = {(tooth + beside) % count for tooth in first for beside in (-1, 0, 1)}
    readings, states = WindowReadings(skipped), dict[int, WindowState]()
    for level in range(min(levels, RING_LEVELS[kind])):
        found = {}
        for tooth in sorted(teeth):
            recipe = window_recipe(kind, level)
            with solved_window(model, state, tooth, recipe, states, RING_GEAR) as window:
                found[tooth] = window.by_region()
            if level >= skipped:
                readings.add(tooth, found[tooth])
        teeth = {max(found, key=partial(_in_region, found, root)) for root in roots}
    return readings.stresses(model, RING_GEAR, nodal, RATIO[kind])


def _in_region(found: Mapping[int, Mapping[str, WindowStress]], name: str, tooth: int) -> float:
    """Largest stress (MPa) of a name that the window around a tooth gives."""
    return found[tooth][name].value if name in found[tooth] else 0.0
