"""Quadrature on slave flank faces by segments: a face is cut along the edges of the master facets
it lies on.

Gap and shape functions of both sides are smooth inside a segment, so that a few Gauss points
integrate them exactly where the whole segment is in contact: the contact patch test then passes on
meshes that do not match. The cuts run along the face's own edges: exact where both grids are
aligned, as those of flanks swept along the axis are; for a tilt t between them the pressure of the
patch test is uniform to about 0.03 t.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.micro_geometry import crowning
from swgpar.geometry.rotation import MIRROR
from swgpar.meshing.sector import FlankGrid, SectorMesh

SAMPLES = 0.5 - 0.5 * np.cos(np.pi * (np.arange(5) + 0.5) / 5)
"""Positions per direction, in [0, 1], at which the exact surface is sampled; it is interpolated by
polynomials."""


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
    mesh: SectorMesh, grid: FlankGrid, removed: float, width: float, shape_name: str
) -> FlankFaces:
    """Faces of a flank; removed : mm, crowning at |z| = width / 2, of the curve `shape_name`."""
    corners = face_corners(grid.nodes)
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
    offset = np.sum((exact - facet[:, :2]) * outward, axis=1).reshape(
        -1, len(SAMPLES), len(SAMPLES)
    )
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


def face_corners(n: np.ndarray) -> np.ndarray:
    """Corners (n_face, 4) of the faces of a grid of nodes (n_s + 1, n_z + 1), as in
    `FlankFaces`."""
    return np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)


def bilinear(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Shape functions (..., 4) of a face's corners at (a, b) in [0, 1]."""
    return np.stack([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b], axis=-1)


def lagrange(t: np.ndarray) -> np.ndarray:
    """Polynomials (..., n) that are one at one of `SAMPLES` and zero at the others, at t (...)."""
    factors = np.subtract.outer(t, SAMPLES)
    values = np.empty_like(factors)
    for k, sample in enumerate(SAMPLES):
        others = np.delete(np.arange(len(SAMPLES)), k)
        values[..., k] = np.prod(factors[..., others] / (sample - SAMPLES[others]), axis=-1)
    return values


def _cuts(low: np.ndarray, high: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """Ends of the segments of [0, 1], ascending, (n, m): where the line from low to high (n,)
    crosses one of `lines`.

    Halves are cut too, and the number of segments padded by empty ones: points move continuously
    with the cuts.
    """
    first = np.searchsorted(lines, np.minimum(low, high))
    count = np.where(
        np.isfinite(low + high), np.searchsorted(lines, np.maximum(low, high)) - first, 0
    )
    step = np.arange(count.max(initial=0))
    crossed = lines[np.minimum(first[:, None] + step, len(lines) - 1)]
    with np.errstate(invalid="ignore", divide="ignore"):
        position = (crossed - low[:, None]) / (high - low)[:, None]
    position = np.where(step < count[:, None], np.clip(position, 0.0, 1.0), 1.0)
    ends = np.broadcast_to([0.0, 0.5, 1.0], (len(low), 3))
    return np.sort(np.concatenate([ends, position], axis=1), axis=1)


@dataclass(frozen=True)
class Segments:
    """Segments of faces: parent (n,) face of each, (a, b) (n, n_q) positions in it, share (n, n_q)
    of its area."""

    parent: np.ndarray
    a: np.ndarray
    b: np.ndarray
    share: np.ndarray


def _ends(
    foot_point: np.ndarray, corners: tuple[list[int], list[int]], length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n,) of both ends of faces on the master, from one component (n, 4) of their
    corners' foot points.

    Feet beyond the end of the flank lie on its straight continuation: the face is cut where the
    flank ends, so that
    what touches changes continuously. length : (n,) of the faces along the master, with sign, which
    stands in for a foot that is much farther off still, or across the tooth.
    """
    low, high = (
        np.where(np.isnan(a), b, np.where(np.isnan(b), a, 0.5 * (a + b)))
        for a, b in (foot_point[:, c].T for c in corners)
    )
    return np.where(np.isnan(low), high - length, low), np.where(np.isnan(high), low + length, high)


def cut_faces(
    foot_point: np.ndarray,
    size: np.ndarray,
    s: np.ndarray,
    z: np.ndarray,
    order: int,
    plane: bool = False,
) -> Segments:
    """Cut faces along the lines s and z of the master's nodes.

    foot_point : (n_face, 4, 2) mm, foot points of the corners on the master, nan where there is
    none
    size : (n_face, 2) mm of the faces along arc length, which runs in the opposite sense on the
    master, and z
    s, z : lines, ascending;  order : Gauss points per direction of a segment
    plane : nothing changes along z, where one point stands for all
    """
    along = [_cuts(*_ends(foot_point[..., 0], ([0, 3], [1, 2]), -size[:, 0]), s)]
    if plane:
        along.append(np.tile([0.0, 1.0], (len(size), 1)))
    else:
        along.append(_cuts(*_ends(foot_point[..., 1], ([0, 1], [3, 2]), size[:, 1]), z))
    width = [np.diff(ends, axis=1) for ends in along]
    parent, i, j = np.nonzero((width[0] > 1e-12)[:, :, None] & (width[1] > 1e-12)[:, None, :])
    (t, w), (tz, wz) = (np.polynomial.legendre.leggauss(n) for n in (order, 1 if plane else order))
    ta, tb = (v.ravel() for v in np.meshgrid(0.5 * (t + 1.0), 0.5 * (tz + 1.0), indexing="ij"))
    size_a, size_b = width[0][parent, i, None], width[1][parent, j, None]
    return Segments(
        parent,
        along[0][parent, i, None] + size_a * ta,
        along[1][parent, j, None] + size_b * tb,
        size_a * size_b * (0.25 * np.outer(w, wz).ravel()),
    )
