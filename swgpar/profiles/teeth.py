"""Number and sizes of the teeth, from which every profile starts, and the pitch circle."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Teeth:
    """Sizes of a gear's teeth.

    n_teeth : int
    module : mm;  pressure_angle : rad
    addendum, dedendum : mm, heights of the tooth above and below the pitch circle, without profile
        shift
    external : bool
    """

    n_teeth: int
    module: float
    pressure_angle: float
    addendum: float
    dedendum: float
    external: bool

    @property
    def sign(self) -> float:
        """+1 for external, -1 for internal teeth."""
        return 1.0 if self.external else -1.0

    @property
    def r_pitch(self) -> float:
        """Pitch radius, mm (eq. 3.13)."""
        return 0.5 * self.n_teeth * self.module

    @property
    def r_tip_circle(self) -> float:
        """Addendum radius, mm (eq. 3.16)."""
        return self.r_pitch + self.sign * self.addendum

    @property
    def r_root_circle(self) -> float:
        """Dedendum radius, mm (eq. 3.17)."""
        return self.r_pitch - self.sign * self.dedendum
