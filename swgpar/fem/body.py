"""A body of the drive: its name, the mesh of a congruent sector, and what it is made of."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from swgpar.fem.element_matrices import element_matrices
from swgpar.kernel import ReferenceElements
from swgpar.materials import NO_GROWTH, Growth, Material
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
    growths : strains without stress of the parts of the mesh; without them none
    incompatible : whether the elements have incompatible modes; without them for comparison only
    """

    mesh: SectorMesh
    materials: tuple[Material, ...]
    thickness: float
    growths: tuple[Growth, ...] = ()
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
        coords = self.mesh.coords[self.mesh.elements]
        elements = self._grown(coords, 0)
        for k, part in enumerate(self.mesh.parts[1:], start=1):
            for matrices, others in zip(elements, self._grown(coords[part], k)):
                matrices[part] = others
        return elements._replace(coords=coords)

    def _grown(self, coords: np.ndarray, part: int) -> ReferenceElements:
        """Matrices of elements (n, m, 3) mm of the material of a part, as large as they are free of
        stress."""
        growth = self.growths[part] if self.growths else NO_GROWTH
        return element_matrices(
            coords + growth.of(coords),
            self.materials[part],
            (1.0 + growth.along) * self.thickness,
            self.incompatible,
        )

    @property
    def stretch(self) -> float:
        """Factor of the growth of the gear across the axis."""
        return 1.0 + (self.growths[0].across if self.growths else 0.0)

    @property
    def in_plane_elasticity(self) -> np.ndarray:
        """Stresses xx, yy, xy by strains in a section of the gear, (3, 3) MPa: plane stress in the
        plane model, else plane strain."""
        material = self.materials[0]
        if self.mesh.plane:
            return material.plane_stress()
        return np.ascontiguousarray(material.elasticity()[np.ix_(IN_PLANE, IN_PLANE)])
