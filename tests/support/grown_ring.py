"""Rings without teeth that grow, alone or one in another, and what Lamé's equations say of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from mpi4py import MPI

from swgpar.constraints.distributing_coupling import DistributingCoupling
from swgpar.constraints.supports import Supports
from swgpar.design.sections import ContactSection, Solver
from swgpar.fem.body import Body
from swgpar.fem.elements import Elements
from swgpar.fem.partition import Partition
from swgpar.load.load_states import LoadState, Stage
from swgpar.log import PhaseTimes
from swgpar.materials import Growth, Isotropic
from swgpar.meshing.race_sector import annular_sector
from swgpar.model.drive_model import newton_settings
from swgpar.model.layouts import build_layout
from swgpar.solve.discrete_problem import DiscreteProblem
from swgpar.solve.newton import NewtonSolver

SECTORS, WIDTH = 90, 2.0


class GrownRing:
    """A ring of a part, or of two, in equilibrium.

    radii : mm, of circles of nodes;  seam : radius between two parts, or None
    materials, growths : of the parts;  held : growth of a rigid frame around it, or None
    plane : plane stress, or a solid

    radius, height : (n_sectors, n_node) mm, undeformed
    displacement : (n_sectors, n_node, 3) mm, radial, around and along the axis
    stress : of each part (n_sectors, n_node, 3) MPa, radial, around and along the axis
    """

    def __init__(
        self,
        radii: np.ndarray,
        materials: tuple[Isotropic, ...],
        growths: tuple[Growth, ...],
        *,
        seam: float | None = None,
        held: Growth | None = None,
        plane: bool = True,
    ) -> None:
        angle, z = np.pi / SECTORS * np.linspace(-1.0, 1.0, 3), WIDTH * np.linspace(-0.5, 0.5, 3)
        mesh = annular_sector("ring_gear", radii, angle, z[::2] if plane else z, SECTORS, plane)
        if seam is not None:
            middle = np.hypot(*mesh.coords[mesh.hexes].mean(axis=1)[:, :2].T)
            mesh = replace(mesh, housing=np.flatnonzero(middle > seam).astype(np.int32))
        body = Body(mesh, materials, WIDTH, growths)
        clamped = {"clamped": True, "held": held} if held is not None else {}
        layout = build_layout(body, copies=1, **clamped)
        partition = Partition([layout], MPI.COMM_SELF)
        elements = Elements(partition)
        ring = elements.bodies["ring_gear"]
        couplings = [] if clamped else [DistributingCoupling(partition, ring, "outer", False)]
        problem = DiscreteProblem(
            partition=partition,
            elements=elements,
            supports=Supports(partition, couplings, scale=1e5, share=1.0),
            boundary_terms=[],
            module=1.0,
            phases=PhaseTimes(),
        )
        solver = NewtonSolver(problem, newton_settings(Solver(rtol=1e-12), ContactSection(), 1.0))
        self.result = solver.solve(LoadState(Stage.ROTATE, 4))
        position, u = ring.positions()[ring.owned], problem.displacement()
        self.height = position[..., 2]
        self.radius = np.hypot(position[..., 0], position[..., 1])
        radial = position[..., :2] / self.radius[..., None]
        around = np.stack([-radial[..., 1], radial[..., 0]], axis=-1)
        moved = ring.displacement(u)[ring.owned]
        in_plane = [np.sum(moved[..., :2] * unit, axis=-1) for unit in (radial, around)]
        self.displacement = np.stack([*in_plane, moved[..., 2]], axis=-1)
        self.stress = []
        for part in range(len(mesh.parts)):
            xx, yy, zz, xy, _, _ = np.moveaxis(ring.nodal_stress(u, part), -1, 0)
            normal = [
                a**2 * xx + b**2 * yy + 2.0 * a * b * xy
                for a, b in (np.moveaxis(unit, -1, 0) for unit in (radial, around))
            ]
            self.stress.append(np.stack([*normal, zz], axis=-1))
        solver.destroy()

    def at(self, radius: float) -> np.ndarray:
        """Nodes at a radius (mm); bool, (n_sectors, n_node)."""
        return np.abs(self.radius - radius) < 1e-9


def lame(
    inner: float, outer: float, pressures: tuple[float, float], material: Isotropic, r: float
) -> tuple[float, float, float]:
    """Radial displacement (mm), radial and hoop stress (MPa) at r (mm) of a ring in plane stress
    under pressures (MPa) inside and outside."""
    a, b, (p, q) = inner**2, outer**2, pressures
    mean, part = (p * a - q * b) / (b - a), (p - q) * a * b / (b - a)
    radial, hoop = mean - part / r**2, mean + part / r**2
    return r * (hoop - material.nu * radial) / material.E, radial, hoop
