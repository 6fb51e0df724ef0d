"""What a periodic curve may reach between the angles at which it is known.

Where a pair of teeth comes into contact, curves over a period have kinks. The largest value lies on
one, between two angles. The straight lines through the points on either side are continued into the
gap between them. A curve that is straight up to its kink reaches the point where they meet, a
smooth one about a third of the way to it.
"""

from __future__ import annotations

import numpy as np

from swgpar.geometry.arrays import Floats

FEWEST = 4
"""Points of a period: two on either side of a gap."""


def missed_range(values: Floats) -> float:
    """How much larger the range of a periodic curve may be than that of its values at even places
    (n,), in their unit; n of at least `FEWEST`."""
    return missed_above(values) + missed_above(-values)


def missed_above(values: Floats) -> float:
    """How much larger a periodic curve may be than the largest of its values at even places (n,),
    in their unit; n of at least `FEWEST`: the height that the lines reach above it.

    Where they do not meet in a gap, because the curve turns twice there, the one counts that rises
    more gently, up to the middle.
    """
    after = np.roll(values, -1)
    left, right = values - np.roll(values, 1), after - np.roll(values, -2)
    rise = left + right
    place = np.divide(after + right - values, rise, out=np.full(len(values), -1.0), where=rise > 0)
    meeting = np.where((place >= 0.0) & (place <= 1.0), values + left * place, -np.inf)
    ends = np.maximum(values, after)
    middle = np.stack([values + 0.5 * left, after + 0.5 * right])
    middle = np.where(middle > ends, middle, np.inf).min(axis=0)
    alone = np.where(np.isinf(meeting) & np.isfinite(middle), middle, -np.inf)
    return max(0.0, float(np.max([meeting, alone]) - values.max()))
