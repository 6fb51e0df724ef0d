"""The tooth sectors of all gears, from the sizes of a drive and a recipe."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from swgpar.errors import InputError
from swgpar.geometry.arrays import Floats, Ints
from swgpar.geometry.micro_geometry import FlankCrowning
from swgpar.meshing.cross_section import CrossSection, cross_section
from swgpar.meshing.cup import cup_slice, rounded_back
from swgpar.meshing.drive_geometry import DriveGeometry
from swgpar.meshing.housing import housing_radii, with_housing
from swgpar.meshing.mapped import MeshError
from swgpar.meshing.quality import element_quality
from swgpar.meshing.recipe import MeshRecipe, ToothRecipe
from swgpar.meshing.relief import relief_field
from swgpar.meshing.sector import FlankGrid, SectorMesh
from swgpar.meshing.sweep import axial_stations, sweep_line, sweep_quads, symmetric_steps
from swgpar.profiles import ToothProfile


def _radii(drive: DriveGeometry, gear: str, recipe: ToothRecipe) -> tuple[float, float]:
    """Return interface and free radius, mm."""
    rim, r_root = drive.gears[gear].rim, drive.gears[gear].profile.r_root_circle
    # layers of equal thickness from the root to the free surface (section 4.11.2 of the source)
    lower = rim * recipe.rim / (recipe.rim + recipe.under)
    if gear != "flexible_spline":
        return r_root + rim - lower, r_root + rim
    if drive.cup is not None and not drive.cup.continues_root:
        lower = drive.cup_thickness
    return drive.inner_radius + lower, drive.inner_radius


def _no_mesh(gear: str, recipe: ToothRecipe, result: str) -> InputError:
    """Recipe, sizes and profile of a tooth do not go together."""
    counts = ", ".join(f"{name} = {value:g}" for name, value in recipe.model_dump().items())
    return InputError(
        f"{gear} {result}, with {counts} of the mesh recipe: allowed are counts, a {gear}.rim and "
        f"a {gear}.profile that leave all Jacobians above 0"
    )


def _relief(
    crowned: FlankCrowning, section: CrossSection, profile: ToothProfile, z: Floats
) -> Floats:
    """Displacement (n_z + 1, n_section, 2), mm, of the section by the crowning along the width."""
    if crowned.amount == 0.0:
        return np.zeros((1, 1, 2))
    return crowned.removed(z)[:, None, None] * relief_field(section, profile)


def _elements(quads: NDArray[np.bool_], layers: int) -> Ints:
    """Elements (n,) of the quadrilaterals of a mask (n_quad,), in all layers."""
    return np.flatnonzero(np.tile(quads, layers)).astype(np.int32)


def tooth_recipe(recipe: MeshRecipe, gear: str) -> ToothRecipe:
    """Elements of half a tooth of a gear; both ring gears of a pancake drive have the same."""
    return recipe.flexible_spline if gear == "flexible_spline" else recipe.ring_gear


def gap_elements(drive: DriveGeometry, recipe: MeshRecipe) -> int:
    """Elements along the gap of a pancake's ring gears: as long as the others, at least one."""
    gap = drive.gears["dynamic_spline"].ends[0] - drive.gears["ring_gear"].ends[1]
    return max(1, round(gap / (drive.face_width - gap) * 2 * recipe.face_width.elements))


def _stations(drive: DriveGeometry, recipe: MeshRecipe, gear: str) -> Floats:
    """Coordinates z (n,) mm of the nodes along the face width of a gear.

    In a pancake drive a ring gear has them along its own width, the flexible spline those of both.
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

    Raises InputError for a recipe or profile with an element whose Jacobian is not above 0.
    """
    counts = tooth_recipe(recipe, gear)
    profile = drive.gears[gear].profile
    spline, plane = gear == "flexible_spline", drive.model == "plane"
    try:
        section = cross_section(profile, counts, *_radii(drive, gear, counts))
    except MeshError:
        raise _no_mesh(gear, counts, "cannot be meshed") from None
    if gear == "ring_gear":
        section = with_housing(section, housing_radii(drive.gears[gear], drive.housing, counts))
    z = np.array([-0.5, 0.5]) * drive.face_width if plane else _stations(drive, recipe, gear)
    toothed = np.empty((len(z), len(section.coords), 3))
    toothed[..., :2], toothed[..., 2] = section.coords, z[:, None]
    toothed[..., :2] += _relief(drive.gears[gear].crowning, section, profile, z)
    coords = toothed.reshape(-1, 3)
    rows = np.arange(len(coords), dtype=np.int32).reshape(len(z), -1)
    hexes = sweep_quads(section.quads, rows)
    cw, ccw = rows[:, section.edge].ravel(), rows[:, section.mirror[section.edge]].ravel()
    surface, node_set = ("inner", "bore") if spline else ("outer", "outer")
    faces = {surface: sweep_line(section.free[:: 1 if spline else -1], rows)}
    # in the plane the torque acts on this surface, of which the lower layer stands for both
    node_sets = {node_set: np.unique(rows[:1, section.free] if plane else faces[surface])}
    if spline and drive.cup is not None:
        cup = cup_slice(drive, recipe, section, rows[-1], len(coords))
        toothed[-1] = rounded_back(drive, section, toothed[-1])
        coords, hexes = np.concatenate((coords, cup.coords)), np.concatenate((hexes, cup.hexes))
        cw, ccw = np.concatenate((cw, cup.cw)), np.concatenate((ccw, cup.ccw))
        node_sets["bore"], faces["end"] = cup.bore, cup.end
    quality = element_quality(coords, hexes[:, :4] if plane else hexes)
    if not quality["min_jacobian"] > 0.0:
        size = f"{quality['min_jacobian']:.3g} {'mm2' if plane else 'mm3'}"
        raise _no_mesh(gear, counts, f"has an element that is inside out (Jacobian {size})")
    flanks = tuple(
        FlankGrid(np.ascontiguousarray(rows[:, nodes].T), section.s, z, side)
        for side, nodes in ((1, section.flank), (-1, section.mirror[section.flank]))
    )
    return SectorMesh(
        body=gear,
        n_sectors=profile.n_teeth,
        phase=0.0 if spline else np.pi / profile.n_teeth,
        coords=coords,
        hexes=hexes,
        ccw_nodes=ccw,
        cw_nodes=cw,
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

    Keys ``flexible_spline`` (with its cup), ``ring_gear`` and, in a pancake, ``dynamic_spline``.
    """
    require_sections(drive.model, recipe)
    return {gear: build_sector(drive, recipe, gear) for gear in drive.gears}
