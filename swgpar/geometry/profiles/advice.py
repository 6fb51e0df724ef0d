"""What to change where the keys of a profile give no flank: which length, in which direction, and a
value that works.

Each length of the section is varied alone, the other keys as they are. The range that works is
found by building the flank, so that it is the range that passes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from swgpar.input.quantities import show

Builds = Callable[[float], bool]
"""Whether the flank can be built with a value of one key."""

SPAN, SAMPLES = 100.0, 61
"""Lengths are tried from the value over `SPAN` to the value times `SPAN`, in equal ratios."""


@dataclass(frozen=True)
class WorkingRange:
    """Values of a key that work, nearest to the one that is given; those at the ends work as well.

    key : name;  value : that is given;  low, high : ends;  example : a round value inside
    """

    key: str
    value: float
    low: float
    high: float
    example: float

    @property
    def change(self) -> float:
        """How far the value is from the range: ratio of lengths, as a logarithm."""
        if self.value <= 0.0:
            return np.inf
        return float(np.abs(np.log(np.clip(self.value, self.low, self.high) / self.value)))


def advise(
    name: str, lengths: Mapping[str, float], builds: Callable[[str, float], bool], unit: float
) -> str:
    """The end of a sentence that refuses a profile; empty where no length alone mends it.

    Parameters
    ----------
    name : section of the design file
    lengths : keys that may be changed, with their values, mm
    builds : whether the flank can be built with another value of a key
    unit : module, mm; a length of zero is varied up to it
    """
    ranges = []
    for key, value in lengths.items():
        working = working_range(key, value, partial(builds, key), unit)
        if working is not None:
            ranges.append(working)
    if not ranges:
        return ""
    best = min(ranges, key=lambda working: working.change)
    direction = "larger" if best.example > best.value else "smaller"
    return (
        f"make {name}.{best.key} {direction}: allowed {show(best.low)} to {show(best.high)} mm "
        f"with the other keys as "
        f"they are, for example {show(best.example)}"
    )


def working_range(key: str, value: float, builds: Builds, unit: float) -> WorkingRange | None:
    """The range nearest to `value` in which `builds` holds; None where no sample of it works."""
    samples = (
        value * np.geomspace(1.0 / SPAN, SPAN, SAMPLES)
        if value > 0.0
        else unit * np.linspace(0.0, 2.0, SAMPLES)
    )
    works = np.array([builds(float(x)) for x in samples])
    if not works.any():
        return None
    middle = int(np.abs(samples - value).argmin()) if value <= 0.0 else SAMPLES // 2
    nearest = int(np.flatnonzero(works)[np.abs(np.flatnonzero(works) - middle).argmin()])
    # the samples around it that all work
    bad = np.flatnonzero(~works)
    first, last = (
        bad[bad < nearest].max(initial=-1) + 1,
        bad[bad > nearest].min(initial=SAMPLES) - 1,
    )
    low = samples[0] if first == 0 else _end(builds, samples[first - 1], samples[first])
    high = samples[-1] if last == SAMPLES - 1 else _end(builds, samples[last + 1], samples[last])
    # a few digits, rounded into the range
    low, high = _inward(low, low, high, up=True), _inward(high, low, high, up=False)
    if not (low < high and builds(low) and builds(high)):
        low, high = float(samples[first]), float(samples[last])
    # inside the range, near the end that is nearer to the value
    near, far = (low, high) if value <= low else (high, low)
    example = near * (far / near) ** 0.1 if min(near, far) > 0.0 else near + 0.1 * (far - near)
    example = _inward(example, low, high, up=far > near)
    return WorkingRange(
        key, value, low, high, example if builds(example) else float(samples[nearest])
    )


def _end(builds: Builds, bad: float, good: float) -> float:
    """The last value that works between one that does not and one that does, to a thousandth."""
    while abs(good - bad) > 1e-3 * abs(good):
        middle = 0.5 * (bad + good)
        bad, good = (bad, middle) if builds(middle) else (middle, good)
    return float(good)


def _inward(value: float, low: float, high: float, *, up: bool) -> float:
    """`value` with three digits, rounded up or down; with more where that leaves the range."""
    for digits in range(3, 12):
        scale = 10.0 ** (digits - 1 - np.floor(np.log10(abs(value)))) if value else 1.0
        rounded = float((np.ceil if up else np.floor)(value * scale) / scale)
        if low <= rounded <= high:
            return float(f"{rounded:.12g}")
    return value
