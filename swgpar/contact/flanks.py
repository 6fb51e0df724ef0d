"""Tooth flanks of the flexible spline (slave) against those of the ring gear (master), both
deformable.

Quadrature is by segments on the slave flank (see segments.py). The master flank is the exact
profile plus the finite-element displacement (see kernel/contact.hpp). Sliding is finite: every
evaluation finds the foot points anew.

Life cycle. `search` finds the pairs and faces that can meet and begins with no segments. Every
`evaluate` cuts the faces into segments anew, until `freeze_segments` freezes them near the
solution: the tangent does not contain the motion of the segments, and multipliers belong to their
points. `release_segments` ends that, and the next `search` begins anew. Before the first search,
and where no faces are near, nothing is in contact and every method has a defined result.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from swgpar.contact import friction
from swgpar.contact.contact import NO_KEYS, FacePressure
from swgpar.contact.enforcement import penetration
from swgpar.contact.flank_deviations import FlankDeviations
from swgpar.contact.flank_pairs import Faces, FlankPairs
from swgpar.contact.flank_state import ActiveSegments, FrictionStart, RingMotion, SearchRange
from swgpar.contact.friction import Friction, PairKey
from swgpar.contact.search import FlankPair
from swgpar.contact.segments import cut_faces, flank_faces
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.elements import BodyElements
from swgpar.fem.local_nodes import LocalNodes
from swgpar.fem.partition import Partition
from swgpar.fem.sparse import BlockRows
from swgpar.geometry.drive_geometry import FlankCrowning
from swgpar.kernel import contact_flanks
from swgpar.load.load_states import LoadState

CONTINUATION = 5.0
"""Length, in facets, of the straight continuation past the ends of the master's flank. Corners of
slave faces have their foot points on it, so that the cut at the flank's end changes continuously
while a face slides over that end."""

SLIP_SHARE = 0.99
"""Share of the friction bound from which a point counts as slipping: base vectors have unit length
but for strain."""


class FlankContact:
    """Contact of all flank pairs that this rank takes part in; meets the protocol `PenaltyContact`.

    Parameters
    ----------
    partition, spline, ring : ownership and the elements of both bodies
    ring_motion : rotation of the ring gear as a whole
    order : Gauss points per direction on a segment of a slave face
    crowning : of the flexible spline's flanks
    penalty : MPa / mm;  max_gap : mm, largest |gap| at which a foot point is looked for
    pressure_limit : MPa, bound of the pressure in the tangent's geometric term
    friction_coefficient : 0 without friction

    Attributes
    ----------
    tractions : tangential tractions of the last accepted state by flank pair
    frozen : whether the segments are frozen
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
        order: int,
        crowning: FlankCrowning,
        penalty: float,
        max_gap: float,
        pressure_limit: float,
        friction_coefficient: float,
    ) -> None:
        self.partition, self.spline, self.ring = partition, spline, ring
        self.ring_motion = ring_motion
        self.full_penalty = self.penalty = penalty
        self.max_gap, self.pressure_limit = max_gap, pressure_limit
        self.order, self.friction_coefficient = order, friction_coefficient
        mesh = spline.layout.mesh
        self.slaves = {
            g.side: flank_faces(mesh, g, crowning.amount, crowning.width, crowning.shape)
            for g in mesh.flanks
        }
        self.masters = {g.side: g for g in ring.layout.mesh.flanks}
        self.n_face = len(self.slaves[1].corners)
        self.tractions: dict[PairKey, np.ndarray] = {}
        self.frozen = False
        self.flank_pairs: FlankPairs | None = None
        self.deviations: FlankDeviations | None = None
        self._near_faces, self._near_pairs = np.zeros((2, 0), dtype=np.int64)
        self._friction_start: FrictionStart | None = None
        self._active: ActiveSegments | None = None
        self._cut_at: np.ndarray | None = None  # displacement at which unfrozen segments were cut
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
            self._friction_start = FrictionStart(accepted, self._stored_tractions())
        touching = np.flatnonzero(gap < distances.touch)
        return flank_pairs.block_keys(touching, foot_point[touching], self.symmetric)

    def reset(self) -> None:
        """Forget the segments with their multipliers, gaps and pressures."""
        self._active, self._cut_at, self.frozen = None, None, False

    def deviate(self, deviations: FlankDeviations) -> None:
        """Let the flanks deviate from now on, also those of the last search, which begin with new
        segments."""
        self.deviations = deviations
        if self.flank_pairs is not None:
            self.flank_pairs.deviate(deviations)
        self.reset()

    def _stored_tractions(self) -> np.ndarray:
        samples = np.zeros((len(self.pairs), self.n_face, friction.SAMPLES, friction.SAMPLES, 2))
        for k, pair in enumerate(self.pairs):
            samples[k] = self.tractions.get(pair.key, 0.0)
        return samples.reshape(-1, *samples.shape[2:])

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
        gap, _, foot_point, _ = self._call_kernel(faces, u, np.zeros((len(faces.conn), 1)), 0.0)
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
        return bool(np.delete(gap + state.flank_clearance < 0.0, self._near_faces).any())

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
        moment, missing = self._evaluate_segments(u, state.flank_clearance, residual, rows)
        if residual is not None:
            # the flanks' heights over their chords rotate with the ring gear
            self.ring_motion.add_ring_moment(u, moment, residual)
        return missing

    def _evaluate_segments(
        self, u: np.ndarray, clearance: float, residual: np.ndarray | None, rows: BlockRows | None
    ) -> tuple[float, np.ndarray]:
        """Moment (N mm) on the ring gear's rotation from owned pairs, and keys of missing
        blocks."""
        if not len(self._near_faces):
            return 0.0, NO_KEYS
        if not self.frozen and (self._cut_at is None or not np.array_equal(u, self._cut_at)):
            self._active, self._cut_at = self._cut(u), u.copy()
        active = self._active
        if active.friction is not None:
            active.friction.stiffness = friction.STIFFNESS * self.penalty
        moments = np.zeros(len(active.faces.conn))
        active.gap, active.pressure, foot_point, missing = self._call_kernel(
            active.faces,
            u,
            active.multiplier,
            clearance,
            residual,
            rows,
            active.friction,
            moment=moments,
        )
        moment = (
            0.0
            if residual is None
            else float(moments[self.flank_pairs.owned[active.faces.patch]].sum())
        )
        if not missing:
            return moment, NO_KEYS
        acts = active.pressure > 0.0
        if active.friction is not None and active.friction.lagged is not None:
            acts |= (active.friction.lagged > 0.0) & np.isfinite(foot_point[..., 0])
        face, point = np.nonzero(acts)
        keys = self.flank_pairs.block_keys(
            active.segments.parent[face], foot_point[face, point], self.symmetric
        )
        return moment, keys

    def _cut(self, u: np.ndarray) -> ActiveSegments:
        """Cut the faces for displacement u; without multipliers, which would belong to other
        points."""
        all_faces, masters = self.flank_pairs.faces, self.flank_pairs.masters
        corners = all_faces.corners(self._near_faces)
        zero = np.zeros(corners.weight.shape)
        foot_point = self._call_kernel(corners, u, zero, 0.0, beyond=CONTINUATION)[2]
        size, plane = all_faces.size[self._near_faces], self.spline.layout.mesh.plane
        segments = cut_faces(foot_point, size, masters.s, masters.z, self.order, plane)
        faces = all_faces.cut(self._near_faces, segments)
        segments = replace(segments, parent=self._near_faces[segments.parent])
        multiplier = np.zeros_like(faces.weight)
        law, start = None, self._friction_start
        if start is not None:
            gap, _, foot_point, _ = self._call_kernel(faces, start.displacement, multiplier, 0.0)
            traction = friction.interpolated(start.tractions, segments)
            law = friction.begin(self.friction_coefficient, foot_point, gap, traction)
        return ActiveSegments(
            self.flank_pairs,
            faces,
            segments,
            law,
            multiplier,
            np.full_like(multiplier, np.inf),
            multiplier.copy(),
        )

    def _call_kernel(
        self,
        faces: Faces,
        u: np.ndarray,
        multiplier: np.ndarray,
        clearance: float,
        residual: np.ndarray | None = None,
        rows: BlockRows | None = None,
        law: Friction | None = None,
        **more: Any,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
        """Gaps, pressures, foot points and the number of missing blocks; see
        `swgpar.kernel.contact_flanks`."""
        settings = (
            self.penalty,
            clearance,
            self.max_gap,
            self.pressure_limit,
            residual,
            rows,
            law,
            self._ring_rotation,
        )
        return contact_flanks(self.flank_pairs.masters, faces, u, multiplier, *settings, **more)

    def add_owned_forces(self, u: np.ndarray, state: LoadState, residual: np.ndarray) -> None:
        """Add the forces of the pairs whose flexible-spline tooth this rank owns to residual
        (n_local, 3) N."""
        active = self._active
        if state.flank_clearance is None or active is None:
            return
        mine = self.flank_pairs.owned[active.faces.patch]
        law = None if active.friction is None else active.friction.subset(mine)
        multiplier = np.ascontiguousarray(active.multiplier[mine])
        self._call_kernel(
            active.faces.subset(mine), u, multiplier, state.flank_clearance, residual, None, law
        )

    def scale_penalty(self, share: float) -> None:
        """Use this share of the full penalty."""
        self.penalty = share * self.full_penalty

    # -- multipliers and frozen segments -----------------------------------------------------------

    @property
    def multiplier(self) -> np.ndarray:
        """Multipliers (n_segment, n_q) MPa of the present segments."""
        points = self.order if self.spline.layout.mesh.plane else self.order**2
        return np.zeros((0, points)) if self._active is None else self._active.multiplier

    @multiplier.setter
    def multiplier(self, values: np.ndarray) -> None:
        if values.shape != self.multiplier.shape:
            raise ValueError(
                f"multipliers of shape {values.shape} do not belong to the present segments"
            )
        if self._active is not None:
            self._active.multiplier = values

    def augment(self) -> None:
        """Take the pressures of the last evaluation as multipliers and freeze the segments that
        they belong to."""
        if self._active is not None:
            self._active.multiplier = self._active.pressure.copy()
        self.freeze_segments()

    def freeze_segments(self) -> None:
        """Freeze the segments of the last evaluation until `release_segments` or the next
        search."""
        self.frozen, self._cut_at = self._active is not None, None

    def release_segments(self) -> None:
        """Cut the faces anew in every evaluation again."""
        self.frozen = False

    def saved_segments(self) -> ActiveSegments | None:
        """The present segments, for `restore_segments`."""
        return self._active

    def restore_segments(self, saved: ActiveSegments | None) -> None:
        """Freeze segments of the last search again; friction follows the pressure on them, without
        multipliers.

        Raises ValueError for segments of an earlier search: their local nodes are others.
        """
        if saved is not None and saved.flank_pairs is not self.flank_pairs:
            raise ValueError("the segments belong to an earlier contact search")
        self._active = saved
        if saved is not None:
            self._active = replace(saved, multiplier=np.zeros_like(saved.faces.weight))
            if saved.friction is not None:
                saved.friction.lagged = None
        self.freeze_segments()

    def freeze_friction_bound(self) -> tuple[float, float]:
        """Let the pressures of the last evaluation bound the friction, on frozen segments.

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
        for face in np.unique(active.segments.parent[(active.pressure > 0.0).any(axis=1)]):
            k, local = divmod(int(face), self.n_face)
            shape = (self.n_face, friction.SAMPLES, friction.SAMPLES, 2)
            store = self.tractions.setdefault(self.pairs[k].key, np.zeros(shape))
            store[local] = friction.sampled(active.segments, active.friction.current, face)

    def resume(self, tractions: dict[PairKey, np.ndarray]) -> None:
        """Take these tractions as those of the last accepted state."""
        self.tractions = tractions

    def traction_rows(self, first: int, end: int) -> dict[str, np.ndarray]:
        """The accepted tractions of the sectors first .. end - 1, as rows for a file."""
        return friction.to_rows(self.tractions, first, end, self.n_face)

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
        return [np.unique(active.segments.parent[points.any(axis=1)]) for points in sets]

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
        sides = np.array([p.side for p in self.pairs])
        return float(active.gap[sides[active.faces.patch] == side].min(initial=np.inf))

    def penetration(self) -> float:
        """Largest penetration (mm) of the last evaluation on this rank."""
        return 0.0 if self._active is None else penetration(self._active.gap, self._active.pressure)

    def owned_pressure(self) -> FacePressure | None:
        """Pressures of the last evaluation on owned faces; None without faces."""
        active = self._active
        if active is None:
            return None
        own, faces = self.flank_pairs.owned[active.faces.patch], active.faces
        return FacePressure(
            faces.conn[own], faces.shape[own], faces.weight[own], active.pressure[own]
        )
