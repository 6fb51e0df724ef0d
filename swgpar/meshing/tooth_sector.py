"""The tooth sectors of both gears, from a design and a recipe."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS, GearName
from swgpar.errors import InputError
from swgpar.geometry.arrays import Floats, Ints
from swgpar.geometry.micro_geometry import crowning
from swgpar.geometry.profiles import ToothProfile
from swgpar.meshing.cross_section import CrossSection, cross_section
from swgpar.meshing.cup import attached_quads, cup_nodes
from swgpar.meshing.quality import hex_quality, quad_quality
from swgpar.meshing.recipe import CupRecipe, MeshRecipe, ToothRecipe
from swgpar.meshing.relief import relief_field
from swgpar.meshing.sector import FlankGrid, SectorMesh
from swgpar.meshing.sweep import axial_stations, sweep_line, sweep_quads

THICK_CUP = 0.85
"""Cup thickness over rim thickness above which the cup continues the layers below the root as well."""


def _radii(design: DriveDesign, gear: GearName, recipe: ToothRecipe, r_root: float) -> tuple[float, float, bool]:
    """Return interface and free radius, mm, and whether the cup takes in the layers below the root."""
    rim = getattr(design, gear).rim
    # layers of equal thickness from the root to the free surface (section 4.11.2 of the source)
    lower = rim * recipe.rim / (recipe.rim + recipe.under)
    if gear == "ring_gear":
        return r_root + rim - lower, r_root + rim, False
    if design.drive.model == "plane":
        return design.inner_radius + lower, design.inner_radius, False
    if design.cup_thickness > THICK_CUP * rim:
        return design.inner_radius + lower, design.inner_radius, True
    return design.inner_radius + design.cup_thickness, design.inner_radius, False


def _swept(section: CrossSection, z: Floats, relief: Floats, amount: Floats) -> Floats:
    """Return the nodes (n_z + 1, n_node, 3), mm, of the toothed part."""
    coords = np.empty((len(z), len(section.coords), 3))
    coords[..., :2] = section.coords + amount[:, None, None] * relief
    coords[..., 2] = z[:, None]
    return coords


def _check(
    design: DriveDesign, gear: GearName, quality: dict[str, float], section: CrossSection, recipe: ToothRecipe
) -> None:
    """Refuse elements that are inside out; says whether the rim or the tooth is the cause."""
    if quality["min_jacobian"] > 0.0:
        return
    unit = "mm2" if design.drive.model == "plane" else "mm3"
    what = f"an element that is inside out (Jacobian {quality['min_jacobian']:.3g} {unit})"
    if _has_inverted_rim(section):
        rim, most = getattr(design, gear).rim, _thickest_rim(design, gear, recipe)
        raise InputError(
            f"{gear}.rim = {rim:g} with {gear}.under = {recipe.under}, {gear}.rim = {recipe.rim} of the mesh recipe "
            f"gives {what} between root and lower rim: allowed up to {most:.3g} mm with this recipe, or "
            "more layers of the lower rim"
        )
    raise InputError(
        f"{gear}.tip = {recipe.tip}, {gear}.flank = {recipe.flank} of the mesh recipe give {what}: allowed are counts, "
        "and a profile, that leave all Jacobians above 0"
    )


def _has_inverted_rim(section: CrossSection) -> bool:
    """Whether a corner of an element between the root and the free surface is inside out."""
    corners = section.coords[section.quads[section.root_layer | section.rim_layer]]
    ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    return bool(np.any(ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0] <= 0.0))


def _thickest_rim(design: DriveDesign, gear: GearName, recipe: ToothRecipe) -> float:
    """The thickest rim, mm, that the recipe can mesh."""
    section, profile = getattr(design, gear), design.profile(gear)
    low, high = 0.0, section.rim
    while high - low > 0.002 * high:
        rim = 0.5 * (low + high)
        thinner = design.model_copy(update={gear: section.model_copy(update={"rim": rim})})
        interface, free, _ = _radii(thinner, gear, recipe, profile.r_root_circle)
        bad = _has_inverted_rim(cross_section(profile, recipe, interface, free))
        low, high = (low, rim) if bad else (rim, high)
    return low


@dataclass(frozen=True)
class Swept:
    """Nodes and elements of a sector.

    coords : (n_node, 3) mm;  hexes : (n_elem, 8);  cw, ccw : (n_pair,) nodes on the sides of the sector
    rows : (n_z + 1, n_section) nodes of the toothed part, one row for each station along the face width
    """

    coords: Floats
    hexes: Ints
    cw: Ints
    ccw: Ints
    rows: Ints


def _toothed_part(section: CrossSection, z: Floats, relief: Floats, amount: Floats) -> Swept:
    coords = _swept(section, z, relief, amount).reshape(-1, 3)
    rows = np.arange(len(coords), dtype=np.int32).reshape(len(z), -1)
    cw, ccw = rows[:, section.edge], rows[:, section.mirror[section.edge]]
    return Swept(coords, sweep_quads(section.quads, rows), cw.ravel(), ccw.ravel(), rows)


def _with_cup(
    design: DriveDesign, recipe: CupRecipe, section: CrossSection, teeth: Swept, root_too: bool
) -> tuple[Swept, Ints]:
    """The sector with the slice of the cup behind its teeth, and the nodes (n,) of the bore."""
    attached = attached_quads(section, root_too)
    cup, columns = cup_nodes(design, recipe, section, attached)
    column_of = np.full(len(section.coords), -1, dtype=np.int32)
    column_of[columns] = np.arange(len(columns), dtype=np.int32)
    new = len(teeth.coords) + np.arange(cup.shape[0] * cup.shape[1], dtype=np.int32).reshape(cup.shape[:2])
    cup_rows = np.concatenate((teeth.rows[-1:, columns], new))
    edge = column_of[section.edge[column_of[section.edge] >= 0]]
    other = column_of[section.mirror[columns[edge]]]
    whole = Swept(
        np.concatenate((teeth.coords, cup.reshape(-1, 3))),
        np.concatenate((teeth.hexes, sweep_quads(column_of[section.quads[attached]], cup_rows))),
        np.concatenate((teeth.cw, new[:, edge].ravel())),
        np.concatenate((teeth.ccw, new[:, other].ravel())),
        teeth.rows,
    )
    return whole, np.sort(cup_rows[-1])


def _relief(
    design: DriveDesign, gear: GearName, section: CrossSection, profile: ToothProfile, z: Floats
) -> tuple[Floats, Floats]:
    """Crowning (n_z + 1,) mm along the width, and the displacement (n_section, 2) of the section per unit of it."""
    micro = design.micro_geometry
    if gear != "flexible_spline" or micro.fs_crowning == 0.0:
        return np.zeros_like(z), np.zeros_like(section.coords)
    amount = crowning(micro.fs_crowning, z, design.drive.face_width, micro.crowning_shape)[0]
    return np.asarray(amount), relief_field(section, profile)


def build_sector(design: DriveDesign, recipe: MeshRecipe, gear: GearName) -> SectorMesh:
    """Mesh the tooth sector of a gear; one layer of it for the plane model.

    Raises InputError for a recipe or a profile that gives elements with a Jacobian that is not above 0.
    """
    counts: ToothRecipe = getattr(recipe, gear)
    profile = design.profile(gear)
    interface, free, root_too = _radii(design, gear, counts, profile.r_root_circle)
    section = cross_section(profile, counts, interface, free)
    width = design.drive.face_width
    plane = design.drive.model == "plane"
    if plane:
        z = np.array([-0.5, 0.5]) * width
    else:
        number, ratio = recipe.face_width.elements, recipe.face_width.end_ratio
        z = axial_stations(width, number, ratio, design.wave_generator.face_width)
    amount, relief = _relief(design, gear, section, profile, z)
    sector = _toothed_part(section, z, relief, amount)
    rows = sector.rows
    if gear == "flexible_spline":
        faces = {"inner": sweep_line(section.free, rows)}
        # in the plane the torque acts on the inner surface, of which the lower layer stands for both
        node_sets = {"bore": np.sort(rows[0, section.free])}
        if not plane:
            sector, node_sets["bore"] = _with_cup(design, recipe.cup, section, sector, root_too)
    else:
        faces = {"outer": sweep_line(section.free[::-1], rows)}
        node_sets = {"outer": np.unique(rows[:1, section.free] if plane else faces["outer"])}
    quality = quad_quality(sector.coords, sector.hexes[:, :4]) if plane else hex_quality(sector.coords, sector.hexes)
    _check(design, gear, quality, section, counts)
    flanks = tuple(
        FlankGrid(np.ascontiguousarray(rows[:, nodes].T), section.s, z, side)
        for side, nodes in ((1, section.flank), (-1, section.mirror[section.flank]))
    )
    return SectorMesh(
        body=gear,
        n_sectors=profile.n_teeth,
        phase=0.0 if gear == "flexible_spline" else np.pi / profile.n_teeth,
        coords=sector.coords,
        hexes=sector.hexes,
        ccw_nodes=sector.ccw,
        cw_nodes=sector.cw,
        faces=faces,
        node_sets=node_sets,
        flanks=flanks,
        profile=profile,
        quality=quality,
        lower_nodes=np.tile(rows[0], 2) if plane else None,
    )


def require_sections(design: DriveDesign, recipe: MeshRecipe) -> None:
    """Raise InputError where the recipe lacks a section that the model needs."""
    if design.drive.model == "cup":
        for name in ("face_width", "cup"):
            if getattr(recipe, name) is None:
                raise InputError(f'[{name}] is missing in the mesh recipe: allowed only with drive.model = "plane"')


def build_sector_meshes(design: DriveDesign, recipe: MeshRecipe) -> dict[str, SectorMesh]:
    """Mesh one tooth sector of each gear.

    Returns
    -------
    dict of SectorMesh
        Keys ``flexible_spline`` (with its slice of the cup) and ``ring_gear``.
    """
    require_sections(design, recipe)
    return {gear: build_sector(design, recipe, gear) for gear in GEARS}
