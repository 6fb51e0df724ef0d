"""Rigid bodies in the view of a drive: the cam or its rollers, and the balls of its bearing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from swgpar.geometry.bearing import RigidParts
from swgpar.geometry.cams import cam_outlines
from swgpar.geometry.rotation import rotated

CAM_POINTS = 360
"""Around the cam, which is drawn without crowning and slope."""

BALL_POINTS = (12, 24)
"""From pole to pole of a ball, and around it."""


@dataclass(frozen=True)
class RigidSolid:
    """Closed surfaces that can be seen whole from a point inside of them.

    points : (n, 3) mm;  quads : (m, 4), of the surfaces;  middles : (m,) of the points inside
    """

    points: np.ndarray
    quads: np.ndarray
    middles: np.ndarray

    @property
    def triangles(self) -> np.ndarray:
        """Triangles (2 m, 3) of the surfaces."""
        return np.concatenate([self.quads[:, [0, 1, 2]], self.quads[:, [0, 2, 3]]])

    @property
    def cells(self) -> np.ndarray:
        """Pyramids (m, 8) as hexahedra: four corners are the point inside."""
        return np.column_stack([np.tile(self.middles[:, None], 4), self.quads])


def _joined(solids: list[RigidSolid]) -> RigidSolid:
    first = np.cumsum([0, *(len(solid.points) for solid in solids)])
    return RigidSolid(
        np.concatenate([solid.points for solid in solids]),
        np.concatenate([solid.quads + k for k, solid in zip(first, solids, strict=False)]),
        np.concatenate([solid.middles + k for k, solid in zip(first, solids, strict=False)]),
    )


def cam_solid(parts: RigidParts) -> RigidSolid:
    """The cam, or its rollers, as prisms, with the major axis along +y; on a bearing it reaches to
    the groove of the inner race."""
    outlines = cam_outlines(parts.curve, CAM_POINTS)
    return _joined([_prism(outline, 0.5 * parts.width) for outline in outlines])


def _prism(outline: np.ndarray, half: float) -> RigidSolid:
    """Between -half and half (mm) along z. outline : (n, 2) mm, counter-clockwise or clockwise"""
    count, middle = len(outline), outline.mean(axis=0)
    ring = np.vstack([outline, middle])
    ends = [np.column_stack([ring, np.full(count + 1, z)]) for z in (-half, half)]
    points = np.concatenate([*ends, [[*middle, 0.0]]])
    low = np.arange(count)
    after, high = np.roll(low, -1), low + count + 1
    axis = np.full(count, count)
    quads = [
        (low, after, np.roll(high, -1), high),
        (low, after, axis, axis),
        (high, np.roll(high, -1), axis + count + 1, axis + count + 1),
    ]
    together = np.concatenate([np.column_stack(corners) for corners in quads])
    return RigidSolid(points, together, np.full(len(together), len(points) - 1))


def ball_solids(parts: RigidParts, balls: Mapping[str, np.ndarray], row: int) -> RigidSolid | None:
    """The balls at a row of the history, from 0, in the frame of the cam; None without any.

    balls : columns of balls.csv
    """
    here = balls["increment"] == row + 1
    if parts.ball_lines is None or not here.any():
        return None
    centres, _, _ = parts.ball_lines(np.radians(balls["cam_angle_deg"][here]))
    ball = _ball(0.5 * parts.ball_diameter)
    return _joined(
        [RigidSolid(ball.points + [*centre, 0.0], ball.quads, ball.middles) for centre in centres]
    )


def _ball(radius: float) -> RigidSolid:
    rows, around = BALL_POINTS
    polar = np.linspace(0.0, np.pi, rows + 1)[:, None]
    angle = 2.0 * np.pi * np.arange(around) / around
    shape = rows + 1, around
    x, y = np.sin(polar) * np.cos(angle), np.sin(polar) * np.sin(angle)
    points = np.stack([x, y, np.broadcast_to(np.cos(polar), shape)], axis=2).reshape(-1, 3)
    node = np.arange(len(points)).reshape(shape)
    after = np.roll(node, -1, axis=1)
    corners = node[:-1], after[:-1], after[1:], node[1:]
    quads = np.stack(corners, axis=2).reshape(-1, 4)
    points = np.vstack([radius * points, np.zeros(3)])
    return RigidSolid(points, quads, np.full(len(quads), len(points) - 1))


def turned(solid: RigidSolid, angle: float) -> np.ndarray:
    """Points (n, 3) mm of a solid in the frame of the cam. angle : rad, of the cam"""
    return np.column_stack([rotated(solid.points[:, :2], angle), solid.points[:, 2]])
