"""A drive that is drawn at random: sizes, tooth profile, cam, layout, load."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

Case = dict[str, Any]
"""Values of the design file that a case replaces: by "section.key", or by "section" for a whole
one."""

FIRST_CAMS = ("elliptical", "simplified", "parabolic", "four_roller")
CAMS = (*FIRST_CAMS, "asymmetric_parabolic")


def draw(
    rng: np.random.Generator,
    model: str,
    teeth: int | None = None,
    module: float | None = None,
    cams: Sequence[str] = FIRST_CAMS,
) -> Case:
    """A drive at random, without teeth and module also these."""

    def number(low: float, high: float) -> float:
        return round(float(rng.uniform(low, high)), 4)

    def side() -> Case:
        return {"a_p": number(0.4, 0.6) / a, "C_p": number(0.3, 0.55), "r_c": 0.17 * a}

    teeth = 2 * int(rng.integers(10, 60)) if teeth is None else teeth
    module = float(rng.choice([0.3, 0.5, 1.0, 2.0])) if module is None else module
    kind = rng.choice(["quadruple_arc", "double_arc", "involute"], p=[0.6, 0.2, 0.2])
    profile = {
        "quadruple_arc": lambda: {
            "type": "quadruple_arc",
            "r_tip": number(0.2, 0.5) * module,
            "r_addendum": number(0.9, 2.0) * module,
            "straight_l": number(0.0, 0.3) * module,
            "r_dedendum": number(0.8, 20.0) * module,
            "r_root": number(0.2, 0.6) * module,
        },
        "double_arc": lambda: {
            "type": "double_arc",
            "r_addendum": number(0.9, 2.0) * module,
            "r_dedendum": number(0.3, 0.7) * module,
        },
        "involute": lambda: {"type": "involute", "cutter_radius": number(0.1, 0.25) * module},
    }[kind]()
    ring = {**profile, "cutter_teeth": teeth // 2} if kind == "involute" else profile
    width = 10.0 * module
    a = 0.5 * teeth * module
    cam = {
        "elliptical": lambda: {"C": number(0.9, 1.0)},
        "simplified": lambda: {"C": number(0.85, 0.98)},
        "harmonic": lambda: {"C": number(0.9, 1.0)},
        "arcs": lambda: {"C": number(0.95, 1.0), "beta": number(30.0, 60.0)},
        "parabolic": lambda: {"C": 1.0, **side()},
        "four_roller": lambda: {"beta": number(10.0, 25.0), "r_4": number(0.1, 0.16) * a},
        "asymmetric_parabolic": lambda: {
            "C": 1.0,
            "rotational_angle": number(-0.5, 0.5),
            "right": side(),
            "left": side(),
        },
    }
    cam_kind = str(rng.choice(cams))
    wave = {"type": cam_kind, **cam[cam_kind](), "face_width": width}
    c_l = 0.0 if kind == "double_arc" else 0.5
    rim, torque = (
        number(0.5, 1.6) * module * teeth / 120,
        number(0.0, 4.0) * module**3 * teeth / 120,
    )
    cup: Case = {}
    if model == "cup":
        torque *= 10.0
        cup["cup"] = {
            "length": number(0.5, 1.5) * a,
            "thickness_coef": number(0.5, 0.95),
            "fillet_radius": number(1.0, 3.0) * rim,
            "inner_radius": number(0.2, 0.5) * a,
        }
        cup["micro_geometry"] = {
            "wg_crowning": number(0.0, 0.1) * module,
            "wg_slope": number(0.0, 0.1) * module,
            "fs_crowning": number(0.0, 0.05) * module,
        }
    return {
        **cup,
        "drive.model": model,
        "drive.teeth_fs": teeth,
        "drive.teeth_rg": teeth + 2,
        "drive.module": module,
        "drive.face_width": width,
        "drive.layout": str(rng.choice(["ring_fixed", "spline_fixed"])),
        "flexible_spline.rim": rim,
        "ring_gear.rim": 2.0 * module,
        "ring_gear.c_P": 1.0 if kind == "involute" else number(0.85, 1.0),
        "flexible_spline.profile": profile,
        "ring_gear.profile": ring,
        "flexible_spline.c_l": c_l,
        "ring_gear.c_l": c_l,
        "wave_generator": wave,
        "load.torque": torque,
        "contact.friction": float(rng.choice([0.0, 0.0, 0.1, 0.3])),
    }
