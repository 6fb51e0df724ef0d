"""The pitch point of directly defined profiles, and the directions at it (section 3.3.2)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from swgpar.errors import InputError
from swgpar.profiles.flank import Segment, ToothProfile
from swgpar.profiles.teeth import Teeth

PlacedSegment = tuple[str, np.ndarray, float, float, float]
"""Name, start, inclination, convexity and length of a segment, see `PitchPointFrame.segment`."""


@dataclass(frozen=True)
class PitchPointFrame(Teeth):
    """Flank at x > 0 of a tooth centred on +y.

    c_P : angular tooth thickness reduction (eq. 3.22)
    """

    c_P: float

    @property
    def half_thickness(self) -> float:
        """Angle between the tooth's centre line and the pitch point, rad (eq. 3.22)."""
        return 0.5 * self.c_P * np.pi / self.n_teeth

    @property
    def base_angle(self) -> float:
        """Angle alpha* of the normal at the pitch point, rad (eq. 3.27)."""
        return self.pressure_angle - self.sign * self.half_thickness

    @property
    def pitch_point(self) -> np.ndarray:
        """Pitch point (2,), mm (eq. 3.23)."""
        return self.r_pitch * np.array([np.sin(self.half_thickness), np.cos(self.half_thickness)])

    @property
    def towards_tip(self) -> np.ndarray:
        """Unit tangent (2,) at the pitch point, towards the tip (eq. 3.29)."""
        return np.array([-np.sin(self.base_angle), self.sign * np.cos(self.base_angle)])

    def normal(self, beta: float) -> np.ndarray:
        """Outward normal (2,) of inclination beta, rad (eqs 3.28, 3.34)."""
        return np.array([np.cos(beta), self.sign * np.sin(beta)])

    def inclination(self, center: np.ndarray) -> float:
        """Inclination, rad, of the normal common to arcs about `center` (2,) and about the axis."""
        x, y = self.sign * center / np.hypot(*center)
        return float(np.arctan2(self.sign * y, x))

    def tip_inclination(self, center: np.ndarray, radius: float, key: str) -> float:
        """Inclination, rad, at which a convex arc of `radius`, mm, about `center` (2,), mm, meets
        the addendum circle.

        Raises InputError, which names the key of the radius, where it does not.
        """
        # |center + radius n(beta)| = r_A (eqs 3.36, 3.39)
        reach = float(np.hypot(*center))
        cosine = (self.r_tip_circle**2 - reach**2 - radius**2) / (2.0 * reach * radius)
        if abs(cosine) > 1.0:
            raise InputError(f"{key} = {radius:g}: its arc does not reach the addendum circle")
        at = float(np.arctan2(self.sign * center[1], center[0]))
        return at - self.sign * float(np.arccos(cosine))

    def straight(self, c_l: float, length: float) -> tuple[np.ndarray, np.ndarray]:
        """Upper and lower end (2,), mm, of a straight segment through the pitch point, of which
        the share c_l is above it."""
        top = self.pitch_point + c_l * length * self.towards_tip
        return top, self.pitch_point - (1.0 - c_l) * length * self.towards_tip

    def reach(self, start: np.ndarray, radius: float) -> float:
        """How far, mm, the circle of `radius`, mm, is from `start` (2,), mm, along `towards_tip`;
        NaN where the line does not meet it."""
        along = float(start @ self.towards_tip)
        square = along**2 - float(start @ start) + radius**2
        return -along + self.sign * math.sqrt(square) if radius > 0.0 <= square else math.nan

    def segment(
        self, name: str, start: np.ndarray, beta: float, convexity: float, length: float
    ) -> Segment:
        """Segment from `start` (2,), mm, where the normal's inclination is beta.

        `convexity` is its curvature, 1/mm, above 0 where convex, `length` its arc length, mm.
        """
        direction = beta - 0.5 * np.pi if self.external else 0.5 * np.pi - beta
        return Segment(
            name,
            (float(start[0]), float(start[1])),
            direction,
            -self.sign * convexity,
            float(length),
        )

    def profile(self, pieces: list[PlacedSegment], name: str) -> ToothProfile:
        """Flank of `pieces` from tip to root without those of no length; refuses a negative one.

        name : section of the design file, for the message
        """
        for piece, *_, length in pieces:
            if length < 0.0:
                raise InputError(
                    f"{name}.r_{piece}: the {piece} arc would have a negative length ({length:.3g} "
                    f"mm)"
                )
        segments = tuple(
            self.segment(*piece) for piece in pieces if piece[-1] > 1e-12 * self.module
        )
        return ToothProfile(
            segments, self.external, self.r_tip_circle, self.r_root_circle, self.n_teeth
        )
