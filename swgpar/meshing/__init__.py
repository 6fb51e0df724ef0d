"""Meshes: one tooth sector per gear, mapped, swept along the axis and replicated."""

from swgpar.meshing.recipe import MeshRecipe, load_recipe
from swgpar.meshing.sector import SectorMesh
from swgpar.meshing.tooth_sector import build_sector_meshes, require_sections

__all__ = [
    "MeshRecipe",
    "SectorMesh",
    "build_sector_meshes",
    "load_recipe",
    "require_sections",
]
