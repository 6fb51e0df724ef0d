"""Whether a flank is smooth: differences of points give tangents, the root is tangent to its
circle."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from swgpar.profiles import ToothProfile
from swgpar.profiles.flank import check_flank


def is_smooth(flank: ToothProfile) -> None:
    """Differences of points are tangents, segments join, the root is tangent to its circle."""
    check_flank(flank)
    for begin, end in pairwise(flank.breaks):
        h = min(1e-6, 0.01 * (end - begin))
        s = np.linspace(begin, end, 9)[1:-1]
        along = (flank.point(s + h) - flank.point(s - h)) / (2.0 * h)
        assert along == pytest.approx(flank.tangent(s), abs=1e-7)
        bend = (flank.tangent(s + h) - flank.tangent(s - h)) / (2.0 * h)
        curvature = np.einsum("ij,ij->i", bend, flank.normal(s))
        assert curvature == pytest.approx(flank.curvature(s), rel=1e-4, abs=1e-5)
    end = flank.length
    assert abs(flank.tangent(end)[0] @ flank.point(end)[0]) < 1e-9 * flank.r_root_circle
