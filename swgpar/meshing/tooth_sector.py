"""The tooth sectors of all gears, from the sizes of a drive and a recipe."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swgpar.errors import InputError
from swgpar.geometry.arrays import Floats, Ints
from swgpar.geometry.drive_geometry import DriveGeometry, FlankCrowning
from swgpar.geometry.micro_geometry import crowning
from swgpar.geometry.profiles import ToothProfile
from swgpar.meshing.cross_section import CrossSection, cross_section
from swgpar.meshing.cup import cup_slice, rounded_back
from swgpar.meshing.housing import housing_radii, with_housing
from swgpar.meshing.mapped import MeshError
from swgpar.meshing.quality import hex_quality, quad_quality
from swgpar.meshing.recipe import MeshRecipe, ToothRecipe
from swgpar.meshing.relief import relief_field
from swgpar.meshing.sector import FlankGrid, SectorMesh
from swgpar.meshing.sweep import axial_stations, sweep_line, sweep_quads, symmetric_steps


def _radii(drive: DriveGeometry, gear: str, recipe: ToothRecipe) -> tuple[float, float, bool]:
    """Return interface and free radius, mm, and whether the cup takes in the layers below the
    root."""
    rim, r_root = drive.gears[gear].rim, drive.gears[gear].profile.r_root_circle
    # layers of equal thickness from the root to the free surface (section 4.11.2 of the source)
    lower = rim * recipe.rim / (recipe.rim + recipe.under)
    if gear != "flexible_spline":
        return r_root + rim - lower, r_root + rim, False
    if drive.cup is None:
        return drive.inner_radius + lower, drive.inner_radius, False
    if drive.cup.continues_root:
        return drive.inner_radius + lower, drive.inner_radius, True
    return drive.inner_radius + drive.cup.thickness_coef * rim, drive.inner_radius, False


def _swept(section: CrossSection, z: Floats, relief: Floats, amount: Floats) -> Floats:
    """Return the nodes (n_z + 1, n_node, 3), mm, of the toothed part."""
    coords = np.empty((len(z), len(section.coords), 3))
    coords[..., :2] = section.coords + amount[:, None, None] * relief
    coords[..., 2] = z[:, None]
    return coords


def _no_mesh(gear: str, recipe: ToothRecipe, result: str) -> str:
    """The sentence for a tooth whose recipe, sizes and profile do not go together."""
    counts = ", ".join(f"{name} = {value:g}" for name, value in recipe.model_dump().items())
    return (
        f"{gear} {result}, with {counts} of the mesh recipe: allowed are counts, a {gear}.rim and "
        f"a {gear}.profile "
        "that leave all Jacobians above 0"
    )


def _check(gear: str, quality: dict[str, float], recipe: ToothRecipe, unit: str) -> None:
    if not quality["min_jacobian"] > 0.0:
        result = (
            f"has an element that is inside out (Jacobian {quality['min_jacobian']:.3g} {unit})"
        )
        raise InputError(_no_mesh(gear, recipe, result))


@dataclass(frozen=True)
class Swept:
    """Nodes and elements of a sector.

    coords : (n_node, 3) mm;  hexes : (n_elem, 8);  cw, ccw : (n_pair,) nodes on the sides of the
    sector
    rows : (n_z + 1, n_section) nodes of the toothed part, one row for each station along the face
    width
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
    drive: DriveGeometry, recipe: MeshRecipe, section: CrossSection, teeth: Swept, root_too: bool
) -> tuple[Swept, Ints, Ints]:
    """The sector with the slice of the cup behind its teeth, nodes (n,) of the bore, faces (n, 4)
    of the closed end."""
    back = teeth.rows[-1]
    layers = recipe.flexible_spline.under
    cup = cup_slice(drive, recipe.cup, section, root_too, back, len(teeth.coords), layers)
    toothed = teeth.coords.copy()
    toothed[back] = rounded_back(drive, section, toothed[back])
    whole = Swept(
        np.concatenate((toothed, cup.coords)),
        np.concatenate((teeth.hexes, cup.hexes)),
        np.concatenate((teeth.cw, cup.cw)),
        np.concatenate((teeth.ccw, cup.ccw)),
        teeth.rows,
    )
    return whole, cup.bore, cup.end


def _relief(
    crowned: FlankCrowning | None, section: CrossSection, profile: ToothProfile, z: Floats
) -> tuple[Floats, Floats]:
    """Crowning (n_z + 1,) mm along the width, and the displacement (n_section, 2) of the section
    per unit of it."""
    if crowned is None or crowned.amount == 0.0:
        return np.zeros_like(z), np.zeros_like(section.coords)
    amount = crowning(crowned.amount, z, crowned.width, crowned.shape)[0]
    return np.asarray(amount), relief_field(section, profile)


