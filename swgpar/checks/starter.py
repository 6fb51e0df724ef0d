"""A design to start from: all sizes of a drive from its ratio, its diameter or bore, its torque and
kinds of curves.

What is given is kept. All else follows from rules of proportion after published sections
(docs/howto/own_drive.md has their sources): sizes of the blank over the pitch diameter D, sizes of
the teeth over the module. So drives of one ratio are similar, whatever their size. With arcs and
involutes the backlash is the smallest of a list with which the undeformed flanks clear each other,
and the teeth of a dynamic spline are the thickest of a list.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np

from swgpar.checks.design_file import make_drive
from swgpar.checks.starter_cam import CamType, cam_keys, rounded
from swgpar.checks.starter_teeth import (
    Profile,
    ToothSizes,
    ring_section,
    spline_section,
    tooth_sizes,
)
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import Fatigue
from swgpar.errors import InputError
from swgpar.input.arguments import require_choice, require_number
from swgpar.input.quantities import show
from swgpar.input.require import require, require_available
from swgpar.input.toml_file import with_value

Model = Literal["cup", "plane", "pancake"]
"""Kinds of drives of a starter design."""

Shape = Literal["cup", "short", "hat"]
"""Shapes of the flexible spline: a usual cup, one of half the length, a silk hat with a flange
outwards."""

Layout = Literal["ring_fixed", "spline_fixed"]
"""Layouts of which the ratio gives the numbers of teeth."""

Lobes = Literal[2, 3]
"""Lobes of the cam of a starter design."""

LEAST_RATIO, LARGEST_RATIO = 15.0, 320.0
"""Ratios for which the rules give a drive that can be built and meshed."""

PRESSURE_ANGLE = {2: 20.0, 3: 14.0}
"""By lobes, degrees. Three lobes lead a tooth on a path that is 1.5 times as steep."""

FACE_WIDTH = 0.2
LENGTH = 0.5
FILLET = 0.02
BORE, HUB = 0.17, 0.30
"""Over the pitch diameter: face width, length, fillet, bore radius and radius of the clamped hub of
the cup."""

WALL, BACK_FILLET, END = 0.667, 0.3, 1.15
"""Over the rim: thickness of the wall behind the teeth, fillet between both, thickness of the
closed end."""

SHORT_LENGTH = 0.25
FLANGE, CLAMPED_FLANGE = 0.68, 0.60
"""Over the pitch diameter: length of a short cup, radius of the flange of a silk hat, radius from
which it is clamped."""

BALLS = 22
BALL_DIAMETER, RACE_THICKNESS = 0.09, 0.018
OUTER_CONFORMITY = 0.52
"""Bearing: balls, their diameter and the thickness of the outer race over the bore of the spline,
and the radius of the outer groove over the ball's diameter."""

PLAY = (0.005, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2)
"""Backlash that is tried: share of the tooth's thickness (1 - c_P of the ring gear), or its profile
shift."""

LEAST_CLEARANCE = 0.0005
"""Between the undeformed flanks, modules."""

GAP = 0.05
"""Between the ring gears of a pancake drive, over its face width."""

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

PANCAKE_FLANK_CROWNING = 0.02
"""Of both ring gears of a pancake drive, modules: they are narrower than the flexible spline, and
without it their ends carry."""

CROWNING, SLOPE, FLANK_CROWNING = 0.1, 0.09, 0.045
"""Micro-geometry of the reference drive (Table 7.4), modules."""

OPEN_END = 1.0
"""Radial deflection at the open end of a cup with S-shaped teeth, modules."""

LEAST_DEFLECTION = 0.83
"""Of these at mid-width, modules: below, the roots of the teeth leave no land."""

SAMPLES = 4
"""Angles of a period: with a bearing fatigue needs them."""

STRENGTHS = ("tensile_strength", "yield_strength", "fatigue_limit", "shear_fatigue_limit")
"""Keys of [fatigue] that the file shows with their defaults."""


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

    @property
    def has_bearing(self) -> bool:
        """Whether balls are between cam and spline: in cups with two lobes, on cams that an inner
        race can follow."""
        followed = self.cam not in ("four_roller", "parabolic")
        return self.model == "cup" and self.lobes == 2 and followed


