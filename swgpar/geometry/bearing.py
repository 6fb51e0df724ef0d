"""Flexible ball bearing between cam and flexible spline: its sizes, and where its balls are.

The outer surface of the outer race takes the place of the cam's surface. Both grooves are curves at
a constant distance inside of the cam's curve, so that all three have the same normals. The inner
race is rigid on the cam.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy

from swgpar.geometry.cams import Cam, OffsetCam
from swgpar.geometry.cams.curve import on_rays

BallLines = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
"""Gives centres (n, 2) mm, groove normals (n, 2) in the cam's frame and curvatures (n,) 1/mm of the
centres' curve at angles (n,) rad from the major axis."""

OUTLINE_POINTS = 2000
"""Points of a cam at which its curvature and its hollows are looked at."""


@dataclass(frozen=True)
class BearingSizes:
    """Sizes of a bearing in the undeformed, circular state.

    outer_radius : mm, of the outer race's outer surface, the inner radius of the flexible spline
    thickness : mm, of the outer race;  ball_diameter : mm
    """

    outer_radius: float
    thickness: float
    ball_diameter: float

    @property
    def outer_groove(self) -> float:
        """Radius of the outer race at the bottom of its groove, mm."""
        return self.outer_radius - self.thickness

    @property
    def inner_groove(self) -> float:
        """Mean radius of the inner race at the bottom of its groove, mm."""
        return self.outer_groove - self.ball_diameter

    @property
    def pitch_diameter(self) -> float:
        """Mean diameter of the curve on which the centres of the balls are, mm."""
        return self.outer_groove + self.inner_groove

    @property
    def centre_depth(self) -> float:
        """Distance of the centres of the balls from the cam's curve, mm."""
        return self.thickness + 0.5 * self.ball_diameter

    def rolling_speed(self, outer_speed: float) -> float:
        """Speed of the cage over that of the wave generator when the balls roll on both races.

        outer_speed : speed of the outer race over that of the wave generator
        """
        return (self.inner_groove + self.outer_groove * outer_speed) / (
            self.inner_groove + self.outer_groove
        )


@dataclass(frozen=True)
class RigidParts:
    """What of a wave generator is rigid, in the frame of the cam, without crowning and slope.

    curve : of the cam, or of the groove of the inner race on it;  width : mm
    ball_lines, ball_diameter : of the balls, mm; None and 0 without a bearing
    """

    curve: Cam
    width: float
    ball_lines: BallLines | None = None
    ball_diameter: float = 0.0


def ball_lines(
    cam: Cam, depth: float, angle: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centres (n, 2) mm of the balls, normals (n, 2) and curvatures (n,) 1/mm of their curve.

    All in the cam's frame; the grooves have the same normals.

    cam : curve of the cam;  depth : mm, of the centres inside of it
    angle : (n,) rad, of the centres from the major axis, counter-clockwise
    """
    ray = np.column_stack([-np.sin(angle), np.cos(angle)])
    centre = on_rays(cam, ray, float(np.linalg.norm(cam.outline(4), axis=1).max()), depth)
    _, normal, curvature = cam.evaluate(centre)
    return centre, normal, curvature


def smallest_curvature_radius(cam: Cam) -> float:
    """Smallest radius of curvature (mm) of a cam; inf for straight lines only."""
    largest = float(cam.evaluate(cam.outline(OUTLINE_POINTS))[2].max())
    return 1.0 / largest if largest > 0.0 else np.inf


def depth_of_hollows(cam: Cam, depth: float) -> float:
    """Largest distance (mm) between a parallel curve of a cam and a ring pressed on it that spans
    its hollows; 0 of a convex curve.

    depth : mm, of the curve inside of the cam's
    """
    curve = OffsetCam(cam, -depth).outline(OUTLINE_POINTS)
    x, y = (np.roll(curve, -1, axis=0) - curve).T
    turns = x * np.roll(y, -1) - y * np.roll(x, -1)
    if turns.min() * turns.max() > 0.0:
        return 0.0  # a convex curve; its hull takes five times as long
    hull = scipy.spatial.ConvexHull(curve)
    spanned = np.delete(curve, hull.vertices, axis=0)  # none of a convex curve
    normals, heights = hull.equations[:, :2], hull.equations[:, 2]
    return float((-(spanned @ normals.T + heights).max(axis=1)).max(initial=0.0))
