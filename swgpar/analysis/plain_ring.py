"""An elastic ring on a rigid surface: the drive's elements, contact and solver on one body without teeth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.analysis.drive_model import PRESSURE_LIMIT
from swgpar.constraints.distributing_coupling import DistributingCoupling
from swgpar.constraints.supports import Supports
from swgpar.contact.rigid_surface import RigidContact
from swgpar.design.load_states import LoadState
from swgpar.design.sections import Contact, Material, Solver
from swgpar.errors import ConvergenceError
from swgpar.fem.body_layout import BodyLayout
from swgpar.fem.elements import Elements
from swgpar.fem.local_nodes import LocalNodes
from swgpar.fem.partition import Partition
from swgpar.fem.stress import body_fields, maxima
from swgpar.geometry.cams import Cam
from swgpar.kernel import reference_elements
from swgpar.log import Phases
from swgpar.meshing.ring import AROUND, ring_sector
from swgpar.solve.newton import NewtonSolver


@dataclass(frozen=True)
class Lengths:
    """module : mm, the length that penalties and tolerances refer to; a ring has no module"""

    module: float = 1.0


@dataclass(frozen=True)
class RingDesign:
    """A ring and how its contact is computed; what `NewtonSolver` reads of a design has the same names here.

    outer_diameter, thickness, width : mm;  plane : plane stress instead of a solid
    """

    outer_diameter: float
    thickness: float
    width: float
    plane: bool
    material: Material
    # a support touches over tenths of a millimetre: many points per facet, and a penalty as of the flanks
    contact: Contact = Contact(wg_penalty_coef=50.0, wg_quadrature=7, penetration_tolerance=1e-4)
    solver: Solver = Solver()
    drive: Lengths = Lengths()
    backlash: float = 0.0

    @property
    def outer_radius(self) -> float:
        """mm"""
        return 0.5 * self.outer_diameter

    @property
    def inner_radius(self) -> float:
        """Inner radius, mm."""
        return self.outer_radius - self.thickness

    @property
    def penalty(self) -> float:
        """MPa / mm; there are no flanks that could use it."""
        return self.wg_penalty

    @property
    def wg_penalty(self) -> float:
        """Penalty of the contact with the rigid surface, MPa / mm."""
        return self.contact.wg_penalty_coef * self.material.E / self.drive.module


@dataclass(frozen=True)
class RingCounts:
    """Elements: two around each of `sectors`, `radial` through the thickness, `axial` along the width of a solid."""

    sectors: int
    radial: int
    axial: int

    def refined(self) -> RingCounts:
        """Twice as many in every direction."""
        return RingCounts(2 * self.sectors, 2 * self.radial, 2 * self.axial)


@dataclass(frozen=True)
class Cylinder:
    """The surface that a cam's curve makes along z."""

    cam: Cam

    def evaluate(self, xyz: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Level function (n,) mm, gradient (n, 3), Hessian (n, 3, 3) 1/mm at points (n, 3)."""
        distance, normal, bend = self.cam.evaluate(xyz[:, :2])
        gradient, hessian = np.zeros((len(xyz), 3)), np.zeros((len(xyz), 3, 3))
        gradient[:, :2] = normal
        tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
        hessian[:, :2, :2] = bend[:, None, None] * tangent[:, :, None] * tangent[:, None, :]
        return distance, gradient, hessian


class NoTeeth:
    """Stands for the flank contact of a body that has no flanks; scenes keep it switched off."""

    penalty, turn, symmetric, frozen = 0.0, 0.0, True, False
    multiplier = np.zeros((0, 0))

    def bind(self, local: LocalNodes) -> None:
        """There is nothing to bind."""

    def numbers(self, pairs: list) -> np.ndarray:
        """Global numbers of the nodes of no flanks."""
        return np.zeros(0, dtype=np.int64)

    def select(self, u: np.ndarray, near: float, touch: float) -> np.ndarray:
        """Blocks of the tangent that flank contact needs: none."""
        return np.zeros(0, dtype=np.int64)

    def hold(self) -> None:
        """There are no segments to keep."""

    def release(self) -> None:
        """Nor to cut anew."""

    def lag(self) -> tuple[float, float]:
        """There is no friction."""
        return 0.0, 0.0

    def augment(self) -> None:
        """There are no multipliers."""

    def accept(self) -> None:
        """There are no tractions to remember."""


class RingBody:
    """A ring's mesh, ownership and elements; its mean motion is held.

    Parameters
    ----------
    design, counts : the ring and its mesh
    comm : communicator
    halved : model half of it, which equals itself turned by 180 degrees
    incompatible : elements with incompatible modes
    """

    def __init__(
        self, design: RingDesign, counts: RingCounts, comm: MPI.Comm, halved: bool, incompatible: bool = True
    ) -> None:
        self.design, self.halved = design, halved
        inner, width, material = design.inner_radius, design.width, design.material
        mesh = ring_sector(inner, design.outer_radius, width, counts.sectors, counts.radial, counts.axial, design.plane)
        count = counts.sectors // 2 if halved else counts.sectors
        layout = BodyLayout(mesh, 0, count, True, halved, np.zeros(0, dtype=np.int32))
        self.mesh, self.partition = mesh, Partition([layout], comm)
        reference = reference_elements(mesh.coords[mesh.elements], material.E, material.nu, width, incompatible)
        self.elements = Elements(self.partition, [reference])
        self.body = self.elements.bodies[0]

    def equilibrium(self, surface: RigidContact) -> NewtonSolver:
        """Equilibrium of the ring on one surface: a scene takes it as the cam, or as the pins, which move."""
        couplings = [DistributingCoupling(self.partition, self.body, "bore", self.halved)]
        scale = self.design.material.E * self.design.drive.module
        share = 0.5 if self.halved else 1.0
        holding = Supports(self.partition, couplings, None, scale, share)
        return NewtonSolver(self.design, self.partition, self.elements, holding, surface, surface, NoTeeth(), Phases())


class RingModel:
    """A ring on a rigid surface.

    Parameters
    ----------
    design, counts, comm, halved, incompatible : of `RingBody`
    cam : curve of the rigid surface, which may have two parts that move along the major axis
    half_angle : rad, the ring can touch within this angle of the major axis while the parts move
    """

    def __init__(
        self,
        design: RingDesign,
        counts: RingCounts,
        cam: Cam,
        half_angle: float,
        comm: MPI.Comm,
        halved: bool = True,
        incompatible: bool = True,
    ) -> None:
        self.design, self.comm = design, comm
        self.ring = RingBody(design, counts, comm, halved, incompatible)
        self.body, mesh = self.ring.body, self.ring.mesh
        layers = mesh.node_sets["outer"].reshape(-1, AROUND + 1)
        self.outline = layers[np.abs(mesh.coords[layers[:, 0], 2]).argmin()]  # counter-clockwise
        self.travel = 0.0
        surface = RigidContact(
            self.body,
            Cylinder(cam),
            design.inner_radius,
            0.5 * design.width * (1.0 + 1e-9),
            design.contact.wg_quadrature,
            design.wg_penalty,
            half_angle,
            PRESSURE_LIMIT * design.material.E,
        )
        self.equilibrium = self.ring.equilibrium(surface)

    def destroy(self) -> None:
        """Release the solver; collective."""
        self.equilibrium.destroy()

    def spread(self, travel: float) -> int:
        """Equilibrium with both parts moved outward by `travel` (mm, above 0) each; returns Newton's iterations."""
        fresh = self.travel == 0.0
        if not fresh:
            self.equilibrium.x.scale(travel / self.travel)  # the ring bends nearly in proportion
        iterations = self._solve(LoadState(1, "deflect", pins=-travel), fresh)
        self.travel = travel
        return iterations

    def mount(self) -> int:
        """Equilibrium on the whole surface, first pushed out by its parts; returns Newton's iterations."""
        return self._solve(LoadState(1, "deflect", pins=0.0), True) + self._solve(LoadState(2, "engage", cam=0.0), True)

    def _solve(self, scene: LoadState, soft: bool) -> int:
        solved = self.equilibrium.solve(scene, soft=soft)
        if not solved.converged:
            raise ConvergenceError(
                f"the ring did not converge ({scene}): PETSc says {solved.reason}, residual "
                f"{solved.residual:.1e} of the contact force"
            )
        return solved.iterations

    def stresses(self) -> dict[str, float]:
        """Largest s1, s3 (positive in compression) and von Mises stress of the nodal averages, MPa."""
        return maxima(self.comm, body_fields(self.body, self.equilibrium.displacement()))

    def contact_force(self) -> float:
        """Contact pressure integrated over the whole inner surface, N."""
        surface = self.equilibrium.rigid
        copies = 2.0 if self.ring.halved else 1.0
        return copies * self.comm.allreduce(float((surface.pressure * surface.weight)[surface.owned].sum()), op=MPI.SUM)

    def dial(self, angle: float, moved: float = 0.0) -> float:
        """Inward reading (mm) of a dial on the outer surface at mid-width, at `angle` (rad) from the major axis.

        Its pin slides along the ring: it stands where the deformed outline crosses the dial's line.

        angle : from the middle of the first to that of the last modelled sector, 0 to almost pi
        moved : mm, by which the dial travels along the major axis, with the support at +y
        """
        nodes, radius = self.outline, self.design.outer_radius
        u = self.body.displacement(self.equilibrium.displacement())[self.body.owned][:, nodes, :2]
        place = self.body.positions()[self.body.owned][:, nodes, :2]
        along = np.array([-np.sin(angle), np.cos(angle)])
        foot = radius * along + (0.0, moved)
        away = place + u - foot
        beside = away[..., 1] * along[0] - away[..., 0] * along[1]
        start, end = beside[:, :-1], beside[:, 1:]
        k, i = np.nonzero((start >= 0.0) & (end < 0.0) | (start <= 0.0) & (end > 0.0))
        t = start[k, i] / (start[k, i] - end[k, i])
        between = (1.0 - t)[:, None] * place[k, i] + t[:, None] * place[k, i + 1]
        between *= radius / np.linalg.norm(between, axis=1, keepdims=True)  # on the circle, not on its chord
        between += (1.0 - t)[:, None] * u[k, i] + t[:, None] * u[k, i + 1]
        outward = (between - foot) @ along
        outward = outward[np.abs(outward) < radius]  # without the crossing on the far side
        return -self.comm.allreduce(float(outward.max(initial=-np.inf)), op=MPI.MAX)
