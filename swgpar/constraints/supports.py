"""Supports and load of the drive: couplings, guide, grounding of a factorisation."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from swgpar.constraints.distributing_coupling import (
    N_COUPLED,
    ROTATION,
    Coupling,
    NodeMeans,
)
from swgpar.constraints.output_springs import OutputSprings
from swgpar.constraints.race_coupling import RaceCoupling
from swgpar.constraints.radial_guide import RadialGuide
from swgpar.constraints.rigid_attachment import RigidAttachment
from swgpar.fem.partition import Partition
from swgpar.fem.sparse import BlockRows, add_diagonal
from swgpar.fem.vectors import create_vector
from swgpar.load.load_states import LoadState
from swgpar.petsc import PETSc

GROUNDING = 0.1
"""Stiffness of the grounding over E times the module."""


SPLINE_COUPLING, RING_COUPLING = 0, 1
"""Indices of the couplings of the flexible spline and of the ring gear that floats, if one does."""


class FixedRing:
    """A ring gear whose outer surface is fixed; meets the protocol `RingMotion`."""

    floats = False

    def ring_rotation(self, u: np.ndarray) -> float:
        """Zero."""
        return 0.0

    def add_ring_moment(self, u: np.ndarray, moment: float, residual: np.ndarray) -> None:
        """The frame takes it."""


class FloatingRing:
    """A ring gear that rotates with its outer surface; meets the protocol `RingMotion`.

    coupling : of that surface;  comm : communicator
    """

    floats = True

    def __init__(self, coupling: Coupling, comm: MPI.Comm) -> None:
        self.coupling, self.comm = coupling, comm

    def ring_rotation(self, u: np.ndarray) -> float:
        """Rotation (rad) of the ring gear at displacement u (n_local, 3) mm; collective."""
        return float(self.coupling.evaluate(u).value[ROTATION])

    def add_ring_moment(self, u: np.ndarray, moment: float, residual: np.ndarray) -> None:
        """Add this rank's part of a moment (N mm) on it to residual (n_local, 3) N; collective."""
        total = self.comm.allreduce(moment, op=MPI.SUM)
        residual[self.coupling.nodes] += total * self.coupling.evaluate(u).gradient[ROTATION]