def _elements(quads: NDArray[np.bool_], layers: int) -> Ints:
    """Return the elements (n,) of the quadrilaterals of a mask (n_quad,), in all layers along the
    face width."""
    return (
        (np.flatnonzero(quads) + len(quads) * np.arange(layers)[:, None]).ravel().astype(np.int32)
    )


def tooth_recipe(recipe: MeshRecipe, gear: str) -> ToothRecipe:
    """Elements of half a tooth of a gear; both ring gears of a pancake drive have the same."""
    return recipe.flexible_spline if gear == "flexible_spline" else recipe.ring_gear


def gap_elements(drive: DriveGeometry, recipe: MeshRecipe) -> int:
    """Elements along the gap between both ring gears of a pancake drive: as long as the others, one
    at least."""
    gap = drive.gears["dynamic_spline"].ends[0] - drive.gears["ring_gear"].ends[1]
    return max(1, round(gap / (drive.face_width - gap) * 2 * recipe.face_width.elements))


def _stations(drive: DriveGeometry, recipe: MeshRecipe, gear: str) -> Floats:
    """Coordinates z (n,) mm of the nodes along the face width of a gear.

    In a pancake drive each ring gear has the recipe's elements along its own width, and the
    flexible spline has the stations of both.
    """
    number, ratio = recipe.face_width.elements, recipe.face_width.end_ratio
    if drive.cup is not None:
        return axial_stations(drive.face_width, number, ratio, drive.cam_width)

    def along(ring: str) -> Floats:
        low, high = drive.gears[ring].ends
        return low + symmetric_steps(number, ratio) * (high - low)

    if gear != "flexible_spline":
        return along(gear)
    first, second = along("ring_gear"), along("dynamic_spline")
    between = np.linspace(first[-1], second[0], gap_elements(drive, recipe) + 1)[1:-1]
    return np.concatenate((first, between, second))


def build_sector(drive: DriveGeometry, recipe: MeshRecipe, gear: str) -> SectorMesh:
    """Mesh the tooth sector of a gear; one layer of it for the plane model.

    Raises InputError for a recipe or a profile that gives elements with a Jacobian that is not
    above 0.
    """
    counts = tooth_recipe(recipe, gear)
    profile = drive.gears[gear].profile
    interface, free, root_too = _radii(drive, gear, counts)
    try:
        section = cross_section(profile, counts, interface, free)
    except MeshError:
        raise InputError(_no_mesh(gear, counts, "cannot be meshed")) from None
    if gear == "ring_gear":
        section = with_housing(section, housing_radii(drive.gears[gear], drive.housing, counts))
    plane = drive.model == "plane"
    z = np.array([-0.5, 0.5]) * drive.face_width if plane else _stations(drive, recipe, gear)
    amount, relief = _relief(
        drive.crowning if gear == "flexible_spline" else None, section, profile, z
    )
    sector = _toothed_part(section, z, relief, amount)
    rows = sector.rows
    if gear == "flexible_spline":
        faces = {"inner": sweep_line(section.free, rows)}
        # in the plane the torque acts on the inner surface, of which the lower layer stands for
        # both
        node_sets = {"bore": np.sort(rows[0, section.free])}
        if drive.model == "pancake":
            node_sets["bore"] = np.unique(faces["inner"])
        elif not plane:
            sector, node_sets["bore"], faces["end"] = _with_cup(
                drive, recipe, section, sector, root_too
            )
    else:
        faces = {"outer": sweep_line(section.free[::-1], rows)}
        node_sets = {"outer": np.unique(rows[:1, section.free] if plane else faces["outer"])}
    quality = (
        quad_quality(sector.coords, sector.hexes[:, :4])
        if plane
        else hex_quality(sector.coords, sector.hexes)
    )
    _check(gear, quality, counts, "mm2" if plane else "mm3")
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
        tooth=_elements(~(section.rim_layer | section.root_layer), len(z) - 1),
        housing=_elements(section.housing, len(z) - 1),
        lower_nodes=np.tile(rows[0], 2) if plane else None,
    )


def require_sections(model: str, recipe: MeshRecipe) -> None:
    """Raise InputError where the recipe lacks a section that the model needs."""
    for name, models in (("face_width", ("cup", "pancake")), ("cup", ("cup",))):
        if model in models and getattr(recipe, name) is None:
            raise InputError(
                f'[{name}] is missing in the mesh recipe: drive.model = "{model}" needs it'
            )


def build_sector_meshes(drive: DriveGeometry, recipe: MeshRecipe) -> dict[str, SectorMesh]:
    """Mesh one tooth sector of each gear.

    Returns
    -------
    dict of SectorMesh
        Keys ``flexible_spline`` (with its slice of the cup), ``ring_gear`` and, in a pancake drive,
        ``dynamic_spline``.
    """
    require_sections(drive.model, recipe)
    return {gear: build_sector(drive, recipe, gear) for gear in drive.gears}
