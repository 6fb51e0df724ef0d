"""The drive as it is computed: meshes, ownership, elements, contacts, supports and solver."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.constraints.distributing_coupling import DistributingCoupling, NodeMeans
from swgpar.constraints.race_coupling import RaceCoupling
from swgpar.constraints.radial_guide import RadialGuide
from swgpar.constraints.supports import (
    RING_COUPLING,
    SPLINE_COUPLING,
    FixedRing,
    FloatingRing,
    Supports,
)
from swgpar.constraints.wave_inertia import WaveInertia
from swgpar.contact.contact import largest
from swgpar.contact.flanks import FlankContact
from swgpar.contact.rigid_surface import RigidContact, RigidSurface, cam_pose, pin_pose
from swgpar.contact.wave_generator import WaveGeneratorContacts
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import ContactSection, Solver
from swgpar.fem.body import FLEXIBLE_SPLINE, OUTER_RACE, RING_GEAR
from swgpar.fem.body_layout import BodyLayout
from swgpar.fem.condensed_parts import relative_end_rotation
from swgpar.fem.elements import BodyElements, Elements
from swgpar.fem.partition import Partition
from swgpar.fem.sectors_in_reach import ModelledSectors, SectorsInReach
from swgpar.fem.stress import body_fields, part_maxima
from swgpar.log import PhaseTimes
from swgpar.meshing import MeshRecipe, SectorMesh, build_sector_meshes
from swgpar.meshing.drive_geometry import DriveGeometry
from swgpar.model.bearing_model import build_bearing_contacts, build_race
from swgpar.model.contact_distances import contact_search, foot_reach
from swgpar.model.couplings import output_springs, spline_attachment
from swgpar.model.layouts import body_counts, build_gear, build_layout
from swgpar.model.regions import sector_regions
from swgpar.model.window_mesh import WindowMesh
from swgpar.solve.discrete_problem import DiscreteProblem
from swgpar.solve.newton import NewtonSolver
from swgpar.solve.solve_state import NewtonSettings

PRESSURE_LIMIT, FLANK_PRESSURE_LIMIT = 0.02, 0.2
"""Bounds of contact pressures in the tangent's geometric terms, as shares of E: above any real
pressure. Narrow cells of flanks have larger ones where a tip slides over a tip."""

EDGE = 1.0 + 1e-9
"""Factor on the width of a rigid surface: points on its edge belong to it."""

RigidContacts = Callable[..., WaveGeneratorContacts]
"""Arguments: elements of the flexible spline, and the surface if it is not the cam's."""


