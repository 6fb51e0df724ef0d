"""Bodies of the drive and their modelled sectors."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from swgpar.fem.body import Body
from swgpar.fem.body_layout import BodyLayout
from swgpar.fem.condensed_parts import condense_sector, condense_tooth
from swgpar.materials import Material
from swgpar.meshing import SectorMesh


def build_gear(mesh: SectorMesh, materials: Mapping[str, Material], thickness: float) -> Body:
    """A gear, with its housing where the mesh has one.

    materials : by name of the body;  thickness : mm, of the plane model
    """
    parts = (mesh.body, "housing")[: len(mesh.parts)]
    return Body(mesh, tuple(materials[part] for part in parts), thickness)


def build_layout(
    body: Body,
    *,
    copies: int,
    clamped: bool = False,
    condensed_sectors: bool = False,
    condensed_teeth: bool = False,
) -> BodyLayout:
    """Modelled sectors of a closed body.

    copies : how many times the model makes the whole;  clamped : whether its outer surface is fixed
    condensed_sectors, condensed_teeth : whether a sector is one element, or its tooth is one where
    nothing touches it
    """
    mesh = body.mesh
    condensed = tooth = None
    if condensed_sectors:
        condensed = condense_sector(mesh, body.elements)
    elif condensed_teeth and len(mesh.tooth):
        tooth = condense_tooth(mesh, body.elements)
    return BodyLayout(
        body=body,
        first_tooth=0,
        count=mesh.n_sectors // copies,
        closed=True,
        copies=copies,
        fixed=mesh.node_sets["outer"] if clamped else np.zeros(0, dtype=np.int32),
        condensed=condensed,
        tooth=tooth,
    )
