"""The outer race of a bearing rotates with the flexible spline, and stays in its plane.

Contact and balls are frictionless: nothing else keeps the race from rotating in the spline.
Friction would take it along. The condition carries no torque: the race is the same all round.
"""

from __future__ import annotations

import numpy as np

from swgpar.constraints.distributing_coupling import (
    N_COUPLED,
    ROTATION,
    DistributingCoupling,
    MeanMotion,
    NodeMeans,
    Z,
)


class RaceCoupling:
    """Mean rotation of the race relative to the spline and, in space, its mean motion along z.

    race : coupling of the race's outer surface;  spline : coupling of the flexible spline
    """

    def __init__(self, race: DistributingCoupling, spline: NodeMeans) -> None:
        self.race, self.spline = race, spline
        self.nodes = np.concatenate([race.nodes, spline.nodes])
        self.active = np.zeros(N_COUPLED, dtype=bool)
        self.active[ROTATION], self.active[Z] = True, race.solid

    def evaluate(self, u: np.ndarray) -> MeanMotion:
        """Relative rotation (rad) and displacement (mm), and gradients; the rest is not used."""
        race, spline = self.race.evaluate(u), self.spline.evaluate(u)
        value, against = race.value.copy(), np.zeros_like(spline.gradient)
        value[ROTATION] -= spline.value[ROTATION]
        against[ROTATION] = -spline.gradient[ROTATION]
        return MeanMotion(value, np.concatenate([race.gradient, against], axis=1))

    def supports(self) -> np.ndarray:
        """Directions that support the race."""
        directions = self.race.supports()
        return np.concatenate(
            [directions, np.zeros((len(directions), len(self.spline.nodes), 3))], axis=1
        )