@dataclass(eq=False, kw_only=True)
class DriveModel:
    """Everything that exists once per run; made by `build_drive_model`.

    design, comm : what is computed, and the communicator
    geometry, recipe : sizes and counts of elements from which the meshes were made
    meshes : one sector of each body by name
    partition, elements : ownership and elements
    problem, solver : discrete problem and its Newton solver
    rigid_contacts : makes the contacts of cam and pins, or of a rigid surface in their place, on
    another mesh of the flexible spline
    phases : wall seconds
    window_meshes : what windows on a mesh share, by gear, recipe and number of sectors
    keeps_windows : whether these and their factors stay until the model is destroyed, for the
    windows of its next load state
    """

    design: DriveDesign
    geometry: DriveGeometry
    recipe: MeshRecipe
    comm: MPI.Comm
    meshes: dict[str, SectorMesh]
    partition: Partition
    elements: Elements
    problem: DiscreteProblem
    solver: NewtonSolver
    rigid_contacts: RigidContacts
    phases: PhaseTimes
    window_meshes: dict[tuple[str, MeshRecipe, int], WindowMesh] = field(default_factory=dict)
    keeps_windows: bool = False

    def destroy(self) -> None:
        """Release the solver and its factor; collective. PETSc's objects refer to each other, so
        Python does not."""
        self.keeps_windows = False
        self.release_windows()
        self.solver.destroy()

    def release_windows(self, kept: MeshRecipe | None = None) -> None:
        """Release the factors of windows on all meshes but that of one recipe, unless the model
        keeps them; collective."""
        if self.keeps_windows:
            return
        for (_, recipe, _), shared in self.window_meshes.items():
            if recipe != kept:
                shared.release()

    def take_over_windows(self, other: DriveModel) -> None:
        """Take over what windows of a model of the same drive on another mesh share.

        Their last tangents are not used: solves with factors of their own take fewer iterations.
        A model that keeps its windows has its own.
        """
        if self.keeps_windows:
            return
        for shared in other.window_meshes.values():
            shared.factor_angle = None
        self.window_meshes |= other.window_meshes
        other.window_meshes.clear()

    @property
    def copies(self) -> int:
        """How many times the model makes the whole drive: 2 where it is half of it, 3 where it is a
        third."""
        return self.design.copies

    @property
    def part_remark(self) -> str:
        """What a message adds to the unknowns of the model."""
        return {1: "", 2: " (half of it, by symmetry)", 3: " (a third of it, by symmetry)"}[
            self.copies
        ]

    @property
    def fixed_body(self) -> str:
        """Name of the gear that does not rotate in the frame in which the drive is computed."""
        return self.design.kinematics.standing_gear

    def omitted_bending_stress(self) -> float:
        """Stress (MPa) that condensed sectors leave out in the present state: E theta^2 / 8 where
        they bend most."""
        body = self.elements.bodies[FLEXIBLE_SPLINE]
        if body.layout.condensed is None:
            return 0.0
        angle = body.layout.chain_angle(body.sectors[body.owned])
        theta = relative_end_rotation(
            body.layout.mesh, angle, body.displacement(self.problem.displacement())[body.owned]
        )
        return largest(
            self.comm,
            self.design.modulus_of("flexible_spline") * float((theta**2).max(initial=0.0)) / 8.0,
        )

    @cached_property
    def regions(self) -> dict[str, dict[bool, np.ndarray]]:
        """Regions of the nodes of a sector of each gear by name, see `sector_regions`."""
        return {
            name: sector_regions(self.geometry, self.meshes[name]) for name in self.geometry.gears
        }

    def n_elements(self) -> int:
        """Elements of the whole drive."""
        return sum(b["elements_whole"] for b in self.counts().values())

    def counts(self) -> dict[str, Any]:
        """Nodes, elements and unknowns per body, modelled and of the whole drive."""
        return {name: body_counts(layout) for name, layout in self.partition.layouts.items()}

    def stresses(self) -> tuple[dict[str, float], dict[str, dict[str, np.ndarray]]]:
        """Largest stresses (MPa) by body and kind ("fs_s1", "race_vm", …), and the nodal fields by
        body."""
        u = self.problem.displacement()
        values, fields = {}, {}
        for name, body in self.elements.bodies.items():
            fields[name] = body_fields(body, u)
            maxima = part_maxima(self.comm, body, u, fields[name])
            for prefix, largest_of in zip(body.layout.body.stress_prefixes, maxima, strict=True):
                values.update({f"{prefix}_{k}": v for k, v in largest_of.items()})
        return values, fields