def usual_profile(model: Model, cam: CamType, lobes: int) -> Profile:
    """The profile of a start for which none is named: S-shaped where the motion is that for which
    these teeth are made, that of an ellipse in a cup or in the plane."""
    fits = model != "pancake" and cam == "elliptical" and lobes == 2
    return "s_shaped" if fits else "quadruple_arc"


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
    made = _made(request)
    if not isinstance(made, str):
        return made
    fitting = {name: _choices_that_fit(request, name) for name in ("cam", "profile")}
    others = [f"{name} = {' or '.join(found)}" for name, found in fitting.items() if found]
    raise InputError(
        f"ratio = {request.ratio:g} with profile = {request.profile} and cam = {request.cam} "
        f"{made}: allowed are {', '.join([*others, 'or other ratios'])}"
    )


def _made(request: Request) -> tuple[DriveDesign, dict[str, Any]] | str:
    """The design of a request with the least backlash that clears its teeth, and the content of its
    file; what it lacks where there is none."""
    refusal, built = None, False
    for play in PLAY if request.profile != "s_shaped" else PLAY[:1]:
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
        return f"gives no teeth that can be built ({refusal})"
    return "leaves no clearance between the flanks"


def _choices_that_fit(request: Request, name: str) -> list[str]:
    """Other values of one of `CHOICES` with which the request gives a drive."""
    found = []
    for value in get_args(CHOICES[name]):
        other = replace(request, **{name: value})
        with suppress(InputError):
            _check(other)
            if value != getattr(request, name) and not isinstance(_made(other), str):
                found.append(value)
    return found


def _thin_teeth(table: dict[str, Any]) -> tuple[DriveDesign, dict[str, Any]]:
    """The pancake drive with the thickest teeth of the dynamic spline that clear those of the
    flexible spline."""
    for c_P in DYNAMIC_THICKNESS:
        thinner = with_value(table, "dynamic_spline.c_P", rounded(c_P))
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


def _table(request: Request, play: float) -> dict[str, Any]:
    """Content of the design file with a backlash."""
    lobes = request.lobes
    teeth = round(lobes * request.ratio) - (0 if request.layout == "ring_fixed" else lobes)
    sizes = tooth_sizes(request.profile, lobes, teeth, coned=_is_coned(request))
    if request.diameter is not None:
        module = request.diameter / teeth
    else:
        assert request.bore is not None  # one of both is given
        module = 0.5 * request.bore / (0.5 * teeth - sizes.below_pitch_circle)
    module = rounded(module, 6)
    pitch = module * teeth
    width = rounded(FACE_WIDTH * pitch, 3)
    inner = 0.5 * pitch - sizes.below_pitch_circle * module
    table: dict[str, Any] = {
        "drive": {
            "model": request.model,
            "layout": request.layout,
            "teeth_fs": teeth,
            "teeth_rg": teeth + lobes,
            "module": module,
            "pressure_angle": PRESSURE_ANGLE[lobes],
            "addendum_coef": sizes.addendum,
            "dedendum_coef": sizes.dedendum,
            "face_width": width,
        },
        "flexible_spline": spline_section(request.profile, sizes, module),
        "ring_gear": ring_section(request.profile, sizes, module, teeth + lobes, play),
        "wave_generator": {
            "type": request.cam,
            **({"lobes": 3} if lobes == 3 else {}),
            "face_width": width,
            **cam_keys(request.cam, inner, module, lobes),
            **_deflection(request, module),
        },
    }
    if request.model == "cup":
        table |= _cup(request, sizes, module, pitch)
    if request.has_bearing:
        taper = table["micro_geometry"].pop("wg_slope")
        table["wave_generator"]["bearing"] = _bearing(2.0 * inner, taper)
    if request.model == "pancake":
        table["dynamic_spline"] = _dynamic_spline(table, module)
        flanks = rounded(PANCAKE_FLANK_CROWNING * module)
        table["micro_geometry"] = {
            "wg_crowning": rounded(PANCAKE_CROWNING * module),
            "rg_crowning": flanks,
            "ds_crowning": flanks,
        }
    table["material"] = {"E": 210e3, "nu": 0.29}
    table["load"] = {"torque": request.torque}
    if request.has_bearing:
        table["steps"] = {"samples": SAMPLES}
    fields = Fatigue.model_fields
    table["fatigue"] = {key: fields[key].default for key in STRENGTHS}
    table["rating"] = {"rated_torque": request.torque}
    return table


