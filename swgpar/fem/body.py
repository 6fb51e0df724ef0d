"""A body of the drive: its name, the mesh of a congruent sector, and what it is made of."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from swgpar.fem.element_matrices import element_matrices
from swgpar.kernel import ReferenceElements
from swgpar.materials import Material
from swgpar.materials.material import IN_PLANE
from swgpar.meshing.sector import SectorMesh

FLEXIBLE_SPLINE = "flexible_spline"
RING_GEAR = "ring_gear"
DYNAMIC_SPLINE = "dynamic_spline"
OUTER_RACE = "outer_race"
"""Names of the bodies of a drive, by what they do. A drive has at most one of each."""

STRESS_PREFIXES = {
    FLEXIBLE_SPLINE: ("fs",),
    RING_GEAR: ("rg", "housing"),
    DYNAMIC_SPLINE: ("ds",),
    OUTER_RACE: ("race",),
}


@dataclass(frozen=True, eq=False)
class Body:
    """What is known of a body before it is distributed over ranks.

    mesh : the congruent sector, which has the name of the body
    materials : of the parts of the mesh (`SectorMesh.parts`): of a gear, and of the housing around
    it
    thickness : mm, of the plane model
    incompatible : whether the elements have incompatible modes; without them for comparison only
    """

    mesh: SectorMesh
    materials: tuple[Material, ...]
    thickness: float
    incompatible: bool = True

    @property
    def name(self) -> str:
        """Name of the body, as in the design file."""
        return self.mesh.body

    @property
    def stress_prefixes(self) -> tuple[str, ...]:
        """How the names of stresses begin, for each part of the mesh."""
        return STRESS_PREFIXES[self.name][: len(self.mesh.parts)]

    @cached_property
    def elements(self) -> ReferenceElements:
        """Matrices of the elements of the sector."""
        mesh, first = self.mesh, self.materials[0]
        coords = mesh.coords[mesh.elements]
        elements = element_matrices(coords, first, self.thickness, self.incompatible)
        for part, material in zip(mesh.parts[1:], self.materials[1:], strict=True):
            others = element_matrices(coords[part], material, self.thickness, self.incompatible)
            for matrices, other in zip(elements, others):
                matrices[part] = other
        return elements

    @property
    def in_plane_elasticity(self) -> np.ndarray:
        """Stresses xx, yy, xy by strains in a section of the gear, (3, 3) MPa: plane stress in the
        plane model, else plane strain."""
        material = self.materials[0]
        if self.mesh.plane:
            return material.plane_stress()
        return np.ascontiguousarray(material.elasticity()[np.ix_(IN_PLANE, IN_PLANE)])
