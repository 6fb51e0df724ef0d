"""Contact forces of the drive on the flanks of a window.

In the plane they act where the cells of the contact law carry them. In a cup drive, where the line
loads of stations are known alone, they are spread along the profile by a parabola.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.flank_pressure.flank_loads import (
    flank_forces,
    line_loads,
    nodal_forces,
    spread_forces,
    tributary,
)
from swgpar.flank_pressure.pressed_cells import PressedCells, pressed_cells
from swgpar.largest_stress.places import APART_DISTANCE, TOUCHED, near_contact
from swgpar.largest_stress.surface_stress import BesideContact
from swgpar.load.load_states import LoadState
from swgpar.meshing.sector import SectorMesh
from swgpar.model.drive_model import DriveModel

HALF_WIDTH = 0.05
"""Half width over the module over which a line load is spread, of the order of Hertz's; the root is
far from it."""


@dataclass(frozen=True)
class WindowLoads:
    """Contact forces on the flanks of the sectors of a window.

    mesh : sector of the window;  count : sectors
    nodal : (n, 3) N on the nodes of the flanks by (sector, side), in the order of their grids
    cells : that carry, of flanks in the plane
    """

    mesh: SectorMesh
    count: int
    nodal: Mapping[tuple[int, int], np.ndarray]
    cells: Mapping[tuple[int, int], PressedCells]

    @classmethod
    def of(
        cls, model: DriveModel, state: LoadState, mesh: SectorMesh, teeth: np.ndarray
    ) -> WindowLoads:
        """The forces of a state on the `teeth` (n,) of a gear; collective. mesh : of the window"""
        gear = mesh.body
        flanks = [
            one for one in model.problem.flanks if gear in (FLEXIBLE_SPLINE, one.ring.layout.name)
        ]
        forces = np.sum([flank_forces(model, state, teeth, one, gear) for one in flanks], axis=0)
        loads = line_loads(model.partition.layouts[gear].mesh, forces)
        cells = pressed_cells(model, flanks[0], gear, teeth) if mesh.plane else {}
        grids, nodal = {grid.side: grid for grid in mesh.flanks}, {}
        for (sector, side), load in loads.items():
            grid, projected = grids[side], load.projected()
            if (sector, side) in cells:
                forces = spread_forces(projected, grid, cells[sector, side].shares(grid.s))
            else:
                forces = nodal_forces(projected, grid, HALF_WIDTH * model.geometry.module)
            nodal[sector, side] = forces.reshape(-1, 3)
        return cls(mesh, len(teeth), nodal, cells)

    def beside(self, module: float) -> BesideContact:
        """Where stresses are read: beyond `APART_DISTANCE` from the contact of flanks. module : mm

        In the plane from the ends of the cells on, so that finer windows read up to the same
        distance. Elsewhere from nodes with a line load on, and from those one station of the face
        width beside them: a contact may be shorter than the elements between, whose stress is in
        the averages of both. A small force is a large load where elements are short.
        """
        mesh, forces, distance = self.mesh, self._forces(), APART_DISTANCE * module
        if mesh.plane:
            return BesideContact.of_cells(mesh, self.count, self.cells, distance, forces > 0.0)
        loads = np.zeros_like(forces)
        for grid in mesh.flanks:
            loads[:, grid.nodes] = forces[:, grid.nodes] / tributary(grid.z)
        touched = loads > TOUCHED * loads.max(initial=0.0)
        for grid in mesh.flanks:
            loaded = touched[:, grid.nodes]
            touched[:, grid.nodes[:, 1:]] |= loaded[:, :, :-1]
            touched[:, grid.nodes[:, :-1]] |= loaded[:, :, 1:]
        return BesideContact.of_nodes(near_contact(mesh, touched, distance))

    def unloaded(self) -> np.ndarray:
        """Nodes (count, n_node) bool of tooth and root on which no force acts, in the plane."""
        surface = np.isin(self.mesh.lower_nodes, self.mesh.surface_edges)
        return surface & (self._forces() == 0.0)

    def _forces(self) -> np.ndarray:
        """Sizes (count, n_node) N of the forces."""
        forces = np.zeros((self.count, len(self.mesh.coords)))
        for grid in self.mesh.flanks:
            for sector in range(self.count):
                if (sector, grid.side) in self.nodal:
                    size = np.linalg.norm(self.nodal[sector, grid.side], axis=1)
                    forces[sector, grid.nodes.ravel()] = size
        return forces
