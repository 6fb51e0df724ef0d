"""The section [wave_generator.bearing] of the design file."""

from __future__ import annotations

import math

from swgpar.input.quantities import Section, not_negative, positive, quantity
from swgpar.materials import OptionalMaterial
from swgpar.materials.temperature import temperature


class Bearing(Section):
    """Section [wave_generator.bearing]: a flexible ball bearing between cam and flexible spline."""

    balls: int = quantity(text="number of balls", ge=3, le=2000)
    ball_diameter: float = positive("diameter of the balls", "mm")
    race_thickness: float = positive("thickness of the outer race, of a rectangular section", "mm")
    race_width: float | None = positive(
        "width of the outer race; without it that of the cam", "mm", None
    )
    clearance: float = quantity(
        0.0,
        unit="mm",
        text="clearance of a ball with the outer race on the cam's curve; below 0 a preload",
    )
    inner_conformity: float = quantity(
        0.52, text="radius of the inner race's groove across over the ball diameter", gt=0.5, le=2.0
    )
    outer_conformity: float = quantity(
        0.53, text="radius of the outer race's groove across over the ball diameter", gt=0.5, le=2.0
    )
    first_ball: float = quantity(
        0.0,
        unit="deg",
        text="angle of a ball from the major axis at the start",
        ge=-180.0,
        le=180.0,
    )
    cage_speed: float | None = not_negative(
        "speed of the cage over that of the wave generator; without it that of rolling balls",
        default=None,
        le=1.0,
    )
    stiffness_factor: float = positive(
        "factor on the stiffness of the ball contacts; 1: Hertz", default=1.0, le=1e6
    )
    race_interference: float = quantity(
        0.0,
        unit="mm",
        text="by how much the outer diameter of the outer race exceeds the bore of the flexible "
        "spline; below 0 a clearance",
    )
    race_taper: float = quantity(
        0.0,
        unit="mm",
        text="taper of the outer race's outside: by how much its radius is larger at the end of "
        "race_width under the open end than at mid-width",
    )
    temperature: float | None = temperature("outer race and balls")
    material: OptionalMaterial = None
    load_rating: float | None = positive(
        "basic dynamic load rating; without it that of ISO 281", "N", None
    )

    @property
    def starts_mirror_symmetric(self) -> bool:
        """Whether a ball, or the middle between two balls, is on the major axis at the start."""
        halves = 2.0 * self.first_ball * self.balls / 360.0
        return math.isclose(halves, round(halves), abs_tol=1e-9)
