"""One tooth sector of a body: the finite elements from which the whole body is made by rotation."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from swgpar.geometry.arrays import Floats, Ints
from swgpar.profiles.flank import ToothProfile


@dataclass(frozen=True)
class FlankGrid:
    """Structured contact surface of one flank of sector 0.

    nodes : (n_s + 1, n_z + 1) local node numbers: row i at the arc length s[i], column j at z[j]
    s : (n_s + 1,) mm, arc lengths on the tooth profile, from T (0) to R (the length of the profile)
    z : (n_z + 1,) mm
    side : +1 for the flank at x > 0 (the clockwise one), -1 for its mirror image at x < 0
    """

    nodes: Ints
    s: Floats
    z: Floats
    side: int


@dataclass(frozen=True)
class SectorMesh:
    """The tooth sector centred on +y; copy k is rotated by `sector_angle` of k about z.

    body : ``flexible_spline``, ``ring_gear``, ``dynamic_spline`` or ``outer_race``, or ``ring`` for
        a plain one
    n_sectors : number of teeth of the full gear
    phase : rad, angle of sector 0 from +y in the drive, counter-clockwise
    coords : (n_node, 3) mm;  hexes : (n_elem, 8) nodes in VTK order
    ccw_nodes, cw_nodes : (n_pair,) nodes on the counter-clockwise and on the clockwise side: the
        first of sector k coincide with the second of sector k + 1, in this order
    faces : (n_face, 4) quadrilaterals whose right-hand normal points out of the material:
        ``inner`` (flexible spline, the cylinder of the inner radius within the face width), ``end``
        (both faces of the cup's closed end or flange) or ``outer`` (ring gear, with its housing if
        it has one)
    node_sets : (n,) ``bore`` (flexible spline; the rim of a flange) or ``outer`` (ring gear, as
        above)
    flanks : side +1, then side -1; none on a plain ring, which has no profile
        either
    profile : ToothProfile or None
    quality : ``min_scaled_jacobian``, ``min_jacobian`` and ``max_jacobian`` (mm³,
        determinants at the 2x2x2 Gauss points), ``max_aspect_ratio``; of the quadrilaterals (mm²,
        2x2 points) in the plane model
    tooth : (n,) elements of the tooth above its rim; none on a plain ring
    housing : (n,) elements of the housing around a ring gear
    lower_nodes : (n_node,) plane model: the lower node that each moves with; None for a solid
    """

    body: str
    n_sectors: int
    phase: float
    coords: Floats
    hexes: Ints
    ccw_nodes: Ints
    cw_nodes: Ints
    faces: dict[str, Ints]
    node_sets: dict[str, Ints]
    flanks: tuple[FlankGrid, ...]
    profile: ToothProfile | None
    quality: dict[str, float]
    tooth: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int32))
    housing: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int32))
    lower_nodes: Ints | None = None

    @property
    def pitch(self) -> float:
        """Angle (rad) of the sector."""
        return 2.0 * np.pi / self.n_sectors

    def sector_angle(self, sector: Ints) -> Floats:
        """Angles (rad) of sectors about z, counter-clockwise from +y; any shape."""
        return self.phase + np.asarray(sector) * self.pitch

    @property
    def plane(self) -> bool:
        """Whether this is the plane model, whose nodes above move with those below."""
        return self.lower_nodes is not None

    @property
    def elements(self) -> Ints:
        """Nodes (n_elem, 8 or 4) of the hexahedra, or of their lower faces in the plane model."""
        return self.hexes if not self.plane else self.hexes[:, :4]

    @property
    def parts(self) -> tuple[Ints, ...]:
        """Elements of each material: those of the gear, then those of a housing."""
        every = np.arange(len(self.hexes), dtype=np.int32)
        return (np.setdiff1d(every, self.housing), self.housing) if len(self.housing) else (every,)

    @cached_property
    def arc_lengths(self) -> dict[int, float]:
        """Arc length (mm) on the tooth profile of every node of the flanks."""
        found: dict[int, float] = {}
        for grid in reversed(self.flanks):
            for s, row in zip(grid.s[::-1], grid.nodes[::-1], strict=True):
                found.update(dict.fromkeys(row.tolist(), float(s)))
        return found

    @cached_property
    def surface_edges(self) -> Ints:
        """Edges (n, 2) of the elements of a plane sector on the surface of tooth and root: neither
        on its cuts nor on the inner surface of the flexible spline or the outer one of the ring
        gear."""
        elements = self.elements
        edges = np.stack([elements, np.roll(elements, -1, axis=1)], axis=-1).reshape(-1, 2)
        edges, times = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
        edges = edges[times == 1]
        others = (self.ccw_nodes, self.cw_nodes, *self.node_sets.values())
        return edges[~np.any([np.isin(edges, nodes).all(axis=1) for nodes in others], axis=0)]

    def nodes_of(self, part: int) -> Ints:
        """Nodes (n,) of a part, those on its boundary included; in the plane of both layers."""
        return np.unique(self.hexes[self.parts[part]])
