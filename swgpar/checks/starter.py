"""A design to start from: all sizes of a drive from its ratio, its diameter or bore, its torque and
kinds of curves.

What is given is kept. All else follows from rules of proportion, those of the designs in
`drivers/catalogue`: sizes of the blank over the pitch diameter D, sizes of the teeth over the
module. The backlash is the smallest of a list with which the undeformed flanks clear each other,
and the teeth of a dynamic spline are the thickest of a list.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from swgpar.checks.design_file import make_drive
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS
from swgpar.errors import InputError
from swgpar.geometry.bracketed_root import root_between
from swgpar.geometry.cams import make_cam, taut_length
from swgpar.geometry.cams.keys import Harmonic, Parabolic, Simplified
from swgpar.input.arguments import require_choice, require_number
from swgpar.input.quantities import show
from swgpar.input.require import require, require_available
from swgpar.input.toml_file import with_value
from swgpar.profiles.keys import DoubleArc, ProfileKeys, QuadrupleArc, RackInvolute

Profile = Literal["quadruple_arc", "double_arc", "involute"]
"""Kinds of profiles of a starter design."""

CamType = Literal["elliptical", "parabolic", "simplified", "four_roller", "harmonic"]
"""Kinds of cams of a starter design."""

Model = Literal["cup", "plane", "pancake"]
"""Kinds of drives of a starter design."""

Layout = Literal["ring_fixed", "spline_fixed"]
"""Layouts of which the ratio gives the numbers of teeth."""

Lobes = Literal[2, 3]
"""Lobes of the cam of a starter design."""

Shape = Literal["cup", "short", "hat"]
"""Shapes of the flexible spline: a usual cup, one of half the length, a silk hat with a flange
outwards."""

LEAST_RATIO, LARGEST_RATIO = 15.0, 320.0
"""Ratios for which the rules give a drive that can be built and meshed."""

RING_RIM = 0.04
FACE_WIDTH = 0.17
LENGTH = 0.5
FILLET = 0.02
BORE, HUB = 0.17, 0.30
"""Over the pitch diameter: rim of the ring gear, face width, length, fillet, bore radius and radius
of the clamped hub of the cup."""

SHORT_LENGTH = 0.25
FLANGE, FLANGE_THICKNESS, CLAMPED_FLANGE = 0.68, 0.016, 0.60
"""Over the pitch diameter: length of a short cup, radius and thickness of the flange of a silk hat,
radius from which it is clamped."""

RING_RIM_MODULES = 8.0
"""Largest rim of the ring gear, modules: a thicker one behaves alike."""


ADDENDUM, DEDENDUM = 0.6, 0.8
"""Of both gears, modules."""

RIM, PRESSURE_ANGLE = {2: 0.012, 3: 0.006}, {2: 20.0, 3: 14.0}
"""By lobes: rim of the flexible spline over the pitch diameter, pressure angle in degrees. Three
lobes lead a tooth on a path that is 1.5 times as steep, and bend the rim four times as much on the
same module."""

PLAY = (0.005, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2)
"""Backlash that is tried: share of the tooth's thickness (1 - c_P of the ring gear), or its profile
shift."""

LEAST_CLEARANCE = 0.0005
"""Between the undeformed flanks, modules."""

GAP = 0.05
"""Between the ring gears of a pancake drive, over its face width."""

PROFILE_KEYS: dict[Profile, type[ProfileKeys]] = {
    "quadruple_arc": QuadrupleArc,
    "double_arc": DoubleArc,
    "involute": RackInvolute,
}
"""Their typical lengths are those of a starter design."""

DYNAMIC_RADII = {
    "r_tip": 0.2,
    "r_addendum": 3.0,
    "straight_l": 0.2,
    "r_dedendum": 3.0,
    "r_root": 0.3,
}
"""Modules. Thin teeth need straighter flanks than those of the ring gear, or their tips end in a
point."""

DYNAMIC_THICKNESS = tuple(0.01 * percent for percent in range(80, 54, -2))
"""c_P of the dynamic spline that is tried: its slots leave room for the motion of the teeth to both
sides."""

LEAST_DYNAMIC_CLEARANCE = 0.01
"""Between the undeformed flanks of the dynamic spline and the flexible spline, modules."""

PANCAKE_CROWNING = 0.05
"""Of the cam of a pancake drive, modules. Its flexible spline has no cone, so that there is no
slope."""

CROWNING, SLOPE, FLANK_CROWNING = 0.1, 0.09, 0.045
"""Micro-geometry of the reference drive (Table 7.4), modules."""

CUTTER_TEETH = 2.0 / 3.0
"""Teeth of the shaper-cutter over those of the ring gear, as in section 6.3."""


@dataclass(frozen=True)
class Request:
    """What a starter design is made from.

    ratio : wave generator over output, without its sign;  torque : N·m, on the output
    diameter : mm, pitch diameter of the flexible spline;  bore : mm, its inner diameter. One of
    both is given.
    """

    ratio: float
    torque: float
    diameter: float | None = None
    bore: float | None = None
    profile: Profile = "quadruple_arc"
    cam: CamType = "elliptical"
    layout: Layout = "ring_fixed"
    model: Model = "cup"
    shape: Shape = "cup"
    lobes: Lobes = 2


CHOICES = {
    "profile": Profile,
    "cam": CamType,
    "layout": Layout,
    "model": Model,
    "shape": Shape,
    "lobes": Lobes,
}
"""Attributes of a `Request` that are one of several -> their types."""


def starter_design(request: Request) -> tuple[DriveDesign, dict[str, Any]]:
    """The checked design of a request, and the content of its file.

    Raises
    ------
    InputError
        A value that is out of range.
    """
    _check(request)
    refusal: InputError | None = None
    built = False
    for play in PLAY:
        table = _table(request, play)
        try:
            design = make_drive(table)
        except InputError as error:  # thinner teeth than their arcs allow
            refusal = refusal or error
            continue
        built = True
        if design.rigid_teeth().clearance() > LEAST_CLEARANCE * design.drive.module:
            return (design, table) if design.dynamic_spline is None else _thin_teeth(table)
    if refusal is not None and not built:
        raise refusal
    raise InputError(
        f"ratio = {request.ratio:g} with profile = {request.profile} and cam = {request.cam} "
        "leaves no clearance between the flanks: allowed are other ratios, profiles or cams"
    )


def _thin_teeth(table: dict[str, Any]) -> tuple[DriveDesign, dict[str, Any]]:
    """The pancake drive with the thickest teeth of the dynamic spline that clear those of the
    flexible spline."""
    for c_P in DYNAMIC_THICKNESS:
        thinner = with_value(table, "dynamic_spline.c_P", _rounded(c_P))
        design = make_drive(thinner)
        if (
            design.rigid_teeth("dynamic_spline").clearance()
            > LEAST_DYNAMIC_CLEARANCE * design.drive.module
        ):
            return design, thinner
    teeth = table["drive"]["teeth_fs"]
    raise InputError(
        f"teeth_fs = {teeth} leaves no clearance in the dynamic spline: allowed are other ratios "
        f"or profiles"
    )


def _check(request: Request) -> None:
    """Refuse numbers from which no drive can be made, and names that no parser has refused."""
    for name, kind in CHOICES.items():
        require_choice(name, getattr(request, name), get_args(kind))
    for name in ("ratio", "torque", "diameter", "bore"):
        if getattr(request, name) is not None or name in ("ratio", "torque"):
            require_number(name, getattr(request, name))
    model, shape, lobes = (
        f"{key} = {show(getattr(request, key))}" for key in ("model", "shape", "lobes")
    )
    require_available("cup" in (request.shape, request.model), shape, model, '"cup"')
    for name, unit in (("torque", "N·m"), ("diameter", "mm"), ("bore", "mm")):
        value = getattr(request, name)
        require(value is None or 0.0 < value < np.inf, name, value, f"above 0 {unit}")
    if (request.diameter is None) == (request.bore is None):
        raise InputError(
            "give either diameter (pitch diameter of the flexible spline, mm) or bore (its inner "
            "diameter)"
        )
    require_available(request.lobes == 2 or request.model != "pancake", lobes, model, "2")
    fits = request.lobes == 2 or request.cam == "harmonic"
    require_available(fits, lobes, f'cam = "{request.cam}"', 'with "harmonic"')
    step = 0.5 if request.lobes == 2 else 1.0
    require(
        LEAST_RATIO <= request.ratio <= LARGEST_RATIO and request.ratio % step == 0.0,
        "ratio",
        request.ratio,
        f"{LEAST_RATIO:g} to {LARGEST_RATIO:g} in steps of {step:g}",
    )


def _rounded(value: float, digits: int = 4) -> float:
    return float(f"{value:.{digits}g}")


def _table(request: Request, play: float) -> dict[str, Any]:
    """Content of the design file with a backlash."""
    lobes = request.lobes
    teeth = round(lobes * request.ratio) - (0 if request.layout == "ring_fixed" else lobes)
    if request.diameter is not None:
        module = request.diameter / teeth
    else:
        assert request.bore is not None  # one of both is given
        # the inner radius is the pitch radius less dedendum and rim
        module = 0.5 * request.bore / ((0.5 - RIM[lobes]) * teeth - DEDENDUM)
    module = _rounded(module, 6)
    pitch = module * teeth
    width = _rounded(FACE_WIDTH * pitch, 3)
    table: dict[str, Any] = {
        "drive": {
            "model": request.model,
            "layout": request.layout,
            "teeth_fs": teeth,
            "teeth_rg": teeth + lobes,
            "module": module,
            "pressure_angle": PRESSURE_ANGLE[lobes],
            "addendum_coef": ADDENDUM,
            "dedendum_coef": DEDENDUM,
            "face_width": width,
        },
        **{gear: _gear(request, gear, module, teeth, play) for gear in GEARS},
        "wave_generator": {
            "type": request.cam,
            **({"lobes": 3} if lobes == 3 else {}),
            "face_width": width,
        },
    }
    if request.model == "cup":
        length = SHORT_LENGTH if request.shape == "short" else LENGTH
        table["cup"] = {
            "length": _rounded(length * pitch),
            "thickness_coef": 0.667,
            "fillet_radius": _rounded(FILLET * pitch),
            **_end(request.shape, pitch),
        }
        # the cone of the deflected wall is steeper the shorter the wall is
        cone = (LENGTH + 0.5 * FACE_WIDTH) / (length + 0.5 * FACE_WIDTH)
        micro = {"wg_crowning": CROWNING, "wg_slope": SLOPE * cone, "fs_crowning": FLANK_CROWNING}
        table["micro_geometry"] = {name: _rounded(value * module) for name, value in micro.items()}
    if request.model == "pancake":
        table["dynamic_spline"] = _dynamic_spline(table, module)
        table["micro_geometry"] = {"wg_crowning": _rounded(PANCAKE_CROWNING * module)}
    table["material"] = {"E": 210e3, "nu": 0.29}
    table["load"] = {"torque": request.torque}
    table["rating"] = {"rated_torque": request.torque}
    table["wave_generator"] |= _cam_keys(request.cam, table)
    return table


def _end(shape: Shape, pitch: float) -> dict[str, Any]:
    """Keys of the closed end or flange. pitch : mm, pitch diameter"""
    if shape != "hat":
        return {"inner_radius": _rounded(BORE * pitch), **_clamped(HUB * pitch)}
    flange = {
        "flange_radius": _rounded(FLANGE * pitch),
        "end_thickness": _rounded(FLANGE_THICKNESS * pitch),
    }
    return {"shape": "hat", **flange, **_clamped(CLAMPED_FLANGE * pitch)}


def _clamped(radius: float) -> dict[str, Any]:
    """Keys of a hub or flange that is clamped: a bare edge bends, and halves the stiffness."""
    return {"attachment": "clamped", "clamping_radius": _rounded(radius)}


def _dynamic_spline(table: dict[str, Any], module: float) -> dict[str, Any]:
    """Section of the second ring gear of a pancake drive, with its thickest teeth."""
    radii = {name: _rounded(value * module) for name, value in DYNAMIC_RADII.items()}
    return {
        "rim": table["ring_gear"]["rim"],
        "c_P": DYNAMIC_THICKNESS[0],
        "gap": _rounded(GAP * table["drive"]["face_width"], 2),
        "profile": {"type": "quadruple_arc", **radii},
    }


def _gear(request: Request, gear: str, module: float, teeth: int, play: float) -> dict[str, Any]:
    """Section of a gear; the ring gear has the backlash."""
    profile, pitch, ring = request.profile, module * teeth, gear == "ring_gear"
    rim = min(RING_RIM * pitch, RING_RIM_MODULES * module) if ring else RIM[request.lobes] * pitch
    radii = {
        name: _rounded(value * module)
        for name, value in PROFILE_KEYS[profile].typical_lengths.items()
    }
    section: dict[str, Any] = {"rim": _rounded(rim)}
    if profile == "involute":
        if ring:
            radii |= {
                "shift": play,
                "cutter_teeth": 2 * round(0.5 * CUTTER_TEETH * (teeth + request.lobes)),
            }
        return {**section, "profile": {"type": profile, **radii}}
    section["c_P"] = _rounded(1.0 - play) if ring else 1.0
    section["c_l"] = 0.0 if profile == "double_arc" else 0.5
    return {**section, "profile": {"type": profile, **radii}}


def _cam_keys(cam: CamType, table: dict[str, Any]) -> dict[str, float]:
    """Keys of the cam that are not common to all."""
    if cam == "elliptical":
        return {"C": 1.0}
    module, teeth = table["drive"]["module"], table["drive"]["teeth_fs"]
    inner = (0.5 * teeth - DEDENDUM) * module - table["flexible_spline"]["rim"]
    lobes = table["drive"]["teeth_rg"] - teeth
    major, minor = inner + 0.5 * lobes * module, inner - 0.5 * lobes * module
    if cam == "four_roller":
        return {
            "beta": 10.0,
            "r_4": _rounded(0.135 * major),
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
        return {"C": _rounded(fitting(lambda C: Simplified(C=C, face_width=1.0), 0.5, 1.0))}
    if cam == "harmonic":
        fit = fitting(lambda C: Harmonic(C=C, lobes=lobes, face_width=1.0), 0.5, 1.0)
        return {"C": _rounded(fit, 6)}
    C_p, r_c = 0.51, _rounded(0.175 * minor)  # that of the improved cam of Table 5.5
    ellipse = 0.5 * major / minor**2
    a_p = fitting(
        lambda a_p: Parabolic(a_p=a_p, C_p=C_p, r_c=r_c, face_width=1.0), ellipse, 1.08 * ellipse
    )
    return {"C": 1.0, "a_p": _rounded(a_p, 5), "C_p": C_p, "r_c": r_c}
