"""Tooth flanks of the flexible spline (slave) against those of the ring gear (master), both deformable.

Quadrature by segments on the slave flank (see segments.py); the master flank is the exact profile plus the
finite-element displacement (see kernel/contact.hpp). Sliding is finite: foot points are found anew in every
evaluation, and segments too until the solution is near: the tangent does not know how they move, and multipliers
belong to their points.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from swgpar.contact import friction
from swgpar.contact.enforcement import penetration
from swgpar.contact.friction import Friction, PairKey
from swgpar.contact.search import FlankPair
from swgpar.contact.segments import MIRROR, FlankFaces, Segments, bilinear, cut_faces, flank_faces, lagrange
from swgpar.fem.body_layout import FLEXIBLE_SPLINE, RING_GEAR
from swgpar.fem.elements import BodyElements
from swgpar.fem.local_nodes import LocalNodes
from swgpar.fem.partition import Partition
from swgpar.fem.sparse import BlockRows
from swgpar.kernel import contact_flanks

CONTINUED = 5.0
"""Facets by which corners of faces may lie past the ends of the master's flank, which goes on straight
there: where faces are cut then changes continuously as they slide over an end."""


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


@dataclass
class PlacedFaces:
    """Faces of all pairs, turned into place, not yet cut: see `Faces` and `FlankFaces`."""

    conn: np.ndarray
    flip: np.ndarray
    coords: np.ndarray
    normal: np.ndarray
    size: np.ndarray
    offset: np.ndarray
    patch: np.ndarray

    def cut(self, pick: np.ndarray, segments: Segments) -> Faces:
        """The segments of the faces `pick` as faces of their own."""
        face = pick[segments.parent]
        area = self.size[face, 0] * self.size[face, 1]
        offset = np.einsum(
            "fij,fqi,fqj->fq", self.offset[face], lagrange(segments.a), lagrange(segments.b), optimize=True
        )
        return Faces(
            self.conn[face],
            self.flip[face],
            self.coords[face],
            self.normal[face],
            bilinear(segments.a, segments.b),
            area[:, None] * segments.share,
            offset,
            self.patch[face],
        )

    def corners(self, pick: np.ndarray) -> Faces:
        """The faces `pick` with their corners as points, offsets left out."""
        a, b = (np.tile(v, (len(pick), 1)) for v in ([0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0]))
        faces = self.cut(pick, Segments(np.arange(len(pick)), a, b, np.ones_like(a)))
        faces.offset[:] = 0.0
        return faces


@dataclass
class FrozenSegments:
    """Segments of faces with their friction."""

    faces: Faces | None
    segments: Segments | None
    friction: Friction | None


class FlankContact:
    """All flank pairs this rank takes part in, from one search to the next.

    Parameters
    ----------
    partition, spline, ring : ownership and the elements of both bodies
    order : Gauss points per direction on a segment of a slave face
    removed, width, shape_name : crowning of the flexible spline's flanks (mm, mm, curve)
    penalty : MPa / mm;  reach : mm, largest |gap| that is looked at
    pressure_limit : MPa, bound of the pressure in the tangent's geometric term
    friction : coefficient

    `turn` (rad) of the ring gear as a whole is set from outside; `moment` (N mm) is the derivative of the contact's
    energy with respect to it, of the last evaluation with a residual, over the pairs that this rank owns.
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
        coefficient: float,
    ) -> None:
        self.partition, self.spline, self.ring = partition, spline, ring
        self.penalty, self.reach, self.pressure_limit = penalty, reach, pressure_limit
        self.order, self.coefficient = order, coefficient
        mesh = spline.layout.mesh
        self.slaves = {g.side: flank_faces(mesh, g, removed, width, shape_name) for g in mesh.flanks}
        self.grids = {g.side: g for g in ring.layout.mesh.flanks}
        self.pairs: list[FlankPair] = []
        self.n_face = len(self.slaves[1].corners)
        self.history: dict[PairKey, np.ndarray] = {}
        self.turn, self.moment = 0.0, 0.0

    def _takes_part(self, p: FlankPair) -> bool:
        owners = (
            self.partition.owner_of_sector(FLEXIBLE_SPLINE, np.array(p.sector)),
            self.partition.owner_of_sector(RING_GEAR, np.array(p.ring)),
        )
        return self.partition.comm.rank in owners

    def numbers(self, pairs: list[FlankPair]) -> np.ndarray:
        """Global numbers of the flank nodes of all pairs that have a node on this rank."""
        self.pairs = [p for p in pairs if self._takes_part(p)]
        seen = [np.zeros(0, dtype=np.int64)]
        for p in self.pairs:
            seen.append(
                self.partition.node_numbers(FLEXIBLE_SPLINE, np.array([p.sector]), self.slaves[p.side].corners.ravel())[
                    0
                ].ravel()
            )
            seen.append(
                self.partition.node_numbers(RING_GEAR, np.array([p.ring]), self.grids[-p.side].nodes.ravel())[0].ravel()
            )
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
        placed: list[PlacedFaces] = []
        for k, p in enumerate(self.pairs):
            grid = self.grids[-p.side]
            mirror = MIRROR if grid.side < 0 else np.ones(2)
            tangent = profile.tangent(grid.s) * mirror
            flanks.point[k], flanks.tangent[k] = profile.point(grid.s) * mirror, tangent
            # tangent (T to R) x z points to the right of the tangent: compare with the outward normal
            right = np.column_stack([tangent[:, 1], -tangent[:, 0]])
            flanks.orientation[k] = np.sign(np.sum(right * profile.normal(grid.s) * mirror))
            angle = self.ring.layout.sector_angle(np.array(p.ring_tooth))
            flanks.turn[k] = np.cos(angle), np.sin(angle)
            number, flip = self.partition.node_numbers(RING_GEAR, np.array([p.ring]), grid.nodes.ravel())
            flanks.conn[k] = local.index(number).reshape(grid.nodes.shape)
            flanks.flip[k] = np.where(number >= 0, flip ^ p.ring_flip, 0).reshape(grid.nodes.shape)
            placed.append(self._placed(self.slaves[p.side], p, k, local))
        self.flanks, self.local = flanks, local
        names = [f.name for f in fields(PlacedFaces)]
        self.all = (
            PlacedFaces(*(np.ascontiguousarray(np.concatenate([getattr(f, n) for f in placed])) for n in names))
            if placed
            else None
        )
        owner = np.array(
            [self.partition.owner_of_sector(FLEXIBLE_SPLINE, np.array(p.sector)) for p in self.pairs], dtype=np.int64
        )
        self.pair_owned = owner == self.partition.comm.rank
        self.pick = np.zeros(0, dtype=np.int64)
        self._reset()
        self.before: np.ndarray | None = None

    def _placed(self, slave: FlankFaces, pair: FlankPair, patch: int, local: LocalNodes) -> PlacedFaces:
        mesh = self.spline.layout.mesh
        number, flip = self.partition.node_numbers(FLEXIBLE_SPLINE, np.array([pair.sector]), slave.corners.ravel())
        angle = self.spline.layout.sector_angle(np.array(self.spline.layout.first_tooth + pair.sector))
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        return PlacedFaces(
            local.index(number).reshape(-1, 4),
            flip.reshape(-1, 4).copy(),
            mesh.coords[slave.corners] @ turn,
            slave.normal @ turn,
            slave.size,
            slave.offset,
            np.full(len(slave.corners), patch, dtype=np.int32),
        )

    def _reset(self) -> None:
        self.faces: Faces | None = None
        self.segments: Segments | None = None
        self.multiplier = self.gap = self.pressure = np.zeros((0, self.order**2))
        self.frozen = False
        self.friction: Friction | None = None

    def _cut(self, u: np.ndarray) -> None:
        """Cut the faces for displacement u; without multipliers, which would belong to other points."""
        faces = self.all.corners(self.pick)
        zero = np.zeros(faces.weight.shape)
        _, _, place, _ = self._contact(faces, u, zero, 0.0, None, None, beyond=CONTINUED)
        segments = cut_faces(place, self.all.size[self.pick], self.flanks.s, self.flanks.z, self.order)
        self.faces = self.all.cut(self.pick, segments)
        self.segments = replace(segments, parent=self.pick[segments.parent])
        self.multiplier = np.zeros_like(self.faces.weight)
        if self.before is not None:
            gap, _, place, _ = self._contact(self.faces, self.before, self.multiplier, 0.0, None, None)
            traction = friction.interpolated(self.samples, self.segments)
            self.friction = friction.begin(self.coefficient, place, gap, traction)

    def _contact(
        self, faces: Faces, u: np.ndarray, multiplier: np.ndarray, opening: float, residual, rows, law=None, **more
    ):
        moment = np.zeros(len(faces.conn))
        settings = self.penalty, opening, self.reach, self.pressure_limit, residual, rows, law, self.turn, moment
        result = contact_flanks(self.flanks, faces, u, multiplier, *settings, **more)
        if residual is not None:
            self.moment = float(moment[self.pair_owned[faces.patch]].sum())
        return result

    def picked_rings(self) -> np.ndarray:
        """Sectors of the ring gear (n,) that the faces of the last `select` may meet."""
        if self.all is None:
            return np.zeros(0, dtype=np.int64)
        return np.array([self.pairs[k].ring for k in np.unique(self.all.patch[self.pick])], dtype=np.int64)

    def select(self, u: np.ndarray, near: float, touch: float) -> np.ndarray:
        """Choose the faces within `near` (mm) of the master and return the blocks that may couple.

        Keys row * n_global + column of the node pairs of faces within `touch` (mm) and of the master facets
        around their foot points; owned rows, of a symmetric tangent the upper triangle.
        """
        if self.all is None:
            return np.zeros(0, dtype=np.int64)
        gap, place = self._centers(u)
        self.pick = np.flatnonzero(gap < near)
        self._reset()
        pick = np.flatnonzero(gap < touch)
        return self._keys(pick, place[pick])

    def _centers(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gap (n_face,) mm at the middle of every face and its place (n_face, 2) on the master."""
        every = np.arange(len(self.all.conn))
        half = np.full((len(every), 1), 0.5)
        faces = self.all.cut(every, Segments(every, half, half, np.ones_like(half)))
        gap, _, place, _ = self._contact(faces, u, np.zeros_like(half), 0.0, None, None)
        return gap[:, 0], place[:, 0]

    def overlooked(self, pairs: list[FlankPair], u: np.ndarray, opening: float) -> bool:
        """Whether there are pairs that the last search did not see, or faces in contact that it did not pick."""
        mine = [p for p in pairs if self._takes_part(p)]
        if not set(mine) <= set(self.pairs):
            return True
        if self.all is None:
            return False
        gap, _ = self._centers(u)
        return bool(np.delete(gap + opening < 0.0, self.pick).any())

    def _keys(self, pick: np.ndarray, place: np.ndarray, window: tuple[int, int] = (2, 1)) -> np.ndarray:
        n_s, n_z = len(self.flanks.s), len(self.flanks.z)
        facet = np.column_stack(
            [
                np.searchsorted(line, value, side="right") - 1
                for line, value in zip((self.flanks.s, self.flanks.z), place.T)
            ]
        )
        number = self.local.number.astype(np.int64)
        slave = self.all.conn[pick]
        patch = self.all.patch[pick]
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
        valid = (row >= lo) & (row < lo + self.local.n_own) & (col >= (row if self.symmetric else 0))
        return np.unique((row * self.partition.n_global + col)[valid])

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric."""
        return self.coefficient == 0.0

    def resist(self, before: np.ndarray) -> None:
        """Let friction act until the next search, on the way from the converged displacement (n_local, 3) mm."""
        self.before = before
        self.samples = np.zeros((len(self.pairs), self.n_face, friction.SAMPLES, friction.SAMPLES, 2))
        for k, pair in enumerate(self.pairs):
            self.samples[k] = self.history.get(pair.key, 0.0)
        self.samples = self.samples.reshape(-1, *self.samples.shape[2:])

    def accept(self) -> None:
        """Keep the tangential tractions of the last evaluation, of a converged state."""
        self.history = {}
        if self.friction is None:
            return
        for face in np.unique(self.segments.parent[(self.pressure > 0.0).any(axis=1)]):
            k, local = divmod(int(face), self.n_face)
            store = self.history.setdefault(self.pairs[k].key, np.zeros((self.n_face, *self.samples.shape[1:])))
            store[local] = friction.sampled(self.segments, self.friction.now, face)

    def history_rows(self, first: int, end: int) -> dict[str, np.ndarray]:
        """The kept tractions of the sectors first .. end - 1, as rows for a file."""
        return friction.to_rows(self.history, first, end, self.n_face)

    def hold(self) -> None:
        """Keep the segments of the last evaluation until the next search."""
        self.frozen = self.faces is not None

    def release(self) -> None:
        """Cut the faces anew in every evaluation again."""
        self.frozen = False

    def held(self) -> FrozenSegments:
        """The segments that are held."""
        return FrozenSegments(self.faces, self.segments, self.friction)

    def hold_again(self, held: FrozenSegments) -> None:
        """Hold these segments, of the last search; friction follows the pressure on them, without multipliers."""
        self.faces, self.segments, self.friction = held.faces, held.segments, held.friction
        self.hold()
        if self.faces is not None:
            self.multiplier = np.zeros_like(self.faces.weight)
        if self.friction is not None:
            self.friction.lagged = None

    def lag(self) -> tuple[float, float]:
        """Give the law of friction the pressures of the last evaluation, on segments that are held.

        Returns the largest change to those given before and the largest pressure (MPa) on this rank; 0 without
        friction.
        """
        if self.friction is None or not self.frozen:
            return 0.0, 0.0
        before, self.friction.lagged = self.friction.lagged, self.pressure.copy()
        top = float(self.pressure.max(initial=0.0))
        return top if before is None else float(np.abs(self.pressure - before).max(initial=0.0)), top

    def augment(self) -> None:
        """Take the pressures of the last evaluation as multipliers; their points stay where they are from now on."""
        self.multiplier = self.pressure.copy()
        self.hold()

    def evaluate(
        self, u: np.ndarray, opening: float, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Gaps and pressures at u (n_local, 3); adds to residual and tangent.

        Returns keys of blocks that the pattern lacks (empty when there are none or `rows` is None).
        """
        self.moment = 0.0
        if self.all is None or not len(self.pick):
            return np.zeros(0, dtype=np.int64)
        if not self.frozen:
            self._cut(u)
        if self.friction is not None:
            self.friction.stiffness = friction.STIFFNESS * self.penalty
        self.gap, self.pressure, place, missing = self._contact(
            self.faces, u, self.multiplier, opening, residual, rows, self.friction
        )
        if not missing:
            return np.zeros(0, dtype=np.int64)
        acts = self.pressure > 0.0
        if self.friction is not None and self.friction.lagged is not None:
            acts |= (self.friction.lagged > 0.0) & np.isfinite(place[..., 0])
        face, point = np.nonzero(acts)
        return self._keys(self.segments.parent[face], place[face, point])

    def owned_forces(self, u: np.ndarray, opening: float) -> np.ndarray:
        """Nodal forces (n_local, 3) N of the pairs whose flexible-spline tooth this rank owns, as a residual."""
        residual = np.zeros_like(u)
        if self.faces is not None:
            mine = self.pair_owned[self.faces.patch]
            faces = Faces(*(np.ascontiguousarray(getattr(self.faces, f.name)[mine]) for f in fields(Faces)))
            law = None if self.friction is None else self.friction.picked(mine)
            self._contact(faces, u, np.ascontiguousarray(self.multiplier[mine]), opening, residual, None, law)
        return residual

    def active_set(self) -> list[np.ndarray]:
        """Faces with pressure, and those with points that slip, of the last evaluation on this rank; their numbers."""
        if self.faces is None:
            return []
        touching = self.pressure > 0.0
        sets = [touching]
        if self.friction is not None:
            limit = 0.99 * self.coefficient * self.pressure  # base vectors are of unit length but for the strain
            sets.append(touching & (np.linalg.norm(self.friction.now, axis=2) >= limit))
        return [np.unique(self.segments.parent[points.any(axis=1)]) for points in sets]

    def touching_pairs(self) -> int:
        """Flank pairs with pressure whose flexible-spline tooth this rank owns."""
        if self.faces is None:
            return 0
        touching = np.unique(self.faces.patch[(self.pressure > 0.0).any(axis=1)])
        return int(self.pair_owned[touching].sum())

    def clearance(self, side: int) -> float:
        """Smallest gap (mm) of the flanks on one side, of the last evaluation on this rank; inf without any."""
        if self.faces is None:
            return np.inf
        sides = np.array([p.side for p in self.pairs])
        return float(self.gap[sides[self.faces.patch] == side].min(initial=np.inf))

    def penetration(self) -> float:
        """Largest penetration (mm) of the last evaluation on this rank."""
        return penetration(self.gap, self.pressure)
