"""Tooth profiles: smooth, closed, and on the circles they must reach."""

from __future__ import annotations

import numpy as np
import pytest

from swgpar.profiles.quadruple_arc import quadruple_arc

IMPROVED = dict(r_tip=0.5, r_addendum=1.0, straight_l=0.0, r_dedendum=20.0, r_root=0.6)
INITIAL = dict(r_tip=0.3, r_addendum=1.0, straight_l=0.2, r_dedendum=2.0, r_root=0.3)


@pytest.mark.parametrize("radii", [IMPROVED, INITIAL])
@pytest.mark.parametrize(("teeth", "external"), [(120, True), (122, False)])
def test_quadruple_arc(teeth: int, external: bool, radii: dict[str, float]) -> None:
    p = quadruple_arc(teeth, 1.0, np.radians(20.0), 0.6, 0.8, 1.0, 0.5, external=external, **radii)
    sign = 1.0 if external else -1.0
    assert np.hypot(*p.point(0.0)[0]) == pytest.approx(0.5 * teeth + 0.6 * sign, abs=1e-12)
    assert np.hypot(*p.point(p.length)[0]) == pytest.approx(0.5 * teeth - 0.8 * sign, abs=1e-12)
    # tangent to both circles
    for s in (0.0, p.length):
        assert abs(p.tangent(s)[0] @ p.point(s)[0]) < 1e-9 * teeth
    # the pitch point: half the pitch's angle at the pitch circle
    s = np.linspace(0.0, p.length, 20001)
    radius = np.hypot(*p.point(s).T)
    at = np.interp(0.5 * teeth, sign * radius[:: -int(sign)] * sign, s[:: -int(sign)])
    assert p.polar_angle(at)[0] == pytest.approx(0.5 * np.pi / teeth, rel=1e-5)
    # differences of points give tangents, of tangents curvatures
    h = 1e-6
    inner = s[(s > 2 * h) & (s < p.length - 2 * h)]
    inner = inner[np.min(np.abs(inner[:, None] - p.breaks), axis=1) > 2 * h]
    assert np.allclose((p.point(inner + h) - p.point(inner - h)) / (2 * h), p.tangent(inner), atol=1e-8)
    bend = np.einsum("ij,ij->i", (p.tangent(inner + h) - p.tangent(inner - h)) / (2 * h), p.normal(inner))
    assert np.allclose(bend, p.curvature(inner), atol=1e-6)
