"""Tooth flanks of the flexible spline (slave) against those of the ring gear (master), both
deformable.

Contact is that of cells on lines along the profile, see contact_lines.py. The master flank is the
exact profile plus the finite-element displacement (see kernel/contact.hpp). Sliding is finite:
every evaluation finds the foot points anew.

Life cycle. `search` finds the pairs and faces that can meet and begins with no cells. Every
`evaluate` places the cells anew, until `freeze_cells` freezes them near the solution: the tangent
does not contain the motion of the cuts between them. `release_cells` ends that, and the next
`search` begins anew. Before the first search, and where no faces are near, nothing is in contact
and every method has a defined result.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from swgpar.contact import friction
from swgpar.contact.cell_forces import CellForces, add_line_tangents
from swgpar.contact.cell_placement import ACROSS, RESOLVED, CellPlacement, PlacedCells
from swgpar.contact.cells import Stations
from swgpar.contact.contact import NO_KEYS, FacePressure
from swgpar.contact.contact_lines import Strips
from swgpar.contact.flank_deviations import FlankDeviations
from swgpar.contact.flank_faces import flank_faces
from swgpar.contact.flank_pairs import Faces, FlankPairs, GapGradients
from swgpar.contact.flank_state import ActiveCells, FrictionStart, RingMotion, SearchRange
from swgpar.contact.friction import CellTractions, Friction, PairKey
from swgpar.contact.pressed_lines import PressedLine
from swgpar.contact.search import FlankPair
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.elements import BodyElements
from swgpar.fem.local_nodes import LocalNodes
from swgpar.fem.partition import Partition
from swgpar.fem.sparse import BlockRows
from swgpar.geometry.drive_geometry import FlankCrowning
from swgpar.kernel import contact_flanks
from swgpar.load.load_states import LoadState

SLIDING = 0.5
"""Facets by which frozen cells may slide past the ends of the master's flank: their forces then
change continuously."""

SLIP_SHARE = 0.99
"""Share of the friction bound from which a point counts as slipping: base vectors have unit length
but for strain."""


class FlankContact:
    """Contact of all flank pairs that this rank takes part in; a `PressureContact`.

    Parameters
    ----------
    partition, spline, ring : ownership and the elements of both bodies
    ring_motion : rotation of the ring gear as a whole
    lines_on_layer : lines of contact on a layer of elements along the face width
    crowning : of the flexible spline's flanks
    stick_stiffness : MPa / mm, tangential;  max_gap : mm, largest |gap| at which a foot point is
    looked for
    pressure_limit : MPa, bound of the pressure in the tangent's geometric term
    friction_coefficient : 0 without friction

    Attributes
    ----------
    tractions : tangential tractions of the last accepted state by flank pair
    frozen : whether the cells are frozen
    flank_pairs : pairs and faces of the last search, None before the first one
    deviations : of the flanks, None where they are ideal
    """

    def __init__(
        self,
        partition: Partition,
        spline: BodyElements,
        ring: BodyElements,
        ring_motion: RingMotion,
        *,
        lines_on_layer: int,
        crowning: FlankCrowning,
        stick_stiffness: float,
        max_gap: float,
        pressure_limit: float,
        friction_coefficient: float,
    ) -> None:
        self.partition, self.spline, self.ring = partition, spline, ring
        self.ring_motion = ring_motion
        self.stick_stiffness, self.stiffness_share = stick_stiffness, 1.0
        self.max_gap, self.pressure_limit = max_gap, pressure_limit
        self.friction_coefficient = friction_coefficient
        mesh = spline.layout.mesh
        self.slaves = {
            g.side: flank_faces(mesh, g, crowning.amount, crowning.width, crowning.shape)
            for g in mesh.flanks
        }
        self.masters = {g.side: g for g in ring.layout.mesh.flanks}
        self.law = CellForces(spline, ring)
        self.stations = Stations.of(lines_on_layer, mesh.plane)
        self.n_face, self.n_layer = self.law.n_face, self.law.n_layer
        self.tractions: dict[PairKey, CellTractions] = {}
        self.frozen = False
        self.flank_pairs: FlankPairs | None = None
        self.deviations: FlankDeviations | None = None
        self._near_faces, self._near_pairs = np.zeros((2, 0), dtype=np.int64)
        self._friction_start: FrictionStart | None = None
        self._active: ActiveCells | None = None
        self._placed_at: np.ndarray | None = None  # displacement of unfrozen cells
        self._ring_rotation = 0.0

    # -- search ------------------------------------------------------------------------------------

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric: without friction."""
        return self.friction_coefficient == 0.0

    @property
    def pairs(self) -> list[FlankPair]:
        """Pairs of the last search that this rank takes part in."""
        return [] if self.flank_pairs is None else self.flank_pairs.pairs

    def takes_part(self, pair: FlankPair) -> bool:
        """Whether this rank owns one of the pair's teeth."""
        owner = self.partition.owner_of_sector
        owners = (
            owner(FLEXIBLE_SPLINE, np.array(pair.sector)),
            owner(self.ring.layout.name, np.array(pair.ring)),
        )
        return self.partition.comm.rank in owners

    def node_numbers(self, pairs: list[FlankPair]) -> np.ndarray:
        """Global numbers (n,) of the flank nodes of pairs."""
        numbers, parts = self.partition.node_numbers, [np.zeros(0, dtype=np.int64)]
        for p in pairs:
            slave, master = self.slaves[p.side].corners.ravel(), self.masters[-p.side].nodes.ravel()
            parts.append(numbers(FLEXIBLE_SPLINE, np.array([p.sector]), slave)[0].ravel())
            parts.append(numbers(self.ring.layout.name, np.array([p.ring]), master)[0].ravel())
        return np.concatenate(parts)

    def search(
        self,
        pairs: list[FlankPair],
        local: LocalNodes,
        u: np.ndarray,
        distances: SearchRange,
        accepted: np.ndarray | None = None,
    ) -> np.ndarray:
        """Choose the faces that can meet, of pairs that this rank takes part in; collective.

        pairs : of this rank;  local : local nodes, those of the pairs among them
        u : (n_local, 3) mm;  accepted : converged displacement from which friction counts the slip,
        None without

        Returns keys row * n_global + column (n,) of the tangent's blocks that may couple.
        """
        self.flank_pairs = flank_pairs = FlankPairs(
            self.partition, self.spline, self.ring, self.slaves, self.masters, pairs, local
        )
        self._near_faces, self._near_pairs = np.zeros((2, 0), dtype=np.int64)
        self._friction_start = None
        self.reset()
        self._ring_rotation = self.ring_motion.ring_rotation(u)
        if flank_pairs.faces is None:
            return NO_KEYS
        if self.deviations is not None:
            flank_pairs.deviate(self.deviations)
        gap, foot_point = self._gaps_at_centers(u)
        near = np.flatnonzero(gap < distances.near)
        closest = np.full(len(pairs), np.inf)
        np.minimum.at(closest, flank_pairs.faces.patch, gap)
        self._near_faces = near[closest[flank_pairs.faces.patch[near]] < distances.reach]
        self._near_pairs = np.unique(flank_pairs.faces.patch[near])
        if accepted is not None:
            self._friction_start = FrictionStart(accepted, self.tractions)
        touching = np.flatnonzero(gap < distances.touch)
        return flank_pairs.block_keys(
            touching, foot_point[touching], self._layer(touching), self.symmetric
        )

    def _layer(self, face: np.ndarray) -> np.ndarray:
        """Numbers (n,) of the layers of faces (n,), of all pairs."""
        pair, face = np.divmod(face, self.n_face)
        return pair * self.n_layer + face % self.n_layer

    def reset(self) -> None:
        """Forget the cells with their gaps and pressures."""
        self._active, self._placed_at, self.frozen = None, None, False

    def deviate(self, deviations: FlankDeviations) -> None:
        """Let the flanks deviate from now on, also those of the last search, which begin with new
        cells."""
        self.deviations = deviations
        if self.flank_pairs is not None:
            self.flank_pairs.deviate(deviations)
        self.reset()

    def sectors_in_reach(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Sectors (n,) by the last search: of both gears with evaluated faces, of the ring gear
        with near ones."""
        if self.flank_pairs is None or self.flank_pairs.faces is None:
            return tuple(np.zeros((3, 0), dtype=np.int64))
        evaluated = [
            self.pairs[k] for k in np.unique(self.flank_pairs.faces.patch[self._near_faces])
        ]
        return (
            np.array([pair.sector for pair in evaluated], dtype=np.int64),
            np.array([pair.ring for pair in evaluated], dtype=np.int64),
            np.array([self.pairs[k].ring for k in self._near_pairs], dtype=np.int64),
        )

    def _gaps_at_centers(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gap (n_face,) mm at the middle of every face and its foot point (n_face, 2) mm on the
        master."""
        faces = self.flank_pairs.faces.centers()
        gap, _, foot_point, _ = self._call_kernel(
            faces, u, np.zeros((len(faces.conn), 1)), 0.0, beyond=0.5
        )
        return gap[:, 0], foot_point[:, 0]

    def overlooked(self, pairs: list[FlankPair], u: np.ndarray, state: LoadState) -> bool:
        """Whether the last search missed pairs, or faces that are now in contact; on this rank.

        pairs : that this rank takes part in now
        """
        if not set(pairs) <= set(self.pairs):
            return True
        if self.flank_pairs is None or self.flank_pairs.faces is None:
            return False
        gap, _ = self._gaps_at_centers(u)
        if np.delete(gap + state.flank_clearance < 0.0, self._near_faces).any():
            return True
        if not self.frozen or not len(self._near_faces):
            return False
        touching = self._placement(state.flank_clearance).overlapping(u)
        return bool(np.isin(touching, self._active.placed.line, invert=True).any())

    # -- forces and tangent ------------------------------------------------------------------------

    def is_active(self, state: LoadState) -> bool:
        """Whether the load state switches this contact on."""
        return state.flank_clearance is not None

    def evaluate(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Compute gaps and pressures at u (n_local, 3) mm; add to residual (n_local, 3) N and to
        the tangent's rows.

        Collective. Returns keys (n,) of blocks that the pattern of `rows` lacks.
        """
        if state.flank_clearance is None:
            return NO_KEYS
        self._ring_rotation = self.ring_motion.ring_rotation(u)
        moment, missing = self._evaluate_cells(u, state.flank_clearance, residual, rows)
        if residual is not None:
            # the flanks' heights over their chords rotate with the ring gear
            self.ring_motion.add_ring_moment(u, moment, residual)
        return missing

    def _evaluate_cells(
        self, u: np.ndarray, clearance: float, residual: np.ndarray | None, rows: BlockRows | None
    ) -> tuple[float, np.ndarray]:
        """Moment (N mm) on the ring gear's rotation from owned pairs, and keys of missing
        blocks."""
        if not len(self._near_faces):
            return 0.0, NO_KEYS
        if not self.frozen and (self._placed_at is None or not np.array_equal(u, self._placed_at)):
            self._active, self._placed_at = self._place(u, clearance), u.copy()
        active = self._active
        gap, _ = self._gaps(active.faces, u, SLIDING, clearance)
        self.law.press(active, gap, self.stiffness_share)
        acts = active.forces.force > 0.0
        law = active.friction
        if law is not None:
            law.stiffness = friction.STIFFNESS * self.stiffness_share * self.stick_stiffness
            law.current[:] = 0.0
            if law.lagged is not None:
                acts |= (law.lagged > 0.0).any(axis=1)
        chosen = np.flatnonzero(acts)
        faces, moments = active.faces.subset(chosen), np.zeros(len(chosen))
        gradients = None if rows is None else GapGradients.empty(*faces.weight.shape)
        part = None if law is None else law.subset(chosen)
        *_, missing = self._call_kernel(
            faces,
            u,
            active.pressure[chosen],
            clearance,
            residual,
            rows,
            part,
            moment=moments,
            gradients=gradients,
            beyond=SLIDING,
        )
        if law is not None:
            law.current[chosen] = part.current
        owned = self.flank_pairs.owned[faces.patch]
        moment = 0.0 if residual is None else float(moments[owned].sum())
        if gradients is None:
            return moment, NO_KEYS
        missing += add_line_tangents(active, chosen, gradients, rows)
        if not missing:
            return moment, NO_KEYS
        nodes = gradients.conn.reshape(len(chosen), -1)
        layer = self._layer(active.parent[chosen])
        return moment, self.flank_pairs.line_keys(nodes, layer, self.symmetric)

    def _placement(self, clearance: float, across: int = ACROSS) -> CellPlacement:
        """What places cells on the near faces."""
        return CellPlacement(
            self.flank_pairs,
            self._near_faces,
            n_face=self.n_face,
            n_layer=self.n_layer,
            stations=self.stations,
            gaps=partial(self._gaps, clearance=clearance),
            across=across,
        )

    def _place(self, u: np.ndarray, clearance: float) -> ActiveCells:
        """The cells for displacement u, and the friction that begins on them."""
        active = self._measured(self._placement(clearance).place(u), u)
        active.friction = self._begun_friction(active.placed, active.slave)
        return active

    def _measured(self, placed: PlacedCells, u: np.ndarray) -> ActiveCells:
        """Cells with their ends on both flanks at displacement u."""
        foot = self._gaps(placed.faces, u, None, 0.0)[1][..., 0]
        return self.law.measured(self.flank_pairs, placed, foot)

    def pressed_lines(self, u: np.ndarray, state: LoadState) -> list[PressedLine]:
        """Pressures of the pairs whose flexible-spline tooth this rank owns at displacement u
        (n_local, 3) mm, on finer cells than those of a solve."""
        if state.flank_clearance is None or not len(self._near_faces):
            return []
        active = self._measured(self._placement(state.flank_clearance, RESOLVED).place(u), u)
        gap, _ = self._gaps(active.faces, u, SLIDING, state.flank_clearance)
        self.law.press(active, gap, self.stiffness_share)
        return self.law.pressed_lines(active)

    def _begun_friction(self, placed: PlacedCells, slave: Strips) -> Friction | None:
        """The law with the last converged state at the points of cells; None without friction."""
        begun, faces = self._friction_start, placed.faces
        if begun is None:
            return None
        zero = np.zeros_like(faces.weight)
        gap, _, foot_point, _ = self._call_kernel(faces, begun.displacement, zero, 0.0)
        traction, of_flank = np.zeros((*zero.shape, 2)), placed.line % self._lines_of_flank
        for k, pair in enumerate(self.pairs):
            stored, mine = begun.tractions.get(pair.key), faces.patch == k
            if stored is not None and mine.any():
                means = stored.means(of_flank[mine], slave.low[mine], slave.high[mine])
                traction[mine] = means[:, None]
        return friction.begin(self.friction_coefficient, foot_point, gap, traction)

    @property
    def _lines_of_flank(self) -> int:
        return self.n_layer * len(self.stations.place)

    def _gaps(
        self, faces: Faces, u: np.ndarray, beyond: float | None, clearance: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Gaps (n, n_q) mm and foot points (n, n_q, 2) mm; see `swgpar.contact.cell_placement`."""
        more: dict[str, Any] = {} if beyond is None else {"beyond": beyond}
        zero = np.zeros_like(faces.weight)
        gap, _, foot_point, _ = self._call_kernel(faces, u, zero, clearance, **more)
        return gap, foot_point

    def _call_kernel(
        self,
        faces: Faces,
        u: np.ndarray,
        pressure: np.ndarray,
        clearance: float,
        residual: np.ndarray | None = None,
        rows: BlockRows | None = None,
        law: Friction | None = None,
        **more: Any,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
        """Gaps, pressures, foot points and the number of missing blocks; see
        `swgpar.kernel.contact_flanks`."""
        settings = (
            0.0,  # the pressures are given
            clearance,
            self.max_gap,
            self.pressure_limit,
            residual,
            rows,
            law,
            self._ring_rotation,
        )
        return contact_flanks(self.flank_pairs.masters, faces, u, pressure, *settings, **more)

    def add_owned_forces(self, u: np.ndarray, state: LoadState, residual: np.ndarray) -> None:
        """Add the forces of the pairs whose flexible-spline tooth this rank owns to residual
        (n_local, 3) N."""
        active = self._active
        if state.flank_clearance is None or active is None:
            return
        mine = self.flank_pairs.owned[active.faces.patch] & (active.forces.force > 0.0)
        law = None if active.friction is None else active.friction.subset(mine)
        pressure = np.ascontiguousarray(active.pressure[mine])
        faces = active.faces.subset(mine)
        self._call_kernel(
            faces, u, pressure, state.flank_clearance, residual, None, law, beyond=SLIDING
        )

    def scale_penalty(self, share: float) -> None:
        """Use this share of the stiffness."""
        self.stiffness_share = share

    # -- frozen cells ------------------------------------------------------------------------------

    def freeze_cells(self) -> None:
        """Freeze the cells of the last evaluation until `release_cells` or the next search."""
        self.frozen, self._placed_at = self._active is not None, None

    def release_cells(self) -> None:
        """Place the cells anew in every evaluation again."""
        self.frozen = False

    def saved_cells(self) -> ActiveCells | None:
        """The present cells, for `restore_cells`."""
        return self._active

    def restore_cells(self, saved: ActiveCells | None) -> None:
        """Freeze cells of the last search again; friction follows the pressure on them.

        Raises ValueError for cells of an earlier search: their local nodes are others.
        """
        if saved is not None and saved.flank_pairs is not self.flank_pairs:
            raise ValueError("the cells belong to an earlier contact search")
        self._active = saved
        if saved is not None and saved.friction is not None:
            saved.friction.lagged = None
        self.freeze_cells()

    def freeze_friction_bound(self) -> tuple[float, float]:
        """Let the pressures of the last evaluation bound the friction, on frozen cells.

        Returns the largest change of these pressures and the largest of them (MPa) on this rank; 0
        without friction.
        """
        if not self.frozen or self._active.friction is None:
            return 0.0, 0.0
        law, pressure = self._active.friction, self._active.pressure
        before, law.lagged = law.lagged, pressure.copy()
        top = float(pressure.max(initial=0.0))
        return top if before is None else float(np.abs(pressure - before).max(initial=0.0)), top

    def accept(self) -> None:
        """Keep the tangential tractions of the last evaluation, of a converged state."""
        self.tractions = {}
        active = self._active
        if active is None or active.friction is None:
            return
        carries, of_flank = active.forces.force > 0.0, active.placed.line % self._lines_of_flank
        for k in np.unique(active.faces.patch[carries]):
            mine = (active.faces.patch == k) & carries
            self.tractions[self.pairs[k].key] = CellTractions(
                of_flank[mine],
                active.slave.low[mine],
                active.slave.high[mine],
                active.friction.current[mine].mean(axis=1),
            )

    def resume(self, tractions: dict[PairKey, CellTractions]) -> None:
        """Take these tractions as those of the last accepted state."""
        self.tractions = tractions

    def traction_rows(self, first: int, end: int) -> dict[str, np.ndarray]:
        """The accepted tractions of the sectors first .. end - 1, as rows for a file;
        collective."""
        return friction.to_rows(self.tractions, first, end, self.partition.comm)

    # -- results of the last evaluation ------------------------------------------------------------

    def active_sets(self) -> list[np.ndarray]:
        """Faces with pressure, and faces with points that slip, of the last evaluation on this
        rank; their numbers."""
        active = self._active
        if active is None:
            return []
        touching = active.pressure > 0.0
        sets = [touching]
        if active.friction is not None:
            limit = SLIP_SHARE * self.friction_coefficient * active.pressure
            sets.append(touching & (np.linalg.norm(active.friction.current, axis=2) >= limit))
        return [np.unique(active.parent[points.any(axis=1)]) for points in sets]

    def touching_pairs(self) -> int:
        """Flank pairs with pressure whose flexible-spline tooth this rank owns."""
        active = self._active
        if active is None:
            return 0
        touching = np.unique(active.faces.patch[(active.pressure > 0.0).any(axis=1)])
        return int(self.flank_pairs.owned[touching].sum())

    def doubtful_slip(self) -> tuple[float, float]:
        """Force (N) of the last evaluation on points of owned faces that stick, or have no foot in
        the accepted state and so no slip; and on all points."""
        active = self._active
        if active is None or active.friction is None:
            return 0.0, 0.0
        force = active.faces.weight * active.pressure
        force[~self.flank_pairs.owned[active.faces.patch]] = 0.0
        bound = SLIP_SHARE * self.friction_coefficient * active.pressure
        slips = np.linalg.norm(active.friction.current, axis=2) >= bound
        slips &= np.isfinite(active.friction.foot_point[..., 0])
        return float(force[~slips].sum()), float(force.sum())

    def smallest_gap(self, side: int) -> float:
        """Smallest gap (mm) of the flanks on one side (+1, -1) in the last evaluation on this rank;
        inf without any."""
        active = self._active
        if active is None:
            return np.inf
        of_side = np.array([p.side for p in self.pairs])[active.faces.patch] == side
        return min(active.placed.nearest[side], float(active.gap[of_side].min(initial=np.inf)))

    def owned_pressure(self) -> FacePressure | None:
        """Pressures of the last evaluation on owned faces; None without faces."""
        active = self._active
        if active is None:
            return None
        own, faces = self.flank_pairs.owned[active.faces.patch], active.faces
        return FacePressure(
            faces.conn[own], faces.shape[own], faces.weight[own], active.pressure[own]
        )
