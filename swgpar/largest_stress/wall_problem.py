"""The wall of the flexible spline behind its teeth on a mesh of its own, driven by a state of the
drive.

Teeth and contacts are left out. The nodes at the back of the teeth have the displacements of the
drive, closed end or flange its support and its torque. The whole ring is solved: where the mesh of
the drive is too stiff, the wall takes another shape everywhere, not at the largest stress alone.
A slice is a part of it on a finer mesh, all cuts of which have the displacements of the ring.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from swgpar.constraints.boundary_conditions import PrescribedDisplacement
from swgpar.constraints.distributing_coupling import ROTATION, DistributingCoupling, NodeMeans
from swgpar.constraints.supports import SPLINE_COUPLING, Supports
from swgpar.errors import ConvergenceError
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.body_layout import BodyLayout
from swgpar.fem.elements import Elements
from swgpar.fem.partition import Partition
from swgpar.fem.vectors import read_field, write_field
from swgpar.geometry.rotation import rotated
from swgpar.largest_stress.local_problem import STIFFNESS
from swgpar.load.load_states import LoadState, Stage
from swgpar.log import PhaseTimes
from swgpar.meshing.interpolation import interpolation_at
from swgpar.meshing.sector import SectorMesh
from swgpar.meshing.spacing import polar
from swgpar.meshing.wall_sector import WallSector
from swgpar.model.couplings import spline_attachment
from swgpar.model.drive_model import DriveModel
from swgpar.petsc import PETSc
from swgpar.solve.discrete_problem import DiscreteProblem
from swgpar.solve.newton import NewtonSolver

RTOL = 1e-3
"""Newton's tolerance. The reference is the force that holds the cuts; a step more changes stresses
by less than 1e-4."""


Source = Callable[[BodyLayout, np.ndarray, np.ndarray], np.ndarray]
"""Displacement (n_sectors, n, 3) mm at nodes (n,) of sectors (n_sectors,) of the chain of a layout;
collective."""

INSIDE = 1.0 - 1e-6
"""Share of its angle at which a node is looked up in the drive: not on the side of a sector."""


def _of_sectors(partition: Partition, x: PETSc.Vec, teeth: np.ndarray) -> np.ndarray:
    """Displacement (n, n_node, 3) mm of sectors of the flexible spline, each in its own frame;
    collective. teeth : (n,)"""
    layout = partition.layouts[FLEXIBLE_SPLINE]
    field = read_field(partition, FLEXIBLE_SPLINE, teeth - layout.first_tooth, x)
    return rotated(field, -layout.sector_angle(teeth)[:, None])


def of_drive(model: DriveModel) -> Source:
    """Displacements of the drive at the back of its teeth, and of its own wall."""

    def source(layout: BodyLayout, sectors: np.ndarray, nodes: np.ndarray) -> np.ndarray:
        teeth = layout.first_tooth + sectors
        field = _of_sectors(model.partition, model.problem.x, teeth)
        points = layout.mesh.coords[nodes]
        angle = np.arctan2(points[:, 0], points[:, 1]) * INSIDE
        points[:, :2] = polar(np.hypot(points[:, 0], points[:, 1]), angle)
        matrix = interpolation_at(model.partition.layouts[FLEXIBLE_SPLINE].mesh, points)
        local = np.array([matrix @ sector for sector in field])
        return rotated(
            local.reshape(len(sectors), len(nodes), 3), layout.sector_angle(teeth)[:, None]
        )

    return source


class WallProblem:
    """The ring of the wall, or a slice of it.

    Parameters
    ----------
    model, state : the drive in its equilibrium under that load state
    grid : of a sector, from whose first station on, or on whose sides, displacements are known
    layout : the modelled sectors of its mesh
    source : of the known displacements;  rotation : rad, of closed end or flange
    """

    def __init__(
        self,
        model: DriveModel,
        state: LoadState,
        layout: BodyLayout,
        source: Source,
        rotation: float,
    ) -> None:
        self.model, self.state, self.layout, self.rotation = model, state, layout, rotation
        self.partition = Partition([layout], model.comm)
        self.elements = Elements(self.partition)
        self.body = self.elements.bodies[FLEXIBLE_SPLINE]
        self.sectors = self.partition.owned_indices(FLEXIBLE_SPLINE)
        whole = model.problem.supports
        supports = Supports(
            self.partition, self._couplings(), scale=whole.scale, share=1.0 / layout.copies
        )
        if supports.couplings:
            held = whole.held_at(SPLINE_COUPLING, model.problem.displacement())
            supports.offsets[SPLINE_COUPLING] = held
        self.problem = DiscreteProblem(
            partition=self.partition,
            elements=self.elements,
            supports=supports,
            boundary_terms=[self._cuts(source, STIFFNESS * whole.scale)],
            module=model.geometry.module,
            phases=PhaseTimes(),
        )
        settings = replace(model.solver.settings, rtol=RTOL, linear="direct", reuse_factor=True)
        self.solver = NewtonSolver(self.problem, settings)

    @classmethod
    def ring(
        cls, model: DriveModel, state: LoadState, mesh: SectorMesh, coarse: Source | None = None
    ) -> WallProblem:
        """The whole wall on a mesh, or as much of it as the drive models.

        coarse : displacements to begin with; None for those of the drive
        """
        whole = model.partition.layouts[FLEXIBLE_SPLINE]
        layout = BodyLayout(
            body=replace(whole.body, mesh=mesh),
            first_tooth=whole.first_tooth,
            count=whole.count,
            closed=True,
            copies=whole.copies,
            fixed=np.zeros(0, dtype=np.int32),
        )
        coupling = model.problem.supports.couplings[SPLINE_COUPLING]
        rotation = float(coupling.evaluate(model.problem.displacement()).value[ROTATION])
        ring = cls(model, state, layout, of_drive(model), rotation)
        ring._begin(ring._everywhere(of_drive(model) if coarse is None else coarse))
        return ring

    def displacements(self, grid: WallSector) -> Source:
        """Displacements of this ring. grid : of its sector"""

        def source(layout: BodyLayout, sectors: np.ndarray, nodes: np.ndarray) -> np.ndarray:
            teeth = layout.first_tooth + sectors
            field = _of_sectors(self.partition, self.problem.x, teeth)
            local = grid.interpolate(field, layout.mesh.coords[nodes])
            return rotated(local, layout.sector_angle(teeth)[:, None])

        return source

    def slice(self, source: Source, mesh: SectorMesh, sector: int, count: int) -> WallProblem:
        """A part of this ring on a finer mesh: `count` sectors around the one with this index.

        source : `displacements` of this ring
        """
        layout = replace(
            self.layout,
            body=replace(self.layout.body, mesh=mesh),
            first_tooth=self.layout.first_tooth + sector - count // 2,
            count=count,
            closed=False,
            copies=1,
        )
        rotation = self.problem.output_rotation()
        part = WallProblem(self.model, self.state, layout, source, rotation)
        part._begin(part._everywhere(source))
        return part

    def _begin(self, displacement: np.ndarray) -> None:
        """Start with a displacement (n_owned, n_node, 3) mm."""
        write_field(self.partition, FLEXIBLE_SPLINE, displacement, self.problem.x)

    def _everywhere(self, source: Source) -> np.ndarray:
        """Displacement (n_owned, n_node, 3) mm of a source at all nodes; collective."""
        return source(self.layout, self.sectors, np.arange(len(self.layout.mesh.coords)))

    def _couplings(self) -> list[NodeMeans]:
        """What supports or loads closed end or flange. A slice has it where it is attached."""
        design, layout = self.model.design, self.layout
        if design.has_attachment:
            if not layout.closed and not self._is_attached():
                return []
            penalty, images = design.penalty("flexible_spline"), layout.copies > 1
            return [
                spline_attachment(self.partition, self.body, design.cup, penalty, images=images)
            ]
        if not layout.closed:
            return []
        return [DistributingCoupling(self.partition, self.body, "bore", layout.copies > 1)]

    def _is_attached(self) -> bool:
        """Whether closed end or flange is attached in any of the sectors."""
        layout = self.layout
        faces = layout.mesh.coords[layout.mesh.faces["end"]].mean(axis=1)[:, :2]
        angles = layout.chain_angle(np.arange(layout.count))
        return any(
            self.model.design.cup.is_attached(rotated(faces, angle)).any() for angle in angles
        )

    def _cuts(self, source: Source, stiffness: float) -> PrescribedDisplacement:
        """The nodes of all cuts, held at the displacements of the source."""
        mesh, layout = self.layout.mesh, self.layout
        sets = [mesh.node_sets["cut"]]
        if not layout.closed and not self.model.design.has_attachment:
            sets.append(mesh.node_sets["bore"])  # the torque acts there
        everywhere = np.unique(np.concatenate(sets)).astype(np.int64)
        at_ends = [] if layout.closed else [(0, mesh.cw_nodes), (layout.count - 1, mesh.ccw_nodes)]
        nodes = np.unique(np.concatenate([everywhere, *(side for _, side in at_ends)]))
        nodes = nodes.astype(np.int64)
        displacement = source(layout, self.sectors, nodes)
        held: dict[int, np.ndarray] = {}
        for row, sector in enumerate(self.sectors):
            sides = [side for end, side in at_ends if end == sector]
            here = np.isin(nodes, np.concatenate([everywhere, *sides]))
            number, sixths = self.partition.node_numbers(
                FLEXIBLE_SPLINE, np.array([sector]), nodes[here]
            )
            own = self.partition.owns(number[0]) & (sixths[0] == 0)
            index = number[0, own] - self.partition.row_start
            held |= dict(zip(index.tolist(), displacement[row, here][own], strict=True))
        index = np.array(sorted(held), dtype=np.int64)
        values = np.array([held[int(i)] for i in index]).reshape(-1, 3)
        return PrescribedDisplacement(self.partition, index, values, stiffness)

    def solve(self) -> None:
        """Bring the wall to equilibrium; collective. Raises ConvergenceError."""
        state = replace(self.state, stage=Stage.ROTATE, flank_clearance=None)
        if not self.layout.closed:
            state = replace(state, control="rotation", output_rotation=self.rotation)
        elif self.model.design.kinematics.output_gear != FLEXIBLE_SPLINE:
            state = replace(state, control="rotation", output_rotation=0.0)
        result = self.solver.solve(state)
        if not result.converged:
            raise ConvergenceError(f"the wall behind the teeth: {result.reason}")

    def stress(self) -> np.ndarray:
        """Stress (n_owned, n_node, 6) MPa at the nodes of the owned sectors; collective."""
        return self.body.nodal_stress(self.problem.displacement())

    def destroy(self) -> None:
        """Release the solver; collective."""
        self.solver.destroy()
