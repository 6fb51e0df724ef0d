"""An elastic ring on a rigid surface: the drive's elements, contact and solver on one body without
teeth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from mpi4py import MPI

from swgpar.constraints.boundary_conditions import DeadLoad
from swgpar.constraints.distributing_coupling import DistributingCoupling
from swgpar.constraints.supports import Supports
from swgpar.contact.rigid_surface import RigidContact, SurfacePose, cam_pose, pin_pose
from swgpar.contact.wave_generator import WaveGeneratorContacts
from swgpar.design import sections
from swgpar.errors import ConvergenceError, InputError
from swgpar.evaluation.losses import work_per_cycle
from swgpar.evaluation.stress_cycle import history_by_renaming, sector_stress
from swgpar.fem.body import Body
from swgpar.fem.body_layout import BodyLayout
from swgpar.fem.elements import Elements
from swgpar.fem.partition import Partition
from swgpar.fem.stress import body_fields, maxima
from swgpar.geometry.cams import Cam
from swgpar.load.load_states import LoadState, Stage
from swgpar.log import PhaseTimes
from swgpar.materials import Material
from swgpar.meshing.race_sector import annular_sector
from swgpar.meshing.sector import SectorMesh
from swgpar.model.drive_model import EDGE, PRESSURE_LIMIT
from swgpar.solve.discrete_problem import DiscreteProblem
from swgpar.solve.newton import NewtonSolver
from swgpar.solve.solve_state import SOFT_PENALTIES, NewtonSettings

REFERENCE_LENGTH = 1.0
"""Length (mm) that penalties and tolerances refer to; a ring has no module."""


AROUND = 2
"""Elements around a sector: even, so that nodes lie on its middle, which for sector 0 is the major
axis."""


def ring_sector(
    inner: float, outer: float, width: float, sectors: int, radial: int, axial: int, plane: bool
) -> SectorMesh:
    """Sector centred on +y of a ring between two radii, its mid-plane at z = 0.

    Parameters
    ----------
    inner, outer, width : float, mm
    sectors : int
        Sectors of the whole ring, two elements around each; a multiple of 4 has nodes every 45
        degrees.
    radial, axial : int
        Elements through the thickness and along the width; the plane model has one layer.
    plane : bool
        Quadrilaterals in plane stress instead of hexahedra.

    Faces ``inner`` and ``outer``, node sets ``bore`` (the inner surface) and ``outer``, no flanks.
    """
    if not 0.0 < inner < outer:
        raise InputError(
            f"inner radius = {inner:g} is out of range: allowed above 0 to below {outer:g} mm (the "
            f"outer)"
        )
    angle = np.pi / sectors * np.linspace(-1.0, 1.0, AROUND + 1)
    z = width * np.linspace(-0.5, 0.5, (1 if plane else axial) + 1)
    return annular_sector("ring", np.linspace(inner, outer, radial + 1), angle, z, sectors, plane)


@dataclass(frozen=True)
class PlainRingDesign:
    """A ring and how its contact is computed.

    outer_diameter, thickness, width : mm;  plane : plane stress instead of a solid
    """

    outer_diameter: float
    thickness: float
    width: float
    plane: bool
    material: Material
    # a support touches over tenths of a millimetre: many points per facet, and a penalty as of the
    # flanks
    contact: sections.ContactSection = sections.ContactSection(
        wg_penalty_coef=50.0, wg_quadrature=7, penetration_tolerance=1e-4
    )
    solver: sections.Solver = sections.Solver()

    @property
    def outer_radius(self) -> float:
        """mm"""
        return 0.5 * self.outer_diameter

    @property
    def inner_radius(self) -> float:
        """Inner radius, mm."""
        return self.outer_radius - self.thickness

    @property
    def wg_penalty(self) -> float:
        """Penalty of the contact with the rigid surface, MPa / mm."""
        return self.contact.wg_penalty_coef * self.material.modulus / REFERENCE_LENGTH


class RingSectors(Protocol):
    """What meshes the congruent sectors of a ring."""

    def mesh(self, design: PlainRingDesign) -> SectorMesh:
        """The sector centred on +y."""


@dataclass(frozen=True)
class RingCounts:
    """Elements: two around each of `sectors`, `radial` through the thickness, `axial` along the
    width of a solid."""

    sectors: int
    radial: int
    axial: int

    def mesh(self, design: PlainRingDesign) -> SectorMesh:
        """See `RingSectors`."""
        radii, counts = (design.inner_radius, design.outer_radius), (self.radial, self.axial)
        return ring_sector(*radii, design.width, self.sectors, *counts, design.plane)

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


class RingBody:
    """A ring's mesh, ownership and elements; its mean motion is prescribed as zero.

    Parameters
    ----------
    design, sectors : the ring and its mesh
    comm : communicator
    copies : how many times the model makes the whole ring, which equals itself rotated by that part
    of a turn
    incompatible : elements with incompatible modes
    """

    def __init__(
        self,
        design: PlainRingDesign,
        sectors: RingSectors,
        comm: MPI.Comm,
        copies: int,
        incompatible: bool = True,
    ) -> None:
        self.design, self.copies = design, copies
        mesh = sectors.mesh(design)
        count, fixed = mesh.n_sectors // copies, np.zeros(0, dtype=np.int32)
        body = Body(mesh, (design.material,), design.width, incompatible=incompatible)
        layout = BodyLayout(
            body=body, first_tooth=0, count=count, closed=True, copies=copies, fixed=fixed
        )
        self.mesh, self.partition = mesh, Partition([layout], comm)
        self.elements = Elements(self.partition)
        self.body = self.elements.bodies[body.name]

    def solver(
        self, contact: RigidContact | None = None, load: DeadLoad | None = None
    ) -> NewtonSolver:
        """Solver of the ring with one contact, or under forces."""
        design, solver = self.design, self.design.solver
        couplings = [DistributingCoupling(self.partition, self.body, "bore", self.copies > 1)]
        scale, share = design.material.modulus * REFERENCE_LENGTH, 1.0 / self.copies
        problem = DiscreteProblem(
            partition=self.partition,
            elements=self.elements,
            supports=Supports(self.partition, couplings, scale=scale, share=share),
            wave_generator=WaveGeneratorContacts(cam=contact),
            boundary_terms=[] if load is None else [load],
            module=REFERENCE_LENGTH,
            phases=PhaseTimes(),
        )
        settings = NewtonSettings(
            rtol=solver.rtol,
            max_iterations=solver.max_iterations,
            max_augmentations=design.contact.max_augmentations,
            penetration_tolerance=design.contact.penetration_tolerance * REFERENCE_LENGTH,
            linear=solver.linear,
            reuse_factor=solver.keep_factor,
        )
        return NewtonSolver(problem, settings)


def cam_or_part_pose(state: LoadState) -> SurfacePose | None:
    """Pose of the surface: that of the cam, or of its parts that move along the major axis like
    pins."""
    return pin_pose(state) if state.cam_clearance is None else cam_pose(state)


class RingModel:
    """A ring on a rigid surface.

    Parameters
    ----------
    design, sectors, comm, copies, incompatible : of `RingBody`
    cam : curve of the rigid surface, which may have two parts that move along the major axis
    half_angle : rad, the ring can touch within this angle of the major axis while the parts move
    """

    def __init__(
        self,
        design: PlainRingDesign,
        sectors: RingSectors,
        cam: Cam,
        half_angle: float,
        comm: MPI.Comm,
        copies: int = 2,
        incompatible: bool = True,
    ) -> None:
        self.design, self.comm = design, comm
        self.ring = RingBody(design, sectors, comm, copies, incompatible)
        self.body = self.ring.body
        self.travel = 0.0
        self.surface = RigidContact(
            self.body,
            Cylinder(cam),
            cam_or_part_pose,
            radius=design.inner_radius,
            half_width=0.5 * design.width * EDGE,
            n_quadrature=design.contact.wg_quadrature,
            penalty=design.wg_penalty,
            pin_half_angle=half_angle,
            pressure_limit=PRESSURE_LIMIT * design.material.modulus,
        )
        self.solver = self.ring.solver(self.surface)
        self.problem = self.solver.problem

    def destroy(self) -> None:
        """Release the solver; collective."""
        self.solver.destroy()

    def spread(self, travel: float) -> int:
        """Equilibrium with both parts moved outward by `travel` (mm, above 0) each; returns
        Newton's iterations."""
        first = self.travel == 0.0
        if not first:
            self.problem.x.scale(travel / self.travel)  # the ring bends nearly in proportion
        iterations = self._solve(LoadState(Stage.DEFLECT, 1, pin_inset=-travel), first)
        self.travel = travel
        return iterations

    def mount(self) -> int:
        """Equilibrium on the whole surface, first pushed out by its parts; returns Newton's
        iterations."""
        return self._solve(LoadState(Stage.DEFLECT, 1, pin_inset=0.0), True) + self._solve(
            LoadState(Stage.ENGAGE, 2, cam_clearance=0.0), True
        )

    def _solve(self, state: LoadState, establish_contact: bool) -> int:
        softenings = SOFT_PENALTIES if establish_contact else ()
        result = self.solver.solve(state, softenings=softenings)
        if not result.converged:
            raise ConvergenceError(
                f"the ring did not converge ({state}): {result.reason}, residual "
                f"{result.residual:.1e} "
                "of the contact force"
            )
        return result.iterations

    def stresses(self) -> dict[str, float]:
        """Largest s1, s3 (positive in compression) and von Mises stress of the nodal averages,
        MPa."""
        return maxima(self.comm, body_fields(self.body, self.problem.displacement()))

    def hysteresis_torque(self) -> float:
        """Torque (N mm) that turns the ring under the surface if its material has a loss factor of
        1; collective.

        Every sector of the ring is at another phase of the cycle that all go through.
        """
        design, body = self.design, self.body
        layout, lower = body.layout, body.layout.mesh.lower_nodes
        nodes = np.arange(len(layout.mesh.coords)) if lower is None else np.unique(lower)
        stress = sector_stress(body, body_fields(body, self.problem.displacement()))[:, nodes]
        mine, history = history_by_renaming(self.comm, layout, nodes, [stress])
        thickness = design.width if design.plane else None
        work = work_per_cycle(self.comm, layout, nodes[mine], history, design.material, thickness)
        return work * layout.mesh.n_sectors / layout.count / (2.0 * np.pi)

    def contact_force(self) -> float:
        """Contact pressure integrated over the whole inner surface, N."""
        surface = self.surface
        return self.ring.copies * self.comm.allreduce(
            float((surface.pressure * surface.weight)[surface.owned].sum()), op=MPI.SUM
        )

    def dial(self, angle: float, moved: float = 0.0) -> float:
        """Inward reading (mm) of a dial on the outer surface at mid-width, at `angle` (rad) from
        the major axis, of a ring without teeth.

        Its pin slides along the ring: it stands where the deformed outline crosses the dial's line.

        angle : from the middle of the first to that of the last modelled sector, 0 to almost pi
        moved : mm, by which the dial travels along the major axis, with the support at +y
        """
        mesh, radius = self.ring.mesh, self.design.outer_radius
        layers = mesh.node_sets["outer"].reshape(-1, AROUND + 1)
        nodes = layers[np.abs(mesh.coords[layers[:, 0], 2]).argmin()]  # counter-clockwise
        u = self.body.displacement(self.problem.displacement())[self.body.owned][:, nodes, :2]
        position = self.body.positions()[self.body.owned][:, nodes, :2]
        along = np.array([-np.sin(angle), np.cos(angle)])
        foot = radius * along + (0.0, moved)
        away = position + u - foot
        beside = away[..., 1] * along[0] - away[..., 0] * along[1]
        start, end = beside[:, :-1], beside[:, 1:]
        k, i = np.nonzero((start >= 0.0) & (end < 0.0) | (start <= 0.0) & (end > 0.0))
        t = start[k, i] / (start[k, i] - end[k, i])
        between = (1.0 - t)[:, None] * position[k, i] + t[:, None] * position[k, i + 1]
        between *= radius / np.linalg.norm(
            between, axis=1, keepdims=True
        )  # on the circle, not on its chord
        between += (1.0 - t)[:, None] * u[k, i] + t[:, None] * u[k, i + 1]
        outward = (between - foot) @ along
        outward = outward[np.abs(outward) < radius]  # without the crossing on the far side
        return -self.comm.allreduce(float(outward.max(initial=-np.inf)), op=MPI.MAX)
