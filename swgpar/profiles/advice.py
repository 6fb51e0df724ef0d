"""What to change where keys give no flank: which length, in which direction, a value that works.

Each length of the section is varied alone, the other keys as they are. The range that works is
found by building the flank, so that it is the range that passes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import NamedTuple

import numpy as np

from swgpar.input.quantities import show

Builds = Callable[[float], bool]
"""Whether the flank can be built with a value of one key."""

SPAN, SAMPLES = 100.0, 61
"""Lengths are tried from the value over `SPAN` to the value times `SPAN`, in equal ratios."""


class WorkingRange(NamedTuple):
    """Values of a key that work, those at the ends as well.  example : a round value inside"""

    low: float
    high: float
    example: float


def advise(
    name: str, lengths: Mapping[str, float], builds: Callable[[str, float], bool], unit: float
) -> str:
    """The end of a sentence that refuses a profile; empty where no length alone mends it.

    name : section of the design file
    lengths : keys that may be changed, with their values, mm
    builds : whether another value of a key gives a flank;  unit : module, mm, for a length of zero
    """
    tried = {
        key: working_range(value, partial(builds, key), unit) for key, value in lengths.items()
    }
    ranges = {key: working for key, working in tried.items() if working is not None}
    if not ranges:
        return ""

    def change(key: str) -> float:
        """Ratio of the nearest length that works to the one that is given, as a logarithm."""
        value = lengths[key]
        nearest = np.clip(value, ranges[key].low, ranges[key].high)
        return abs(np.log(nearest / value)) if value > 0.0 else np.inf

    key = min(ranges, key=change)
    low, high, example = ranges[key]
    change_to = f"make {name}.{key} {'larger' if example > lengths[key] else 'smaller'}:"
    as_they_are = "with the other keys as they are"
    if show(low) == show(high):
        return f"{change_to} allowed {show(example)} mm {as_they_are}"
    return (
        f"{change_to} allowed {show(low)} to {show(high)} mm {as_they_are}, for example "
        f"{show(example)}"
    )


def working_range(value: float, builds: Builds, unit: float) -> WorkingRange | None:
    """The range nearest to `value` in which `builds` holds; None where no sample of it works."""
    if value > 0.0:
        samples, at = value * np.geomspace(1.0 / SPAN, SPAN, SAMPLES), SAMPLES // 2
    else:
        samples, at = unit * np.linspace(0.0, 2.0, SAMPLES), 0
    works = np.array([builds(float(x)) for x in samples])
    if not works.any():
        return None
    good, bad = np.flatnonzero(works), np.flatnonzero(~works)
    nearest = good[np.abs(good - at).argmin()]
    # the samples around it that all work
    first = bad[bad < nearest].max(initial=-1) + 1
    last = bad[bad > nearest].min(initial=SAMPLES) - 1
    low = samples[0] if first == 0 else _end(builds, samples[first - 1], samples[first])
    high = samples[-1] if last == SAMPLES - 1 else _end(builds, samples[last + 1], samples[last])
    # a few digits, inside of the range
    low, high = float(f"{1.001 * low:.4g}"), float(f"{0.999 * high:.4g}")
    if not (low < high and builds(low) and builds(high)):
        low, high = float(samples[first]), float(samples[last])
    # near the end that is nearer to the value
    near, far = (low, high) if value <= low else (high, low)
    example = near * (far / near) ** 0.1 if low > 0.0 else near + 0.1 * (far - near)
    example = float(f"{example:.3g}")
    inside = low <= example <= high and builds(example)
    return WorkingRange(low, high, example if inside else float(samples[nearest]))


def _end(builds: Builds, bad: float, good: float) -> float:
    """The last value that works between one that does not and one that does, to a thousandth."""
    while abs(good - bad) > 1e-3 * abs(good):
        middle = 0.5 * (bad + good)
        bad, good = (bad, middle) if builds(middle) else (middle, good)
    return float(good)
