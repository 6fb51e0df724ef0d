"""Deviations of a gear's flanks from their ideal places: how far every point is moved.

A tooth moves as a rigid body: along the pitch circle (pitch), with the axis of the gear
(eccentricity, tilt), with a ring that is pressed oval. Its profile deviates along the normal.
Everything is of first order in the deviations.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from swgpar.geometry.rotation import MIRROR, rotated
from swgpar.profiles import ToothProfile


def direction(angle: float) -> np.ndarray:
    """Unit vector (2,) at an angle (rad) from +y, counter-clockwise."""
    return np.array([-np.sin(angle), np.cos(angle)])


@dataclass(frozen=True)
class GearDeviations:
    """Deviations of one gear.

    r_pitch : mm, pitch radius
    pitch : (n_teeth,) mm, position of the teeth along the pitch circle less the theoretical one,
    counter-clockwise
    shift : (2,) mm, of the gear's axis at mid-width;  tilt : (2,) displacement of the axis per mm
    along z
    ovality : mm, largest less smallest diameter;  oval_angle : rad, of the largest one from +y
    profile_slope, profile_form : mm, see `profile_height`
    """

    r_pitch: float
    pitch: np.ndarray
    shift: np.ndarray = field(default_factory=lambda: np.zeros(2))
    tilt: np.ndarray = field(default_factory=lambda: np.zeros(2))
    ovality: float = 0.0
    oval_angle: float = 0.0
    profile_slope: float = 0.0
    profile_form: float = 0.0

    def is_twofold(self) -> bool:
        """Whether the gear equals itself rotated by 180 degrees."""
        teeth = len(self.pitch)
        centred = not self.shift.any() and not self.tilt.any()
        twofold = teeth % 2 == 0 and np.array_equal(np.roll(self.pitch, teeth // 2), self.pitch)
        return centred and twofold

    def moved(self, points: np.ndarray, angle: np.ndarray) -> np.ndarray:
        """Displacement (n_teeth, n, 2) mm, in the teeth's frames, of points (n, 2) mm of one tooth.

        angle : (n_teeth,) rad, of the teeth from +y

        The oval gear is a ring that bends without stretching: with psi from the largest diameter
        and a the ovality, w = a / 4 cos 2 psi outward, v = -a / 8 sin 2 psi counter-clockwise,
        rotation 3 a / 8 sin 2 psi / r.
        """
        turn = self.pitch / self.r_pitch
        psi = 2.0 * (angle - self.oval_angle)
        outward, around = 0.25 * self.ovality * np.cos(psi), -0.125 * self.ovality * np.sin(psi)
        lean = 0.375 * self.ovality * np.sin(psi) / self.r_pitch
        x, y = points.T
        rigid = rotated(np.broadcast_to(self.shift, (len(angle), 2)), -angle)
        along = (
            rigid[:, :1] - around[:, None] - np.outer(turn, y) - np.outer(lean, y - self.r_pitch)
        )
        across = rigid[:, 1:] + outward[:, None] + np.outer(turn, x) + np.outer(lean, x)
        return np.stack([along, across], axis=-1)

    def profile_height(self, profile: ToothProfile, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Height (n,) mm of the profile over the ideal one at s (n,) mm, and its derivative by s.

        The slope raises the tip end by half of it and lowers the root end of the active profile by
        half of it. The form is one wave, high at both ends. Both fade out where crowning does.
        """
        end = profile.root_start

        def height(at: np.ndarray) -> np.ndarray:
            share = np.clip(at / end, 0.0, 1.0)
            wave = 0.5 * self.profile_form * np.cos(2.0 * np.pi * share)
            return profile.crowning_weight(at) * (self.profile_slope * (0.5 - share) + wave)

        step = 1e-5 * profile.length
        low, high = np.clip(s - step, 0.0, None), np.clip(s + step, None, profile.length)
        return height(s), (height(high) - height(low)) / (high - low)

    def heights(
        self, profile: ToothProfile, s: np.ndarray, z: np.ndarray, angle: np.ndarray, side: int
    ) -> np.ndarray:
        """Height (n_teeth, n) mm of the moved flank along its ideal normal, at s and z (n,) mm.

        side : +1 for the clockwise flank, -1 for the other;  angle : (n_teeth,) rad, of the teeth
        """
        normal = profile.normal(s) * (MIRROR if side < 0 else np.ones(2))
        tilt = rotated(np.broadcast_to(self.tilt, (len(angle), 2)), -angle)
        moved = self.flank_shift(profile, s, angle, side)[0] + z[:, None] * tilt[:, None, :]
        return np.einsum("tni,ni->tn", moved, normal)

    def flank_shift(
        self, profile: ToothProfile, s: np.ndarray, angle: np.ndarray, side: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Displacement (n_teeth, n, 2) mm of flanks at s (n,) mm in the teeth's frames, no tilt.

        Returns it and its derivative by s, which changes the tangent. side, angle : as in `heights`
        """
        mirror = MIRROR if side < 0 else np.ones(2)
        points, tangent, normal = (
            f(s) * mirror for f in (profile.point, profile.tangent, profile.normal)
        )
        height, rise = self.profile_height(profile, s)
        moved = self.moved(points, angle)
        turned = self.moved(points + tangent, angle) - moved
        bend = rise[:, None] * normal - (height * profile.curvature(s))[:, None] * tangent
        return moved + height[:, None] * normal, turned + bend
