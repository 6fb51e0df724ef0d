"""The flexible units: torque against twist, and what it does to the rack force that a pinion
carries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.gear_trains.cascade.design import CascadeDesign

NEWTON_STEPS = 40
"""More than the convergence to the last digit takes."""


@dataclass(frozen=True)
class FlexUnits:
    """The mean curve of the units; that of a pinion is its ratio times this one (section 4.2).

    Equation (26) of the source is lost. Its text says that the stiffness is higher at small
    deformations and constant beyond 0.42 mm: here the stiffness falls from its initial value along
    a parabola that ends level there. Torque and stiffness are the derivatives of an energy, and
    even in the twist.

    Attributes
    ----------
    stiffness, initial : N·m/rad, beyond and at the start of the curve
    end : rad, twist beyond which the stiffness is constant
    ratios : (8,) float64
    """

    stiffness: float
    initial: float
    end: float
    ratios: np.ndarray

    @classmethod
    def of(cls, design: CascadeDesign) -> FlexUnits:
        """The units of a design."""
        unit, per_rad = design.flex_unit, 180.0 / np.pi
        return cls(
            unit.stiffness * per_rad,
            unit.initial_stiffness * per_rad,
            unit.linear_above / unit.radius,
            np.array(unit.ratio),
        )

    def torque(self, twist: np.ndarray) -> np.ndarray:
        """Mean torque at a twist (rad), N·m; any shape."""
        size = np.abs(twist)
        rest = np.maximum(1.0 - size / self.end, 0.0)
        extra = (self.initial - self.stiffness) * self.end / 3.0 * (1.0 - rest**3)
        return np.sign(twist) * (self.stiffness * size + extra)

    def twist(self, torque: np.ndarray) -> np.ndarray:
        """Twist in rad at a mean torque (N·m): the inverse of `torque`, by Newton's method.

        The curve bends one way, so that steps from 0 cannot pass the solution of a stiffness that
        falls, and pass that of one that rises once.
        """
        found = np.zeros_like(torque)
        for _ in range(NEWTON_STEPS):
            found = found + (torque - self.torque(found)) / self.tangent(found)
        return found

    def tangent(self, twist: np.ndarray) -> np.ndarray:
        """Derivative of `torque`, N·m/rad."""
        rest = np.maximum(1.0 - np.abs(twist) / self.end, 0.0)
        return self.stiffness + (self.initial - self.stiffness) * rest**2
