"""The section [wave_generator] of the design file: one set of keys for each `type` of cam."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, field_validator

from swgpar.geometry.cams.bearing_keys import Bearing
from swgpar.input.quantities import Section, default_type, not_negative, positive, quantity
from swgpar.materials.temperature import temperature


def _pins(default: float) -> float:
    return positive("half of the angle a pushing pin covers", "deg", default, le=60.0)


class _WaveGenerator(Section):
    lobes: int = quantity(2, text="lobes of the cam, places around it where teeth mesh", ge=2, le=3)
    deflection: float | None = positive(
        "radial deflection w0 of the flexible spline at the tip of a lobe; without it half of "
        "the module times the difference of the teeth",
        "mm",
        None,
    )
    offset: float = quantity(
        0.0,
        unit="mm",
        text="distance of the surface on the spline from the curve of the cam, outwards: thickness "
        "of a bearing, less a clearance",
    )
    face_width: float = positive("width of the cam", "mm")
    # Pins begin where they first touch. Flat or rotated parabolas touch beside the major axis, as
    # far as 30 degrees from it, and rollers wherever they are: the pins have to reach that far.
    pin_half_angle: float = _pins(60.0)
    temperature: float | None = temperature("the rigid cam and an inner race on it")
    expansion: float | None = not_negative(
        "coefficient of thermal expansion of the cam; without it material.expansion",
        "1/K",
        None,
        le=1e-3,
    )
    bearing: Bearing | None = None

    @property
    def is_mirror_symmetric(self) -> bool:
        """Whether both sides of a lobe are mirror images."""
        return True

    @property
    def width(self) -> float:
        """Width (mm) of all that presses on the spline."""
        return self.face_width

    @property
    def lobes_are_alike(self) -> bool:
        """Whether a rotation by one lobe leaves the wave generator as it is."""
        return True


class Reduced(_WaveGenerator):
    """Cams with a minor semi-axis b = C (r_fs - w0) (eq. 3.4), or with both axes given."""

    C: float = positive("minor axis reduction", default=1.0, le=1.0)
    major_axis: float | None = positive(
        "size along the major axis, in place of deflection", "mm", None
    )
    minor_axis: float | None = positive("size along the minor axis, in place of C", "mm", None)


class Elliptical(Reduced):
    """Section 3.2.2."""

    type: Literal["elliptical"] = quantity("elliptical", text="kind of cam")
    # An ellipse first touches at its tips, so narrow pins suffice. On drivers/plane_half_turn.toml
    # (plane_coarse) the stage DEFLECT takes 14 Newton iterations with 15 degrees, 18 with 60.
    pin_half_angle: float = _pins(15.0)


class Harmonic(Reduced):
    """The radius is a cosine of the polar angle, with two lobes or three."""

    type: Literal["harmonic"] = quantity("harmonic", text="kind of cam")
    pin_half_angle: float = _pins(15.0)


class Simplified(Reduced):
    """Section 3.2.1."""

    type: Literal["simplified"] = quantity("simplified", text="kind of cam")


class Arcs(Reduced):
    """Arcs of two radii."""

    type: Literal["arcs"] = quantity("arcs", text="kind of cam")
    beta: float = positive("half angle of the arcs about the major axis", "deg", lt=90.0)


class SideKeys(Section):
    """The parabola of a lobe, or of one side of it, and how it is led to the minor axis."""

    a_p: float = positive("parabola coefficient", "1/mm")
    C_p: float = positive("half length of the parabola over the minor semi-axis", le=1.0)
    r_c: float = positive("radius of the connector arc", "mm")


class Parabolic(Reduced, SideKeys):
    """Section 3.2.3."""

    type: Literal["parabolic"] = quantity("parabolic", text="kind of cam")


class AsymmetricParabolic(Reduced):
    """Section 5.7; right and left on the upper lobe, both rotated by lambda."""

    type: Literal["asymmetric_parabolic"] = quantity("asymmetric_parabolic", text="kind of cam")
    rotational_angle: float = quantity(
        0.0,
        unit="deg",
        text="rotation of the parabolas about their apexes, counter-clockwise",
        gt=-10.0,
        lt=10.0,
    )
    right: SideKeys
    left: SideKeys

    @property
    def is_mirror_symmetric(self) -> bool:
        """Whether both sides of a lobe are mirror images."""
        return False


class Polar(Reduced):
    """The radius is an expression of the polar angle, with two lobes or three."""

    type: Literal["polar"] = quantity("polar", text="kind of cam")
    radius: str = quantity(
        text="radius in mm, an expression of the angle theta from the tip of a lobe, in rad up to "
        "midway between two lobes, of the semi-axes a and b and of parameters"
    )
    parameters: dict[str, float] = quantity({}, text="names of the expression with their values")


class CamPoints(_WaveGenerator):
    """A curve through points of the whole cam, of a lobe or of half a lobe, with two lobes or
    three."""

    type: Literal["points"] = quantity("points", text="kind of cam")
    points: list[list[float]] = quantity(
        [], text="pairs of numbers around the axis; a file takes their place"
    )
    file: str | None = quantity(
        None, text="CSV or DXF file of the points, relative to the design file"
    )
    layer: str | None = quantity(None, text="layer of a DXF file; without it the model space")
    coordinates: Literal["cartesian", "polar"] = quantity(
        "cartesian",
        text="x and y in mm, or angle in degrees from the major axis, counter-clockwise, and "
        "radius in mm",
    )
    rotation: float = quantity(
        0.0,
        unit="deg",
        text="rotation of the points, counter-clockwise, that puts the major axis on +y",
        ge=-360.0,
        le=360.0,
    )
    symmetric: bool = quantity(True, text="whether both sides of a lobe are mirror images")
    tolerance: float = not_negative(
        "mean distance of the points from the smooth curve", "mm", 0.0005
    )

    @field_validator("points", mode="before")
    @classmethod
    def _without_round_off(cls, value: Any) -> Any:
        """Coordinates to 1e-9: zeros of other programs are 1e-16, which would be slips."""
        if not isinstance(value, list):
            return value
        return [
            [round(x, 9) if isinstance(x, float) else x for x in point]
            if isinstance(point, list)
            else point
            for point in value
        ]

    @property
    def is_mirror_symmetric(self) -> bool:
        """Whether both sides of a lobe are mirror images."""
        return self.symmetric


class _Rollers(_WaveGenerator):
    """Cams of rollers, whose outermost points are w0 outside of the undeformed spline."""

    centre_radius: float | None = positive(
        "radius of the circle of the rollers' centres, in place of deflection", "mm", None
    )


class FourRoller(_Rollers):
    """Section 3.2.4."""

    type: Literal["four_roller"] = quantity("four_roller", text="kind of cam")
    beta: float = positive("angle of the rollers from the major axis", "deg", lt=90.0)
    r_4: float = positive("radius of the rollers", "mm")


class TwoRoller(_Rollers):
    """Two rollers on the major axis."""

    type: Literal["two_roller"] = quantity("two_roller", text="kind of cam")
    r_2: float = positive("radius of the rollers", "mm")
    distance: float = not_negative(
        "distance of the rollers along the axis, the one on +y towards the closed end; beside "
        "each other they are discs as large as they fit",
        "mm",
        0.0,
    )

    @property
    def width(self) -> float:
        """Width (mm) of both rollers."""
        return self.face_width + self.distance

    @property
    def lobes_are_alike(self) -> bool:
        """Whether a rotation by one lobe leaves the wave generator as it is."""
        return self.distance == 0.0


WaveGenerator = Annotated[
    Elliptical
    | Harmonic
    | Simplified
    | Arcs
    | Parabolic
    | AsymmetricParabolic
    | Polar
    | CamPoints
    | TwoRoller
    | FourRoller,
    Field(discriminator="type"),
    BeforeValidator(default_type("elliptical")),
]