class Supports:
    """The couplings of all bodies that float: of the gears by their indices, then of an outer race.

    partition : ownership
    couplings : six multipliers each, in this order at the end of the vector; none where contacts
    hold the body, no second one where the ring gear is clamped
    output : index of the coupling of the output
    guide : around the ring gear, or None
    scale : unit of the multipliers and of the grounding: E times the module, N/mm
    share : modelled share of the drive: 1, or 1 over the number of lobes
    race : coupling of the outer race, without a bearing None
    spline_ratio : rotation of the flexible spline over that of the output, where contacts alone
    hold it unless the load state says otherwise; None where its coupling supports it
    bearing : of the output; None where it is held but for its rotation

    Attributes:
    gear_couplings, couplings : those of the gears alone, and all
    offsets : (n_couplings, 6) values at which coupled quantities are held, mm and rad
    """

    def __init__(
        self,
        partition: Partition,
        couplings: list[NodeMeans],
        *,
        output: int = SPLINE_COUPLING,
        guide: RadialGuide | None = None,
        scale: float,
        share: float,
        race: RaceCoupling | None = None,
        spline_ratio: float | None = None,
        bearing: OutputSprings | None = None,
    ) -> None:
        self.spline_ratio, self.bearing = spline_ratio, bearing
        self.partition, self.guide = partition, guide
        self.couplings: list[Coupling] = [*couplings] if race is None else [*couplings, race]
        self.gear_couplings, self.output_gear = couplings, output
        self.scale, self.share = scale, share
        self.offsets = np.zeros((len(self.couplings), N_COUPLED))
        self._attached = [(i, c) for i, c in enumerate(couplings) if isinstance(c, RigidAttachment)]
        self._ground_vectors: list[PETSc.Vec] = []
        self._grounded_nodes: list[tuple[int, np.ndarray]] = []
        for coupling in self.couplings:
            for support in coupling.supports():
                self._ground(coupling, support)

    def _ground(self, coupling: Coupling, support: np.ndarray) -> None:
        """Ground the coupling's nodes along their directions in `support` (n, 3)."""
        directions = np.sqrt(GROUNDING * self.scale) * support
        self._ground_vectors.append(self._vector(coupling.nodes, directions))
        for i in np.flatnonzero(support.any(axis=1)):
            self._grounded_nodes.append((int(coupling.nodes[i]), directions[i]))

    def grounding(self, u: np.ndarray) -> list[PETSc.Vec]:
        """Vectors B of what the matrix holds too much, B B^T, at u (n_local, 3) mm; collective.

        One for each supported direction, and those of the free motions of rigid attachments and of
        the guide.
        """
        free = [(part.nodes, part.free_motions(u)) for _, part in self._attached]
        if self.guide is not None:
            free.append((self.guide.nodes, self.guide.free_motions(u)))
        vectors = [self._vector(nodes, values) for nodes, some in free for values in some]
        return [*self._ground_vectors, *vectors]

    def springs(self, u: np.ndarray) -> list[PETSc.Vec]:
        """Vectors S of what the matrix lacks of the output's bearing, S S^T, at u (n_local, 3) mm;
        collective."""
        if self.bearing is None:
            return []
        output = self.output
        vectors = self.bearing.spring_vectors(output.evaluate(u))
        return [self._vector(output.nodes, values) for values in vectors]

    def _vector(self, nodes: np.ndarray, values: np.ndarray) -> PETSc.Vec:
        """A vector with values (n, 3) at nodes (n,)."""
        vector = create_vector(self.partition)
        vector.array.reshape(-1, 3)[nodes] = values
        return vector

    @property
    def output(self) -> Coupling:
        """Coupling of the output."""
        return self.couplings[self.output_gear]

    @property
    def ring_floats(self) -> bool:
        """Whether the ring gear has a coupling, and is not clamped."""
        return len(self.gear_couplings) > RING_COUPLING

    def prescribed(self, state: LoadState) -> list[tuple[int, int]]:
        """Pairs (coupling, coupled quantity) that the load state prescribes."""
        active = [
            (i, int(k)) for i, c in enumerate(self.couplings) for k in np.flatnonzero(c.active)
        ]
        if self.bearing is not None:
            active = [(i, k) for i, k in active if i != self.output_gear or k == ROTATION]
        if state.control == "torque":
            active.remove((self.output_gear, ROTATION))
        if self.spline_ratio is not None and not state.spline_held:
            active.remove((SPLINE_COUPLING, ROTATION))
        return active

    def holds_spline(self, state: LoadState) -> bool:
        """Whether the load state prescribes the rotation of the flexible spline."""
        return (SPLINE_COUPLING, ROTATION) in self.prescribed(state)

    def unused_multipliers(self, state: LoadState) -> np.ndarray:
        """Which multipliers the load state does not use; bool, one entry each."""
        unused = np.ones(self.partition.n_multipliers, dtype=bool)
        unused[[N_COUPLED * i + k for i, k in self.prescribed(state)]] = False
        return unused

    def output_rotation(self, u: np.ndarray) -> float:
        """Rotation (rad) of the output at displacement u (n_local, 3) mm; collective."""
        return float(self.output.evaluate(u).value[ROTATION])

    def torque_norm(self, state: LoadState) -> float:
        """Norm (N) over all nodes of the forces by which the torque acts on the output; inf where
        none does."""
        torque = state.torque if state.control == "torque" else 0.0
        if torque == 0.0:
            return np.inf
        output = self.gear_couplings[self.output_gear]
        return self.share * abs(torque) * output.rotation_norm

    def add_forces(
        self, u: np.ndarray, state: LoadState, multiplier: np.ndarray, residual: np.ndarray
    ) -> np.ndarray:
        """Add forces of multipliers, load, guide and bearing to residual (n_local, 3) N.

        Returns the residual's rows (n_multipliers,) of the multipliers, N.
        """
        if self.guide is not None:
            self.guide.add_forces(u, residual)
        for i, attachment in self._attached:
            attachment.add_forces(u, self.offsets[i], residual)
        motion = [coupling.evaluate(u) for coupling in self.couplings]
        rows = self.scale * multiplier  # unused ones are zero; used ones are overwritten below
        if not motion:
            return rows
        target = self.offsets.copy()
        target[self.output_gear, ROTATION] += state.output_rotation
        if self.spline_ratio is not None:
            target[SPLINE_COUPLING, ROTATION] += self.spline_ratio * state.output_rotation
        for i, k in self.prescribed(state):
            gradient = motion[i].gradient[k]
            residual[self.couplings[i].nodes] += (
                self.scale * multiplier[N_COUPLED * i + k] * gradient
            )
            rows[N_COUPLED * i + k] = self.scale * (motion[i].value[k] - target[i, k])
        if self.bearing is not None:
            output = motion[self.output_gear]
            forces = self.bearing.forces(output)
            residual[self.output.nodes] += np.tensordot(forces, output.gradient[:ROTATION], axes=1)
        if state.control == "torque":
            residual[self.output.nodes] -= (
                self.share * state.torque * motion[self.output_gear].gradient[ROTATION]
            )
        return rows

    def add_blocks(self, u: np.ndarray, rows: BlockRows) -> None:
        """Add the stiffness of grounding, guide and rigid attachments to the tangent's diagonal."""
        for node, direction in self._grounded_nodes:
            add_diagonal(rows, self.partition, np.array([node]), np.outer(direction, direction))
        if self.guide is not None:
            add_diagonal(rows, self.partition, self.guide.nodes, self.guide.blocks(u))
        for _, attachment in self._attached:
            add_diagonal(rows, self.partition, attachment.nodes, attachment.blocks())

    def border(self, u: np.ndarray, state: LoadState) -> tuple[list[PETSc.Vec], list[int]]:
        """Gradients of prescribed quantities, rows of their multipliers; a loaded one is last."""
        prescribed = self.prescribed(state)
        if state.control == "torque":
            prescribed.append((self.output_gear, ROTATION))
        motion, border = [coupling.evaluate(u) for coupling in self.couplings], []
        for i, k in prescribed:
            border.append(self._vector(self.couplings[i].nodes, self.scale * motion[i].gradient[k]))
        return border, [N_COUPLED * i + k for i, k in prescribed]

    def held_at(self, coupling: int, u: np.ndarray) -> np.ndarray:
        """Values (6,) at which a coupling is held, mm and rad, but for a prescribed rotation; where
        a bearing carries it, its displacements and tilts at u (n_local, 3) mm. Collective."""
        held = self.offsets[coupling].copy()
        if self.bearing is not None and coupling == self.output_gear:
            held[:ROTATION] = self.output.evaluate(u).value[:ROTATION]
        return held

    def output_displacement(self, u: np.ndarray) -> np.ndarray:
        """Displacements (mm) along x, y and z and tilts (rad) about x and y of the output in the
        middle of its bearing, (5,) at u (n_local, 3) mm; (0,) without a bearing. Collective."""
        if self.bearing is None:
            return np.zeros(0)
        return self.bearing.displacement(self.output.evaluate(u))

    def bearing_moment(self, u: np.ndarray) -> float:
        """Moment (N mm) about z of the whole drive of bearing and forces on the output that is
        displaced at u (n_local, 3) mm; collective."""
        if self.bearing is None:
            return 0.0
        return self.bearing.moment(self.output.evaluate(u)) / self.share

    def reactions(self, multiplier: np.ndarray) -> np.ndarray:
        """Torques (N mm) about z of the whole drive that support the gears, by the multipliers."""
        rotations = multiplier[ROTATION::N_COUPLED][: len(self.gear_couplings)]
        return -self.scale * rotations / self.share
