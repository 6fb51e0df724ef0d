"""Drag of the lubricant in the wave generator's bearing, by Palmgren (docs/theory/losses.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SLOW = 2000.0
"""Product of viscosity (mm²/s) and speed (1/min) below which the drag does not fall further."""

COEFFICIENT = 1e-7
"""N·mm over f0, mm³ and (mm²/s · 1/min)^(2/3)."""


@dataclass(frozen=True)
class BearingDrag:
    """Torque that the lubricant takes between the races, without a load.

    factor : f0, of the bearing and its lubrication;  viscosity : mm²/s, kinematic; 0 for no drag
    diameter : mm, of the circle of the balls' centres
    relative : speed of one race against the other over that of the input
    """

    factor: float
    viscosity: float
    diameter: float
    relative: float = 1.0

    def torque(self, speed: float) -> float:
        """N·mm at the input. speed : rad/s, of the input

        Source: Palmgren, Ball and Roller Bearing Engineering, 3rd ed. (1959), section 2.
        """
        if not self.viscosity:
            return 0.0
        per_minute = abs(speed * self.relative) * 30.0 / np.pi
        product = max(SLOW, self.viscosity * per_minute)
        share = COEFFICIENT * self.factor * product ** (2.0 / 3.0) * self.diameter**3
        return float(share * abs(self.relative))
