"""Bearing of the output: springs and forces on the mean motion of the surface that is the output.

With the displacement of that surface and its tilts about x and y, q, and those at the middle of the
bearing, B q, the bearing adds

    W = 1/2 (B q) . K (B q) - F . B q

to the potential. Forces keep their directions in space. Rotation about z is free.
"""

from __future__ import annotations

import numpy as np

from swgpar.constraints.distributing_coupling import ROTATION, TILT_X, TILT_Y, MeanMotion, X, Y


class OutputSprings:
    """Springs and forces at the middle of the bearing, of displacements along x, y and z and of
    tilts about x and y.

    stiffness : (5,) N/mm and N mm;  load : (5,) N and N mm, on the output
    lever : mm, from the middle of the coupled surface to that of the bearing, along z
    movable : (5,) bool, quantities that the model leaves free
    share : modelled share of the drive

    Attributes:
    factor : (m, 5) of the springs: the second derivative of W is its square
    """

    def __init__(
        self,
        stiffness: np.ndarray,
        load: np.ndarray,
        lever: float,
        movable: np.ndarray,
        share: float,
    ) -> None:
        self.to_bearing = np.eye(ROTATION)
        self.to_bearing[X, TILT_Y], self.to_bearing[Y, TILT_X] = lever, -lever
        self.to_bearing[:, ~movable] = self.to_bearing[~movable] = 0.0
        self.factor = np.sqrt(share * stiffness)[:, None] * self.to_bearing
        self.factor = self.factor[movable]
        self.force = share * self.to_bearing.T @ load

    def forces(self, motion: MeanMotion) -> np.ndarray:
        """Derivative (5,) of W by the quantities of the coupled surface, N and N mm."""
        return self.factor.T @ (self.factor @ motion.value[:ROTATION]) - self.force

    def moment(self, motion: MeanMotion) -> float:
        """Moment (N mm) about the drive's axis of springs and forces on the surface, of the model:
        they act on a surface that is displaced and tilted."""
        x, y, _, tilt_x, tilt_y = motion.value[:ROTATION]
        f_x, f_y, _, moment_x, moment_y = -self.forces(motion)
        return float(x * f_y - y * f_x + tilt_x * moment_y - tilt_y * moment_x)

    def spring_vectors(self, motion: MeanMotion) -> np.ndarray:
        """Vectors S (m, n, 3) of the part S S^T of the tangent."""
        return np.tensordot(self.factor, motion.gradient[:ROTATION], axes=1)

    def displacement(self, motion: MeanMotion) -> np.ndarray:
        """Displacements (mm) and tilts (rad) at the middle of the bearing, (5,)."""
        return self.to_bearing @ motion.value[:ROTATION]
