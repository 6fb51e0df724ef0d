"""Teeth that get a window, and stresses that are followed over finer ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from swgpar.largest_stress.local_problem import SECTORS, WindowStress
from swgpar.largest_stress.region_stress import CLOSE, CLOSE_IN_ROOT
from swgpar.largest_stress.window_recipes import by_model
from swgpar.model.regions import AT_ENDS as END_REGIONS
from swgpar.model.regions import TOOTH_ROOT

IN_ROOT = (0.82, 0.92, 0.97)
"""Shares of the largest stress, which is not in a root, from which one in a root is followed after
the first windows: there up to 15, 8 and 2 % are still to come."""

SAME_REGION, AT_ENDS, BETWEEN_ENDS = 0.97, (0.9, 1.0), 0.88
"""Shares of the largest stress from which another is followed on finer windows. In the same region,
after the first window, which changes the ratio of two stresses by up to 2 %.
At the ends of teeth, after the first window, and after later ones. Between them, while an end has
the largest. At the ends the second window gives the most, up to 12 % too much."""


LATER = by_model(0.995, 0.985)
"""The same in one region after later windows, in one window or in two. In the plane these change
the ratio of two stresses by up to 0.3 %, in the reference cup the third one by 1.2 %."""

ROUND_OFF = 1e-6
"""Share by which equal stresses differ: that of Newton's iteration."""


Followed = tuple[int, bool]
"""A stress that is followed: modelled tooth in the middle of the first window, whether at the ends
of teeth."""


def first_of_largest(values: np.ndarray) -> int:
    """Index of the largest of stresses (n,), of equal ones the first: two teeth have one nodal
    average in the middle of their root, and round-off differs with the number of ranks."""
    return int(np.argmax(values >= values.max() - ROUND_OFF * abs(values.max())))


def candidates(
    between: np.ndarray,
    at_ends: np.ndarray | None = None,
    *,
    in_root: np.ndarray,
    mises: np.ndarray,
) -> list[int]:
    """Teeth whose stresses are looked at: the one with the largest between its ends, and others
    that are close to it.

    between, at_ends, in_root : (n_modelled,) largest nodal s1, MPa, of the teeth between their
    ends, in the cup at them, and in their roots
    mises : (n_modelled,) largest von Mises stress of teeth and rim, apart from the contact
    """
    first = first_of_largest(between)
    teeth = [first]
    shares = [(between, CLOSE)]
    if in_root[first] < between[first]:
        shares.append((in_root, CLOSE_IN_ROOT))
    if at_ends is not None:
        shares.append((at_ends, CLOSE))
    near = _near(first, len(between))
    limits = [(stresses, share * between[first]) for stresses, share in shares]
    limits.append((mises, CLOSE * mises[near].max()))
    for stresses, limit in limits:
        far = stresses.copy()
        far[near] = -np.inf
        other = first_of_largest(far)
        if far[other] > limit and other not in teeth:
            teeth.append(other)
    return teeth


def may_be_largest(one: WindowStress, best: WindowStress, level: int, later: float) -> bool:
    """Whether a stress may overtake the largest one on windows finer than `level`; one region
    converges alike. later : see `LATER`"""
    share = SAME_REGION if level == 0 else later
    if one.region != best.region:
        share = BETWEEN_ENDS if best.region in END_REGIONS else AT_ENDS[min(level, 1)]
        if one.region == TOOTH_ROOT and best.region not in END_REGIONS:
            share = IN_ROOT[min(level, len(IN_ROOT) - 1)]
    return one is best or one.value > share * best.value


def followed(found: Mapping[Followed, WindowStress], level: int, later: float) -> list[Followed]:
    """Places that may have the largest stress on windows finer than `level`: each may overtake the
    first of both parts. later : see `LATER`"""
    firsts: dict[bool, WindowStress] = {}
    for (_, ends), stress in found.items():
        firsts[ends] = max(firsts.get(ends, stress), stress, key=lambda s: s.value)
    return [
        place
        for place, stress in found.items()
        if all(may_be_largest(stress, f, level, later) for f in firsts.values())
    ]


def levels_of(read: Sequence[Mapping[int, float]], is_followed: bool) -> list[float]:
    """Largest s1 (MPa) of a place on the windows, coarse to fine.

    read : by tooth
    is_followed : whether windows are there for it; if not, narrow ones may lie around other teeth
    than the one with the largest stress, so that only those of one tooth can be compared
    """
    of = read[-1]
    tooth = max(of, key=lambda one: of[one])
    return [max(by.values()) if is_followed else by[tooth] for by in read]


def narrowed(
    found: Mapping[Followed, Sequence[WindowStress]], first_tooth: int, count: int, later: float
) -> dict[Followed, list[int]]:
    """Teeth around which narrow windows lie, by place, and places that need none any more.

    found : stresses of the teeth in the windows of a place, the largest first
    first_tooth, count : of the modelled teeth, of which others are images
    later : see `LATER`

    A tooth that windows of two places read has one narrow window, in that with the larger stress;
    of equal ones in the first, on any number of ranks.
    """
    taken, narrow = set[tuple[int, bool]](), dict[Followed, list[int]]()
    top = max((of_teeth[0].value for of_teeth in found.values()), default=0.0)
    shares = {place: round((top - found[place][0].value) / (abs(top) or 1.0), 5) for place in found}
    for place in sorted(found, key=lambda place: shares[place]):
        close = [one for one in found[place] if one.value >= later * found[place][0].value]
        for one in close:
            modelled = (one.tooth - first_tooth) % count, place[1]
            if modelled not in taken:
                taken.add(modelled)
                narrow.setdefault(place, []).append(one.tooth)
    return narrow


def _near(tooth: int, count: int) -> np.ndarray:
    """Modelled teeth (n,) whose stresses the window of a tooth resolves."""
    inside = SECTORS // 2 - 1
    return (tooth + np.arange(-inside, inside + 1)) % count
