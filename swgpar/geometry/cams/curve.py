"""What every cam offers, and its points on rays from the axis."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from swgpar.geometry.arrays import SignedDistance

MAX_STEPS = 50
"""Newton steps along a ray to a curve; a few suffice."""


class Cam(Protocol):
    """A closed curve with two lobes or three, major axis along +y; all lengths in mm.

    A turn by one lobe leaves it as it is.
    """

    def evaluate(self, xy: np.ndarray) -> SignedDistance:
        """Signed distance, outward normal and Hessian factor at points (n, 2) mm near it."""

    def outline(self, n: int) -> np.ndarray:
        """About n points of the surface (n, 2), mm.

        They lie all around the curve, with steps of about the same size. Neighbours follow each
        other, in either direction; separate parts follow one after the other.
        """


def on_rays(cam: Cam, ray: np.ndarray, start: float, depth: float = 0.0) -> np.ndarray:
    """Points (n, 2) mm on unit vectors `ray` (n, 2) from the axis, at `depth` mm inside of a cam.

    start : mm, radius from which Newton's method begins. The distance along a ray is convex: from
    outside it stays outside.
    """
    radius = np.full(len(ray), start)
    for _ in range(MAX_STEPS):
        distance, normal, _ = cam.evaluate(radius[:, None] * ray)
        step = (distance + depth) / np.einsum("ni,ni->n", normal, ray)
        radius -= step
        if np.abs(step).max(initial=0.0) < 1e-13 * radius.max(initial=0.0):
            break
    return radius[:, None] * ray
