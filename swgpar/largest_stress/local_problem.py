"""A window of a gear on a finer mesh, driven by a state of the drive.

The displacements of a drive converge long before its stresses. A few tooth sectors are cut out,
meshed finely, and solved once more: the cuts have the displacements of the drive, and the flanks
carry its contact forces. On the inner surface of the flexible spline the exact cam stays in
contact, the outer surface of the ring gear has the displacements of the drive. Stresses hold one
pitch or more inside of the cuts.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain

import numpy as np
from scipy.sparse import csr_matrix

from swgpar.constraints.boundary_conditions import DeadLoad, PrescribedDisplacement
from swgpar.constraints.distributing_coupling import node_weights
from swgpar.constraints.supports import Supports
from swgpar.errors import ConvergenceError
from swgpar.fem.body import FLEXIBLE_SPLINE, STRESS_PREFIXES
from swgpar.fem.stress import principal_at_nodes
from swgpar.fem.vectors import read_field, write_field
from swgpar.geometry.rotation import rotated
from swgpar.largest_stress.along_width import Peak, WidthStations
from swgpar.largest_stress.places import OF_REGION
from swgpar.largest_stress.surface_stress import surface_mises
from swgpar.largest_stress.window_loads import WindowLoads
from swgpar.largest_stress.window_recipes import by_model
from swgpar.largest_stress.window_regions import read_regions, tooth_nodes
from swgpar.largest_stress.window_state import WindowState
from swgpar.load.load_states import LoadState, Stage
from swgpar.log import PhaseTimes
from swgpar.meshing import MeshRecipe
from swgpar.meshing.drive_geometry import DriveGeometry
from swgpar.meshing.interpolation import interpolated
from swgpar.meshing.sector import SectorMesh
from swgpar.meshing.tooth_sector import build_sector
from swgpar.meshing.trim import trimmed
from swgpar.model.drive_model import DriveModel
from swgpar.model.part_contacts import contacts_of_part
from swgpar.model.regions import WITHOUT_LIMIT, warning_of
from swgpar.model.torques import torques
from swgpar.model.window_mesh import WindowEquilibrium, WindowMesh
from swgpar.solve.discrete_problem import DiscreteProblem
from swgpar.solve.newton import NewtonSolver

SECTORS, MARGIN = 5, 1
"""Tooth sectors of a window, and those next to each cut whose stresses are not read."""

RING_SECTORS = 3
"""Those of a window of the ring gear, which its rim supports all around."""

NARROW = 3
"""Tooth sectors of a window around the largest stress of a coarser one, which holds its cuts."""

CUP_LENGTH = 2.0
"""Length of the cup's wall behind the teeth that belongs to a window, over sqrt(radius *
thickness): a disturbance of the cut at its end decays by e within about 0.8 of that."""

STIFFNESS = 1e3
"""Stiffness of the springs that hold the nodes of the cuts, over E times the module: forces of some
N stretch them by nanometres."""

RTOL = by_model(1e-4, 1e-3)
"""Newton's tolerance: it changes the stress by up to 1e-5 and 5e-4, far less than a finer
window."""


@dataclass(frozen=True)
class WindowStress:
    """A largest stress in a window.

    value : MPa;  tooth : where;  position : (3,) mm, undeformed, with the tooth at +y
    region, warning : as of a `Place`;  elements : of the window
    beside : whether it is where the distance from a contact ends
    """

    value: float
    tooth: int
    position: np.ndarray
    region: str
    warning: str
    elements: int
    beside: bool = False


@dataclass(frozen=True)
class _Found:
    """A largest stress and the tooth in whose sector it is; beside : of `WindowStress`."""

    peak: Peak
    tooth: int
    beside: bool = False


def window_sector(
    geometry: DriveGeometry, recipe: MeshRecipe, gear: str = FLEXIBLE_SPLINE
) -> SectorMesh:
    """The sector of a window of a gear. Of a flexible spline it is the toothed part and the
    beginning of the cup's wall, which ends in the set ``cut``."""
    mesh = build_sector(geometry, recipe, gear)
    if gear != FLEXIBLE_SPLINE or geometry.cup is None:
        return mesh
    end = 0.5 * geometry.face_width + CUP_LENGTH * geometry.wall_decay
    return trimmed(mesh, mesh.coords[mesh.hexes, 2].min(axis=1) < end)


