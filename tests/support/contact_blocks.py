"""Two elastic blocks pressed together by the flank contact of the program, on one rank, solved by
Newton's iteration with SciPy."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from mpi4py import MPI
from scipy.sparse import bsr_matrix, csr_matrix
from scipy.sparse.linalg import spsolve

from support.element_mesh import ElementMesh
from swgpar.contact.flank_pairs import MasterFlanks
from swgpar.contact.flank_state import SearchRange
from swgpar.contact.flanks import FlankContact
from swgpar.contact.search import FlankPair
from swgpar.fem.body import FLEXIBLE_SPLINE, RING_GEAR, Body
from swgpar.fem.local_nodes import LocalNodes
from swgpar.geometry.micro_geometry import FlankCrowning
from swgpar.geometry.rotation import MIRROR
from swgpar.load.load_states import LoadState, Stage
from swgpar.materials import Material
from swgpar.meshing.sector import FlankGrid, SectorMesh

ORDERING = "MMD_AT_PLUS_A"
"""Of SuperLU, for matrices with a symmetric pattern."""

PAIR = FlankPair(sector=0, side=1, ring=0, ring_sixths=0, ring_tooth=0)
"""The upper block's face is the flexible spline's flank, the lower block's the ring gear's."""

CLOSED = LoadState(Stage.LOAD, 3, flank_clearance=0.0)


class Rows:
    """All blocks among the first n of n_local nodes (None: n), of a symmetric matrix the upper
    triangle."""

    def __init__(self, n: int, symmetric: bool = True, n_local: int | None = None) -> None:
        first = np.arange(n) if symmetric else np.zeros(n, dtype=np.int64)
        self.start = np.concatenate([[0], np.cumsum(n - first)]).astype(np.int64)
        self.column = np.concatenate([np.arange(k, n) for k in first]).astype(np.int32)
        self.values = np.zeros((len(self.column), 3, 3))
        self.number, self.n_own, self.symmetric = (
            np.arange(n_local or n, dtype=np.int32),
            n,
            symmetric,
        )

    def matrix(self) -> np.ndarray:
        full = np.zeros((self.n_own, 3, self.n_own, 3))
        row = np.repeat(np.arange(self.n_own), np.diff(self.start))
        for r, c, v in zip(row, self.column, self.values):
            full[r, :, c] = v.T
            if self.symmetric:
                full[c, :, r] = v
        return full.reshape(3 * self.n_own, -1)


class PatternRows:
    """The blocks with these keys, row * n + column, of a matrix of n nodes."""

    def __init__(self, keys: np.ndarray, n: int, symmetric: bool) -> None:
        self.keys, self.n_own, self.symmetric = keys, n, symmetric
        row, column = np.divmod(keys, n)
        self.start = np.searchsorted(row, np.arange(n + 1)).astype(np.int64)
        self.column, self.number = column.astype(np.int32), np.arange(n, dtype=np.int32)
        self.values = np.zeros((len(keys), 3, 3))

    def matrix(self) -> csr_matrix:
        shape = (3 * self.n_own, 3 * self.n_own)
        blocks = self.values.transpose(0, 2, 1)
        found = bsr_matrix((blocks, self.column, self.start), shape=shape).tocsr()
        if not self.symmetric:
            return found
        row = np.repeat(np.arange(self.n_own), np.diff(self.start))
        above = np.where((row != self.column)[:, None, None], blocks, 0.0)
        return found + bsr_matrix((above, self.column, self.start), shape=shape).tocsr().T


def master(
    points: np.ndarray, tangents: np.ndarray, s: np.ndarray, z: np.ndarray, first: int
) -> MasterFlanks:
    """One flank whose nodes are numbered from `first`; the tangent runs to +x, the outward normal
    to +y."""
    n = len(s) * len(z)
    return MasterFlanks(
        s,
        z,
        points[None].copy(),
        tangents[None].copy(),
        np.zeros((1, len(s) - 1, 4, 2)),
        np.array([-1.0]),  # x cross z points to -y
        np.array([[1.0, 0.0]]),
        (first + np.arange(n, dtype=np.int32)).reshape(1, len(s), len(z)),
        np.zeros((1, len(s), len(z)), dtype=np.uint8),
    )


def block(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points (n, 3), hexahedra (m, 8) and the numbers (n_x, n_y, n_z) of the nodes of a grid."""
    points = np.stack(np.meshgrid(x, y, z, indexing="ij"), -1)
    number = np.arange(points[..., 0].size).reshape(points.shape[:3])
    corner = [
        (0, 0, 0),
        (1, 0, 0),
        (1, 1, 0),
        (0, 1, 0),
        (0, 0, 1),
        (1, 0, 1),
        (1, 1, 1),
        (0, 1, 1),
    ]
    n = np.array(number.shape) - 1
    hexes = [number[a : a + n[0], b : b + n[1], c : c + n[2]].ravel() for a, b, c in corner]
    return points.reshape(-1, 3), np.stack(hexes, axis=1), number


