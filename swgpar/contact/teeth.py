"""Tooth flanks of the flexible spline (slave) against those of the ring gear (master), both deformable.

Face quadrature on the slave flank; the master flank is the exact profile plus the finite-element
displacement (see kernel/contact.hpp). Sliding is finite: the foot point is found anew in every evaluation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.assembly import BlockRows, BodyElements
from swgpar.contact.enforcement import penetration
from swgpar.contact.search import FlankPair
from swgpar.kernel import contact_flanks
from swgpar.meshing.sector import FlankGrid, SectorMesh
from swgpar.micro_geometry import crowning
from swgpar.partition import LocalNodes, Partition

MIRROR = np.array([-1.0, 1.0])


@dataclass
class Flanks:
    """Master flanks; see `swgpar.kernel.contact_flanks`."""

    s: np.ndarray
    z: np.ndarray
    point: np.ndarray
    tangent: np.ndarray
    orientation: np.ndarray
    turn: np.ndarray
    conn: np.ndarray
    flip: np.ndarray


@dataclass
class Faces:
    """Slave faces with their quadrature points; see `swgpar.kernel.contact_flanks`."""

    conn: np.ndarray
    flip: np.ndarray
    coords: np.ndarray
    normal: np.ndarray
    shape: np.ndarray
    weight: np.ndarray
    offset: np.ndarray
    patch: np.ndarray

    def take(self, pick: np.ndarray) -> Faces:
        return Faces(
            self.conn[pick],
            self.flip[pick],
            self.coords[pick],
            self.normal[pick],
            self.shape,
            self.weight[pick],
            self.offset[pick],
            self.patch[pick],
        )


@dataclass(frozen=True)
class FlankQuadrature:
    """Quadrature of one flank of sector 0: faces by rows of the profile, then along the width.

    corners : (n_face, 4) local nodes;  shape : (n_q, 4);  weight, offset : (n_face, n_q) mm^2, mm
    normal : (n_face, 3), s, z : (n_face, n_q) arc length and axial place of the points
    """

    corners: np.ndarray
    shape: np.ndarray
    weight: np.ndarray
    offset: np.ndarray
    normal: np.ndarray
    s: np.ndarray
    z: np.ndarray


def quadrature(
    mesh: SectorMesh,
    grid: FlankGrid,
    order: int,
    removed: float,
    width: float,
    shape_name: str,
    rule: tuple[np.ndarray, np.ndarray] | None = None,
) -> FlankQuadrature:
    """Quadrature points of a flank and their distance from the exact, crowned surface.

    order : Gauss points per direction;  removed : mm, crowning at |z| = width / 2;  rule : replaces the Gauss rule
    """
    t, w = np.polynomial.legendre.leggauss(order) if rule is None else rule
    t, w = 0.5 * (t + 1.0), 0.5 * w
    a, b = (v.ravel() for v in np.meshgrid(t, t, indexing="ij"))
    shape = np.column_stack([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b])
    n = grid.nodes
    corners = np.stack([n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]], axis=-1).reshape(-1, 4)
    ds, dz = np.diff(grid.s), np.diff(grid.z)
    n_s, n_z, n_q = len(ds), len(dz), len(a)
    s = np.broadcast_to((grid.s[:-1, None] + ds[:, None] * a)[:, None, :], (n_s, n_z, n_q)).reshape(-1, n_q)
    z = np.broadcast_to((grid.z[:-1, None] + dz[:, None] * b)[None, :, :], (n_s, n_z, n_q)).reshape(-1, n_q)
    weight = (ds[:, None] * dz).reshape(-1, 1) * np.outer(w, w).ravel()
    profile = mesh.profile
    flip = MIRROR if grid.side < 0 else np.ones(2)
    normal2 = profile.normal(s.ravel()) * flip
    cut = crowning(removed, z.ravel(), width, shape_name)[0] * profile.crowning_weight(s.ravel())
    exact = profile.point(s.ravel()) * flip - cut[:, None] * normal2
    facet = np.einsum("qa,fai->fqi", shape, mesh.coords[corners]).reshape(-1, 3)
    offset = np.sum((exact - facet[:, :2]) * normal2, axis=1).reshape(s.shape)
    middle = profile.normal(s.mean(axis=1)) * flip
    normal = np.column_stack([middle, np.zeros(len(middle))])
    return FlankQuadrature(corners, shape, weight, offset, normal, s, z)


class ToothContact:
    """All flank pairs this rank takes part in, from one search to the next.

    Parameters
    ----------
    partition, spline, ring : ownership and the elements of both bodies
    order : Gauss points per direction on a slave face
    removed, width, shape_name : crowning of the flexible spline's flanks (mm, mm, curve)
    penalty : MPa / mm;  reach : mm, largest |gap| that is looked at
    pressure_limit : MPa, bound of the pressure in the tangent's geometric term
    """

    def __init__(
        self,
        partition: Partition,
        spline: BodyElements,
        ring: BodyElements,
        order: int,
        removed: float,
        width: float,
        shape_name: str,
        penalty: float,
        reach: float,
        pressure_limit: float,
    ) -> None:
        self.partition, self.spline, self.ring = partition, spline, ring
        self.penalty, self.reach, self.pressure_limit = penalty, reach, pressure_limit
        mesh = spline.layout.mesh
        args = (removed, width, shape_name)
        self.rules = {g.side: quadrature(mesh, g, order, *args) for g in mesh.flanks}
        center = (np.array([0.0]), np.array([2.0]))
        self.centers = {g.side: quadrature(mesh, g, 1, *args, rule=center) for g in mesh.flanks}
        self.grids = {g.side: g for g in ring.layout.mesh.flanks}
        self.pairs: list[FlankPair] = []

    def numbers(self, pairs: list[FlankPair]) -> np.ndarray:
        """Global numbers of the flank nodes of all pairs that have a node on this rank."""
        self.pairs = [
            p
            for p in pairs
            if self.partition.comm.rank
            in (self.partition.owner(0, np.array(p.sector)), self.partition.owner(1, np.array(p.ring)))
        ]
        seen = [np.zeros(0, dtype=np.int64)]
        for p in self.pairs:
            seen.append(self.partition.numbers(0, np.array([p.sector]), self.rules[p.side].corners.ravel())[0].ravel())
            seen.append(self.partition.numbers(1, np.array([p.ring]), self.grids[-p.side].nodes.ravel())[0].ravel())
        return np.concatenate(seen)

    def bind(self, local: LocalNodes) -> None:
        """Set up the arrays of all pairs; nothing is in contact before `select`."""
        grid = self.ring.layout.mesh.flanks[0]
        n_pair = len(self.pairs)
        flanks = Flanks(
            grid.s,
            grid.z,
            *(np.zeros((n_pair, len(grid.s), 2)) for _ in range(2)),
            np.zeros(n_pair),
            np.zeros((n_pair, 2)),
            np.zeros((n_pair, *grid.nodes.shape), dtype=np.int32),
            np.zeros((n_pair, *grid.nodes.shape), dtype=np.uint8),
        )
        profile = self.ring.layout.mesh.profile
        everything: list[tuple[FlankPair, Faces]] = []
        for k, p in enumerate(self.pairs):
            grid = self.grids[-p.side]
            mirror = MIRROR if grid.side < 0 else np.ones(2)
            tangent = profile.tangent(grid.s) * mirror
            flanks.point[k], flanks.tangent[k] = profile.point(grid.s) * mirror, tangent
            # tangent (T to R) x z points to the right of the tangent: compare with the outward normal
            right = np.column_stack([tangent[:, 1], -tangent[:, 0]])
            flanks.orientation[k] = np.sign(np.sum(right * profile.normal(grid.s) * mirror))
            angle = self.ring.layout.turn(np.array(p.ring_tooth))
            flanks.turn[k] = np.cos(angle), np.sin(angle)
            number, flip = self.partition.numbers(1, np.array([p.ring]), grid.nodes.ravel())
            flanks.conn[k] = local.index(number).reshape(grid.nodes.shape)
            flanks.flip[k] = np.where(number >= 0, flip ^ p.ring_flip, 0).reshape(grid.nodes.shape)
            everything.append((p, self._faces(self.rules[p.side], p, k, local)))
        self.flanks, self.local = flanks, local
        self.all = _join([f for _, f in everything]) if everything else None
        self.all_centers = (
            _join([self._faces(self.centers[p.side], p, k, local) for k, (p, _) in enumerate(everything)])
            if everything
            else None
        )
        self.pair_of = (
            np.concatenate([np.full(len(f.conn), k) for k, (_, f) in enumerate(everything)]) if everything else None
        )
        owner = np.array([self.partition.owner(0, np.array(p.sector)) for p in self.pairs], dtype=np.int64)
        self.pair_owned = owner == self.partition.comm.rank
        self.pick = np.zeros(0, dtype=np.int64)
        self._reset()

    def _faces(self, rule: FlankQuadrature, pair: FlankPair, patch: int, local: LocalNodes) -> Faces:
        mesh = self.spline.layout.mesh
        number, flip = self.partition.numbers(0, np.array([pair.sector]), rule.corners.ravel())
        angle = self.spline.layout.turn(np.array(self.spline.layout.first_tooth + pair.sector))
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        return Faces(
            local.index(number).reshape(-1, 4),
            flip.reshape(-1, 4).copy(),
            mesh.coords[rule.corners] @ turn,
            rule.normal @ turn,
            rule.shape,
            rule.weight,
            rule.offset,
            np.full(len(rule.corners), patch, dtype=np.int32),
        )

    def _reset(self) -> None:
        self.multiplier = np.zeros((len(self.pick), self.all.weight.shape[1] if self.all is not None else 0))
        self.gap, self.pressure = np.full_like(self.multiplier, np.inf), np.zeros_like(self.multiplier)
        self.faces = self.all.take(self.pick) if self.all is not None else None

    def select(self, u: np.ndarray, near: float, touch: float) -> np.ndarray:
        """Choose the faces within `near` (mm) of the master and return the blocks that may couple.

        Keys row * n_global + column of the node pairs of faces within `touch` (mm) and of the master facets
        around their foot points; upper triangle, owned rows.
        """
        if self.all is None:
            return np.zeros(0, dtype=np.int64)
        zero = np.zeros((len(self.all_centers.conn), 1))
        gap, _, facet, _ = contact_flanks(
            self.flanks, self.all_centers, u, zero, self.penalty, 0.0, self.reach, self.pressure_limit, None, None
        )
        gap = gap[:, 0] - 0.0
        self.pick = np.flatnonzero(gap < near)
        self._reset()
        pick = np.flatnonzero(gap < touch)
        return self._keys(pick, facet[pick, 0])

    def _keys(self, pick: np.ndarray, facet: np.ndarray, window: tuple[int, int] = (2, 1)) -> np.ndarray:
        n_s, n_z = len(self.flanks.s), len(self.flanks.z)
        number = self.local.number.astype(np.int64)
        slave = self.all_centers.conn[pick]
        patch = self.all_centers.patch[pick]
        columns = [np.where(slave >= 0, number[slave], -1)]
        for di in range(-window[0], window[0] + 2):
            for dj in range(-window[1], window[1] + 2):
                i, j = facet[:, 0] + di, facet[:, 1] + dj
                ok = (i >= 0) & (i < n_s) & (j >= 0) & (j < n_z)
                node = np.where(ok, self.flanks.conn[patch, np.where(ok, i, 0), np.where(ok, j, 0)], -1)
                columns.append(np.where(node >= 0, number[node], -1)[:, None])
        nodes = np.concatenate(columns, axis=1)
        row, col = nodes[:, :, None], nodes[:, None, :]
        lo = self.local.row_start
        valid = (row >= lo) & (row < lo + self.local.n_own) & (col >= row)
        return np.unique((row * self.partition.n_global + col)[valid])

    def augment(self) -> None:
        """Take the pressures of the last evaluation as multipliers."""
        self.multiplier = self.pressure.copy()

    def evaluate(
        self, u: np.ndarray, opening: float, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Gaps and pressures at u (n_local, 3); adds to residual and tangent.

        Returns keys of blocks that the pattern lacks (empty when there are none or `rows` is None).
        """
        if self.faces is None or not len(self.faces.conn):
            return np.zeros(0, dtype=np.int64)
        self.gap, self.pressure, facet, missing = contact_flanks(
            self.flanks,
            self.faces,
            u,
            self.multiplier,
            self.penalty,
            opening,
            self.reach,
            self.pressure_limit,
            residual,
            rows,
        )
        if not missing:
            return np.zeros(0, dtype=np.int64)
        face, point = np.nonzero(self.pressure > 0.0)
        return self._keys(self.pick[face], facet[face, point])

    def owned_forces(self, u: np.ndarray, opening: float) -> np.ndarray:
        """Nodal forces (n_local, 3) N of the pairs whose flexible-spline tooth this rank owns, as a residual."""
        residual = np.zeros_like(u)
        if self.faces is not None and len(self.pick):
            mine = self.pair_owned[self.pair_of[self.pick]]
            faces = self.faces.take(np.flatnonzero(mine))
            contact_flanks(
                self.flanks,
                faces,
                u,
                np.ascontiguousarray(self.multiplier[mine]),
                self.penalty,
                opening,
                self.reach,
                self.pressure_limit,
                residual,
                None,
            )
        return residual

    def touching_pairs(self) -> int:
        """Flank pairs with pressure whose flexible-spline tooth this rank owns."""
        if self.faces is None:
            return 0
        touching = np.unique(self.pair_of[self.pick[(self.pressure > 0.0).any(axis=1)]])
        return int(self.pair_owned[touching].sum())

    def penetration(self) -> float:
        """Largest penetration (mm) of the last evaluation on this rank."""
        return penetration(self.gap, self.pressure)


def _join(faces: list[Faces]) -> Faces:
    names = ("conn", "flip", "coords", "normal", "weight", "offset", "patch")
    joined = {n: np.ascontiguousarray(np.concatenate([getattr(f, n) for f in faces])) for n in names}
    return Faces(shape=np.ascontiguousarray(faces[0].shape), **joined)
