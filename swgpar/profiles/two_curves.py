"""Flanks of two curves, convex above and concave below, that meet near the pitch circle.

Curves of rolling circles have no radius of curvature where they meet: it is zero there. A cubic
takes their place from `GAP` above to `GAP` below. Its ends have the curves' points and tangents.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from swgpar.geometry.arrays import Complex, Floats
from swgpar.profiles.curved_segment import CurvedSegment, CurvePoints, points_of
from swgpar.profiles.fitted_curve import fitted
from swgpar.profiles.flank import ToothProfile
from swgpar.profiles.teeth import Teeth

GAP = 0.01
"""Height over the module, from where the curves meet, in which the cubic is."""

Derivatives = tuple[Complex, Complex, Complex]
"""Points x + i y (n,), mm, of a curve, and their first and second derivatives by its parameter."""


def two_curves(
    convex: Callable[[Floats], Derivatives],
    concave: Callable[[Floats], Derivatives],
    upper: tuple[float, float],
    lower: tuple[float, float],
    teeth: Teeth,
) -> ToothProfile:
    """Curve from tip to root, beyond the circles or up to where the curves end.

    convex, concave : curves by parameters (n,) that grow away from where they meet
    upper, lower : parameters of the convex and of the concave curve, near where they meet and at
        their other ends
    """
    above, below = (
        _along(convex, upper[1], upper[0], "face"),
        _along(concave, lower[0], lower[1], "flank"),
    )
    tip, root = teeth.r_tip_circle, teeth.r_root_circle
    segments = (above, _cubic(above, below), below)
    return ToothProfile(segments, teeth.external, tip, root, teeth.n_teeth)


def _along(
    curve: Callable[[Floats], Derivatives], begin: float, end: float, name: str
) -> CurvedSegment:
    """The curve between two parameters."""
    span = end - begin

    def evaluate(t: Floats) -> CurvePoints:
        z, first, second = curve(begin + span * t)
        return points_of(z, span * first, span**2 * second)

    return fitted(CurvedSegment(name, evaluate))


def _cubic(above: CurvedSegment, below: CurvedSegment) -> CurvedSegment:
    """Curve between both, linear along its chord."""
    ends = above.evaluate(np.ones(1)), below.evaluate(np.zeros(1))
    start, end = (complex(*each.point[0]) for each in ends)
    chord = end - start
    tangents = [complex(np.exp(1j * each.angle[0])) for each in ends]
    first, last = (t * abs(chord) ** 2 / (np.conj(chord) * t).real for t in tangents)
    square, cube = 3.0 * chord - 2.0 * first - last, first + last - 2.0 * chord

    def evaluate(t: Floats) -> CurvePoints:
        return points_of(
            start + t * (first + t * (square + t * cube)),
            first + t * (2.0 * square + 3.0 * t * cube),
            2.0 * square + 6.0 * t * cube,
        )

    return CurvedSegment("middle", evaluate)
