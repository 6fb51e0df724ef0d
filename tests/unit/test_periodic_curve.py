"""Curves through the samples of a period, against SciPy's."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from swgpar.results.periodic_curve import periodic_curve


@pytest.mark.parametrize("count", [1, 2, 3, 6, 40])
def test_curve_is_the_periodic_spline(count):
    draw = np.random.default_rng(count)
    knots = 7.0 + np.cumsum(draw.uniform(0.2, 1.0, count + 1))
    values = draw.normal(size=count + 1)
    values[-1] = values[0]
    at = np.linspace(knots[0], knots[-1], 201)
    expected = CubicSpline(knots, values, bc_type="periodic")(at)
    np.testing.assert_allclose(periodic_curve(knots, values, at), expected, rtol=0.0, atol=1e-12)
