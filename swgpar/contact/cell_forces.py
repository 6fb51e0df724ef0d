"""The law of contact lines on placed cells: their ends on both flanks, forces, pressures and
tangent."""

from __future__ import annotations

import numpy as np

from swgpar.contact import contact_lines
from swgpar.contact.active_cells import ActiveCells
from swgpar.contact.cell_placement import PlacedCells
from swgpar.contact.cells import Stations
from swgpar.contact.contact_lines import CellLoads, FlankCompliance, Strips
from swgpar.contact.flank_faces import exact_strips
from swgpar.contact.flank_pairs import FlankPairs, GapGradients
from swgpar.contact.line_coupling import LineCoupling
from swgpar.contact.missing_compliance import MissingCompliance
from swgpar.contact.pressed_lines import PressedLine
from swgpar.fem.elements import BodyElements
from swgpar.fem.sparse import BlockRows
from swgpar.kernel import OVERHANG, add_contact_lines

EDGE_ZONE, EDGE_SOFTNESS = 0.05, 0.02
"""Zone at the ends of the master's flank, in facets, and thickness of the elastic layer that cells
have at the very end, in facets: a flank that slides over an end loses its force there
continuously, where half planes would lose it at once."""

MAX_APPROACHES, SAME_FORCE = 12, 1e-9
"""Steps of Newton's method to the approach at which a line carries a given force, and the relative
difference of forces that are the same."""


