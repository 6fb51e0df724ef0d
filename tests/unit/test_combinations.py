"""Every profile with every cam, chosen in a design file, passes `swgpar check`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from swgpar import load_design
from swgpar.cli import main

DOUBLE_ARC = {"type": "double_arc", "r_addendum": 1.0, "r_dedendum": 0.6}
INVOLUTE = {"type": "involute", "cutter_radius": 0.2}
TRAPEZOID = {"type": "trapezoid", "r_root": 0.2}
COMMON_TANGENT = {
    "type": "common_tangent",
    "r_addendum": 1.0,
    "c_addendum": 0.22,
    "e_addendum": 0.14,
    "r_dedendum": 1.3,
    "c_dedendum": 0.51,
    "e_dedendum": 0.24,
    "r_root": 0.3,
}
S_SHAPED = {"type": "s_shaped", "r_root": 0.25, "deflection": 1.0}
CYCLOID = {"type": "cycloid", "r_epicycloid": 1.0, "r_hypocycloid": 1.0, "r_root": 0.2}
QUADRUPLE_ARC = {"r_tip": 0.5, "r_addendum": 1.0, "r_dedendum": 20.0, "r_root": 0.6}
PROFILES = {
    "quadruple_arc": (QUADRUPLE_ARC, QUADRUPLE_ARC, 0.95, 0.5),
    "double_arc": (DOUBLE_ARC, DOUBLE_ARC, 0.95, 0.0),
    "trapezoid": (TRAPEZOID, TRAPEZOID, 0.9, 0.5),
    "common_tangent": (COMMON_TANGENT, COMMON_TANGENT, 0.9, 0.5),
    "s_shaped": (S_SHAPED, S_SHAPED, 0.9, 0.5),
    "cycloid": (CYCLOID, CYCLOID, 0.9, 0.5),
    "involute": (INVOLUTE, {**INVOLUTE, "cutter_teeth": 80, "shift": 0.1}, 1.0, 0.5),
}
SIDE = {"a_p": 0.0097, "C_p": 0.51, "r_c": 10.0}
CAMS = {
    "elliptical": {},
    "harmonic": {},
    "simplified": {"C": 0.97},
    "arcs": {"beta": 45.0},
    "parabolic": SIDE,
    "asymmetric_parabolic": {"rotational_angle": 0.5, "right": SIDE, "left": {**SIDE, "r_c": 12.0}},
    "four_roller": {"beta": 10.0, "r_4": 8.0},
    "two_roller": {"r_2": 20.0},
    "polar": {"radius": "a - (a - b) * sin(theta)**2"},
    "points": {
        "coordinates": "polar",
        "points": [[5.0 * k, 58.2 + np.cos(np.radians(10.0 * k))] for k in range(19)],
    },
}


@pytest.mark.parametrize("cam", CAMS)
@pytest.mark.parametrize("profile", PROFILES)
def test_check(
    profile: str, cam: str, design_file: Callable, capsys: pytest.CaptureFixture
) -> None:
    spline, ring, c_P, c_l = PROFILES[profile]
    path = design_file(
        {
            "flexible_spline": {"rim": 1.0, "c_l": c_l, "profile": spline},
            "ring_gear": {"rim": 2.0, "c_P": c_P, "c_l": c_l, "profile": ring},
            "wave_generator": {"type": cam, "face_width": 10.0, **CAMS[cam]},
        }
    )
    assert main(["check", str(path)]) == 0
    lines = [
        line for line in capsys.readouterr().out.splitlines() if not line.startswith("warning:")
    ]
    values = {line[:-12].strip(): float(line.split()[-1]) for line in lines}
    assert all(np.isfinite(value) for value in values.values())
    design = load_design(path)
    assert (design.wave_generator.type, design.flexible_spline.profile.type) == (cam, profile)
    tip = design.cam().evaluate(np.array([[0.0, design.major_semi_axis]]))[0]
    # between the rollers there is no tip: their centres are 10 degrees and a - r_4 away
    gap = (
        np.hypot(
            design.major_semi_axis - 51.2 * np.cos(np.radians(10)), 51.2 * np.sin(np.radians(10))
        )
        - 8.0
    )
    assert tip == pytest.approx(gap if cam == "four_roller" else 0.0, abs=1e-12)
