"""Places of the balls of a bearing at the angles of a sampled period (docs/theory/bearing.md).

A state of a drive with a bearing depends on two phases: of the teeth, which repeats after a pitch,
and of the balls, which repeats when a ball has the place of its neighbour on the wave generator.
Angles evenly spaced in a period of the teeth show all of both if the balls go on by whole passings
meanwhile: both phases then take evenly spaced values, in different orders. Such points are a
rank-1 lattice. A wave of the tooth order a and the ball order b is taken for the mean over them
where a + b x passings is a multiple of their number.
"""

from __future__ import annotations

import math

HIGHEST = 4
"""Highest order of waves of the teeth, over which sets of points are compared."""

AGAINST, IN_TEETH = 0.25, 0.25
"""Weights of waves with orders of opposite signs, and of those of balls that all have the same
place in a tooth. Measured in the drives of docs/theory/bearing.md."""

DECAY = 0.25
"""Size of waves of the next order of the teeth."""


def ball_passings(samples: int, teeth_per_ball: float, pitches: int = 1) -> int:
    """Passings of balls in a period of so many angles, more than zero where the balls gain on the
    wave generator; no common divisor with `samples`. 0 with one angle.

    teeth_per_ball : teeth of the flexible spline between two balls
    pitches : of the teeth in the period
    """
    if samples < 2:
        return 0
    fitting = [k for k in range(1, samples) if math.gcd(k, samples) == 1]
    best = min(fitting, key=lambda k: round(_mistaken(samples, k, teeth_per_ball), 12))
    # the same points with teeth that go on by several pitches
    passings = best * pitches % samples
    return passings if 2 * passings <= samples else passings - samples


def _mistaken(samples: int, passings: int, teeth_per_ball: float) -> float:
    """Weight of the waves that so many angles take for the mean."""
    total = 0.0
    for a in range(1, HIGHEST + 1):
        for b in range(-samples * HIGHEST, samples * HIGHEST + 1):
            if (a + b * passings) % samples == 0:
                total += _weight(a, b, teeth_per_ball)
    return total


def _weight(a: int, b: int, teeth_per_ball: float) -> float:
    """Relative size of the wave of the orders `a` of the teeth and `b` of the balls. A ball meets
    teeth on its way to the place of its neighbour: waves with b near a x teeth_per_ball."""
    along = (1.0 if b >= 0 else AGAINST) / (1.0 + abs(b)) ** 2
    in_teeth = IN_TEETH / (1.0 + abs(b - a * teeth_per_ball)) ** 2
    return float(DECAY**a * (along + in_teeth))
