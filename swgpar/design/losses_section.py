"""The section [losses] of the drive's design file (docs/theory/losses.md)."""

from __future__ import annotations

import numpy as np

from swgpar.design.sections import PER_MINUTE
from swgpar.input.quantities import Section, not_negative, positive, quantity


class Losses(Section):
    """Section [losses]: coefficients of the losses; present to compute them."""

    loss_factor: float = not_negative(
        "loss factor of the flexible spline's material", default=3e-4, le=0.1
    )
    flank_friction: float = not_negative(
        "friction between the flanks for their losses, without contact.friction",
        default=0.05,
        le=1.0,
    )
    bearing_friction: float = not_negative(
        "friction of the wave generator's bearing", default=0.0015, le=0.1
    )
    bearing_diameter: float | None = positive(
        "diameter at which that friction acts; default that of the balls' centres, without a "
        "bearing of the bore",
        "mm",
        None,
    )
    lubricant_viscosity: float | None = positive(
        "kinematic viscosity of the oil, or of the grease's base oil, at the temperature of the "
        "drive; without it the bearing has no drag of the lubricant",
        "mm²/s",
        None,
    )
    lubrication_factor: float = positive(
        "Palmgren's factor f0 of the bearing and its lubrication", default=1.0, le=20.0
    )
    static_friction: float = quantity(
        1.0,
        text="friction of flanks, bearing and seals at rest over that in motion",
        ge=1.0,
        le=10.0,
    )
    stribeck_speed: float | None = positive(
        "speed of the input at which 37 % of the additional friction at rest are left; without it "
        "a drive that moves has none of it",
        "1/min",
        None,
    )
    input_drag: float = not_negative(
        "torque of seals and grease at the input, at any speed", "N·m", 0.0
    )
    input_viscous_drag: float = not_negative(
        "torque of seals and grease at the input over its speed", "N·m·s/rad", 0.0
    )
    output_drag: float = not_negative(
        "torque of seals and grease at the output, at any speed", "N·m", 0.0
    )
    output_viscous_drag: float = not_negative(
        "torque of seals and grease at the output over its speed", "N·m·s/rad", 0.0
    )

    def dry_friction(self, speed: float) -> float:
        """Friction of flanks, bearing and seals over that of a fast drive.

        speed : rad/s, of the input.

        Source: S. Andersson, A. Söderberg, S. Björklund, Friction models for sliding dry, boundary
        and mixed lubricated contacts, Tribology International 40 (2007) 580-587, the Stribeck
        friction with the exponent 2.
        """
        if speed == 0.0:
            return self.static_friction
        if self.stribeck_speed is None:
            return 1.0
        left = np.exp(-((speed / (self.stribeck_speed * PER_MINUTE)) ** 2))
        return float(1.0 + (self.static_friction - 1.0) * left)

    def drag_at_input(self, speed: float, ratio: float) -> float:
        """Torque (N·m) at the input that seals and grease take on both sides.

        speed : rad/s, of the input;  ratio : input over output
        """
        dry = self.input_drag + self.output_drag / abs(ratio)
        viscous = self.input_viscous_drag + self.output_viscous_drag / ratio**2
        return dry * self.dry_friction(speed) + viscous * abs(speed)
