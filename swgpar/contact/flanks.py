"""Tooth flanks of the flexible spline (slave) against those of the ring gear (master), both
deformable.

Contact is that of cells on lines along the profile, see contact_lines.py. The master flank is the
exact profile plus the finite-element displacement (see kernel/contact.hpp). Sliding is finite:
every evaluation finds the foot points anew.

Life cycle. `search` finds the pairs and faces that can meet and begins with no cells. Every
`evaluate` places the cells anew, until they are frozen (line_cells.py); the next `search` begins
anew. Before the first search, and where no faces are near, nothing is in contact and every method
has a defined result.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from swgpar.contact import friction
from swgpar.contact.active_cells import ActiveCells
from swgpar.contact.cell_forces import CellForces, add_line_tangents
from swgpar.contact.cells import Stations
from swgpar.contact.contact import NO_KEYS, FacePressure
from swgpar.contact.flank_deviations import FlankDeviations
from swgpar.contact.flank_faces import flank_faces
from swgpar.contact.flank_kernel import FlankKernel
from swgpar.contact.flank_pairs import FlankPairs, GapGradients
from swgpar.contact.flank_state import RingMotion, SearchRange
from swgpar.contact.friction import CellTractions, PairKey
from swgpar.contact.friction_history import FrictionHistory
from swgpar.contact.line_cells import SLIDING, LineCells
from swgpar.contact.pressed_lines import PressedLine
from swgpar.contact.search import FlankPair
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.elements import BodyElements
from swgpar.fem.local_nodes import LocalNodes
from swgpar.fem.partition import Partition
from swgpar.fem.sparse import BlockRows
from swgpar.geometry.micro_geometry import FlankCrowning
from swgpar.load.load_states import LoadState


class FlankContact:
    """Contact of all flank pairs that this rank takes part in; a `PressureContact`.

    Parameters
    ----------
    partition, spline, ring : ownership and the elements of both bodies
    ring_motion : rotation of the ring gear as a whole
    lines_on_layer : lines of contact on a layer of elements along the face width
    crowning : of the flanks of the flexible spline and of those of the ring gear
    max_gap : mm, largest |gap| at which a foot point is looked for
    pressure_limit : MPa, bound of the pressure in the tangent's geometric term
    friction_coefficient : 0 without friction

    Attributes
    ----------
    cells : on the lines of contact;  history : what friction counts from
    kernel : gives gaps and forces of faces
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
        crowning: tuple[FlankCrowning, FlankCrowning],
        max_gap: float,
        pressure_limit: float,
        friction_coefficient: float,
    ) -> None:
        self.partition, self.spline, self.ring = partition, spline, ring
        self.ring_motion = ring_motion
        self.friction_coefficient = friction_coefficient
        mesh = spline.layout.mesh
        self.slaves = {
            g.side: flank_faces(mesh, g, *crowning, spline.layout.body.stretch) for g in mesh.flanks
        }
        self.masters = {g.side: g for g in ring.layout.mesh.flanks}
        stations = Stations.of(lines_on_layer, mesh.plane)
        self.law = CellForces(spline, ring, stations)
        self.n_face = self.law.n_face
        self.history = FrictionHistory(friction_coefficient, self.law.n_line)
        self.kernel = FlankKernel(max_gap, pressure_limit)
        self.cells = LineCells(self.kernel, self.law, stations, self.history)
        self.deviations: FlankDeviations | None = None
        self._near_pairs = np.zeros(0, dtype=np.int64)

    @property
    def flank_pairs(self) -> FlankPairs | None:
        """Pairs and faces of the last search, None before the first one."""
        return self.kernel.pairs

    @property
    def _active(self) -> ActiveCells | None:
        return self.cells.active

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
        numbers, parts = self.partition.node_numbers, []
        for side, slave in self.slaves.items():
            of_side = [p for p in pairs if p.side == side]
            sector, ring = (
                np.array(of_pair, dtype=np.int64)
                for of_pair in ([p.sector for p in of_side], [p.ring for p in of_side])
            )
            master = self.masters[-side].nodes.ravel()
            parts.append(numbers(FLEXIBLE_SPLINE, sector, slave.corners.ravel())[0].ravel())
            parts.append(numbers(self.ring.layout.name, ring, master)[0].ravel())
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
        self.kernel.pairs = flank_pairs = FlankPairs(
            self.partition, self.spline, self.ring, self.slaves, self.masters, pairs, local
        )
        self.cells.near, self._near_pairs = np.zeros((2, 0), dtype=np.int64)
        self.reset()
        self.kernel.ring_rotation = self.ring_motion.ring_rotation(u)
        if accepted is None:
            self.history.begin_without()
        else:
            self.history.begin(accepted, self.ring_motion.ring_rotation(accepted))
        if flank_pairs.faces is None:
            return NO_KEYS
        if self.deviations is not None:
            flank_pairs.deviate(self.deviations)
        gap, foot_point = self._gaps_of_faces(u)
        near = np.flatnonzero(gap < distances.near)
        closest = np.full(len(pairs), np.inf)
        np.minimum.at(closest, flank_pairs.faces.patch, gap)
        self.cells.near = near[closest[flank_pairs.faces.patch[near]] < distances.reach]
        self._near_pairs = np.unique(flank_pairs.faces.patch[near])
        touching = np.flatnonzero(gap < distances.touch)
        return flank_pairs.block_keys(
            touching, foot_point[touching], touching // self.n_face, self.symmetric
        )

    def reset(self) -> None:
        """Forget the cells with their gaps and pressures."""
        self.cells.reset()

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
            self.pairs[k] for k in np.unique(self.flank_pairs.faces.patch[self.cells.near])
        ]
        return (
            np.array([pair.sector for pair in evaluated], dtype=np.int64),
            np.array([pair.ring for pair in evaluated], dtype=np.int64),
            np.array([self.pairs[k].ring for k in self._near_pairs], dtype=np.int64),
        )

    def _gaps_of_faces(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gap (n_face,) mm of every face and its foot point (n_face, 2) mm on the master: in the
        middle, or where that lies beside the master's flank the smaller one at both ends. A tip may
        reach past the other one by less than half of a face."""
        placed = self.flank_pairs.faces
        gap, foot_point = (one[:, 0] for one in self.kernel.gaps(placed.centers(), u, 0.5, 0.0))
        beside = np.flatnonzero(np.isinf(gap))
        if beside.size:
            at_ends, feet = self.kernel.gaps(placed.ends(beside), u, 0.5, 0.0)
            end = np.argmin(at_ends, axis=1)
            rows = np.arange(len(beside))
            gap[beside], foot_point[beside] = at_ends[rows, end], feet[rows, end]
        return gap, foot_point

    def overlooked(self, pairs: list[FlankPair], u: np.ndarray, state: LoadState) -> bool:
        """Whether the last search missed pairs, or faces that are now in contact; on this rank.

        pairs : that this rank takes part in now
        """
        if not set(pairs) <= set(self.pairs):
            return True
        if self.flank_pairs is None or self.flank_pairs.faces is None:
            return False
        gap, _ = self._gaps_of_faces(u)
        if np.delete(gap + state.flank_clearance < 0.0, self.cells.near).any():
            return True
        return self.cells.misses_lines(u, state.flank_clearance)

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
        self.kernel.ring_rotation = self.ring_motion.ring_rotation(u)
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
        if not len(self.cells.near):
            return 0.0, NO_KEYS
        active = self.cells.pressed(u, clearance)
        acts, law = active.carries, active.friction
        if law is not None:
            law.current[:] = 0.0
            if law.lagged is not None:
                acts |= (law.lagged > 0.0).any(axis=1)
        chosen = np.flatnonzero(acts)
        faces, moments = active.faces.subset(chosen), np.zeros(len(chosen))
        gradients = None if rows is None else GapGradients.empty(*faces.weight.shape)
        part = None if law is None else law.subset(chosen)
        *_, missing = self.kernel(
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
        pair = active.parent[chosen] // self.n_face
        return moment, self.flank_pairs.line_keys(nodes, pair, self.symmetric)

    def pressed_lines(
        self, u: np.ndarray, state: LoadState, narrow: Collection[FlankPair] | None = None
    ) -> list[PressedLine]:
        """Pressures of the pairs whose flexible-spline tooth this rank owns at displacement u
        (n_local, 3) mm, on finer cells than those of a solve.

        narrow : see `LineCells.pressed_lines`
        """
        if state.flank_clearance is None or not len(self.cells.near):
            return []
        return self.cells.pressed_lines(u, state.flank_clearance, narrow)

    def least_gaps(self, u: np.ndarray, state: LoadState) -> np.ndarray:
        """Smallest gap (n_pair,) mm of each pair of the last search at u (n_local, 3) mm; inf where
        none of its faces is near."""
        return self.cells.least_gaps(u, state.flank_clearance)

    def add_forces(
        self,
        active: ActiveCells,
        chosen: np.ndarray,
        u: np.ndarray,
        state: LoadState,
        residual: np.ndarray,
    ) -> None:
        """Add the forces of some cells (n,) without friction to residual (n_local, 3) N;
        collective."""
        faces, moments = active.faces.subset(chosen), np.zeros(len(chosen))
        pressure = np.ascontiguousarray(active.pressure[chosen])
        at = u, pressure, state.flank_clearance, residual
        self.kernel(faces, *at, moment=moments, beyond=SLIDING)
        owned = self.flank_pairs.owned[faces.patch]
        self.ring_motion.add_ring_moment(u, float(moments[owned].sum()), residual)

    def add_owned_forces(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray, *, friction: bool = True
    ) -> None:
        """Add the forces of the pairs whose flexible-spline tooth this rank owns to residual
        (n_local, 3) N. friction : with it, or those of the pressures alone"""
        active = self._active
        if state.flank_clearance is None or active is None:
            return
        mine = active.owned & active.carries
        law = active.friction.subset(mine) if friction and active.friction is not None else None
        pressure = np.ascontiguousarray(active.pressure[mine])
        faces = active.faces.subset(mine)
        self.kernel(faces, u, pressure, state.flank_clearance, residual, None, law, beyond=SLIDING)

    def scale_penalty(self, share: float) -> None:
        """Use this share of the stiffness."""
        self.cells.scale(share)

    def accept(self) -> None:
        """Keep the tangential tractions of the last evaluation, of a converged state."""
        self.history.accept(self._active)

    def resume(self, tractions: dict[PairKey, CellTractions]) -> None:
        """Take these tractions as those of the last accepted state."""
        self.history.tractions = tractions

    def traction_rows(self, first: int, end: int) -> dict[str, np.ndarray]:
        """The accepted tractions of the sectors first .. end - 1, as rows for a file;
        collective."""
        return friction.to_rows(self.history.tractions, first, end, self.partition.comm)

    # -- results of the last evaluation ------------------------------------------------------------

    def active_sets(self) -> list[np.ndarray]:
        """Faces with pressure, and faces with points that slip, of the last evaluation on this
        rank; their numbers."""
        return [] if self._active is None else self._active.active_sets()

    def touching_pairs(self) -> int:
        """Flank pairs with pressure whose flexible-spline tooth this rank owns."""
        return 0 if self._active is None else self._active.touching_pairs()

    def doubtful_slip(self) -> tuple[float, float]:
        """See `ActiveCells.doubtful_slip`."""
        return (0.0, 0.0) if self._active is None else self._active.doubtful_slip()

    def smallest_gap(self, side: int) -> float:
        """Smallest gap (mm) of the flanks on one side (+1, -1) in the last evaluation on this rank;
        inf without any."""
        return np.inf if self._active is None else self._active.smallest_gap(side)

    def owned_pressure(self) -> FacePressure | None:
        """Pressures of the last evaluation on owned faces; None without faces."""
        return None if self._active is None else self._active.owned_pressure()
