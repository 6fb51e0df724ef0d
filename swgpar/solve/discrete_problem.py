"""Forces and stiffness of the discrete drive at a displacement: structure, contact, what holds and loads the bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from swgpar.constraints.supports import Supports
from swgpar.contact.flanks import FlankContact
from swgpar.contact.friction import FIRST_STEP, PairKey
from swgpar.contact.rigid_surface import CamPose, RigidContact
from swgpar.contact.search import FlankPair, facing_flanks, largest
from swgpar.design.drive_design import DriveDesign
from swgpar.design.load_states import LoadState
from swgpar.fem.body_layout import FLEXIBLE_SPLINE, RING_GEAR
from swgpar.fem.elements import Elements
from swgpar.fem.inactive_sectors import InactiveSectors
from swgpar.fem.partition import Partition
from swgpar.fem.sparse import BlockRows, add_unit_diagonal, create_matrix, fill_matrix
from swgpar.fem.vectors import Exchange, create_vector, read_multipliers
from swgpar.geometry.rotation import HALF_TURN
from swgpar.log import Phases

NEAR, TOUCH, TIP_MARGIN = 0.25, 0.05, 0.1
"""Search distances as shares of the module: faces evaluated (farther off in a drive with more backlash), blocks
foreseen, tip overlap."""


def near(design: DriveDesign) -> float:
    """Distance (mm) within which flanks are followed: under torque all those that the backlash may bring together."""
    return max(NEAR * design.drive.module, TOUCH * design.drive.module + design.backlash)


@dataclass(eq=False, repr=False)
class DiscreteProblem:
    """The discrete drive: which flanks can meet, the forces that are left over at a displacement, and their tangent.

    Parameters
    ----------
    design : the drive;  partition, elements : ownership and elements, bound to their local nodes
    holding : what holds and loads the bodies
    rigid, pins : cam and pins on the inner surface;  teeth : flank contact

    `x` is the state, `accepted` the last one that was found in equilibrium. `residual` leaves the norm of the contact
    forces in `reference`, N, and whether an element has collapsed in `failed`; `tangent` leaves `matrix`, contact
    blocks that have no room in it in `missing`, and what round-off can make of the forces in `round_off`, N.
    """

    design: DriveDesign
    partition: Partition
    elements: Elements
    holding: Supports
    rigid: RigidContact
    pins: RigidContact
    teeth: FlankContact
    phases: Phases

    def __post_init__(self) -> None:
        design, partition, elements, holding = self.design, self.partition, self.elements, self.holding
        self.contacts = self.rigid, self.pins, self.teeth
        self.scale, self.share = holding.scale, holding.share
        self.x, self.accepted = create_vector(partition), create_vector(partition)
        self.near = near(design)
        self.scene: LoadState | None = None
        self.matrix: PETSc.Mat | None = None
        self.rebind(np.zeros(0, dtype=np.int64))
        self.keys: np.ndarray | None = None
        ring_stands = design.solver.far_teeth == "left_out" and holding.housing is None and len(elements.bodies) == 2
        self.far = InactiveSectors(partition.layouts[RING_GEAR].count) if ring_stands else None
        own = np.arange(partition.row_start, partition.row_start + partition.n_own)
        self.own_keys = own * partition.n_global + own
        self.round_off = 0.0

    # -- local data ------------------------------------------------------------------------------------

    def rebind(self, further: np.ndarray) -> None:
        """Take further global nodes (n,) into this rank's view."""
        self.local = self.elements.local.extended(further)
        self.exchange = Exchange(self.partition, self.local.number)
        self.teeth.bind(self.local)
        self.teeth.turn = self.holding.ring_turn(self.displacement())

    def displacement(self, x: PETSc.Vec | None = None) -> np.ndarray:
        """(n_local, 3) mm, ghosts included."""
        return self.exchange(self.x if x is None else x)

    def positions(self) -> np.ndarray:
        """Undeformed positions (n_local, 3) mm, as their owners see them; zero for the multipliers."""
        place = np.zeros((len(self.local), 3))
        for body in self.elements.bodies:
            seen, where = body.local >= 0, body.positions()
            where[body.flip == 1] *= HALF_TURN
            place[body.local[seen]] = where[seen]
        return place

    def multipliers(self, x: PETSc.Vec) -> np.ndarray:
        """Of the couplings, on every rank."""
        return read_multipliers(self.partition, x)

    # -- search ----------------------------------------------------------------------------------------

    def search(self) -> None:
        """Find the flanks and faces that can meet at the present displacement and lay out the tangent for them."""
        with self.phases("search"):
            further = np.zeros(0, dtype=np.int64)
            if self.scene is not None and self.scene.teeth is not None:
                margin = TIP_MARGIN * self.design.drive.module
                pairs = self._facing(margin)
                further = self.teeth.numbers(pairs)
            else:
                self.teeth.numbers([])
            self.rebind(further)
            keys = self.teeth.select(self.displacement(), self.near, TOUCH * self.design.drive.module)
            if self.far is not None:
                near = np.concatenate(self.partition.comm.allgather(self.teeth.picked_rings()))
                if self.far.update(near, self.elements):
                    self.keys = None
                self.x.array.reshape(-1, 3)[self.elements.pattern.nodes_without_elements] = 0.0
            if not self.teeth.symmetric and self.scene is not None and self.scene.step >= FIRST_STEP:
                self.teeth.resist(self.displacement(self.accepted))
        self.rigid.reset()
        self.pins.reset()
        self.lay_out(keys)

    def _facing(self, margin: float) -> list[FlankPair]:
        u = self.displacement()
        return facing_flanks(
            self.partition, self.elements.bodies[FLEXIBLE_SPLINE], u, self.holding.ring_turn(u), margin
        )

    def overlooked(self) -> bool:
        """Whether flanks that the search left out have come into contact."""
        if self.scene.teeth is None:
            return False
        with self.phases("search"):
            pairs = self._facing(0.0)
            found = self.teeth.overlooked(pairs, self.displacement(), self.scene.teeth)
        return bool(self.partition.comm.allreduce(int(found), op=MPI.MAX))

    def lay_out(self, keys: np.ndarray) -> None:
        """Make room in the tangent for contact blocks, keys row * n_global + column, where they are other ones."""
        with self.phases("pattern"):
            changed = self.keys is None or not np.array_equal(keys, self.keys)
            if not self.partition.comm.allreduce(int(changed), op=MPI.MAX):
                self.rows.number = self.local.number
                return
            self.keys = keys
            self.rows, self.slots = self.elements.rows(keys, self.local.number)
            if self.matrix is not None:
                self.matrix.destroy()
            self.matrix = create_matrix(self.partition, self.rows)

    # -- residual and tangent --------------------------------------------------------------------------

    def _contact(self, u: np.ndarray, residual: np.ndarray | None, rows: BlockRows | None) -> np.ndarray:
        scene = self.scene
        if scene.cam is not None:
            self.rigid.evaluate(u, CamPose(scene.angle, scene.cam), residual, rows)
        if scene.pins is not None:
            self.pins.evaluate(u, CamPose(scene.angle, inset=scene.pins), residual, rows)
        if scene.teeth is None:
            return np.zeros(0, dtype=np.int64)
        self.teeth.turn = self.holding.ring_turn(u)
        missing = self.teeth.evaluate(u, scene.teeth, residual, rows)
        if residual is not None:
            # the flanks' heights over their chords turn with the ring gear
            self.holding.add_ring_moment(u, self.teeth.moment, residual)
        return missing

    def residual(self, x: PETSc.Vec, f: PETSc.Vec) -> None:
        """Set f to the forces left over at x, N."""
        with self.phases("residual"):
            u = self.displacement(x)
            n_own = self.partition.n_own
            contact = np.zeros_like(u)
            self.failed = False
            try:
                self._contact(u, contact, None)
                residual = contact.copy()
                self.elements.assemble(u, residual, None, None)
            except FloatingPointError:
                self.failed, residual = True, contact
            if self.partition.comm.allreduce(int(self.failed), op=MPI.MAX):
                self.failed = True
            self.reference = np.sqrt(self.partition.comm.allreduce(float(np.sum(contact[:n_own] ** 2))))
            tail = self.holding.add_forces(u, self.scene, self.multipliers(x), residual)
            f.array[:] = residual[:n_own].ravel()
            if self.partition.comm.rank == self.partition.comm.size - 1:
                f.array[-len(tail) :] = tail

    def tangent(self, u: np.ndarray) -> None:
        """Fill `matrix` at displacement u (n_local, 3) mm."""
        with self.phases("tangent"):
            self.rows.values[:] = 0.0
            self.elements.assemble(u, None, self.rows, self.slots)
            self.missing = self._contact(u, None, self.rows)
            self.holding.add_blocks(u, self.rows)
            without_elements = self.elements.pattern.nodes_without_elements
            add_unit_diagonal(self.rows, self.partition, without_elements, self.scale)
        # forces that follow from a last-digit error of every position
        diagonal = self.rows.values[np.searchsorted(self.rows.keys, np.delete(self.own_keys, without_elements))]
        squares = float(np.einsum("nkk,nkk->", diagonal, diagonal))
        squares = self.partition.comm.allreduce(squares, op=MPI.SUM)
        self.round_off = np.finfo(float).eps * self.design.inner_radius * np.sqrt(squares)
        with self.phases("insert"):
            fill_matrix(self.matrix, self.rows)

    # -- state -----------------------------------------------------------------------------------------

    def accept(self) -> None:
        """Make x the state from which friction counts the slip of the next solve."""
        self.x.copy(self.accepted)
        self.teeth.accept()

    def resume(self, tractions: dict[PairKey, np.ndarray]) -> None:
        """Take x and these tractions of the flanks as an accepted state."""
        self.x.copy(self.accepted)
        self.teeth.history = tractions

    def penetration(self) -> float:
        """Largest penetration (mm) of the last evaluation, over all ranks."""
        scene, depth = self.scene, 0.0
        for contact, on in zip(self.contacts, (scene.cam, scene.pins, scene.teeth)):
            if on is not None:
                depth = max(depth, contact.penetration())
        return largest(self.partition.comm, depth)

    def rotation(self) -> float:
        """Turn of the output (rad)."""
        return self.holding.turn(self.displacement())
