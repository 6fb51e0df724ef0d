"""Elements and nodes of tooth sectors by their recipe: known before a mesh is made.

They follow from the blocks of half a tooth (`half_tooth.py`) and the sweep (`tooth_sector.py`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from swgpar.meshing.cup import joined_columns, last_full_station, meridian
from swgpar.meshing.drive_geometry import DriveGeometry
from swgpar.meshing.housing import housing_radii
from swgpar.meshing.race_sector import RADIAL
from swgpar.meshing.recipe import MeshRecipe, ToothRecipe
from swgpar.meshing.tooth_sector import gap_elements, require_sections, tooth_recipe


@dataclass(frozen=True)
class SectorCounts:
    """Counts of one tooth sector.

    n_sectors : teeth of the gear
    elements, nodes : of the sector; in the plane those of one layer
    shared : nodes on one of its sides, which belong to the next sector as well
    outer : nodes of the outer surface of a ring gear or housing, but for shared ones; else 0
    """

    n_sectors: int
    elements: int
    nodes: int
    shared: int
    outer: int


def section_counts(recipe: ToothRecipe) -> tuple[int, int, int]:
    """Quadrilaterals and nodes of the cross-section of one tooth, and nodes on one of its sides."""
    around, depth = recipe.tip + recipe.layers + recipe.root, recipe.under + recipe.rim
    tooth = (recipe.tip + recipe.layers) * recipe.flank + recipe.tip * recipe.layers
    above = recipe.flank * (recipe.layers + 1 + recipe.tip) + recipe.tip * recipe.layers
    middle = depth + 1 + recipe.flank + recipe.layers
    half = (around + 1) * (depth + 1) + above
    return 2 * (tooth + around * depth), 2 * half - middle, depth + 1


def sector_counts(drive: DriveGeometry, recipe: MeshRecipe) -> dict[str, SectorCounts]:
    """Counts of the tooth sectors that `build_sector_meshes` makes of a drive and a recipe."""
    require_sections(drive.model, recipe)
    return {gear: _counts(drive, recipe, gear) for gear in drive.gears}


def _counts(drive: DriveGeometry, recipe: MeshRecipe, gear: str) -> SectorCounts:
    teeth = tooth_recipe(recipe, gear)
    external = gear == "flexible_spline"
    quads, nodes, side = section_counts(teeth)
    around = 2 * (teeth.tip + teeth.layers + teeth.root)
    n_sectors = drive.gears[gear].profile.n_teeth
    if gear == "ring_gear":
        housing = len(housing_radii(drive.gears[gear], drive.housing, teeth)) - 1
        quads += housing * around
        nodes += housing * (around + 1)
        side += housing
    if drive.model == "plane":
        return SectorCounts(n_sectors, quads, nodes, side, 0 if external else around)
    layers = recipe.face_width.elements
    if external and drive.model == "pancake":
        layers = 2 * layers + gap_elements(drive, recipe)
    elements, nodes, side = quads * layers, nodes * (layers + 1), side * (layers + 1)
    if external and drive.cup is not None:
        lines = meridian(drive.cup, recipe.cup, teeth.under)
        stations = len(lines.inner) - 1
        full = last_full_station(lines, recipe.cup, drive.module)
        depth = teeth.rim + (teeth.under if drive.cup.continues_root else 0)
        elements += around * full * depth
        nodes += (around + 1) * full * (depth + 1)
        if behind := stations - full:
            groups = joined_columns(around)
            joined, threes = len(groups), groups.count(3)
            elements += (around + threes + joined * (behind - 1)) * depth
            nodes += (2 * threes + (joined + 1) * behind) * (depth + 1)
        side += (depth + 1) * stations
    return SectorCounts(n_sectors, elements, nodes, side, 0 if external else around * (layers + 1))


def race_counts(drive: DriveGeometry, recipe: MeshRecipe, width: float) -> SectorCounts:
    """Counts of a sector of a bearing's outer race, of so many mm along z; as far as it covers the
    teeth."""
    teeth = recipe.flexible_spline
    n_sectors = drive.gears["flexible_spline"].profile.n_teeth
    around, layers = 2 * (teeth.tip + teeth.layers + teeth.root), 1
    nodes, side = (around + 1) * (RADIAL + 1), RADIAL + 1
    if drive.model != "plane":
        share = min(width / drive.face_width, 1.0)
        layers = math.ceil(round(recipe.face_width.elements * share, 9))
        nodes, side = nodes * (layers + 1), side * (layers + 1)
    return SectorCounts(n_sectors, around * RADIAL * layers, nodes, side, 0)
