"""The tooth sectors of both gears, from a design and a recipe."""

from __future__ import annotations

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.geometry.micro_geometry import crowning
from swgpar.meshing.cup import attached_quads, cup_nodes
from swgpar.meshing.quality import hex_quality, quad_quality
from swgpar.meshing.recipe import MeshRecipe, ToothRecipe
from swgpar.meshing.relief import relief_field
from swgpar.meshing.sector import FlankGrid, Floats, SectorMesh
from swgpar.meshing.sweep import axial_stations, sweep_line, sweep_quads
from swgpar.meshing.tooth import CrossSection, cross_section

THICK_CUP = 0.85
"""Cup thickness over rim thickness above which the cup continues the layers below the root as well."""


def _radii(design: DriveDesign, gear: str, recipe: ToothRecipe, r_root: float) -> tuple[float, float, bool]:
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


def _check(gear: str, quality: dict[str, float], recipe: ToothRecipe, unit: str) -> None:
    if not quality["min_jacobian"] > 0.0:
        raise InputError(
            f"{gear}.tip = {recipe.tip}, {gear}.flank = {recipe.flank} of the mesh recipe turn an element "
            f"inside out (Jacobian {quality['min_jacobian']:.3g} {unit}): allowed are counts, and a profile, "
            "that leave all Jacobians above 0"
        )


def build_sector(design: DriveDesign, recipe: MeshRecipe, gear: str) -> SectorMesh:
    """Mesh the tooth sector of `gear` (``flexible_spline`` or ``ring_gear``); one layer of it for the plane model."""
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
    amount, relief = np.zeros_like(z), np.zeros_like(section.coords)
    micro = design.micro_geometry
    if gear == "flexible_spline" and micro.fs_crowning != 0.0:
        amount = np.asarray(crowning(micro.fs_crowning, z, width, micro.crowning_shape)[0])
        relief = relief_field(section, profile)
    coords = _swept(section, z, relief, amount).reshape(-1, 3)
    rows = np.arange(len(coords), dtype=np.int32).reshape(len(z), -1)
    hexes = sweep_quads(section.quads, rows)
    cw, ccw = rows[:, section.edge], rows[:, section.mirror[section.edge]]
    if gear == "flexible_spline":
        faces = {"inner": sweep_line(section.free, rows)}
        # in the plane the torque acts on the inner surface, of which the lower layer stands for both
        node_sets = {"bore": np.sort(rows[0, section.free])}
    if gear == "flexible_spline" and not plane:
        attached = attached_quads(section, root_too)
        cup, columns = cup_nodes(design, recipe.cup, section, attached)
        place = np.full(len(section.coords), -1, dtype=np.int32)
        place[columns] = np.arange(len(columns), dtype=np.int32)
        new = len(coords) + np.arange(cup.shape[0] * cup.shape[1], dtype=np.int32).reshape(cup.shape[:2])
        cup_rows = np.concatenate((rows[-1:, columns], new))
        edge = place[section.edge[place[section.edge] >= 0]]
        other = place[section.mirror[columns[edge]]]
        coords = np.concatenate((coords, cup.reshape(-1, 3)))
        hexes = np.concatenate((hexes, sweep_quads(place[section.quads[attached]], cup_rows)))
        cw = np.concatenate((cw.ravel(), new[:, edge].ravel()))
        ccw = np.concatenate((ccw.ravel(), new[:, other].ravel()))
        node_sets = {"bore": np.sort(cup_rows[-1])}
    if gear == "ring_gear":
        faces = {"outer": sweep_line(section.free[::-1], rows)}
        node_sets = {"outer": np.unique(rows[:1, section.free] if plane else faces["outer"])}
    quality = quad_quality(coords, hexes[:, :4]) if plane else hex_quality(coords, hexes)
    _check(gear, quality, counts, "mm2" if plane else "mm3")
    flanks = tuple(
        FlankGrid(np.ascontiguousarray(rows[:, nodes].T), section.s, z, side)
        for side, nodes in ((1, section.flank), (-1, section.mirror[section.flank]))
    )
    return SectorMesh(
        body=gear,
        n_sectors=profile.n_teeth,
        phase=0.0 if gear == "flexible_spline" else np.pi / profile.n_teeth,
        coords=coords,
        hexes=hexes,
        ccw_nodes=ccw.ravel(),
        cw_nodes=cw.ravel(),
        faces=faces,
        node_sets=node_sets,
        flanks=(flanks[0], flanks[1]),
        profile=profile,
        quality=quality,
        lower_nodes=np.tile(rows[0], 2) if plane else None,
    )


def require_sections(design: DriveDesign, recipe: MeshRecipe) -> None:
    """Refuse a recipe that lacks what the model needs."""
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
    return {gear: build_sector(design, recipe, gear) for gear in ("flexible_spline", "ring_gear")}