def build_drive_model(design: DriveDesign, recipe: MeshRecipe, *, comm: MPI.Comm) -> DriveModel:
    """Mesh the drive and set up its discrete problem and solver; collective.

    Raises InputError where the recipe gives no mesh of this design.
    """
    phases, geometry = PhaseTimes(), design.geometry
    with phases("mesh"):
        meshes = build_sector_meshes(geometry, recipe)
    with phases("elements"):
        layouts = build_layouts(design, meshes)
    partition = Partition(layouts, comm)
    with phases("elements"):
        symmetric = design.contact.friction == 0.0
        elements = Elements(partition, symmetric=symmetric)
    supports, on_spline = build_supports(design, partition, elements), rigid_contacts(design)
    if design.bearing is None:
        wave_generator = on_spline(elements.bodies[FLEXIBLE_SPLINE])
    else:
        wave_generator = build_bearing_contacts(design, elements, PRESSURE_LIMIT, EDGE)
    modelled = ModelledSectors(
        elements,
        ring_sectors(design, partition.layouts[RING_GEAR]),
        [
            SectorsInReach.whole_teeth(layout.name, layout.count)
            for layout in layouts
            if layout.tooth is not None
        ],
    )
    problem = DiscreteProblem(
        partition=partition,
        elements=elements,
        supports=supports,
        wave_generator=wave_generator,
        flanks=build_flank_contacts(
            design, partition=partition, elements=elements, supports=supports
        ),
        contact_search=contact_search(
            design.drive.module,
            design.largest_backlash,
            outer_radius=0.5 * design.drive.teeth_rg * design.drive.module
            + max(design.deflection, design.drive.standard_deflection),
            condensed_teeth=design.condenses_teeth,
        ),
        boundary_terms=inertia_terms(design, elements) if design.load.inertia else [],
        module=design.drive.module,
        modelled=modelled,
        phases=phases,
    )
    solver = NewtonSolver(
        problem, newton_settings(design.solver, design.contact, design.drive.module)
    )
    return DriveModel(
        design=design,
        geometry=geometry,
        recipe=recipe,
        comm=comm,
        meshes=meshes,
        partition=partition,
        elements=elements,
        problem=problem,
        solver=solver,
        rigid_contacts=on_spline,
        phases=phases,
    )


def ring_sectors(design: DriveDesign, ring: BodyLayout) -> SectorsInReach | None:
    """What chooses the sectors of the ring gear that are modelled; None where all are, also where
    its growth or that of its frame stresses it all round."""
    pressed = any(ring.body.growths) or bool(ring.held)
    return SectorsInReach.of_ring(ring.count) if design.leaves_out_sectors and not pressed else None


def build_layouts(design: DriveDesign, meshes: Mapping[str, SectorMesh]) -> list[BodyLayout]:
    """Modelled sectors of the gears and of the outer race."""
    held = design.kinematics.standing_gear if design.frame_is_rigid else None
    grown = design.growths
    layouts = [
        build_layout(
            build_gear(mesh, design.materials, design.drive.face_width, grown),
            copies=design.copies,
            clamped=name == held != FLEXIBLE_SPLINE,
            held=design.frame_growth,
            condensed_sectors=design.solver.condensed_sectors,
            condensed_teeth=design.condenses_teeth,
        )
        for name, mesh in meshes.items()
    ]
    if design.bearing is not None:
        race = build_race(design, meshes[FLEXIBLE_SPLINE])
        layouts.append(build_layout(race, copies=design.copies))
    return layouts


def build_supports(design: DriveDesign, partition: Partition, elements: Elements) -> Supports:
    """Couplings of the spline, of a ring gear that is not clamped and of a bearing; the guide of a
    rotating ring."""
    spline, copies = elements.bodies[FLEXIBLE_SPLINE], design.copies
    output_gear, bearing = design.kinematics.output_gear, design.output_bearing
    rotates, guide = output_gear != "flexible_spline", None
    couplings: list[NodeMeans] = []
    if design.has_attachment:
        attachment = spline_attachment(
            partition,
            spline,
            design.cup,
            design.penalty("flexible_spline"),
            images=copies > 1,
            moves=bearing is not None and not rotates,
        )
        couplings.append(attachment)
    else:
        # a plane section with deviations is centred by its cam alone: the wall of the cup gives way
        centred = design.has_cup or (design.drive.model == "plane" and design.deviations is None)
        couplings.append(DistributingCoupling(partition, spline, "bore", copies > 1, centred))
    if rotates or not design.frame_is_rigid:
        ring = elements.bodies[output_gear if rotates else RING_GEAR]
        ring_coupling = DistributingCoupling(partition, ring, "outer", copies > 1)
        couplings.append(ring_coupling)
        if design.frame_is_rigid:
            guide = _ring_guide(design, ring_coupling)
    spline_ratio = None
    if design.dynamic_spline is not None:  # the flexible spline rotates with the dynamic one
        spline_ratio = 1.0 if output_gear == "dynamic_spline" else 0.0
    output, race = len(couplings) - 1 if rotates else SPLINE_COUPLING, None
    if design.bearing is not None:
        outer = DistributingCoupling(partition, elements.bodies[OUTER_RACE], "outer", copies > 1)
        race = RaceCoupling(outer, couplings[0])
    return Supports(
        partition,
        couplings,
        output=output,
        guide=guide,
        scale=design.modulus_of("flexible_spline") * design.drive.module,
        share=1.0 / copies,
        race=race,
        spline_ratio=spline_ratio,
        bearing=None if bearing is None else output_springs(bearing, couplings[output], copies),
    )


