"""Bodies of the drive and their modelled sectors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from swgpar.fem.body import Body
from swgpar.fem.body_layout import BodyLayout
from swgpar.fem.condensed_parts import condense_sector, condense_tooth
from swgpar.materials import NO_GROWTH, Growth, Material
from swgpar.meshing import SectorMesh

NO_GROWTHS: Mapping[str, Growth] = MappingProxyType({})
"""Bodies at the temperature at which their sizes hold."""


def build_gear(
    mesh: SectorMesh,
    materials: Mapping[str, Material],
    thickness: float,
    growths: Mapping[str, Growth] = NO_GROWTHS,
) -> Body:
    """A gear, with its housing where the mesh has one.

    materials, growths : by name of the body;  thickness : mm, of the plane model
    """
    parts = (mesh.body, "housing")[: len(mesh.parts)]
    grown = tuple(growths.get(part, NO_GROWTH) for part in parts)
    return Body(mesh, tuple(materials[part] for part in parts), thickness, grown)


def build_layout(
    body: Body,
    *,
    copies: int,
    clamped: bool = False,
    held: Growth = NO_GROWTH,
    condensed_sectors: bool = False,
    condensed_teeth: bool = False,
) -> BodyLayout:
    """Modelled sectors of a closed body.

    copies : how many times the model makes the whole;  clamped : whether its outer surface is fixed
    held : growth of what holds a clamped body
    condensed_sectors, condensed_teeth : whether a sector is one element, or its tooth is one where
    nothing touches it
    """
    mesh = body.mesh
    if mesh.plane:  # sections stay in their plane
        held = replace(held, along=0.0)
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
        held=held if clamped else NO_GROWTH,
        condensed=condensed,
        tooth=tooth,
    )


def body_counts(layout: BodyLayout) -> dict[str, Any]:
    """Nodes, elements and unknowns of a body, modelled and of the whole drive."""
    plane = layout.mesh.plane
    per_sector = (len(layout.mesh.coords) - len(layout.mesh.ccw_nodes)) // (2 if plane else 1)
    return {
        "nodes": per_sector * layout.count,
        "elements": len(layout.mesh.hexes) * layout.count,
        "dofs": (2 if plane else 3) * len(layout.numbering.owned_nodes) * layout.count,
        "nodes_whole": per_sector * layout.mesh.n_sectors,
        "elements_whole": len(layout.mesh.hexes) * layout.mesh.n_sectors,
        "quality": layout.mesh.quality,
    }
