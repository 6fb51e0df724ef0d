"""Which flexible units should drive the even pinions: all choices of four of the eight, at rest."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from swgpar.gear_trains.cascade.design import PAIRS, PINIONS, CascadeDesign
from swgpar.gear_trains.cascade.static_sharing import even_pinion_mask, static_sharing


@dataclass(frozen=True)
class Sorting:
    """Largest load shares of all choices, ascending.

    even_units : (70, 4) numbers from 1 of the units of pinions 2, 4, 6 and 8, ascending
    largest : (70,) largest load share of a pinion at the largest rack force in direction B
    """

    even_units: np.ndarray
    largest: np.ndarray


def sort_units(design: CascadeDesign) -> Sorting:
    """The units of odd and of even pinions are mounted in ascending order of their numbers, which
    matters only if meshes have gaps of their own."""
    mounted, even = static_sharing(design, "B"), even_pinion_mask()
    ratios, force = mounted.units.ratios, 1e3 * design.load.peak
    choices = np.array(list(combinations(range(PINIONS), PAIRS)))
    largest = np.empty(len(choices))
    for k, chosen in enumerate(choices):
        sorted_ratios = np.empty(PINIONS)
        sorted_ratios[even], sorted_ratios[~even] = ratios[chosen], np.delete(ratios, chosen)
        units = replace(mounted.units, ratios=sorted_ratios)
        largest[k] = replace(mounted, units=units).shares(force).max()
    order = np.argsort(largest, kind="stable")
    return Sorting(choices[order] + 1, largest[order])