@dataclass(frozen=True)
class Surface:
    """Contact surface of a block as the profile of a tooth: an arc, flat without a radius.

    apex : (2,) mm, its lowest or highest point;  first : mm along the arc from there to its start
    facing : -1 on the upper block, whose outward normal points to -y, +1 on the lower one
    radius : mm, of a convex surface
    """

    apex: tuple[float, float]
    first: float
    facing: int
    radius: float = np.inf

    @property
    def breaks(self) -> np.ndarray:
        """Arc lengths (n,) mm of its joints."""
        return np.zeros(0)

    def _angle(self, s: np.ndarray) -> np.ndarray:
        return (self.first + np.asarray(s)) / self.radius

    def _own(self, vectors: np.ndarray) -> np.ndarray:
        """The ring gear's flank is the mirror image of its profile."""
        return vectors * MIRROR if self.facing > 0 else vectors

    def place(self, s: np.ndarray) -> np.ndarray:
        """Points (n, 2) mm."""
        if np.isinf(self.radius):
            x, y = self.first + np.asarray(s), np.zeros_like(s)
        else:
            x = self.radius * np.sin(self._angle(s))
            y = self.facing * self.radius * (np.cos(self._angle(s)) - 1.0)
        return np.column_stack([x, y]) + self.apex

    def point(self, s: np.ndarray) -> np.ndarray:
        return self._own(self.place(s))

    def tangent(self, s: np.ndarray) -> np.ndarray:
        t = self._angle(s)
        return self._own(np.column_stack([np.cos(t), -self.facing * np.sin(t)]))

    def normal(self, s: np.ndarray) -> np.ndarray:
        t = self._angle(s)
        return self._own(np.column_stack([np.sin(t), self.facing * np.cos(t)]))

    def crowning_weight(self, s: np.ndarray) -> np.ndarray:
        return np.ones_like(s)


@dataclass(frozen=True)
class Block:
    """A body: points (n, 3) mm, hexes (m, 8), the nodes (n_s, n_z) of its contact surface and their
    arc lengths s (n_s,) and z (n_z,) on it, mm."""

    points: np.ndarray
    hexes: np.ndarray
    nodes: np.ndarray
    s: np.ndarray
    z: np.ndarray
    surface: Surface
    material: Material

    @property
    def mesh(self) -> SectorMesh:
        """The block as the sector of a gear of one tooth."""
        upper = self.surface.facing < 0
        none = np.zeros(0, dtype=np.int32)
        return SectorMesh(
            FLEXIBLE_SPLINE if upper else RING_GEAR,
            1,
            0.0,
            self.points,
            self.hexes.astype(np.int32),
            none,
            none,
            {},
            {},
            (FlankGrid(self.nodes, self.s, self.z, 1 if upper else -1),),
            cast(Any, self.surface),
            {},
        )


def arc_block(
    s: np.ndarray, depth: np.ndarray, z: np.ndarray, surface: Surface, material: Material
) -> Block:
    """A block of columns of elements below the nodes s (n_s,) of a surface.

    depth : (n_y,) mm, ascending from 0, of the nodes of a column at the apex; the far side is flat
    """
    ascending = depth if surface.facing < 0 else depth[::-1]
    points, hexes, number = block(s, ascending, z)
    nodes = number[:, 0 if surface.facing < 0 else -1]
    place = surface.place(s - s[0])
    points = points.reshape(*number.shape, 3)
    below = points[..., 1] / depth[-1]
    points[..., 0] = place[:, 0, None, None]
    far = surface.apex[1] - surface.facing * depth[-1]
    points[..., 1] = (1.0 - below) * place[:, 1, None, None] + below * far
    return Block(points.reshape(-1, 3), hexes, nodes, s - s[0], z, surface, material)


