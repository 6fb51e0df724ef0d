"""Torques that starter designs carry, by ratio: those with which a rating passes.

Drives of one ratio are similar, so that their stresses depend on the torque over the third power of
the diameter alone. docs/verification/starter.md has the runs behind the numbers, and the command.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from swgpar.checks.starter import Request, usual_profile
from swgpar.design.drive_design import DriveDesign

CARRIED = {30.0: 0.04, 40.0: 0.064, 50.0: 0.14, 80.0: 0.112, 100.0: 0.1, 160.0: 0.096}
"""Ratio -> torque over the third power of the pitch diameter, N/mm². Cups with the default teeth,
cam and bearing, ring gear fixed; the strengths are those that their files have. Linear between
ratios."""

DIGITS = 3
"""Digits of torques and diameters in sentences."""

ROUNDING = 1e-3
"""Share by which a torque may be larger than the one that is carried: the module of a design has
four digits, and the torque goes with its third power."""


def carried_torque(request: Request, design: DriveDesign) -> float | None:
    """The torque (N·m) that the start of a request carries; None where it has not been computed.

    design : of the request
    """
    usual = Request(request.ratio, request.torque, profile=usual_profile("cup", "elliptical", 2))
    if replace(request, diameter=None, bore=None) != usual or not min(
        CARRIED
    ) <= request.ratio <= max(CARRIED):
        return None
    share = float(np.interp(request.ratio, list(CARRIED), list(CARRIED.values())))
    return 1e-3 * share * pitch_diameter(design) ** 3 * (1.0 + ROUNDING)


def pitch_diameter(design: DriveDesign) -> float:
    """Pitch diameter (mm) of the flexible spline."""
    return design.drive.module * design.drive.teeth_fs


def overload(request: Request, design: DriveDesign) -> str:
    """What is to know of a torque that is more than the start carries; empty where it is not, or
    where that has not been computed."""
    carried = carried_torque(request, design)
    if carried is None or request.torque <= carried:
        return ""
    needed = pitch_diameter(design) * (request.torque / carried) ** (1.0 / 3.0)
    most, least = _rounded(carried, np.floor), _rounded(needed, np.ceil)
    return (
        f"torque = {request.torque:g} N·m is more than this start carries: allowed by its rating "
        f"up to {most:g} N·m, or {request.torque:g} N·m with a pitch diameter of {least:g} mm"
    )


def torque_text(request: Request, design: DriveDesign) -> str:
    """What the head of the file says of the torque that the start carries."""
    carried = carried_torque(request, design)
    if carried is None:
        return "The torque that this start carries has not been computed: swgpar rate judges it."
    most = _rounded(carried, np.floor)
    return overload(request, design) or f"It carries up to {most:g} N·m."


def _rounded(value: float, to: np.ufunc) -> float:
    """The value rounded to `DIGITS` digits. to : down or up"""
    unit = 10.0 ** (int(np.floor(np.log10(value))) + 1 - DIGITS)
    return float(to(value / unit) * unit)
