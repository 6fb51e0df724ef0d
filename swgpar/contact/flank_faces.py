"""Faces of the slave flanks, with the height of the exact, crowned surface over them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.chebyshev import chebpts1, chebpts2, chebvander

from swgpar.contact.flank_curve import has_a_joint
from swgpar.geometry.micro_geometry import NO_CROWNING, FlankCrowning
from swgpar.geometry.rotation import MIRROR
from swgpar.meshing.sector import FlankGrid, SectorMesh
from swgpar.meshing.sweep import grid_quads
from swgpar.profiles.flank import ToothProfile

PER_DIRECTION = 9
"""Samples of the exact surface of a face in each direction. With five, S-shaped flanks of six
elements are 0.02 to 0.06 micrometres off: where they nearly conform that is a multiple of the
pressure (docs/verification/error_sources_plane.md)."""

SAMPLES = 0.5 + 0.5 * chebpts2(PER_DIRECTION)
"""Their positions in [0, 1], the ends among them; the surface is interpolated by polynomials. A
step of a nanometre between two faces is a multiple of the pressure on the finest cells."""

OF_SAMPLES = np.linalg.inv(chebvander(1.0 - 2.0 * SAMPLES, len(SAMPLES) - 1))
"""Chebyshev coefficients (n, n) of the polynomials that are one at one of `SAMPLES`."""

AT_JOINTS = 0.5 + 0.5 * chebpts1(5)
"""Samples along the profile of faces with a joint of it inside: with more of them, and with the
ends among them, the polynomial swings further about a curvature that jumps."""

FROM_FEWER = chebvander(1.0 - 2.0 * SAMPLES, len(AT_JOINTS) - 1) @ np.linalg.inv(
    chebvander(1.0 - 2.0 * AT_JOINTS, len(AT_JOINTS) - 1)
)
"""Values (n, 5) at `SAMPLES` of the polynomials that are one at one of `AT_JOINTS`."""

FEET = 40
"""Most steps to a foot on the exact flank. Each leaves the height over the facet over the radius of
curvature of the distance, a tenth at most."""


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
    own: FlankCrowning,
    facing: FlankCrowning = NO_CROWNING,
    stretch: float = 1.0,
) -> FlankFaces:
    """Faces of a flank. own : its crowning, which the mesh has

    facing : crowning of the flank that it meets, which the gap has as if it were on this one: the
    kernel takes that flank as a cylinder
    stretch : factor of the growth of the gear, by which the heights over the facets grow
    """
    corners = grid_quads(grid.nodes)
    ds, dz = np.diff(grid.s), np.diff(grid.z)
    size = np.stack(np.meshgrid(ds, dz, indexing="ij"), axis=-1).reshape(-1, 2)
    profile = mesh.profile
    side = MIRROR if grid.side < 0 else np.ones(2)

    def heights(along: np.ndarray) -> np.ndarray:
        """Over the facets (n_face, n_along, n) mm, at places (n_along,) along the profile."""
        s, z = (values.ravel() for values in face_samples(grid, along))
        outward = profile.normal(s) * side
        cut = own.removed(z) * profile.crowning_weight(s) + facing.removed(z)
        exact = profile.point(s) * side - cut[:, None] * outward
        a, b = (v.ravel() for v in np.meshgrid(along, SAMPLES, indexing="ij"))
        facet = np.einsum("qa,fai->fqi", bilinear(a, b), mesh.coords[corners]).reshape(-1, 3)
        height = stretch * np.sum((exact - facet[:, :2]) * outward, axis=1)
        return height.reshape(-1, len(along), len(SAMPLES))

    offset, at_joint = heights(SAMPLES), np.repeat(has_a_joint(profile, grid.s), len(dz))
    if at_joint.any():
        fewer = heights(AT_JOINTS)[at_joint]
        offset[at_joint] = np.einsum("ij,fjk->fik", FROM_FEWER, fewer)
    middle = profile.normal(np.repeat(grid.s[:-1] + 0.5 * ds, len(dz))) * side
    return FlankFaces(corners, size, np.column_stack([middle, np.zeros(len(middle))]), offset)


def face_samples(grid: FlankGrid, along: np.ndarray = SAMPLES) -> tuple[np.ndarray, np.ndarray]:
    """Arc lengths and z (n_face, n_along, n) mm of the samples of all faces of a flank. along :
    places along the profile, in [0, 1]"""
    shape = (len(grid.s) - 1, len(grid.z) - 1, len(along), len(SAMPLES))
    s = grid.s[:-1, None] + np.diff(grid.s)[:, None] * along
    z = grid.z[:-1, None] + np.diff(grid.z)[:, None] * SAMPLES
    s, z = np.broadcast_to(s[:, None, :, None], shape), np.broadcast_to(z[None, :, None, :], shape)
    return s.reshape(-1, *shape[2:]), z.reshape(-1, *shape[2:])


def exact_arc_lengths(
    profile: ToothProfile, s: np.ndarray, facet: np.ndarray, place: np.ndarray
) -> np.ndarray:
    """Arc lengths (n,) mm of the feet on the exact flank of places on its facets.

    s : (n_node,) mm, of the flank's nodes;  facet : (n,) numbers;  place : (n,) in [0, 1] on each
    """
    points, low, high = _on_facets(profile, s, facet, place), s[facet], s[facet + 1]
    arc = low + place * (high - low)
    for _ in range(FEET):
        step = np.sum((points - profile.point(arc)) * profile.tangent(arc), axis=1)
        arc = np.clip(arc + step, low, high)
        if np.abs(step).max(initial=0.0) < 1e-13 * s[-1]:
            break
    return arc


def exact_strips(
    profile: ToothProfile, s: np.ndarray, facet: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Ends (n,) and (n,) mm, arc lengths, of cells on the exact flank, over which the gap of the
    contact law has the curvature of the flanks.

    low, high : (n,) ends of the cells on their facets, in [0, 1], ascending along the flank;  s,
    facet : as above

    The gap is that of points on facets with the height of the flank along its own normal. Where the
    flank is curved a facet is shorter than its arc and inclined to it. The curvature is right over
    the mean of the lengths along the flank's direction and on the flank (docs/theory,
    "Widths on arcs"). Cells that touch stay together, around the middle of all of them.
    """
    begin, end = (exact_arc_lengths(profile, s, facet, place) for place in (low, high))
    along = _on_facets(profile, s, facet, high) - _on_facets(profile, s, facet, low)
    chord = np.sum(along * profile.tangent(0.5 * (begin + end)), axis=1)
    width = np.sqrt(chord * (end - begin))
    apart = np.flatnonzero(begin[1:] - end[:-1] > 1e-9 * s[-1]) + 1
    edges = np.zeros((2, len(width)))
    for cells in np.split(np.arange(len(width)), apart):
        ends = np.concatenate([[0.0], np.cumsum(width[cells])])
        ends += 0.5 * (begin[cells[0]] + end[cells[-1]] - ends[-1])
        edges[:, cells] = ends[:-1], ends[1:]
    return edges[0], edges[1]


def _on_facets(
    profile: ToothProfile, s: np.ndarray, facet: np.ndarray, place: np.ndarray
) -> np.ndarray:
    """Points (n, 2) mm at places on facets."""
    nodes = profile.point(s)
    return (1.0 - place)[:, None] * nodes[facet] + place[:, None] * nodes[facet + 1]


def bilinear(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Shape functions (..., 4) of a face's corners at (a, b) in [0, 1]."""
    return np.stack([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b], axis=-1)


def lagrange(t: np.ndarray) -> np.ndarray:
    """Polynomials (..., n) that are one at one of `SAMPLES` and zero at the others, at t (...)."""
    return chebvander(1.0 - 2.0 * t, len(SAMPLES) - 1) @ OF_SAMPLES
