"""What windows of a gear on one mesh share: sector, elements, room of the tangent and its factor.

A window around another tooth is the same chain of sectors, rotated. So the pattern of its tangent
and the order in which MUMPS eliminates the unknowns stay. Its tangent is nearly the rotated one of
the last window, whose factor serves it too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from mpi4py import MPI
from scipy.sparse import csr_matrix

from swgpar.fem.body_layout import BodyLayout
from swgpar.fem.elements import Elements
from swgpar.fem.partition import Partition
from swgpar.meshing.drive_geometry import DriveGeometry
from swgpar.meshing.interpolation import interpolation
from swgpar.meshing.sector import SectorMesh
from swgpar.model.regions import regions_of
from swgpar.solve.tangent_matrix import TangentMatrix

MOST_STATES = 24
"""Equilibria that a mesh keeps for further loads, the last ones."""


@dataclass(frozen=True)
class WindowEquilibrium:
    """A window in its equilibrium.

    of_drive : (n_teeth, n_node, 3) mm, displacement of the drive at its nodes
    of_window : the same, its own
    """

    of_drive: np.ndarray
    of_window: np.ndarray

    def near(self, of_drive: np.ndarray) -> np.ndarray:
        """Displacement (n_teeth, n_node, 3) mm near the equilibrium under another load, in which
        the drive has other displacements."""
        return of_drive + (self.of_window - self.of_drive)


class WindowMesh:
    """One window at a time is on it.

    It does not depend on the drive's mesh: windows of a drive on a finer one take it over.

    geometry : of the drive
    body : layout of the gear in the drive;  mesh : its sector in windows
    count : sectors of a window;  comm : communicator

    Attributes:
    partition, elements : of the present window
    blocks : room of its tangent, with the factor
    factor_angle : rad, of the first sector of the window whose tangent is factorised; None for none
    regions : (n_node,) regions of the nodes where no contact presses
    states : equilibria by first tooth and angle (rad) of the wave generator, under the last load
    """

    def __init__(
        self,
        geometry: DriveGeometry,
        body: BodyLayout,
        mesh: SectorMesh,
        count: int,
        comm: MPI.Comm,
    ) -> None:
        self.gear, self.mesh = body.name, mesh
        chain = BodyLayout(
            body=replace(body.body, mesh=mesh),
            first_tooth=0,
            count=count,
            closed=False,
            copies=1,
            fixed=np.zeros(0, dtype=np.int32),
        )
        self.partition = Partition([chain], comm)
        self.elements = Elements(self.partition)
        self.blocks = TangentMatrix(self.elements)
        self.factor_angle: float | None = None
        self.regions = regions_of(geometry, mesh, range(len(mesh.coords)), False)
        self.states: dict[tuple[int, float], WindowEquilibrium] = {}
        self._interpolations: dict[str, tuple[SectorMesh, csr_matrix]] = {}

    @property
    def angle(self) -> float:
        """Angle (rad) of the first sector of the present window, counter-clockwise from +y."""
        layout = self.partition.layouts[self.gear]
        return float(layout.sector_angle(np.array(layout.first_tooth)))

    def move(self, first_tooth: int) -> BodyLayout:
        """Let the sectors begin with another tooth; returns their layout."""
        layout = replace(self.partition.layouts[self.gear], first_tooth=first_tooth)
        self.partition.layouts[self.gear] = layout
        self.elements.bodies[self.gear].rotate(layout)
        return layout

    def from_drive(self, mesh: SectorMesh) -> csr_matrix:
        """Interpolation from the mesh of the drive."""
        return self._interpolation("drive", mesh)

    def from_window(self, coarser: SectorMesh) -> csr_matrix:
        """Interpolation from the mesh of a coarser window."""
        return self._interpolation("window", coarser)

    def _interpolation(self, kind: str, mesh: SectorMesh) -> csr_matrix:
        """Interpolation from the last mesh of a kind is kept."""
        if kind not in self._interpolations or self._interpolations[kind][0] is not mesh:
            self._interpolations[kind] = mesh, interpolation(mesh, self.mesh)
        return self._interpolations[kind][1]

    def keep_state(self, place: tuple[int, float], state: WindowEquilibrium) -> None:
        """Keep the equilibrium of a window, see `states`."""
        self.states.pop(place, None)
        self.states[place] = state  # the last one
        while len(self.states) > MOST_STATES:
            del self.states[next(iter(self.states))]

    def release(self) -> None:
        """Release tangent and factor; collective. The next window makes them anew."""
        self.blocks.destroy()
        self.factor_angle = None