def _length(request: Request) -> float:
    """Length of the cup over the pitch diameter."""
    return SHORT_LENGTH if request.shape == "short" else LENGTH


def _is_coned(request: Request) -> bool:
    """Whether teeth and deflection follow the cone of a cup."""
    kinds = request.model, request.profile, request.cam
    return kinds == ("cup", "s_shaped", "elliptical")


def _deflection(request: Request, module: float) -> dict[str, float]:
    """The deflection at mid-width with which S-shaped teeth move by `OPEN_END` at the open end of a
    cup, whose deflection grows linearly from the closed end. module : mm"""
    if not _is_coned(request):
        return {}
    from_end = _length(request) + 0.5 * FACE_WIDTH
    share = from_end / (from_end + 0.5 * FACE_WIDTH)
    share = max(share * OPEN_END, LEAST_DEFLECTION)
    return {"deflection": rounded(0.5 * request.lobes * share * module)}


def _cup(request: Request, sizes: ToothSizes, module: float, pitch: float) -> dict[str, Any]:
    """Sections [cup] and [micro_geometry]. module, pitch : mm, pitch diameter"""
    length = _length(request)
    rim = sizes.rim * module
    # the cone of the deflected wall is steeper the shorter the wall is
    cone = (LENGTH + 0.5 * FACE_WIDTH) / (length + 0.5 * FACE_WIDTH)
    flanks = sizes.crowning * cone if request.profile == "s_shaped" else FLANK_CROWNING
    micro = {"wg_crowning": CROWNING, "wg_slope": SLOPE * cone, "fs_crowning": flanks}
    cup = {
        "length": rounded(length * pitch),
        "thickness_coef": WALL,
        "back_fillet": rounded(BACK_FILLET * rim),
        "end_thickness": rounded(END * rim),
        "fillet_radius": rounded(FILLET * pitch),
        **_end(request.shape, pitch),
    }
    micro_geometry = {name: rounded(value * module) for name, value in micro.items()}
    return {"cup": cup, "micro_geometry": micro_geometry}


def _end(shape: Shape, pitch: float) -> dict[str, Any]:
    """Keys of the closed end or flange. pitch : mm, pitch diameter"""
    if shape != "hat":
        return {"inner_radius": rounded(BORE * pitch), **_clamped(HUB * pitch)}
    flange = {"flange_radius": rounded(FLANGE * pitch)}
    return {"shape": "hat", **flange, **_clamped(CLAMPED_FLANGE * pitch)}


def _clamped(radius: float) -> dict[str, Any]:
    """Keys of a hub or flange that is clamped: a bare edge bends, and halves the stiffness."""
    return {"attachment": "clamped", "clamping_radius": rounded(radius)}


def _bearing(bore: float, taper: float) -> dict[str, Any]:
    """Section [wave_generator.bearing]. bore : mm, of the spline;  taper : mm, of the race"""
    return {
        "balls": BALLS,
        "ball_diameter": rounded(BALL_DIAMETER * bore),
        "race_thickness": rounded(RACE_THICKNESS * bore),
        "outer_conformity": OUTER_CONFORMITY,
        "race_taper": taper,
    }


def _dynamic_spline(table: dict[str, Any], module: float) -> dict[str, Any]:
    """Section of the second ring gear of a pancake drive, with its thickest teeth."""
    radii = {name: rounded(value * module) for name, value in DYNAMIC_RADII.items()}
    return {
        "rim": table["ring_gear"]["rim"],
        "c_P": DYNAMIC_THICKNESS[0],
        "gap": rounded(GAP * table["drive"]["face_width"], 2),
        "profile": {"type": "quadruple_arc", **radii},
    }
