"""Teeth of a starter design: heights, rims and profiles of both gears.

All sizes are in modules and follow from the number of teeth: drives of one ratio are similar.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from swgpar.checks.starter_cam import rounded
from swgpar.profiles.keys import DoubleArc, ProfileKeys, QuadrupleArc, RackInvolute

Profile = Literal["s_shaped", "quadruple_arc", "double_arc", "involute"]
"""Kinds of profiles of a starter design. The ring gear of S-shaped teeth is conjugate to them."""

PROFILE_KEYS: dict[Profile, type[ProfileKeys]] = {
    "quadruple_arc": QuadrupleArc,
    "double_arc": DoubleArc,
    "involute": RackInvolute,
}
"""Their typical lengths are those of a starter design."""

ADDENDUM, DEDENDUM = 0.6, 0.8
"""Of both gears, modules."""

CONED_ADDENDUM, CONED_DEDENDUM = 0.55, 0.66
"""Of both gears with S-shaped teeth on a cone, modules: at mid-width a cup is deflected by less
than the distance of the pitch circles, and the path of a tooth is lower."""

RIM = {2: 0.012, 3: 0.006}
"""By lobes: largest rim of the flexible spline over the pitch diameter. Three lobes bend the rim
four times as much on the same module."""

BENDING = 7.2e-4
"""Strain by which the wave generator bends the rim below S-shaped teeth of two lobes, if it had no
teeth, where `BENT_TEETH` is the number of teeth. Fewer teeth have a strain in proportion to their
number: bending of a rim that is thin against its teeth is concentrated between them."""

BENT_TEETH = 100

LEAST_RIM, RIM_OF_HEIGHT = 0.25, 0.35
"""Least rim below S-shaped teeth, in modules, and over their height: they are lower on a thin
rim."""

RING_RIM, RING_RIM_MODULES = 0.04, 8.0
"""Rim of the ring gear over the pitch diameter, and the largest in modules: a thicker one behaves
alike."""

S_SHAPED = {"r_tip": 0.15, "r_root": 0.35}
CONJUGATE = {"r_tip": 0.15, "r_root": 0.2, "backlash": 0.005}
TIP_RELIEF, RELIEVED_TEETH, MOST_TEETH, TIP_RELIEF_HEIGHT = 0.02, 100, 320, 0.5
"""S-shaped teeth and the ring gear conjugate to them, modules: radii, backlash, and relief of both
tips, which would else carry where pairs come into mesh and leave it. The relief is that of so many
teeth of the flexible spline, and grows with the third root of their number up to the most: loads
of one torque over D³ bend more teeth by more modules."""

CROWNING = 0.04
"""Crowning of S-shaped flanks in a usual cup, modules, in proportion to its cone. The ring gear is
conjugate at mid-width. The cone tilts the flanks most near the major axis: with this crowning
contacts there end within the face width."""

CLOSE_TEETH, CLOSE_CROWNING, CLOSE_RELIEF = (60, 80, 100), 1.5, 1.38
"""Around 80 teeth high teeth on a thin rim touch at the ends of the face width and at their tips:
there crowning and relief of S-shaped flanks are larger by these factors, linear to none at the
least and the most teeth (docs/verification/starter.md)."""

CUTTER_TEETH = 2.0 / 3.0
"""Teeth of the shaper-cutter over those of the ring gear, as in section 6.3."""


@dataclass(frozen=True)
class ToothSizes:
    """Sizes of the flexible spline, modules.

    scale : heights over those of thick rims
    tip_relief : of S-shaped teeth, whatever the scale: a load bends low teeth as much
    crowning : of S-shaped flanks in a usual cup
    """

    rim: float
    addendum: float
    dedendum: float
    scale: float
    tip_relief: float = 0.0
    crowning: float = 0.0

    @property
    def below_pitch_circle(self) -> float:
        """Distance of the inner surface from the pitch circle."""
        return self.dedendum + self.rim


def tooth_sizes(profile: Profile, lobes: Literal[2, 3], teeth: int, *, coned: bool) -> ToothSizes:
    """Heights of the teeth and rim below them, by the number of teeth of the flexible spline.

    coned : whether the deflection at mid-width is below the distance of the pitch circles

    The curvature of n lobes with the deflection w0 = n m / 2 on the pitch radius r is
    (n^2 - 1) w0 / r^2. Half of the rim's thickness times that is the strain of `BENDING`.
    """
    largest = RIM[lobes] * teeth
    if profile != "s_shaped":
        return ToothSizes(largest, ADDENDUM, DEDENDUM, 1.0)
    strain = BENDING * min(1.0, teeth / BENT_TEETH)
    bent = strain * teeth**2 / (lobes * (lobes**2 - 1))
    rim = min(largest, max(bent, LEAST_RIM))
    addendum, dedendum = (CONED_ADDENDUM, CONED_DEDENDUM) if coned else (ADDENDUM, DEDENDUM)
    lower = min(1.0, rim / (RIM_OF_HEIGHT * (addendum + dedendum)))
    relief = TIP_RELIEF * (min(teeth, MOST_TEETH) / RELIEVED_TEETH) ** (1.0 / 3.0)
    heights = rounded(lower * addendum, 3), rounded(lower * dedendum, 3)
    return ToothSizes(
        rim,
        *heights,
        lower,
        relief * _around_80(teeth, CLOSE_RELIEF),
        CROWNING * _around_80(teeth, CLOSE_CROWNING),
    )


def _around_80(teeth: int, factor: float) -> float:
    """The factor for a number of teeth, by that of the middle of `CLOSE_TEETH`."""
    return float(np.interp(teeth, CLOSE_TEETH, (1.0, factor, 1.0)))


def spline_section(profile: Profile, sizes: ToothSizes, module: float) -> dict[str, Any]:
    """Section [flexible_spline]. module : mm"""
    section: dict[str, Any] = {"rim": rounded(sizes.rim * module)}
    if profile == "s_shaped":
        keys = {"type": "s_shaped"} | _lengths(S_SHAPED, sizes.scale * module)
        return section | _relief(sizes, module) | {"profile": keys}
    return section | _thickness(profile, 1.0) | {"profile": _typical(profile, module)}


def ring_section(
    profile: Profile, sizes: ToothSizes, module: float, teeth: int, play: float
) -> dict[str, Any]:
    """Section [ring_gear], which has the backlash.

    sizes : of the flexible spline;  module : mm;  teeth : of the ring gear
    play : share of the tooth's thickness, or profile shift; not for S-shaped teeth
    """
    rim = min(RING_RIM * teeth, RING_RIM_MODULES)
    section: dict[str, Any] = {"rim": rounded(rim * module)}
    if profile == "s_shaped":
        keys = {"type": "conjugate"} | _lengths(CONJUGATE, sizes.scale * module)
        return section | _relief(sizes, module) | {"profile": keys}
    keys = _typical(profile, module)
    if profile == "involute":
        keys |= {"shift": play, "cutter_teeth": 2 * round(0.5 * CUTTER_TEETH * teeth)}
    return section | _thickness(profile, rounded(1.0 - play)) | {"profile": keys}


def _lengths(modules: dict[str, float], module: float) -> dict[str, float]:
    return {name: rounded(value * module) for name, value in modules.items()}


def _relief(sizes: ToothSizes, module: float) -> dict[str, float]:
    return {
        "tip_relief": rounded(sizes.tip_relief * module),
        "tip_relief_height": rounded(TIP_RELIEF_HEIGHT * sizes.scale),
    }


def _typical(profile: Profile, module: float) -> dict[str, Any]:
    lengths = dict(PROFILE_KEYS[profile].typical_lengths)
    return {"type": profile} | _lengths(lengths, module)


def _thickness(profile: Profile, c_P: float) -> dict[str, float]:
    """Keys of the thickness of arcs; involutes have their profile shift."""
    if profile == "involute":
        return {}
    return {"c_P": c_P, "c_l": 0.0 if profile == "double_arc" else 0.5}