class CellForces:
    """What acts on cells of a pair of bodies.

    slave, master : elements of the flexible spline and of the ring gear
    stations : lines on a layer

    Attributes
    ----------
    missing : what the elements under the flanks of both lack in compliance
    n_line : lines of a flank
    n_face, n_layer : faces and layers of a slave flank;  z : (n_layer + 1,) mm, ends of the layers
    """

    def __init__(self, slave: BodyElements, master: BodyElements, stations: Stations) -> None:
        self.missing = _missing(slave), _missing(master)
        self._profile = slave.layout.mesh.profile
        self.z = slave.layout.mesh.flanks[0].z
        self._grid = self.missing[1].s, master.layout.mesh.flanks[0].z
        self.n_layer = len(self.z) - 1
        self.n_line = self.n_layer * len(stations.place)
        thickness = np.diff(self.z)[:, None]
        z = (self.z[:-1, None] + thickness * stations.place).ravel()
        length = (thickness * stations.share).ravel()
        lower, upper = (
            FlankCompliance(
                missing, None if self.n_line == 1 else LineCoupling(missing, nodes, z, length)
            )
            for missing, nodes in zip(self.missing, (self.z, self._grid[1]))
        )
        self._bodies = lower, upper
        self.n_face = (len(self.missing[0].s) - 1) * self.n_layer

    def measured(self, pairs: FlankPairs, placed: PlacedCells, foot: np.ndarray) -> ActiveCells:
        """Cells with their ends on both flanks; foot : (n, n_q, 2) mm, arc length and z of their
        points on the master, which may lie past its ends."""
        cells, n = placed.cells, len(placed.line)
        size = pairs.faces.size[cells.parent]
        start = self.missing[0].s[cells.parent % self.n_face // self.n_layer]
        slave = Strips(start + cells.low * size[:, 0], start + cells.high * size[:, 0])
        has_foot = self._lies_on_master(foot)
        foot = foot[..., 0]
        middle = np.where(has_foot, foot.mean(axis=1), 0.0)
        # two Gauss points tell the ends of a cell
        half = np.where(has_foot, 0.5 * np.sqrt(3.0) * np.abs(foot[:, 1] - foot[:, 0]), 1.0)
        return ActiveCells(
            flank_pairs=pairs,
            placed=placed,
            slave=slave,
            master=Strips(middle - half, middle + half),
            has_foot=has_foot,
            softness=self._edge_softness(middle) / (slave.high - slave.low),
            length=size[:, 1] * cells.share,
            friction=None,
            gap=np.full(n, np.inf),
            forces=CellLoads(np.zeros(n), []),
            pressure=np.zeros_like(placed.faces.weight),
        )

    def _lies_on_master(self, foot: np.ndarray) -> np.ndarray:
        """Which cells (n,) have all of their foot points (n, n_q, 2) on the master's flank."""
        lies = np.isfinite(foot).all(axis=(1, 2))
        for place, nodes in zip(np.moveaxis(foot, 2, 0), self._grid):
            low, high = OVERHANG * (nodes[1] - nodes[0]), OVERHANG * (nodes[-1] - nodes[-2])
            lies &= (place.min(axis=1) >= nodes[0] - low) & (place.max(axis=1) <= nodes[-1] + high)
        return lies

    def _edge_softness(self, middle: np.ndarray) -> np.ndarray:
        """Compliance (n,) mm / MPa of cells at places (n,) mm near the ends of the master's
        flank."""
        master = self.missing[1]
        out, facets = np.zeros(len(middle)), np.diff(master.s)
        for end, facet in ((master.s[0], facets[0]), (master.s[-1], facets[-1])):
            near = np.maximum(0.0, 1.0 - np.abs(middle - end) / (EDGE_ZONE * facet))
            out += EDGE_SOFTNESS * facet / master.modulus * near
        return out

    def press(self, active: ActiveCells, gap: np.ndarray, share: float) -> None:
        """Set gaps, forces and pressures of the cells.

        gap : (n, n_q) mm, at their points;  share : of the stiffness that acts
        """
        active.gap = np.where(active.has_foot, gap.mean(axis=1), np.inf)
        self._load(active, share)

    def _load(self, active: ActiveCells, share: float) -> None:
        """Set forces and pressures of the cells by their gaps. share : as for `press`"""
        flank, line = np.divmod(active.placed.line, self.n_line)
        active.forces = contact_lines.forces(
            flank,
            line,
            active.gap,
            active.length,
            (active.slave, active.master),
            self._bodies,
            active.softness,
            share,
        )
        pressure = active.forces.force / active.width
        active.pressure = np.repeat(pressure[:, None], active.faces.weight.shape[1], axis=1)

    def carry(self, cells: ActiveCells, share: float, present: ActiveCells) -> None:
        """Let the bodies approach on every line until its cells, which are pressed, carry the force
        of the present ones; one line on a flank. share : as for `press`
        """
        line, wanted = cells.placed.line, np.zeros(int(cells.placed.line.max(initial=-1)) + 1)
        known = present.placed.line < len(wanted)
        np.add.at(wanted, present.placed.line[known], present.forces.force[known])
        gap, deeper = cells.gap, np.zeros(len(wanted))
        for _ in range(MAX_APPROACHES):
            carried, stiffness = np.bincount(line, cells.forces.force, len(wanted)), 0.0 * wanted
            for acts, of_cells in cells.forces.flanks:
                stiffness[line[acts[0]]] = of_cells.sum()
            moves = (wanted > 0.0) & (stiffness > 0.0)
            lacks = np.where(moves, wanted - carried, 0.0)
            if not (np.abs(lacks) > SAME_FORCE * wanted).any():
                break
            deeper[moves] += lacks[moves] / stiffness[moves]
            cells.gap = gap - deeper[line]
            self._load(cells, share)

    def pressed_lines(self, active: ActiveCells) -> list[PressedLine]:
        """Pressures of the pairs whose flexible-spline tooth this rank owns, on widths along
        the exact flank."""
        pairs, lines = active.flank_pairs, []
        assert self._profile is not None  # all gears have one
        carries = (active.forces.force > 0.0) & pairs.owned[active.faces.patch]
        for line in np.unique(active.placed.line[carries]):
            on = np.flatnonzero(carries & (active.placed.line == line))
            layer = active.parent[on[0]] % self.n_layer
            station = active.placed.cells.station[on[0]]
            facet = active.parent[on] % self.n_face // self.n_layer
            ends = active.placed.cells.low[on], active.placed.cells.high[on]
            low, high = exact_strips(self._profile, self.missing[0].s, facet, *ends)
            lines.append(
                PressedLine(
                    pair=pairs.pairs[active.faces.patch[on[0]]],
                    z=float(self.z[layer] + station * (self.z[layer + 1] - self.z[layer])),
                    length=float(active.length[on[0]]),
                    low=low,
                    high=high,
                    pressure=active.forces.force[on] / (high - low),
                )
            )
        return lines


def add_line_tangents(
    active: ActiveCells, chosen: np.ndarray, gradients: GapGradients, rows: BlockRows
) -> int:
    """Add the tangents of the flanks that carry; returns the number of missing blocks.

    chosen : (n,) cells, ascending, whose gradients these are
    """
    flanks = active.forces.flanks
    if not flanks:
        return 0
    start = np.cumsum([0, *(len(cells) for cells, _ in flanks)])
    at = np.searchsorted(chosen, np.concatenate([cells for cells, _ in flanks]))
    gap = 0.5 * gradients.vector[at].reshape(len(at), -1, 3)
    force = gap - 0.5 * gradients.friction[at].reshape(len(at), -1, 3)
    length = active.length[chosen[at]]
    return add_contact_lines(
        start,
        np.ascontiguousarray(gradients.conn[at].reshape(len(at), -1)),
        np.ascontiguousarray(gradients.sixths[at].reshape(len(at), -1)),
        np.ascontiguousarray(length[:, None, None] * force),
        gap,
        np.concatenate([stiffness.ravel() for _, stiffness in flanks]),
        rows,
    )


def _missing(body: BodyElements) -> MissingCompliance:
    """What the elements under the flanks of a body lack in compliance."""
    mesh, of = body.layout.mesh, body.layout.body
    return MissingCompliance(mesh, mesh.flanks[0], of.in_plane_elasticity, of.incompatible)
