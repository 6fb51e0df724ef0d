"""The drive as it is computed: meshes, ownership, elements, contact, supports and solver."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.constraints.distributing_coupling import DistributingCoupling, Housing
from swgpar.constraints.supports import Supports
from swgpar.contact.flanks import FlankContact
from swgpar.contact.rigid_surface import RigidContact
from swgpar.contact.search import largest
from swgpar.design.drive_design import DriveDesign
from swgpar.fem.body_layout import FLEXIBLE_SPLINE, RING_GEAR, BodyLayout
from swgpar.fem.condensed_sectors import condense, relative_end_rotation
from swgpar.fem.elements import Elements
from swgpar.fem.partition import Partition
from swgpar.fem.stress import body_fields, maxima
from swgpar.kernel import reference_elements
from swgpar.log import Phases
from swgpar.meshing import MeshRecipe, build_sector_meshes
from swgpar.solve.discrete_problem import near
from swgpar.solve.newton import NewtonSolver

PRESSURE_LIMIT = 0.02
"""Bound of contact pressures in the tangent's geometric terms, as a share of E: above any real pressure."""


def halved(design: DriveDesign) -> bool:
    """Whether the drive equals itself turned by 180 degrees and the design lets the model use it."""
    even = design.drive.teeth_fs % 2 == 0 and design.drive.teeth_rg % 2 == 0
    return design.solver.twofold_symmetry and even


class DriveModel:
    """Everything that exists once per run: meshes, ownership, equilibrium.

    Parameters
    ----------
    design, recipe : the drive and how it is meshed
    comm : communicator
    """

    def __init__(self, design: DriveDesign, recipe: MeshRecipe, comm: MPI.Comm) -> None:
        self.design, self.comm, self.phases = design, comm, Phases()
        images = halved(design)
        with self.phases("mesh"):
            self.meshes = build_sector_meshes(design, recipe)
        layouts, references = [], []
        for name, mesh in self.meshes.items():
            with self.phases("elements"):
                coords = mesh.coords[mesh.elements]
                reference = reference_elements(coords, design.material.E, design.material.nu, design.drive.face_width)
                condensed = condense(mesh, reference) if design.solver.condensed_sectors else None
            references.append(reference)
            clamped = name == "ring_gear" and design.drive.layout == "ring_fixed"
            fixed = mesh.node_sets["outer"] if clamped else np.zeros(0, dtype=np.int32)
            count = mesh.n_sectors // 2 if images else mesh.n_sectors
            layouts.append(BodyLayout(mesh, 0, count, True, images, fixed, condensed))
        self.partition = Partition(layouts, comm)
        with self.phases("elements"):
            self.elements = Elements(self.partition, references, symmetric=design.contact.friction == 0.0)
        spline, ring = self.elements.bodies
        surface = design.cam_surface()
        half_width = 0.5 * design.wave_generator.face_width * (1.0 + 1e-9)
        rigid = (
            surface,
            design.inner_radius,
            half_width,
            design.contact.wg_quadrature,
            design.wg_penalty,
            np.radians(design.wave_generator.pin_half_angle),
            PRESSURE_LIMIT * design.material.E,
        )
        micro = design.micro_geometry
        teeth = FlankContact(
            self.partition,
            spline,
            ring,
            design.contact.quadrature,
            micro.fs_crowning,
            design.drive.face_width,
            micro.crowning_shape,
            design.penalty,
            max(0.5 * design.drive.module, near(design)),
            PRESSURE_LIMIT * design.material.E,
            design.contact.friction,
        )
        couplings, housing = [DistributingCoupling(self.partition, spline, "bore", images)], None
        if design.drive.layout == "spline_fixed":
            couplings.append(DistributingCoupling(self.partition, ring, "outer", images))
            outer = float(np.hypot(*couplings[-1].reference[:, :2].T).max(initial=0.0))
            area = 2.0 * np.pi * outer * design.drive.face_width / (2.0 if images else 1.0)
            housing = Housing(couplings[-1], area, design.penalty)
        scale = design.material.E * design.drive.module
        self.equilibrium = NewtonSolver(
            design,
            self.partition,
            self.elements,
            Supports(self.partition, couplings, housing, scale, 0.5 if images else 1.0),
            RigidContact(spline, *rigid),
            RigidContact(spline, *rigid),
            teeth,
            self.phases,
        )
        self.copies = 2 if images else 1
        self.fixed_body = RING_GEAR if design.drive.layout == "ring_fixed" else FLEXIBLE_SPLINE

    def destroy(self) -> None:
        """Release the solver and its factor, which Python cannot: PETSc holds references in a circle. Collective."""
        self.equilibrium.destroy()

    def bend_left_out(self) -> float:
        """Stress (MPa) that condensed sectors leave out in the present state: E theta^2 / 8 where they bend most."""
        body = self.elements.bodies[FLEXIBLE_SPLINE]
        if body.layout.condensed is None:
            return 0.0
        angle = body.layout.sector_angle(body.layout.first_tooth + body.sectors[body.owned])
        angle = relative_end_rotation(
            body.layout.mesh, angle, body.displacement(self.equilibrium.displacement())[body.owned]
        )
        return largest(self.comm, self.design.material.E * float((angle**2).max(initial=0.0)) / 8.0)

    def elements_whole(self) -> int:
        """Elements of the whole drive."""
        return sum(b["elements_whole"] for b in self.counts().values())

    def counts(self) -> dict[str, Any]:
        """Nodes, elements and unknowns per body, modelled and of the whole drive."""
        out = {}
        for layout in self.partition.layouts:
            layers = 2 if layout.mesh.plane else 1
            per_sector = (len(layout.mesh.coords) - len(layout.mesh.ccw_nodes)) // layers
            out[layout.name] = {
                "nodes": per_sector * layout.count,
                "elements": len(layout.mesh.hexes) * layout.count,
                "dofs": self.partition.dims * len(layout.numbering.owned_nodes) * layout.count,
                "nodes_whole": per_sector * layout.mesh.n_sectors,
                "elements_whole": len(layout.mesh.hexes) * layout.mesh.n_sectors,
                "quality": layout.mesh.quality,
            }
        return out


def stresses(model: DriveModel) -> tuple[dict[str, float], list[dict[str, np.ndarray]]]:
    """Maxima for the history and nodal fields of both bodies."""
    u = model.equilibrium.displacement()
    values, fields = {}, []
    for prefix, body in zip(("fs", "rg"), model.elements.bodies):
        field = body_fields(body, u)
        fields.append(field)
        values.update({f"{prefix}_{k}": v for k, v in maxima(model.comm, field).items()})
    return values, fields
