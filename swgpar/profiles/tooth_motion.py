"""Motion of a tooth of the flexible spline in the ring gear, as the cam passes by.

A tooth is a rigid body on the neutral line. In the cam's frame the tooth of the material angle psi
faces the slot at q psi, q = N_fs / N_rg. Points are complex numbers x + i y. With X and L of the
neutral line, a point Z of the tooth's frame (axis at 0, tooth on +i) is, in the frame of its slot,

    z = c + exp(i alpha) Z,  c = (X - i r exp(i (psi + L))) exp(-i q psi),  alpha = psi + L - q psi.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swgpar.geometry.arrays import Floats
from swgpar.geometry.neutral_line import NeutralLine


class Pose(NamedTuple):
    """Positions of a moving frame: z = c + exp(i alpha) Z, with the derivatives by psi.

    c, c1, c2 : (n,) complex, mm;  angle, angle1, angle2 : (n,) rad
    turn : (n,) exp(i alpha)
    """

    c: np.ndarray
    c1: np.ndarray
    c2: np.ndarray
    angle: Floats
    angle1: Floats
    angle2: Floats
    turn: np.ndarray

    def inverse(self) -> Pose:
        """The fixed frame as seen from the moving one."""
        turn = np.conj(self.turn)
        a1, a2 = self.angle1, self.angle2
        second = self.c2 - 2j * a1 * self.c1 - (1j * a2 + a1**2) * self.c
        return Pose(
            -turn * self.c,
            -turn * (self.c1 - 1j * a1 * self.c),
            -turn * second,
            -self.angle,
            -a1,
            -a2,
            turn,
        )

    def taken(self, index: NDArray[np.intp]) -> Pose:
        """The positions `index` of these."""
        return Pose(*(each[index] for each in self))

    def turned(self, angle: Floats) -> Pose:
        """These positions turned about the axis by `angle` (n,) rad, which does not depend on
        psi."""
        turn = np.exp(1j * angle)
        c, c1, c2, own, angle1, angle2, own_turn = self
        return Pose(turn * c, turn * c1, turn * c2, own + angle, angle1, angle2, turn * own_turn)

    def moved(self, points: np.ndarray) -> np.ndarray:
        """Points of the moving frame (n,) complex, mm, in the fixed one."""
        return self.c + self.turn * points


@dataclass(frozen=True)
class ToothMotion:
    """Motion on the neutral line `line` of a drive with these tooth numbers."""

    line: NeutralLine
    teeth_fs: int
    teeth_rg: int

    def pose(self, psi: Floats) -> Pose:
        """Pose of the flexible spline's tooth in its slot, at the material angles psi (n,) rad."""
        line, q = self.line, self.teeth_fs / self.teeth_rg
        offset, tilt, tilt1, tilt2 = line.at(psi)
        angle = (1.0 - q) * psi + tilt
        turn, slip = np.exp(1j * angle), line.radius * (1.0 + tilt1) - line.stretched
        c = np.exp(1j * (1.0 - q) * psi) * offset - 1j * line.radius * turn
        bend = 1j * (1.0 + tilt1 - 2.0 * q) * slip + line.radius * tilt2
        return Pose(
            c,
            turn * slip - 1j * q * c,
            turn * bend - q**2 * c,
            angle,
            1.0 + tilt1 - q,
            tilt2,
            turn,
        )

    def mirror_image(self) -> ToothMotion:
        """Motion on the mirror image of the cam, in the plane through its major axis."""
        tilts = tuple(tilt.conjugate() + 0.0 for tilt in self.line.tilts)
        return replace(self, line=replace(self.line, tilts=tilts))

    def mirrored(self, points: np.ndarray) -> np.ndarray:
        """Points x + i y (n,) mm between the frames of the slot and the tooth clockwise of it.

        The image is a mirror image, so that the flank at x > 0 of that tooth is the one that faces
        the slot. The same function leads back.
        """
        half_pitch = np.exp(1j * np.pi / self.teeth_rg)
        return -np.conj(points * half_pitch)
