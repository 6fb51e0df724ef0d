"""Exact flanks of the ring gear between the nodes of their profile.

Between two nodes the contact has the cubic through the exact points and tangents, and what the
exact flank has above it. A cubic alone is 0.15 micrometres off the flank of a conjugate ring gear
with six elements where its curvature changes: with flanks that nearly conform as much as a third of
the force of a pair (docs/verification/error_sources_plane.md).
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.chebyshev import chebpts1

from swgpar.profiles.flank import ToothProfile

TERMS = 4
"""Coefficients of an element, of t²(1 − t)² times a cubic in t − 1/2; the kernel has as many."""

POINTS = 24
"""Points of an element at which they are fitted to the exact flank."""

PLACES = 0.5 + 0.5 * chebpts1(POINTS)
"""Of these points, as shares of the element: Chebyshev points."""

FITTED = np.linalg.pinv(
    (PLACES * (1.0 - PLACES))[:, None] ** 2 * np.vander(PLACES - 0.5, TERMS, increasing=True)
)
"""Coefficients (`TERMS`, `POINTS`) by least squares of values at these points."""


def above_cubics(profile: ToothProfile, s: np.ndarray) -> np.ndarray:
    """What the exact profile has above the cubics through its points and tangents at s (n,) mm:
    coefficients (n - 1, `TERMS`, 2) mm, by least squares.

    t is the share of the arc length between two nodes. Value and slope are zero at both. Elements
    with a joint of the profile inside, as of meshes with fewer elements than segments, have none:
    no polynomial has a curvature that jumps.
    """
    t, length = PLACES[:, None], np.diff(s)[:, None, None]
    point, tangent = profile.point(s), profile.tangent(s)
    begin, end = point[:-1, None], point[1:, None]
    cubic = (1.0 - 3.0 * t**2 + 2.0 * t**3) * begin + (3.0 * t**2 - 2.0 * t**3) * end
    cubic = cubic + (t - 2.0 * t**2 + t**3) * length * tangent[:-1, None]
    cubic = cubic + (t**3 - t**2) * length * tangent[1:, None]
    between = s[:-1, None] + np.diff(s)[:, None] * PLACES
    exact = profile.point(between.ravel()).reshape(*between.shape, 2)
    smooth = ~has_a_joint(profile, s)[:, None, None]
    return np.einsum("kq,iqd->ikd", FITTED, (exact - cubic) * smooth)


def has_a_joint(profile: ToothProfile, s: np.ndarray) -> np.ndarray:
    """Whether a joint of the profile lies inside of the elements between s (n,) mm, (n - 1,)."""
    margin = 1e-9 * (s[-1] - s[0])
    after, before = s[:-1, None] + margin, s[1:, None] - margin
    return ((profile.breaks > after) & (profile.breaks < before)).any(axis=1)
