"""Arrays of flank pairs in the form that the kernel reads: master flanks, slave faces and their
quadrature points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

from swgpar.contact.cells import Cells
from swgpar.contact.contact import NO_KEYS
from swgpar.contact.flank_curve import TERMS, above_cubics
from swgpar.contact.flank_deviations import FlankDeviations
from swgpar.contact.flank_faces import FlankFaces, bilinear, lagrange
from swgpar.contact.search import FlankPair
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.elements import BodyElements
from swgpar.fem.local_nodes import LocalNodes
from swgpar.fem.partition import Partition
from swgpar.geometry.rotation import MIRROR, rotated
from swgpar.meshing.sector import FlankGrid

LINE_WINDOW = (1, 1)
"""Facets beside that of a foot point, along the profile and along z, whose nodes may couple with
the slave face."""


@dataclass
class MasterFlanks:
    """Flanks of the ring gear, one for each pair; see `swgpar.kernel.contact_flanks`.

    bulge : see `above_cubics`
    """

    s: np.ndarray
    z: np.ndarray
    point: np.ndarray
    tangent: np.ndarray
    bulge: np.ndarray
    orientation: np.ndarray
    rotation: np.ndarray
    conn: np.ndarray
    sixths: np.ndarray


@dataclass
class Faces:
    """Slave faces with their quadrature points; see `swgpar.kernel.contact_flanks`."""

    conn: np.ndarray
    sixths: np.ndarray
    coords: np.ndarray
    normal: np.ndarray
    shape: np.ndarray
    weight: np.ndarray
    offset: np.ndarray
    patch: np.ndarray

    def subset(self, chosen: np.ndarray) -> Faces:
        """The faces of a mask (n_face,)."""
        return Faces(*(np.ascontiguousarray(getattr(self, f.name)[chosen]) for f in fields(Faces)))


@dataclass
class PlacedFaces:
    """Whole faces of all pairs at their undeformed positions; see `Faces` and `FlankFaces`."""

    conn: np.ndarray
    sixths: np.ndarray
    coords: np.ndarray
    normal: np.ndarray
    size: np.ndarray
    offset: np.ndarray
    patch: np.ndarray

    def points(self, chosen: np.ndarray, a: np.ndarray, b: np.ndarray, share: np.ndarray) -> Faces:
        """Faces (n,) of their own with points.

        chosen : (n,) faces;  a, b : (n, n_q) places on them;  share : (n, n_q) of their area
        """
        area = self.size[chosen, 0] * self.size[chosen, 1]
        offset = np.sum(lagrange(a) @ self.offset[chosen] * lagrange(b), axis=2)
        return Faces(
            self.conn[chosen],
            self.sixths[chosen],
            self.coords[chosen],
            self.normal[chosen],
            bilinear(a, b),
            area[:, None] * share,
            offset,
            self.patch[chosen],
        )

    def of_cells(self, cells: Cells) -> Faces:
        """Faces of their own with the quadrature points of cells."""
        return self.points(cells.parent, cells.a, cells.b, cells.area)

    def centers(self) -> Faces:
        """All faces with their middle as the only point."""
        indices = np.arange(len(self.conn))
        half = np.full((len(indices), 1), 0.5)
        return self.points(indices, half, half, np.ones_like(half))

    def ends(self, chosen: np.ndarray) -> Faces:
        """Faces (n,) with the middles of both ends along the profile as points."""
        a = np.broadcast_to([0.0, 1.0], (len(chosen), 2)).copy()
        half = np.full_like(a, 0.5)
        return self.points(chosen, a, half, half)


@dataclass
class GapGradients:
    """Gradients of gaps by the 4 nodes of the slave face and the 4 of the master's facet.

    conn, sixths : (n, n_q, 8) local nodes and image flags;  vector : (n, n_q, 8, 3)
    friction : (n, n_q, 8, 3) forces of friction on the nodes by the pressure that bounds it, where
    that is the present one, per area
    """

    conn: np.ndarray
    sixths: np.ndarray
    vector: np.ndarray
    friction: np.ndarray

    @classmethod
    def empty(cls, n: int, n_q: int) -> GapGradients:
        """Room for those of n faces."""
        shape = (n, n_q, 8)
        conn, sixths = np.full(shape, -1, dtype=np.int32), np.zeros(shape, dtype=np.uint8)
        return cls(conn, sixths, *np.zeros((2, *shape, 3)))


class FlankPairs:
    """The pairs of one contact search that this rank takes part in, with their arrays in local
    numbering.

    Parameters
    ----------
    partition, spline, ring : ownership and the elements of both bodies
    slaves : faces of the flexible spline's flanks by side;  masters : grids of the ring gear's
    flanks by side
    pairs : pairs of flanks;  local : local nodes, those of the pairs among them

    Attributes
    ----------
    masters : arrays of the ring gear's flanks;  faces : of the flexible spline's, None without
    pairs
    owned : (n_pair,) bool, whether this rank owns the tooth of the flexible spline
    """

    def __init__(
        self,
        partition: Partition,
        spline: BodyElements,
        ring: BodyElements,
        slaves: Mapping[int, FlankFaces],
        masters: Mapping[int, FlankGrid],
        pairs: list[FlankPair],
        local: LocalNodes,
    ) -> None:
        self.partition, self.spline, self.ring = partition, spline, ring
        self.pairs, self.local = pairs, local
        table = [(p.sector, p.side, p.ring, p.ring_sixths, p.ring_tooth) for p in pairs]
        columns = np.array(table, dtype=np.int64).reshape(-1, 5).T
        self._sector, self._side, self._ring, self._ring_sixths, self._ring_tooth = columns
        self.masters = self._master_flanks(masters)
        self.faces = self._placed(slaves) if pairs else None
        self._ideal = (
            self.masters.point,
            self.masters.tangent,
            None if self.faces is None else self.faces.offset,
        )
        owner = partition.owner_of_sector(FLEXIBLE_SPLINE, self._sector)
        self.owned = owner == partition.comm.rank

    def deviate(self, deviations: FlankDeviations) -> None:
        """Move the flanks from their ideal places by these deviations, in place of earlier ones."""
        if self.faces is None:
            return
        point, tangent, offset = self._ideal
        shift, turned = deviations.master_shifts(self.pairs)
        self.masters.point, self.masters.tangent = point + shift, tangent + turned
        self.faces.offset = offset + deviations.slave_heights(
            self.pairs, self.spline.layout.first_tooth
        )

    def _master_flanks(self, grids: Mapping[int, FlankGrid]) -> MasterFlanks:
        grid, n_pair = self.ring.layout.mesh.flanks[0], len(self.pairs)
        flanks = MasterFlanks(
            grid.s,
            grid.z,
            point=np.zeros((n_pair, len(grid.s), 2)),
            tangent=np.zeros((n_pair, len(grid.s), 2)),
            bulge=np.zeros((n_pair, len(grid.s) - 1, TERMS, 2)),
            orientation=np.zeros(n_pair),
            rotation=np.zeros((n_pair, 2)),
            conn=np.zeros((n_pair, *grid.nodes.shape), dtype=np.int32),
            sixths=np.zeros((n_pair, *grid.nodes.shape), dtype=np.uint8),
        )
        layout = self.ring.layout
        for side, grid in grids.items():
            of_side = np.flatnonzero(self._side == -side)
            (
                flanks.point[of_side],
                flanks.tangent[of_side],
                flanks.orientation[of_side],
            ) = self._curve(grid)
            mirror = MIRROR if grid.side < 0 else np.ones(2)
            flanks.bulge[of_side] = above_cubics(layout.mesh.profile, grid.s) * mirror
            angle = layout.sector_angle(self._ring_tooth[of_side])
            flanks.rotation[of_side] = np.column_stack([np.cos(angle), np.sin(angle)])
            number, sixths = self.partition.node_numbers(
                layout.name, self._ring[of_side], grid.nodes.ravel()
            )
            sixths = np.where(number >= 0, (sixths + self._ring_sixths[of_side, None]) % 6, 0)
            shape = (len(of_side), *grid.nodes.shape)
            flanks.conn[of_side] = self.local.index(number).reshape(shape)
            flanks.sixths[of_side] = sixths.reshape(shape)
        return flanks

    def _curve(self, grid: FlankGrid) -> tuple[np.ndarray, np.ndarray, float]:
        """Points and tangents (n_s, 2) of a flank of the ring gear, mm, and its orientation."""
        profile, mirror = self.ring.layout.mesh.profile, MIRROR if grid.side < 0 else np.ones(2)
        point, tangent, normal = (
            along(grid.s) * mirror for along in (profile.point, profile.tangent, profile.normal)
        )
        # tangent (T to R) x z points to the right of the tangent: compare with the outward normal
        right = np.column_stack([tangent[:, 1], -tangent[:, 0]])
        return point, tangent, float(np.sign(np.sum(right * normal)))

    def _placed(self, slaves: Mapping[int, FlankFaces]) -> PlacedFaces:
        """The faces of all pairs, one pair after the other."""
        layout = self.spline.layout
        some = next(iter(slaves.values()))
        shape = len(self.pairs), len(some.corners)
        conn, sixths = np.zeros((*shape, 4), np.int32), np.zeros((*shape, 4), np.uint8)
        coords, normal, size = (np.zeros((*shape, *n)) for n in ((4, 3), (3,), (2,)))
        offset = np.zeros((*shape, *some.offset.shape[1:]))
        for side, slave in slaves.items():
            of_side = np.flatnonzero(self._side == side)
            sector = self._sector[of_side]
            number, flags = self.partition.node_numbers(
                FLEXIBLE_SPLINE, sector, slave.corners.ravel()
            )
            conn[of_side] = self.local.index(number).reshape(-1, *conn.shape[1:])
            sixths[of_side] = flags.reshape(-1, *sixths.shape[1:])
            angle = layout.chain_angle(sector)[:, None]
            coords[of_side] = rotated(layout.mesh.coords[slave.corners][None], angle[..., None])
            normal[of_side] = rotated(slave.normal[None], angle)
            size[of_side], offset[of_side] = slave.size, slave.offset
        patch = np.arange(shape[0], dtype=np.int32).repeat(shape[1]).reshape(shape)
        of_pairs = conn, sixths, coords, normal, size, offset, patch
        return PlacedFaces(*(values.reshape(-1, *values.shape[2:]) for values in of_pairs))

    def block_keys(
        self, chosen: np.ndarray, foot_point: np.ndarray, line: np.ndarray, symmetric: bool
    ) -> np.ndarray:
        """Keys row * n_global + column of the blocks that lines of contact may need.

        The nodes of all faces of a line, and of the master facets at and beside their foot points,
        couple with each other.

        chosen : (n,) faces;  foot_point : (n, 2) mm, arc length and z on the master;  line : (n,)
        symmetric : keep the upper triangle only
        """
        masters = self.masters
        n_s, n_z = len(masters.s), len(masters.z)
        facet = np.column_stack(
            [
                np.clip(np.searchsorted(ends, value, side="right") - 1, 0, len(ends) - 2)
                for ends, value in zip((masters.s, masters.z), foot_point.T)
            ]
        )
        patch = self.faces.patch[chosen]
        nodes = [self.faces.conn[chosen]]
        for di in range(-LINE_WINDOW[0], LINE_WINDOW[0] + 2):
            for dj in range(-LINE_WINDOW[1], LINE_WINDOW[1] + 2):
                i, j = facet[:, 0] + di, facet[:, 1] + dj
                ok = (i >= 0) & (i < n_s) & (j >= 0) & (j < n_z)
                node = masters.conn[patch, np.where(ok, i, 0), np.where(ok, j, 0)]
                nodes.append(np.where(ok, node, -1)[:, None])
        return self.line_keys(np.concatenate(nodes, axis=1), line, symmetric)

    def line_keys(self, nodes: np.ndarray, line: np.ndarray, symmetric: bool) -> np.ndarray:
        """Keys of the blocks of local nodes (n, m), -1 without unknowns, that lie on the same of
        the lines (n,)."""
        number, first = self.local.number.astype(np.int64), self.local.row_start
        keys = []
        for k in np.unique(line):
            of_line = nodes[line == k]
            of_line = number[np.unique(of_line[of_line >= 0])]
            row, column = (v.ravel() for v in np.meshgrid(of_line, of_line, indexing="ij"))
            valid = (row >= first) & (row < first + self.local.n_own)
            if symmetric:
                valid &= column >= row
            keys.append((row * self.partition.n_global + column)[valid])
        return np.unique(np.concatenate([NO_KEYS, *keys]))
