"""The sections [flexible_spline.profile] and [ring_gear.profile]: keys of each `type`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from swgpar.input.quantities import Section, default_type, not_negative, positive, quantity


class ProfileKeys(Section):
    """Keys of one type of profile. What refusals say of them is declared here.

    typical_lengths : keys that are lengths, with values in modules that give a flank for most tooth
        numbers; a refusal says which of them to change. Empty: the reason says what is allowed
    thickness_key : the key that replaces c_P and c_l, which are then 1 and 0.5; empty: they count
    divides_straight : whether c_l divides a straight segment; without one it is 0.5
    """

    typical_lengths: ClassVar[Mapping[str, float]] = {}
    thickness_key: ClassVar[str] = ""
    divides_straight: ClassVar[bool] = True


def _root_arc() -> Any:
    return positive("radius of the root arc", "mm")


def _rounded_tip() -> Any:
    return not_negative("radius of the rounded tip edge; 0: sharp", "mm", 0.0)


class QuadrupleArc(ProfileKeys):
    """Section 3.3.3. The typical lengths are those of the reference drive."""

    typical_lengths = {
        "r_tip": 0.5,
        "r_addendum": 1.0,
        "straight_l": 0.0,
        "r_dedendum": 20.0,
        "r_root": 0.6,
    }

    type: Literal["quadruple_arc"] = quantity("quadruple_arc", text="kind of profile")
    r_tip: float = positive("radius of the tip arc", "mm")
    r_addendum: float = positive("radius of the addendum arc", "mm")
    straight_l: float = not_negative("length of the straight segment", "mm", 0.0)
    r_dedendum: float = positive("radius of the dedendum arc", "mm")
    r_root: float = _root_arc()


class DoubleArc(ProfileKeys):
    """Section 3.3.2. The typical lengths are those of Table 6.12."""

    typical_lengths = {"r_addendum": 1.0, "r_dedendum": 0.6}

    type: Literal["double_arc"] = quantity("double_arc", text="kind of profile")
    r_addendum: float = positive("radius of the addendum arc", "mm")
    r_dedendum: float = positive("radius of the dedendum arc", "mm")


class Trapezoid(ProfileKeys):
    """A straight flank through the pitch point, a tip arc and a root arc."""

    typical_lengths = {"r_tip": 0.05, "r_root": 0.2}
    divides_straight = False

    type: Literal["trapezoid"] = quantity("trapezoid", text="kind of profile")
    flank_angle: float | None = not_negative(
        "angle between flank and centre line of the tooth; without it that of "
        "drive.pressure_angle at the pitch point",
        "deg",
        None,
        lt=60.0,
    )
    r_tip: float = not_negative("radius of the tip arc; 0: a sharp edge", "mm", 0.0)
    r_root: float = _root_arc()


class CommonTangent(ProfileKeys):
    """Two arcs with a common tangent, given by their centres, and a root arc."""

    typical_lengths = {"r_addendum": 1.0, "r_dedendum": 1.2, "r_root": 0.3}
    divides_straight = False

    type: Literal["common_tangent"] = quantity("common_tangent", text="kind of profile")
    r_addendum: float = positive("radius of the convex arc", "mm")
    c_addendum: float = quantity(
        unit="mm", text="centre of the convex arc, beyond the centre line of the tooth"
    )
    e_addendum: float = quantity(
        unit="mm", text="centre of the convex arc, below the pitch circle, towards the root"
    )
    r_dedendum: float = positive("radius of the concave arc", "mm")
    c_dedendum: float = quantity(
        unit="mm", text="centre of the concave arc, beyond half a pitch from the centre line"
    )
    e_dedendum: float = quantity(
        unit="mm", text="centre of the concave arc, above the pitch circle, towards the tip"
    )
    r_root: float = _root_arc()


class SShaped(ProfileKeys):
    """Path of a rigid tooth at half scale (US patent 4,823,638), and a root arc."""

    typical_lengths = {"r_root": 0.3}
    divides_straight = False

    type: Literal["s_shaped"] = quantity("s_shaped", text="kind of profile")
    deflection: float | None = positive(
        "radial deflection of the path; without it that of the wave generator", "mm", None
    )
    r_tip: float = _rounded_tip()
    r_root: float = _root_arc()


class Cycloid(ProfileKeys):
    """An epicycloid outside of the pitch circle, a hypocycloid inside, and a root arc."""

    typical_lengths = {"r_epicycloid": 1.0, "r_hypocycloid": 1.0, "r_root": 0.3}
    divides_straight = False

    type: Literal["cycloid"] = quantity("cycloid", text="kind of profile")
    r_epicycloid: float = positive(
        "radius of the circle that rolls on the outside of the pitch circle", "mm"
    )
    r_hypocycloid: float = positive("radius of the circle that rolls on its inside", "mm")
    r_tip: float = _rounded_tip()
    r_root: float = _root_arc()


class Points(ProfileKeys):
    """A smooth curve through points of one flank, of a space or of a tooth."""

    divides_straight = False

    type: Literal["points"] = quantity("points", text="kind of profile")
    points: list[list[float]] = quantity(
        [],
        text="pairs x, y with the axis of the gear at 0, 0: of one flank of a tooth on +y, of a "
        "space or of a tooth; a file takes their place",
    )
    file: str | None = quantity(
        None, text="CSV or DXF file of the points, relative to the design file"
    )
    layer: str | None = quantity(None, text="layer of a DXF file; without it the model space")
    scale: float = positive("mm over the unit of the points", default=1.0, le=1e6)
    tolerance: float = not_negative(
        "mean distance of the points from the curve; 0: the curve passes through all", "mm", 0.0
    )
    corner: float = positive(
        "least angle between the chords beside a point that is a corner", "deg", 20.0, le=90.0
    )
    joints: list[float] = quantity(
        [],
        text="radii (mm) from the axis where smooth parts of the flank join, the one where the "
        "root begins among them; without it the root begins where the curve turns sharply",
    )
    rounded_tip: bool = quantity(
        False, text="whether the first part, up to a joint or corner, is a rounded tip edge"
    )


class _Involute(ProfileKeys):
    """Section 3.3.1. The typical radius is the bottom clearance."""

    typical_lengths = {"cutter_radius": 0.2}
    divides_straight = False

    type: Literal["involute"] = quantity("involute", text="kind of profile")
    pressure_angle: float | None = positive(
        "pressure angle; without it drive.pressure_angle", "deg", None, lt=45.0
    )
    cutter_radius: float = positive("tip radius of the cutter's teeth", "mm")
    shift: float = quantity(0.0, unit="modules", text="profile shift coefficient", ge=-1.0, le=1.0)


class RackInvolute(_Involute):
    """External teeth, cut by a rack."""


class ShaperInvolute(_Involute):
    """Internal teeth, cut by a shaper."""

    cutter_teeth: int = quantity(text="teeth of the shaper-cutter", ge=8, le=2000)


class Conjugate(ProfileKeys):
    """Envelope of the other flank in the motion of its tooth (docs/theory/conjugate.md)."""

    thickness_key = "backlash"

    type: Literal["conjugate"] = quantity("conjugate", text="kind of profile")
    r_root: float = _root_arc()
    r_tip: float = _rounded_tip()
    backlash: float = not_negative(
        "backlash along the pitch circle, taken from these teeth", "mm", 0.0
    )
    section: float = quantity(
        0.0, unit="mm", text="axial coordinate of the section whose motion counts; 0: mid-width"
    )


_EitherGear = QuadrupleArc | DoubleArc | CommonTangent | Trapezoid | SShaped | Cycloid | Points

ExternalProfile = Annotated[
    _EitherGear | RackInvolute | Conjugate,
    Field(discriminator="type"),
    BeforeValidator(default_type("quadruple_arc")),
]
InternalProfile = Annotated[
    _EitherGear | ShaperInvolute | Conjugate,
    Field(discriminator="type"),
    BeforeValidator(default_type("quadruple_arc")),
]