def shared_mesh(model: DriveModel, recipe: MeshRecipe, gear: str, count: int) -> WindowMesh:
    """What the windows of `count` sectors of a gear on a mesh share, made once for a model."""
    key = gear, recipe, count
    if key not in model.window_meshes:
        layout, sector = model.partition.layouts[gear], window_sector(model.geometry, recipe, gear)
        model.window_meshes[key] = WindowMesh(model.geometry, layout, sector, count, model.comm)
    return model.window_meshes[key]


def sectors_of(gear: str) -> int:
    """Tooth sectors of a window of a gear."""
    return SECTORS if gear == FLEXIBLE_SPLINE else RING_SECTORS


class LocalProblem:
    """A window around a tooth.

    Parameters
    ----------
    model, state : the drive in its equilibrium under that load state
    tooth : in the middle of the window
    recipe : of the window's mesh
    gear : name of the body
    coarser : equilibrium of a coarser window around the tooth, which is nearer than the drive's
    narrow : whether it has few sectors, and cuts with the displacements of the coarser window

    One window of a mesh at a time: the next one takes over its elements and factor.
    """

    def __init__(
        self,
        model: DriveModel,
        state: LoadState,
        tooth: int,
        recipe: MeshRecipe,
        gear: str = FLEXIBLE_SPLINE,
        coarser: WindowState | None = None,
        *,
        narrow: bool = False,
    ) -> None:
        self.model, self.state, geometry = model, state, model.geometry
        self.gear = gear
        count = NARROW if narrow else sectors_of(gear)
        first = tooth - count // 2
        self._shared = shared = shared_mesh(model, recipe, gear, count)
        self.layout = shared.move(first)
        self.partition, self.elements = shared.partition, shared.elements
        self.body = self.elements.bodies[gear]
        teeth = first + np.arange(count)
        self._loads = WindowLoads.of(model, state, self.layout.mesh, teeth)
        self._of_drive = displacement = self._of_the_drive(teeth)
        begin = displacement
        if coarser is not None:
            matrix = shared.from_window(coarser.mesh)
            begin = self._interpolated(coarser.of(first, count), matrix)
        self.scale = model.problem.supports.scale
        problem = DiscreteProblem(
            partition=self.partition,
            elements=self.elements,
            supports=Supports(self.partition, [], scale=self.scale, share=1.0),
            wave_generator=(
                contacts_of_part(model, state, self.body, teeth)
                if gear == FLEXIBLE_SPLINE
                else None
            ),
            boundary_terms=[self._dead_load(), self._cuts(begin if narrow else displacement)],
            module=geometry.module,
            blocks=shared.blocks,
            phases=PhaseTimes(),
        )
        self.solver = NewtonSolver(
            problem,
            replace(
                model.solver.settings,
                rtol=RTOL[geometry.model],
                linear="direct",
                reuse_factor=True,
            ),
        )
        if shared.factor_angle is not None:
            self.solver.system.take_over_factor(shared.angle - shared.factor_angle)
        self.problem = problem
        if (known := shared.states.get(self._place)) is not None:
            begin = known.near(displacement)
        own = begin[self.partition.owned_indices(gear)]
        write_field(self.partition, gear, own, problem.x)

    @property
    def _place(self) -> tuple[int, float]:
        """What tells the window from others on its mesh under one load."""
        return self.layout.first_tooth, self.state.angle

    def _of_the_drive(self, teeth: np.ndarray) -> np.ndarray:
        """Displacement (n_teeth, n_node, 3) mm of the drive at the nodes of the window;
        collective."""
        model = self.model
        coarse = model.partition.layouts[self.gear]
        field = read_field(model.partition, self.gear, teeth - coarse.first_tooth, model.problem.x)
        return self._interpolated(field, self._shared.from_drive(coarse.mesh))

    def _interpolated(self, field: np.ndarray, matrix: csr_matrix) -> np.ndarray:
        """Displacement (n_teeth, n_node, 3) mm at the nodes of this window from that on another
        mesh of its teeth. matrix : of `interpolation`"""
        angle = self.layout.chain_angle(np.arange(self.layout.count))
        local = rotated(field, -angle[:, None])
        return rotated(interpolated(local, matrix), angle[:, None])

    def equilibrium(self) -> WindowState:
        """The present state, for a finer window; collective."""
        teeth = np.arange(self.layout.count)
        field = read_field(self.partition, self.gear, teeth, self.problem.x)
        return WindowState(self.layout.mesh, self.layout.first_tooth, field)

    def _numbers(self, sectors: np.ndarray, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Own local indices (n_sectors, n) of nodes, and whether this rank owns them."""
        partition = self.partition
        number, _ = partition.node_numbers(self.gear, sectors, nodes)
        return number - partition.row_start, partition.owns(number)

    def _attached(self) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Sectors, one by one, and their nodes where closed end or flange is clamped or bolted."""
        cup, mesh = self.model.design.cup, self.layout.mesh
        if "end" not in mesh.faces:
            return
        nodes = np.unique(mesh.faces["end"])
        for sector in range(self.layout.count):
            angle = self.layout.chain_angle(np.array(sector))
            yield (
                np.array([sector]),
                nodes[cup.is_attached(rotated(mesh.coords[nodes], float(angle))[:, :2])],
            )

    def _cuts(self, displacement: np.ndarray) -> PrescribedDisplacement:
        """The nodes of all cuts and of the attachment, held at the displacements of the drive."""
        mesh, every = self.layout.mesh, np.arange(self.layout.count)
        held: dict[int, np.ndarray] = {}
        parts = [(every[:1], mesh.cw_nodes), (every[-1:], mesh.ccw_nodes)]
        if self.gear != FLEXIBLE_SPLINE:
            parts.append((every, mesh.node_sets["outer"]))
        elif "cut" in mesh.node_sets:
            parts += [
                (every, mesh.node_sets["cut"]),
                (every, mesh.node_sets["bore"]),
                *self._attached(),
            ]
        for sectors, nodes in parts:
            nodes = nodes.astype(np.int64)
            index, own = self._numbers(sectors, nodes)
            for k, sector in enumerate(sectors):
                for i, node in zip(index[k, own[k]], nodes[own[k]]):
                    held[int(i)] = displacement[sector, node]
        nodes = np.array(sorted(held), dtype=np.int64)
        values = np.array([held[int(i)] for i in nodes]).reshape(-1, 3)
        return PrescribedDisplacement(self.partition, nodes, values, STIFFNESS * self.scale)

    def _dead_load(self) -> DeadLoad:
        """Contact forces of the flanks, on their nodes of the window."""
        forces = np.zeros((self.partition.n_own, 3))
        grids = {grid.side: grid for grid in self.layout.mesh.flanks}
        for (sector, side), nodal in self._loads.nodal.items():
            nodes = grids[side].nodes.ravel().astype(np.int64)
            index, own = self._numbers(np.array([sector]), nodes)
            np.add.at(forces, index[0, own[0]], nodal[own[0]])
        if self.layout.mesh.plane and self.gear == FLEXIBLE_SPLINE:
            self._add_torque(forces)
        nodes = np.flatnonzero(np.abs(forces).sum(axis=1))
        return DeadLoad(nodes, forces[nodes])

    def _add_torque(self, forces: np.ndarray) -> None:
        """Add the torque that acts on the inner surface in the plane, to forces (n_own, 3) N;
        collective."""
        model, mesh = self.model, self.layout.mesh
        found = torques(model.problem, self.state)
        moment = -(found.wave_generator + sum(found.teeth)) / mesh.n_sectors
        nodes = mesh.node_sets["bore"].astype(np.int64)
        weight = node_weights(mesh.coords, nodes, mesh.ccw_nodes)
        weighted = weight > 0.0
        nodes, share = nodes[weighted], weight[weighted] / weight.sum()
        x, y, _ = mesh.coords[nodes].T
        force = (moment * share / (x**2 + y**2))[:, None] * np.column_stack([-y, x, 0.0 * x])
        for sector in range(self.layout.count):
            angle = self.layout.chain_angle(np.array([sector]))
            index, own = self._numbers(np.array([sector]), nodes)
            np.add.at(forces, index[0, own[0]], rotated(force[None], angle[:, None])[0][own[0]])

    def solve(self) -> None:
        """Bring the window to equilibrium. Raises ConvergenceError."""
        state = replace(self.state, stage=Stage.ROTATE, control="rotation", flank_clearance=None)
        self._shared.factor_angle = None
        result = self.solver.solve(state)
        if not result.converged:
            raise ConvergenceError(
                f"a window around tooth {self.layout.first_tooth + self.layout.count // 2}: "
                f"{result.reason}"
            )
        self._shared.factor_angle = self._shared.angle - self.solver.system.turn
        if self.model.keeps_windows:
            solved = WindowEquilibrium(self._of_drive, self.equilibrium().displacement)
            self._shared.keep_state(self._place, solved)

    @cached_property
    def _stresses(self) -> tuple[dict[str, np.ndarray], np.ndarray]:
        """s1, |s3| and von Mises stress (n, n_node) MPa at the nodes of owned sectors inside of the
        margin, by the names of columns, and their indices (n,)."""
        first, end = self.partition.owned_sectors(self.gear)
        sectors = np.arange(first, end)
        inside = (sectors >= MARGIN) & (sectors < self.layout.count - MARGIN)
        stress, mesh = self.body.nodal_stress(self.problem.displacement())[inside], self.layout.mesh
        s1, s3, mises = principal_at_nodes(mesh, stress)
        if mesh.plane:
            mises = surface_mises(s1, s3, mises, self._loads.unloaded()[sectors[inside]])
        prefix = STRESS_PREFIXES[self.gear][0]
        named = {f"{prefix}_s1": s1, f"{prefix}_s3": -s3, f"{prefix}_vm": mises}
        return named, sectors[inside]

    def by_tooth(self, ends: bool = False) -> list[WindowStress]:
        """Largest s1 of every tooth at its ends or between them with a limit, the largest first.
        Collective."""
        nodes = tooth_nodes(self.layout.mesh, self.model.geometry, ends)
        return self._tension(nodes[~self._no_limit(nodes)])

    def largest_at_corners(self) -> WindowStress | None:
        """Largest s1 of the teeth where it has no limit; None where it has one everywhere;
        collective."""
        mesh, geometry = self.layout.mesh, self.model.geometry
        parts = (False,) if mesh.plane else (False, True)
        nodes = np.concatenate([tooth_nodes(mesh, geometry, ends) for ends in parts])
        nodes = nodes[self._no_limit(nodes)]
        return self._tension(nodes)[0] if len(nodes) else None

    def _no_limit(self, nodes: np.ndarray) -> np.ndarray:
        return np.isin(self._shared.regions[nodes], WITHOUT_LIMIT)

    def _tension(self, nodes: np.ndarray) -> list[WindowStress]:
        """Largest s1 at nodes (n,) of the sector of every tooth, the largest first; collective."""
        stresses, sectors = self._stresses
        values = stresses[f"{STRESS_PREFIXES[self.gear][0]}_s1"][:, nodes]
        teeth = self.layout.first_tooth + sectors
        mine = [
            _Found(self._largest(nodes, one), int(tooth))
            for tooth, one in zip(teeth, values, strict=True)
        ]
        found = sorted(chain(*self.model.comm.allgather(mine)), key=lambda one: -one.peak.value)
        return [self._named(one, str(self._shared.regions[one.peak.node])) for one in found]

    def _largest(self, nodes: np.ndarray, values: np.ndarray) -> Peak:
        """The largest of the stresses (n,) MPa of nodes (n,) of a sector."""
        peak = self._stations.largest(self.layout.mesh.coords[nodes, 2], values)
        return replace(peak, node=int(nodes[peak.node]))

    @cached_property
    def _stations(self) -> WidthStations:
        return WidthStations.of(self.layout.mesh)

    def by_region(self) -> dict[int, dict[str, WindowStress]]:
        """Largest stresses of the regions that the window resolves, by tooth and by names with
        `OF_REGION`; collective."""
        geometry, mesh = self.model.geometry, self.layout.mesh
        length = CUP_LENGTH * geometry.wall_decay if "cut" in mesh.node_sets else 0.0
        regions = read_regions(geometry, mesh, length, self._shared.regions)
        stresses, sectors = self._stresses
        beside, mine = self._loads.beside(geometry.module), list[tuple[str, str, _Found]]()
        read = {name: beside.read(values, sectors) for name, values in stresses.items()}
        for region in sorted(set(regions) - {""}):
            nodes = np.flatnonzero(regions == region)
            for name, values in read.items():
                for k, sector in enumerate(sectors):
                    peak = self._largest(nodes, values[k, nodes])
                    if peak.value > 0.0:
                        at_end = bool(values[k, peak.node] > stresses[name][k, peak.node])
                        tooth = self.layout.first_tooth + int(sector)
                        mine.append((name, region, _Found(peak, tooth, at_end)))
        found: dict[int, dict[str, WindowStress]] = {}
        for name, region, one in chain(*self.model.comm.allgather(mine)):
            of_tooth = found.setdefault(one.tooth, {})
            of_tooth[f"{name}{OF_REGION}{region}"] = self._named(one, region)
        return found

    def _named(self, found: _Found, region: str) -> WindowStress:
        mesh, peak = self.layout.mesh, found.peak
        position = np.array([*mesh.coords[peak.node, :2], peak.z])
        warning = warning_of(self.model.geometry, region, position)
        elements = self.layout.count * len(mesh.hexes)
        return WindowStress(
            peak.value, found.tooth, position, region, warning, elements, found.beside
        )

    def destroy(self) -> None:
        """Release what further windows on this mesh do not take over; collective."""
        self.solver.destroy()
