"""Faces of the slave flanks, with the height of the exact, crowned surface over them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from swgpar.geometry.micro_geometry import crowning
from swgpar.geometry.rotation import MIRROR
from swgpar.meshing.sector import FlankGrid, SectorMesh
from swgpar.meshing.sweep import grid_quads

SAMPLES = 0.5 - 0.5 * np.cos(np.pi * (np.arange(5) + 0.5) / 5)
"""Positions per direction, in [0, 1], at which the exact surface is sampled; it is interpolated by
polynomials."""

OF_SAMPLES = np.linalg.inv(chebvander(1.0 - 2.0 * SAMPLES, len(SAMPLES) - 1))
"""Chebyshev coefficients (n, n) of the polynomials that are one at one of `SAMPLES`."""


@dataclass(frozen=True)
class FlankFaces:
    """Faces of one flank of sector 0, by rows of the profile, then along the width.

    corners : (n_face, 4) local nodes, at (a, b) = (0, 0), (1, 0), (1, 1), (0, 1): a along the
    profile, b along z
    size : (n_face, 2) mm, arc length and width;  normal : (n_face, 3) outward, undeformed
    offset : (n_face, n, n) mm, height of the exact, crowned surface over the facet at `SAMPLES`
    """

    corners: np.ndarray
    size: np.ndarray
    normal: np.ndarray
    offset: np.ndarray


def flank_faces(
    mesh: SectorMesh,
    grid: FlankGrid,
    removed: float,
    width: float,
    shape_name: str,
    stretch: float = 1.0,
) -> FlankFaces:
    """Faces of a flank; removed : mm, crowning at |z| = width / 2, of the curve `shape_name`.

    stretch : factor of the growth of the gear, by which the heights over the facets grow
    """
    corners = grid_quads(grid.nodes)
    ds, dz = np.diff(grid.s), np.diff(grid.z)
    size = np.stack(np.meshgrid(ds, dz, indexing="ij"), axis=-1).reshape(-1, 2)
    a, b = (v.ravel() for v in np.meshgrid(SAMPLES, SAMPLES, indexing="ij"))
    s, z = (values.ravel() for values in face_samples(grid))
    profile = mesh.profile
    side = MIRROR if grid.side < 0 else np.ones(2)
    outward = profile.normal(s) * side
    cut = crowning(removed, z, width, shape_name)[0] * profile.crowning_weight(s)
    exact = profile.point(s) * side - cut[:, None] * outward
    facet = np.einsum("qa,fai->fqi", bilinear(a, b), mesh.coords[corners]).reshape(-1, 3)
    height = stretch * np.sum((exact - facet[:, :2]) * outward, axis=1)
    offset = height.reshape(-1, len(SAMPLES), len(SAMPLES))
    middle = profile.normal(np.repeat(grid.s[:-1] + 0.5 * ds, len(dz))) * side
    return FlankFaces(corners, size, np.column_stack([middle, np.zeros(len(middle))]), offset)


def face_samples(grid: FlankGrid) -> tuple[np.ndarray, np.ndarray]:
    """Arc lengths and z (n_face, n, n) mm of the samples of all faces of a flank."""
    n = len(SAMPLES)
    shape = (len(grid.s) - 1, len(grid.z) - 1, n, n)
    s = grid.s[:-1, None] + np.diff(grid.s)[:, None] * SAMPLES
    z = grid.z[:-1, None] + np.diff(grid.z)[:, None] * SAMPLES
    s, z = np.broadcast_to(s[:, None, :, None], shape), np.broadcast_to(z[None, :, None, :], shape)
    return s.reshape(-1, n, n), z.reshape(-1, n, n)


def bilinear(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Shape functions (..., 4) of a face's corners at (a, b) in [0, 1]."""
    return np.stack([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b], axis=-1)


def lagrange(t: np.ndarray) -> np.ndarray:
    """Polynomials (..., n) that are one at one of `SAMPLES` and zero at the others, at t (...)."""
    return chebvander(1.0 - 2.0 * t, len(SAMPLES) - 1) @ OF_SAMPLES