class OneRank:
    """What the flank contact asks of a partition: two bodies of one sector on one rank."""

    comm = MPI.COMM_SELF

    def __init__(self, n_lower: int, n_upper: int) -> None:
        self.first = {RING_GEAR: 0, FLEXIBLE_SPLINE: n_lower}
        self.row_start, self.n_own = 0, n_lower + n_upper
        self.n_global = self.n_own

    def owns(self, number: np.ndarray) -> np.ndarray:
        return (number >= 0) & (number < self.n_own)

    def owner_of_sector(self, body: str, index: np.ndarray) -> np.ndarray:
        return np.zeros_like(index)

    def node_numbers(
        self, body: str, index: np.ndarray, nodes: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        number = (self.first[body] + nodes.astype(np.int64))[None]
        return number, np.zeros(number.shape, dtype=np.uint8)


class FixedRing:
    """The lower block does not rotate as a whole."""

    floats = False

    def ring_rotation(self, u: np.ndarray) -> float:
        return 0.0

    def add_ring_moment(self, u: np.ndarray, moment: float, residual: np.ndarray) -> None:
        pass


def _straight_ahead(tooth: np.ndarray) -> np.ndarray:
    """Angles of sectors, rad."""
    return 0.0 * np.asarray(tooth, dtype=float)


def _elements(block: Block) -> Any:
    mesh = block.mesh
    layout = SimpleNamespace(
        name=mesh.body,
        mesh=mesh,
        body=Body(mesh, (block.material,), 1.0),
        first_tooth=0,
        sector_angle=_straight_ahead,
        chain_angle=_straight_ahead,
    )
    return SimpleNamespace(layout=layout)


@dataclass(frozen=True)
class Pressed:
    """The cells of an equilibrium, by lines.

    line : (n,) number of each cell's line;  x : (n,) mm, places of their middles
    width, length : (n,) mm, along the profile and across;  force : (n,) N/mm, per length of the
    line;  gap : (n,) mm, of the elements' surfaces, averaged over each cell, inf without a foot
    contact : (n, 3) N, forces on the nodes against the motion
    """

    line: np.ndarray
    x: np.ndarray
    width: np.ndarray
    length: np.ndarray
    force: np.ndarray
    gap: np.ndarray
    contact: np.ndarray

    @property
    def pressure(self) -> np.ndarray:
        """MPa"""
        return self.force / self.width


class Blocks:
    """The lower block's surface is the master, the faces of the upper one are the slaves; the nodes
    of the lower block come first.

    fixed (n, 3) : components with a given displacement
    coefficient : of friction, on the way from the displacement of the last `press`, at first
    `before`
    incompatible : elements with incompatible modes
    """

    def __init__(
        self,
        lower: Block,
        upper: Block,
        fixed: np.ndarray,
        *,
        coefficient: float = 0.0,
        before: np.ndarray | None = None,
        incompatible: bool = True,
        reach: float = 0.2,
    ) -> None:
        n_lower, n_upper = len(lower.points), len(upper.points)
        self.points = np.vstack([lower.points, upper.points])
        self.first, self.fixed, self.before = n_lower, fixed, before
        bodies = ((lower.hexes, lower.material), (upper.hexes + n_lower, upper.material))
        self.meshes = [
            ElementMesh(self.points, hexes, material, incompatible=incompatible)
            for hexes, material in bodies
        ]
        partition = cast(Any, OneRank(n_lower, n_upper))
        self.local = LocalNodes(partition, np.zeros(0, dtype=np.int64))
        self.reach = reach
        self.flanks = FlankContact(
            partition,
            _elements(upper),
            _elements(lower),
            FixedRing(),
            crowning=(FlankCrowning(), FlankCrowning()),
            max_gap=reach,
            pressure_limit=np.inf,
            friction_coefficient=coefficient,
            lines_on_layer=2,
        )

    def search(self, u: np.ndarray) -> np.ndarray:
        """Begin anew with the faces near each other at u; keys of the tangent's blocks."""
        distances = SearchRange(self.reach, self.reach, self.reach)
        friction = self.flanks.friction_coefficient > 0.0
        return self.flanks.search(
            [PAIR], self.local, u, distances, self.before if friction else None
        )

    def take_all_faces(self) -> None:
        """Evaluate all faces, also those whose middle the search finds beyond the flank's end."""
        self.flanks.cells.near = np.arange(self.flanks.n_face)

    def forces(self, u: np.ndarray) -> np.ndarray:
        """Contact forces (n, 3) N on the nodes against the motion, at u."""
        out = np.zeros_like(u)
        self.flanks.evaluate(u, CLOSED, out, None)
        return out

    def tangent(self, u: np.ndarray, keys: np.ndarray) -> csr_matrix:
        """Tangent of the contact at u, with the blocks of these keys at least."""
        n = len(u)
        while True:
            rows = PatternRows(keys, n, self.flanks.symmetric)
            missing = self.flanks.evaluate(u, CLOSED, None, cast(Any, rows))
            if not len(missing):
                return rows.matrix()
            keys = np.union1d(keys, missing)

    def press(self, u: np.ndarray, force: np.ndarray) -> Pressed:
        """Equilibrium from u (n, 3), which is changed; its fixed components stay."""
        keys, free = self.search(u), np.flatnonzero(~self.fixed.ravel())
        for self.iterations in range(60):
            contact = self.forces(u)
            r = sum(mesh.residual(u) for mesh in self.meshes) - force + contact
            residual = np.abs(r.ravel()[free]).max() / np.abs(contact).max()
            if residual < 1e-8:  # round-off of positions times the stiffness of narrow cells
                break
            if residual < 1e-3:
                self.flanks.cells.freeze()
            stiffness = sum(mesh.tangent(u) for mesh in self.meshes) + self.tangent(u, keys)
            u.ravel()[free] -= spsolve(stiffness.tocsc()[free][:, free], r.ravel()[free], ORDERING)
        assert residual < 1e-7, residual
        if self.flanks.friction_coefficient > 0.0:
            self.before = u.copy()
            self.flanks.accept()
        return self.pressed(contact)

    def pressed(self, contact: np.ndarray) -> Pressed:
        """The cells of the last evaluation."""
        active = self.flanks.cells.active
        assert active is not None
        cells, x = active.placed.cells, active.faces.coords[:, :, 0]
        middle = 0.5 * (cells.low + cells.high)
        # the face's corners 0 and 1 are its ends along the profile
        place = (1.0 - middle) * x[:, 0] + middle * x[:, 1]
        return Pressed(
            active.placed.line,
            place,
            active.width,
            active.length,
            active.forces.force,
            active.gap,
            contact,
        )
