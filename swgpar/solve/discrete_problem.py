"""The discrete problem: residual and tangent of the drive at a displacement.

Its parts are the structure (elements), the contacts, and the supports with the load.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.constraints.supports import Supports
from swgpar.contact.clearance import FlankClearance
from swgpar.contact.contact import (
    NO_KEYS,
    Contact,
    ForceTerm,
    PenaltyContact,
    PressureContact,
    largest,
)
from swgpar.contact.flank_state import ContactSearch
from swgpar.contact.flanks import FlankContact
from swgpar.contact.friction import CellTractions, PairKey
from swgpar.contact.frozen_cells import FrozenCells
from swgpar.contact.search import FlankPair, facing_flanks
from swgpar.contact.wave_generator import WaveGeneratorContacts
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.elements import Elements
from swgpar.fem.partition import Partition
from swgpar.fem.sectors_in_reach import ModelledSectors
from swgpar.fem.sparse import BlockRows, add_unit_diagonal
from swgpar.fem.vectors import Exchange, create_vector, read_multipliers
from swgpar.geometry.rotation import to_owners
from swgpar.load.load_states import LoadState
from swgpar.log import PhaseTimes
from swgpar.petsc import PETSc
from swgpar.solve.tangent_matrix import TangentMatrix
from swgpar.solve.torque_control import TorqueControl

FORCE_FLOOR = 1e-6
"""Contact force, over E times the module squared, below which no residual is judged by it."""


@dataclass(frozen=True)
class ResidualInfo:
    """What comes with a residual.

    contact_force : N, norm of the contact forces over all nodes
    collapsed : whether an element has collapsed; the residual is then not valid
    """

    contact_force: float
    collapsed: bool


class DiscreteProblem:
    """Residual and tangent of a body, or of a drive, with contact; no solver.

    partition, elements : ownership and elements, bound to their local nodes
    supports : couplings, guide, grounding and load
    wave_generator : its contacts; none for a body without one
    flanks, contact_search : contacts of the tooth flanks, one for each ring gear, and their search;
    none and None for a body without teeth
    boundary_terms : what holds and loads a part that is cut out
    module : mm, length that bounds and floors refer to
    modelled : what of the drive is modelled in full; None where all is
    blocks : room for the tangent, which outlives the problem; None: its own
    phases : wall seconds

    Attributes:
    contacts : all of them;  penalty_contacts : those with multipliers;  pressure_contacts : of
    faces;  force_terms : all that is evaluated
    cells : freezing of the flanks' cells;  torque_control : of the output's motion
    x : state vector: displacements (mm) and multipliers;  accepted : the last state found in
    equilibrium
    blocks : of the last `tangent`, and their matrix
    round_off : N, of the last `tangent`, largest force by a last-digit error of the positions
    """

    def __init__(
        self,
        *,
        partition: Partition,
        elements: Elements,
        supports: Supports,
        wave_generator: WaveGeneratorContacts | None = None,
        flanks: Sequence[FlankContact] = (),
        contact_search: ContactSearch | None = None,
        boundary_terms: Sequence[ForceTerm] = (),
        module: float,
        modelled: ModelledSectors | None = None,
        blocks: TangentMatrix | None = None,
        phases: PhaseTimes,
    ) -> None:
        self.partition = partition
        self.elements = elements
        self.supports = supports
        self.phases = phases
        self.wave_generator = wave_generator or WaveGeneratorContacts()
        self.flanks, self.contact_search = list(flanks), contact_search
        surfaces = self.wave_generator.of_inner_surface
        self.penalty_contacts: list[PenaltyContact] = list(surfaces)
        self.pressure_contacts: list[PressureContact] = [*surfaces, *flanks]
        self.contacts: list[Contact] = [*self.wave_generator.all, *flanks]
        self.cells = FrozenCells(self.flanks, partition.comm)
        self.force_terms: list[ForceTerm] = [*self.contacts, *boundary_terms]
        outermost = 0.0 if contact_search is None else contact_search.outer_radius
        clearances = [
            FlankClearance(contact, partition.comm, module=module, outer_radius=outermost)
            for contact in flanks
        ]
        self.torque_control = TorqueControl(supports, clearances)
        self.module = module
        self.modelled = modelled or ModelledSectors(elements)
        self.scale = supports.scale
        self.coupling_keys = self.wave_generator.block_keys(elements)
        self.x, self.accepted = create_vector(partition), create_vector(partition)
        self.local_nodes = elements.local
        self.exchange = Exchange(partition, self.local_nodes.number)
        self.blocks, self._owns_blocks = blocks or TangentMatrix(elements), blocks is None
        self._extent = largest(partition.comm, float(np.abs(self.positions()).max(initial=0.0)))
        self.round_off = 0.0
        self._searched = self.x.array_r.copy()

    def destroy(self) -> None:
        """Release the tangent and the exchange of ghost values; collective."""
        self.exchange.destroy()
        if self._owns_blocks:
            self.blocks.destroy()

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric."""
        return all(flanks.symmetric for flanks in self.flanks)

    def flanks_of(self, ring: str) -> FlankContact:
        """Contact of the flanks of the flexible spline with those of a ring gear."""
        (contact,) = (flanks for flanks in self.flanks if flanks.ring.layout.name == ring)
        return contact

    @property
    def force_floor(self) -> float:
        """Smallest contact force (N) that residuals are compared with."""
        return FORCE_FLOOR * self.scale * self.module

    # -- local data --------------------------------------------------------------------------------

    def displacement(self, x: PETSc.Vec | None = None) -> np.ndarray:
        """Displacement (n_local, 3) mm of the state x (default: `self.x`), ghosts included."""
        return self.exchange(self.x if x is None else x)

    def positions(self) -> np.ndarray:
        """Undeformed positions (n_local, 3) mm as owners see them; zero for multipliers."""
        out = np.zeros((len(self.local_nodes), 3))
        for body in self.elements.bodies.values():
            seen, position = body.local >= 0, to_owners(body.positions(), body.sixths)
            out[body.local[seen]] = position[seen]
        return out

    def multipliers(self, x: PETSc.Vec | None = None) -> np.ndarray:
        """Multipliers of the couplings (n_multipliers,), on every rank; collective."""
        return read_multipliers(self.partition, self.x if x is None else x)

    def clear_unused_multipliers(self, state: LoadState) -> None:
        """Set the multipliers of x to zero that the load state does not use."""
        if self.partition.has_multipliers:
            unused = self.supports.unused_multipliers(state)
            self.x.array[-len(unused) :][unused] = 0.0

    # -- contact search ----------------------------------------------------------------------------

    def search(self, state: LoadState) -> None:
        """Find the flanks and faces that can meet at x; make room in the tangent; collective."""
        with self.phases("search"):
            self.complete()
            self._searched = self.x.array_r.copy()
            pairs = [
                self._facing_pairs(flanks, state, self.contact_search.tip_margin)
                for flanks in self.flanks
            ]
            further = [flanks.node_numbers(facing) for flanks, facing in zip(self.flanks, pairs)]
            self.local_nodes = self.elements.local.extended(
                np.concatenate([np.zeros(0, dtype=np.int64), *further])
            )
            self.exchange.destroy()
            self.exchange = Exchange(self.partition, self.local_nodes.number)
            pattern = self.coupling_keys
            if self.flanks:
                accepted = None
                if not self.symmetric and state.friction_acts:
                    accepted = self.displacement(self.accepted)
                u = self.displacement()
                for flanks, facing in zip(self.flanks, pairs):
                    keys = flanks.search(
                        facing, self.local_nodes, u, self.contact_search.distances, accepted
                    )
                    pattern = np.union1d(pattern, keys)
                self._choose_modelled_sectors()
        for contact in self.wave_generator.of_inner_surface:
            contact.reset()
        self.set_pattern(pattern)

    def complete(self) -> None:
        """Let the inside of condensed teeth follow their rims; collective."""
        if self.modelled.whole_teeth:
            self.modelled.complete(self.displacement(), self.x.array.reshape(-1, 3))

    def reset_contacts(self) -> None:
        """Begin all contacts anew with the pairs and faces of the last search."""
        for contact in self.pressure_contacts:
            contact.reset()

    def moved_since_search(self) -> float:
        """Largest displacement (mm) of a node since the last search, by component; collective."""
        moved = np.abs(self.x.array_r - self._searched)
        if self.partition.has_multipliers:
            moved = moved[: -self.partition.n_multipliers]
        return largest(self.partition.comm, float(moved.max(initial=0.0)))

    def _facing_pairs(
        self, flanks: FlankContact, state: LoadState, margin: float
    ) -> list[FlankPair]:
        """Pairs of flanks of this rank that can meet at x; none while they are switched off."""
        if not flanks.is_active(state):
            return []
        u = self.displacement()
        rotation = flanks.ring_motion.ring_rotation(u)
        ring = flanks.ring.layout
        pairs = facing_flanks(self.partition, flanks.spline, ring, u, rotation, margin)
        return [pair for pair in pairs if flanks.takes_part(pair)]

    def _choose_modelled_sectors(self) -> None:
        """Leave out ring-gear sectors, and condense teeth, that are out of reach; collective."""
        within: dict[str, np.ndarray] = {}
        near: dict[str, np.ndarray] = {}
        splines = []
        for flanks in self.flanks:
            parts = self.partition.comm.allgather(flanks.sectors_in_reach())
            name = flanks.ring.layout.name
            spline, within[name], near[name] = (np.concatenate(part) for part in zip(*parts))
            splines.append(spline)
        within[FLEXIBLE_SPLINE] = np.concatenate(splines)
        if self.modelled.update(within, near):
            self.blocks.pattern = None
        if self.modelled.choices:
            self.x.array.reshape(-1, 3)[self.elements.pattern.nodes_without_elements] = 0.0
            self.complete()

    def overlooked(self, state: LoadState) -> bool:
        """Whether flanks that the search left out have come into contact; collective."""
        if not any(flanks.is_active(state) for flanks in self.flanks):
            return False
        with self.phases("search"):
            self.complete()
            u = self.displacement()
            overlooked = [
                flanks.overlooked(self._facing_pairs(flanks, state, 0.0), u, state)
                for flanks in self.flanks
            ]
        return bool(self.partition.comm.allreduce(int(any(overlooked)), op=MPI.MAX))

    def set_pattern(self, pattern: np.ndarray) -> None:
        """Make room in the tangent for contact blocks, keys row * n_global + column (n,)."""
        with self.phases("pattern"):
            self.blocks.make_room(pattern, self.local_nodes, self.exchange)

    def extend_pattern(self, missing: np.ndarray) -> None:
        """Make room for further contact blocks, keys (n,) that `tangent` returned; collective."""
        self.set_pattern(np.union1d(self.blocks.pattern, missing))

    # -- residual and tangent ----------------------------------------------------------------------

    def _evaluate_terms(
        self, u: np.ndarray, state: LoadState, residual: np.ndarray | None, rows: BlockRows | None
    ) -> np.ndarray:
        """Add the forces and blocks of all terms; returns keys of blocks that the pattern lacks."""
        missing = [term.evaluate(u, state, residual, rows) for term in self.force_terms]
        return np.concatenate([NO_KEYS, *missing])

    def residual(self, x: PETSc.Vec, f: PETSc.Vec, state: LoadState) -> ResidualInfo:
        """Set f to the residual at x, N; collective."""
        comm, n_own = self.partition.comm, self.partition.n_own
        with self.phases("residual"):
            u = self.displacement(x)
            contact = np.zeros_like(u)
            collapsed = False
            try:
                self._evaluate_terms(u, state, contact, None)
                residual = contact.copy()
                self.elements.assemble(u, residual, None, None)
            except FloatingPointError:
                collapsed, residual = True, contact
            collapsed = bool(comm.allreduce(int(collapsed), op=MPI.MAX))
            contact_force = np.sqrt(comm.allreduce(float(np.sum(contact[:n_own] ** 2))))
            tail = self.supports.add_forces(u, state, self.multipliers(x), residual)
            f.array[:] = residual[:n_own].ravel()
            if self.partition.has_multipliers:
                f.array[-len(tail) :] = tail
        return ResidualInfo(float(contact_force), collapsed)

    def tangent(self, u: np.ndarray, state: LoadState) -> np.ndarray:
        """Fill `blocks`, the grounded tangent K' = K + B B^T, at u (n_local, 3) mm; collective.

        Symmetric: without friction, where residual and tangent are derivatives of a potential
        (`symmetric`). With it all blocks are stored, also where nothing slips.

        Definite: K is singular where contacts or multipliers alone hold a body; the grounding B
        makes K' positive definite where K is semi-definite, as in the undeformed drive. Geometric
        terms make K' indefinite: those of elements where a thin rim under compression gives way
        between contacts, those of pressures on curved surfaces and of balls. That happens in early
        iterations; the line search then reverses the step. PETSc is told that a symmetric K' is
        positive definite, so that MUMPS factorises it without pivoting whether it is or not.

        It lacks the second variation of a coupling's rotation, the motion of the cuts between
        cells, and pressures beyond the bound of the geometric terms. The multipliers couple
        through the border (`BorderedSystem`).

        Returns keys (n,) of contact blocks on this rank that have no room in it.
        """
        with self.phases("tangent"):
            rows = self.blocks.rows
            rows.values[:] = 0.0
            self.elements.assemble(u, None, rows, self.blocks.block_indices)
            missing = self._evaluate_terms(u, state, None, rows)
            self.supports.add_blocks(u, rows)
            add_unit_diagonal(rows, self.partition, self.scale)
        # of the forces that follow from a last-digit error of every position
        eps = float(np.finfo(float).eps)
        self.round_off = eps * self._extent * self.blocks.norm_of_diagonal()
        with self.phases("insert"):
            self.blocks.fill()
        return missing

    def complete_tangent(self, u: np.ndarray, state: LoadState) -> None:
        """Fill `blocks` with the tangent at u (n_local, 3) mm, with room for all of its blocks;
        collective."""
        missing = self.tangent(u, state)
        if self.partition.comm.allreduce(len(missing), op=MPI.MAX):
            self.extend_pattern(missing)
            self.tangent(u, state)

    def closing_rotation(self, state: LoadState) -> float:
        """Rotation (rad) of the output that brings flanks together, after a search; collective."""
        self.search(state)
        return self.torque_control.closing_rotation(self.displacement(), state)

    # -- state -------------------------------------------------------------------------------------

    def active_sets(self, state: LoadState) -> list[np.ndarray]:
        """Active sets of the contacts that the load state switches on, on this rank."""
        active = [contact for contact in self.contacts if contact.is_active(state)]
        return [part for contact in active for part in contact.active_sets()]

    def scale_penalties(self, share: float) -> None:
        """Use this share of the full penalty in every contact."""
        for contact in self.pressure_contacts:
            contact.scale_penalty(share)

    def penetration(self) -> float:
        """Largest penetration (mm) of the last evaluation, over all ranks; collective."""
        here = max((contact.penetration() for contact in self.penalty_contacts), default=0.0)
        return largest(self.partition.comm, here)

    def touching_pairs(self) -> int:
        """Flank pairs of the model in contact, over all ranks; collective."""
        pairs = sum(flanks.touching_pairs() for flanks in self.flanks)
        return int(self.partition.comm.allreduce(pairs, op=MPI.SUM))

    def doubtful_slip(self) -> float:
        """Share of the flanks' force on points whose friction may depend on the step;
        collective."""
        forces = np.array([flanks.doubtful_slip() for flanks in self.flanks]).reshape(-1, 2)
        doubtful, force = self.partition.comm.allreduce(forces.sum(axis=0), op=MPI.SUM)
        return float(doubtful / force) if force else 0.0

    def accept(self) -> None:
        """Take x as the state from which friction counts the slip of the next solve; collective."""
        self.complete()
        self.x.copy(self.accepted)
        for flanks in self.flanks:
            flanks.accept()

    def resume_sectors(self, chosen: list[list[int]]) -> None:
        """Model these in full, as a run did that is continued; before the search. Collective."""
        self.modelled.resume(chosen)
        self.blocks.pattern = None

    def resume(self, tractions: Mapping[str, dict[PairKey, CellTractions]]) -> None:
        """Take x and these tractions of the flanks as an accepted state. tractions : by ring gear,
        of which those that are not named have none"""
        self.x.copy(self.accepted)
        for flanks in self.flanks:
            flanks.resume(dict(tractions.get(flanks.ring.layout.name, {})))

    def output_rotation(self) -> float:
        """Rotation of the output (rad); collective."""
        return self.supports.output_rotation(self.displacement())
