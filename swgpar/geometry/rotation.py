"""Rotations about the drive's axis z, and the reflection of a tooth at its centre line."""

from __future__ import annotations

import numpy as np

SINE = np.sqrt(0.75)
COSINES, SINES = (1.0, 0.5, -0.5, -1.0, -0.5, 0.5), (0.0, SINE, SINE, 0.0, -SINE, -SINE)

SIXTHS = np.array(
    [[[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]] for c, s in zip(COSINES, SINES, strict=True)]
)
"""Rotations (6, 3, 3) about z by multiples of a sixth of a turn, those that take a drive of two or
three lobes to itself among them. Half a turn is exact. The kernels have the same table
(`kernel/contact.hpp`)."""


def sixths_of_turn(copies: int, number: np.ndarray | int) -> np.ndarray:
    """Sixths of a turn, uint8, of the images with these integers (n,); copies : 1, 2 or 3."""
    return (np.asarray(number) % copies * (6 // copies)).astype(np.uint8)


def to_images(vectors: np.ndarray, sixths: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) of owners, rotated to their images by sixths (...) of a turn, uint8."""
    return _rotated_by(SIXTHS, vectors, sixths)


def to_owners(vectors: np.ndarray, sixths: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) of images, rotated back to their owners; sixths as in `to_images`."""
    return _rotated_by(SIXTHS.transpose(0, 2, 1), vectors, sixths)


def _rotated_by(matrices: np.ndarray, vectors: np.ndarray, sixths: np.ndarray) -> np.ndarray:
    image = sixths != 0
    if not image.any():
        return vectors
    out = vectors.copy()
    out[image] = np.einsum("nij,nj->ni", matrices[sixths[image]], vectors[image])
    return out


MIRROR = np.array([-1.0, 1.0])
"""Factors of (x, y) that give a vector of the other flank of the tooth at +y."""


def rotated(vectors: np.ndarray, angle: float | np.ndarray) -> np.ndarray:
    """Rotate vectors about z, counter-clockwise.

    vectors : (..., 2) or (..., 3), points or vectors in any unit; a third component is kept
    angle : rad, scalar, or an array that broadcasts against ``vectors.shape[:-1]``
    """
    c, s = np.cos(angle), np.sin(angle)
    x, y = vectors[..., 0], vectors[..., 1]
    components = [c * x - s * y, s * x + c * y]
    if vectors.shape[-1] == 3:
        components.append(np.broadcast_to(vectors[..., 2], components[0].shape))
    return np.stack(components, axis=-1)


def rotation_between(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Rotations (n,) rad about z that fit the motion of points (n, m, 2 or 3) best, by the polar
    decomposition."""
    a, b = (points - points.mean(axis=1, keepdims=True) for points in (before, after))
    across = (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]).sum(axis=1)
    return np.arctan2(across, (a * b)[..., :2].sum(axis=(1, 2)))
