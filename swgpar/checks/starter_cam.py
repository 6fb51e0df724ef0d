"""Keys of the cam of a starter design."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from swgpar.geometry.bracketed_root import root_between
from swgpar.geometry.cams import make_cam, taut_length
from swgpar.geometry.cams.keys import Harmonic, Parabolic, Simplified

CamType = Literal["elliptical", "parabolic", "simplified", "four_roller", "harmonic"]
"""Kinds of cams of a starter design."""


def rounded(value: float, digits: int = 4) -> float:
    """A number with as many digits as a file of a starter design has."""
    return float(f"{value:.{digits}g}")


def cam_keys(cam: CamType, inner: float, module: float, lobes: int) -> dict[str, float]:
    """Keys of the cam that are not common to all.

    inner : mm, inner radius of the flexible spline;  module : mm
    """
    if cam == "elliptical":
        return {"C": 1.0}
    major, minor = inner + 0.5 * lobes * module, inner - 0.5 * lobes * module
    if cam == "four_roller":
        return {
            "beta": 10.0,
            "r_4": rounded(0.135 * major),
        }  # 8 mm on the reference drive (section 5.5)

    def excess(keys: Simplified | Harmonic | Parabolic) -> float:
        C = 1.0 if isinstance(keys, Parabolic) else keys.C
        return taut_length(make_cam(keys, major, C * minor), 720) / (2.0 * np.pi * inner) - 1.0

    def fitting(
        keys: Callable[[float], Simplified | Harmonic | Parabolic], low: float, high: float
    ) -> float:
        """The value of a key with which the band around the cam is as long as the spline's inner
        circumference."""
        return root_between(lambda value: excess(keys(value)), low, high, xtol=1e-8)

    if cam == "simplified":
        return {"C": rounded(fitting(lambda C: Simplified(C=C, face_width=1.0), 0.5, 1.0))}
    if cam == "harmonic":
        fit = fitting(lambda C: Harmonic(C=C, lobes=lobes, face_width=1.0), 0.5, 1.0)
        return {"C": rounded(fit, 6)}
    C_p, r_c = 0.51, rounded(0.175 * minor)  # that of the improved cam of Table 5.5
    ellipse = 0.5 * major / minor**2
    a_p = fitting(
        lambda a_p: Parabolic(a_p=a_p, C_p=C_p, r_c=r_c, face_width=1.0), ellipse, 1.08 * ellipse
    )
    return {"C": 1.0, "a_p": rounded(a_p, 5), "C_p": C_p, "r_c": r_c}