def _ring_guide(design: DriveDesign, coupling: NodeMeans) -> RadialGuide:
    """Guide around a rotating ring gear, which it follows where a bearing carries the output."""
    gear = design.kinematics.output_gear
    first, last = design.axial_range(gear)
    outer = float(np.hypot(*coupling.undeformed[:, :2].T).max(initial=0.0))
    area = 2.0 * np.pi * outer * (last - first) / design.copies
    follows = design.output_bearing is not None and design.copies == 1
    return RadialGuide(coupling, area, design.penalty(gear), design.frame_growth, follows=follows)


def inertia_terms(design: DriveDesign, elements: Elements) -> list[WaveInertia]:
    """Forces of inertia of the bodies that the wave deforms, at `load.input_speed`."""
    bodies = [name for name in (FLEXIBLE_SPLINE, OUTER_RACE) if name in elements.bodies]
    lobes = design.wave_generator.lobes
    return [WaveInertia(elements.bodies[name], lobes, *design.speeds) for name in bodies]


def rigid_contacts(design: DriveDesign) -> RigidContacts:
    """What makes the contacts of cam and pins, or of a surface in their place, on the inner surface
    of any mesh of the flexible spline."""
    width = design.wave_generator.width if design.bearing is None else design.race_width
    contact = partial(
        RigidContact,
        radius=design.inner_radius,
        half_width=0.5 * width * EDGE,
        n_quadrature=design.contact.wg_quadrature,
        penalty=design.wg_penalty,
        pin_half_angle=float(np.radians(design.wave_generator.pin_half_angle)),
        lobes=design.wave_generator.lobes,
        pressure_limit=PRESSURE_LIMIT * design.modulus_of("flexible_spline"),
    )
    cam = design.grown_cam_surface()

    def on(spline: BodyElements, surface: RigidSurface = cam) -> WaveGeneratorContacts:
        return WaveGeneratorContacts(
            cam=contact(spline, surface, cam_pose), pins=contact(spline, surface, pin_pose)
        )

    return on


def build_flank_contacts(
    design: DriveDesign, *, partition: Partition, elements: Elements, supports: Supports
) -> list[FlankContact]:
    """Contacts of the flexible spline's flanks, one with each ring gear."""
    contacts = []
    for name in design.gears[1:]:
        fixed = len(partition.layouts[name].fixed) > 0
        contacts.append(
            FlankContact(
                partition,
                elements.bodies[FLEXIBLE_SPLINE],
                elements.bodies[name],
                FixedRing()
                if fixed
                else FloatingRing(supports.couplings[RING_COUPLING], partition.comm),
                lines_on_layer=design.contact.quadrature,
                crowning=(design.crowning("flexible_spline"), design.crowning(name)),
                max_gap=foot_reach(design.drive.module, design.largest_backlash),
                pressure_limit=FLANK_PRESSURE_LIMIT * design.modulus_of("flexible_spline", name),
                friction_coefficient=design.contact.friction,
            )
        )
    return contacts


def newton_settings(solver: Solver, contact: ContactSection, module: float) -> NewtonSettings:
    """Settings of the solver. module : mm"""
    return NewtonSettings(
        rtol=solver.rtol,
        max_iterations=solver.max_iterations,
        max_augmentations=contact.max_augmentations,
        penetration_tolerance=contact.penetration_tolerance * module,
        linear=solver.linear,
        reuse_factor=solver.keep_factor,
    )
