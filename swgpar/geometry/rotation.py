"""Rotations about the drive's axis z, and the reflection of a tooth at its centre line."""

from __future__ import annotations

import numpy as np

HALF_TURN = np.array([-1.0, -1.0, 1.0])
"""Factors of a vector's components (x, y, z) under a rotation by 180 degrees about z."""

SIXTHS = np.array(
    [
        [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
        for c, s in (
            (1.0, 0.0),
            (0.5, np.sqrt(0.75)),
            (-0.5, np.sqrt(0.75)),
            (-1.0, 0.0),
            (-0.5, -np.sqrt(0.75)),
            (0.5, -np.sqrt(0.75)),
        )
    ]
)
"""Rotations (6, 3, 3) about z by multiples of 60 degrees: half a turn is exact."""


def image_rotation(lobes: int, turns: int) -> np.ndarray:
    """Rotation (3, 3) about z by so many of `lobes` parts of a turn; lobes : 2, 3 or 6."""
    return SIXTHS[turns * (6 // lobes) % 6]


MIRROR = np.array([-1.0, 1.0])
"""Factors of the components (x, y) of a vector of one flank of the tooth at +y that give those of the other flank."""


def rotated(vectors: np.ndarray, angle: float | np.ndarray) -> np.ndarray:
    """Rotate vectors about z, counter-clockwise.

    Parameters
    ----------
    vectors : (..., 2) or (..., 3)
        Points or vectors in any unit; a third component is kept.
    angle : rad
        Scalar, or an array that broadcasts against ``vectors.shape[:-1]``.
    """
    c, s = np.cos(angle), np.sin(angle)
    x, y = vectors[..., 0], vectors[..., 1]
    components = [c * x - s * y, s * x + c * y]
    if vectors.shape[-1] == 3:
        components.append(np.broadcast_to(vectors[..., 2], components[0].shape))
    return np.stack(components, axis=-1)
