"""Meshes: closed-form volumes, conforming sectors, positive Jacobians, exact flanks, recipes and
exports."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import meshio
import numpy as np
import pytest

from support.paths import RECIPE, REFERENCE
from swgpar import load_design, new
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError, OutputError
from swgpar.meshing import MeshRecipe, SectorMesh, build_sector_meshes, load_recipe
from swgpar.meshing.cross_section import cross_section
from swgpar.meshing.cup import meridian
from swgpar.meshing.drive_mesh import DriveMesh
from swgpar.meshing.export import whole_body, whole_drive
from swgpar.meshing.half_tooth import SHORT, block_ends
from swgpar.meshing.quality import element_quality, hex_volumes
from swgpar.meshing.recipe import ToothRecipe, make_recipe
from swgpar.meshing.recipe_counts import coarsened
from swgpar.meshing.sweep import axial_stations
from swgpar.meshing.tooth_sector import build_sector
from swgpar.profiles.flank import Segment, ToothProfile

CUP_RECIPES = ("coarse", "forces", "medium", "full")
GEARS = ("flexible_spline", "ring_gear")
SMALL = (
    "drive.teeth_fs=40",
    "drive.teeth_rg=42",
    "cup.length=12.0",
    "cup.inner_radius=6.0",
    "flexible_spline.rim=0.6",
    *(
        f"{gear}.profile.{key}={radius}"
        for gear in GEARS
        for key, radius in (
            ("r_tip", 0.3),
            ("straight_l", 0.2),
            ("r_dedendum", 2.0),
            ("r_root", 0.3),
        )
    ),
)
# section 6.5.4, and involutes of both cutters; their tip edges are sharp
DOUBLE_ARC = tuple(
    item
    for gear in GEARS
    for item in (
        f"{gear}.profile={{type='double_arc', r_addendum=1.0, r_dedendum=0.6}}",
        f"{gear}.c_l=0.0",
    )
)
INVOLUTE = (
    "flexible_spline.profile={type='involute', cutter_radius=0.2}",
    "ring_gear.profile={type='involute', cutter_radius=0.2, cutter_teeth=80}",
    "ring_gear.c_P=1.0",
)
SHIFTED = (
    "flexible_spline.profile.shift=0.3",
    "ring_gear.profile.shift=0.35",
    "ring_gear.profile.pressure_angle=20.4",
)


@lru_cache
def design(*overrides: str) -> DriveDesign:
    return load_design(REFERENCE, overrides)


def plane_design(*overrides: str) -> DriveDesign:
    straight = [f"micro_geometry.{key}=0" for key in ("wg_crowning", "wg_slope", "fs_crowning")]
    return design(*overrides, "drive.model=plane", *straight)


@lru_cache
def meshes(recipe: Path, *overrides: str) -> dict[str, SectorMesh]:
    return build_sector_meshes(design(*overrides).geometry, load_recipe(recipe))


CASES = [pytest.param(name, (), id=name) for name in CUP_RECIPES]
CASES += [
    pytest.param(RECIPE, SMALL, id="tiny"),
    pytest.param(RECIPE, (), id="tiny-reference"),
    pytest.param("medium", ("cup.thickness_coef=0.95",), id="thick-cup"),
    pytest.param("medium", ("cup.thickness_coef=1.0",), id="cup-as-rim"),
    pytest.param("medium", ("cup.thickness_coef=0.2",), id="thin-cup"),
    pytest.param("full", ("wave_generator.face_width=6.0",), id="narrow-cam"),
    pytest.param("coarse", DOUBLE_ARC, id="double-arc"),
    pytest.param("coarse", INVOLUTE, id="involute"),
    pytest.param("full", INVOLUTE, id="involute-full"),
    pytest.param("coarse", (*INVOLUTE, *SHIFTED), id="involute-shifted"),
]


def rotated(coords: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return coords @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def refined(recipe: MeshRecipe, factor: int) -> MeshRecipe:
    """Every element count of the recipe multiplied by `factor`."""
    table = recipe.model_dump()
    for section in table.values():
        for key, value in section.items():
            if type(value) is int:
                section[key] = factor * value
    return MeshRecipe.model_validate(table)


def polygon_area(points: np.ndarray) -> float:
    x, y = points.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def section_area(case: DriveDesign, gear: str) -> float:
    """Area of one tooth and its rim by integration along the exact outline."""
    profile = case.profile(gear)
    half = np.pi / profile.n_teeth
    flank = profile.point(np.linspace(0.0, profile.length, 20001))
    # Green's theorem: the flank as a fine polygon, the circles exactly
    x, y = flank.T
    along_flank = -0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])
    land, root = profile.polar_angle(0.0)[0], half - profile.polar_angle(profile.length)[0]
    teeth = 2.0 * along_flank + profile.r_tip_circle**2 * land + profile.r_root_circle**2 * root
    free = (
        case.inner_radius
        if gear == "flexible_spline"
        else profile.r_root_circle + case.ring_gear.rim
    )
    return abs(teeth - free**2 * half)


def cup_volume(case: DriveDesign) -> float:
    cup, t = case.cup, case.cup_sizes.thickness
    outer, inner = cup.fillet_radius, cup.fillet_radius - t
    r_centre = case.inner_radius + t - outer
    cylinder = np.pi * ((case.inner_radius + t) ** 2 - case.inner_radius**2) * (cup.length - outer)
    fillet = (
        2.0 * np.pi * (r_centre * np.pi / 4.0 * (outer**2 - inner**2) + (outer**3 - inner**3) / 3.0)
    )
    return cylinder + fillet + np.pi * (r_centre**2 - cup.inner_radius**2) * t


@pytest.mark.parametrize("recipe", ["coarse", "medium", "full"])
@pytest.mark.parametrize("radius", [0.1, 0.2])
def test_fillet_at_the_back_of_the_teeth(recipe: str, radius: float) -> None:
    """Its nodes lie on an arc that is tangent to the back and to the wall; it adds its volume."""
    case = load_design(REFERENCE, [f"cup.back_fillet={radius}"])
    mesh = build_sector(case.geometry, load_recipe(recipe), "flexible_spline")
    plain = build_sector(load_design(REFERENCE).geometry, load_recipe(recipe), "flexible_spline")
    assert mesh.quality["min_scaled_jacobian"] > 0.3
    back, wall = 0.5 * case.drive.face_width, case.inner_radius + case.cup_sizes.thickness
    r, z = np.hypot(*mesh.coords[:, :2].T), mesh.coords[:, 2]
    on = (
        (r > wall - 1e-9)
        & (r < wall + radius + 1e-9)
        & (z > back - 1e-9)
        & (z < back + radius + 1e-9)
    )
    assert np.count_nonzero(on) >= (20 if recipe == "full" else 3)
    assert np.hypot(r[on] - wall - radius, z[on] - back - radius) == pytest.approx(radius, rel=1e-9)
    if recipe == "full":  # others have no layer of nodes between the corner and the root
        area, centroid = (1.0 - 0.25 * np.pi) * radius**2, wall + 0.2234 * radius
        added = [float(hex_volumes(m.coords, m.hexes).sum()) for m in (mesh, plain)]
        exact = area * 2.0 * np.pi * centroid / mesh.n_sectors
        # chords of the hollow arc lie outside of it: three straight elements have a fifth more
        assert exact < added[0] - added[1] < 1.3 * exact


@pytest.mark.parametrize(("recipe", "overrides"), CASES)
def test_jacobians_are_positive_and_elements_are_good(
    recipe: Path, overrides: tuple[str, ...]
) -> None:
    for mesh in meshes(recipe, *overrides).values():
        assert mesh.quality == element_quality(mesh.coords, mesh.hexes)
        assert mesh.quality["min_jacobian"] > 0.0
        assert mesh.quality["min_scaled_jacobian"] > 0.5
        assert np.unique(mesh.hexes).size == len(mesh.coords)


@pytest.mark.parametrize("recipe", CUP_RECIPES)
def test_double_arcs_in_finer_recipes(recipe: str) -> None:
    # elements of the top land narrow towards the tooth's inside: less well shaped than with rounded
    # tip edges
    for mesh in meshes(recipe, *DOUBLE_ARC).values():
        assert mesh.quality["min_jacobian"] > 0.0 and mesh.quality["min_scaled_jacobian"] > 0.4


@pytest.mark.parametrize("external", [True, False])
def test_a_sharp_trapezoidal_tooth_can_be_meshed(external: bool) -> None:
    """No rounded tip edge and no root arc: K is T and Q is R."""
    side = 1.0 if external else -1.0
    t, r = np.array((0.5, 30.0 + 0.6 * side)), np.array((0.9, 30.0 - 0.8 * side))
    direction = float(np.arctan2(*(r - t)[::-1]))
    segment = Segment("straight", (t[0], t[1]), direction, 0.0, float(np.hypot(*(r - t))))
    profile = ToothProfile((segment,), external, float(np.hypot(*t)), float(np.hypot(*r)), 60)
    recipe = load_recipe("full").flexible_spline
    section = cross_section(
        profile, recipe, float(np.hypot(*r)) - 0.6 * side, float(np.hypot(*r)) - side
    )
    x = section.coords[section.quads]
    after, before = np.roll(x, -1, axis=1) - x, np.roll(x, 1, axis=1) - x
    area = after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0]
    sine = area / np.linalg.norm(after, axis=-1) / np.linalg.norm(before, axis=-1)
    assert sine.min() > 0.2
    assert (section.s[0], section.s[-1]) == (0.0, pytest.approx(profile.length))


@pytest.mark.parametrize(("recipe", "overrides"), CASES)
def test_sectors_conform(recipe: Path, overrides: tuple[str, ...]) -> None:
    for mesh in meshes(recipe, *overrides).values():
        next_sector = rotated(mesh.coords, 2.0 * np.pi / mesh.n_sectors)
        gap = np.abs(mesh.coords[mesh.ccw_nodes] - next_sector[mesh.cw_nodes]).max()
        assert gap < 1e-13 * np.abs(mesh.coords).max()
        angle = np.arctan2(-mesh.coords[:, 0], mesh.coords[:, 1])
        half = np.pi / mesh.n_sectors
        assert np.all(np.abs(angle) <= half * (1.0 + 1e-12))
        for side, nodes in ((half, mesh.ccw_nodes), (-half, mesh.cw_nodes)):
            assert np.array_equal(
                np.sort(nodes), np.flatnonzero(np.abs(angle - side) < 1e-9 * half)
            )


@pytest.mark.parametrize(("recipe", "overrides"), CASES)
def test_flanks_lie_on_the_profile_with_crowning(recipe: Path, overrides: tuple[str, ...]) -> None:
    case = design(*overrides)
    for gear, mesh in meshes(recipe, *overrides).items():
        profile, width = mesh.profile, case.drive.face_width
        crowning = case.micro_geometry.fs_crowning if gear == "flexible_spline" else 0.0
        for flank, side in zip(mesh.flanks, (1, -1), strict=True):
            assert flank.side == side
            assert (flank.s[0], flank.z[0], flank.z[-1]) == (0.0, -0.5 * width, 0.5 * width)
            assert flank.s[-1] == pytest.approx(profile.length, rel=1e-14)
            assert np.all(np.diff(flank.s) > 0.0) and np.all(np.diff(flank.z) > 0.0)
            assert flank.nodes.shape == (len(flank.s), len(flank.z))
            cut = crowning * (2.0 * flank.z / width) ** 2
            move = profile.crowning_weight(flank.s)[:, None] * profile.normal(flank.s)
            exact = profile.point(flank.s)[:, None] - cut[:, None] * move[:, None]
            exact = exact * (side, 1.0)
            nodes = mesh.coords[flank.nodes]
            assert np.abs(nodes[..., :2] - exact).max() < 1e-12
            assert np.array_equal(nodes[..., 2], np.broadcast_to(flank.z, flank.nodes.shape))


@pytest.mark.parametrize("name", CUP_RECIPES)
def test_segment_ends_are_nodes(name: str) -> None:
    for mesh in meshes(name).values():
        for end in mesh.profile.breaks:
            assert np.abs(mesh.flanks[0].s - end).min() < 1e-12


@pytest.mark.parametrize("count", [6, 4])
def test_short_segments_have_elements_of_their_own(count: int) -> None:
    """S-shaped teeth have a short segment in their middle: the elements of the recipe share the
    rest of the flank, on the coarser mesh of a run too."""
    case = new(ratio=80, diameter=60.0, torque=5.0, model="plane")
    recipe = load_recipe("plane_coarse")
    recipe = recipe if count == recipe.flexible_spline.flank else coarsened(recipe)
    assert recipe.flexible_spline.flank == count
    mesh = build_sector_meshes(case.geometry, recipe)["flexible_spline"]
    profile, s = mesh.profile, mesh.flanks[0].s
    k, q = block_ends(profile)
    side = s[(s >= k - 1e-9) & (s <= q + 1e-9)]
    ends = profile.breaks[(profile.breaks > k) & (profile.breaks < q)]
    assert all(np.abs(side - end).min() < 1e-9 for end in ends)
    lengths = np.diff([k, *ends, q])
    short = int((lengths < SHORT * (q - k) / count).sum())
    assert short > 0
    assert len(side) - 1 == count + short
    assert np.diff(side).max() < 1.5 * (q - k) / count


def test_windows_of_a_tooth_with_a_small_rounded_edge_can_be_meshed() -> None:
    """The edge is too short for a cap, and begins as the top land ends: an inner line of the same
    shape folds the core."""
    case = plane_design().with_values(
        {
            "drive.teeth_fs": 118,
            "drive.teeth_rg": 120,
            "drive.module": 0.723,
            "drive.addendum_coef": 0.517,
            "drive.dedendum_coef": 0.6893,
            "flexible_spline.rim": 1.086,
            "flexible_spline.profile": {"type": "s_shaped", "r_tip": 0.068, "r_root": 0.191},
            "ring_gear.profile": {"type": "conjugate", "r_tip": 0.124, "r_root": 0.118},
            "ring_gear.c_P": 1.0,
            "wave_generator": {"type": "elliptical", "C": 0.9644, "face_width": 7.23},
        }
    )
    profile = case.profile("flexible_spline")
    window = ToothRecipe(tip=16, layers=8, flank=64, root=32, under=24, rim=32)
    inner = case.inner_radius
    interface = 0.5 * (inner + profile.r_root_circle)
    section = cross_section(profile, window, interface, inner)
    corners = section.coords[section.quads]
    first, second = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    assert np.min(first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]) > 0.0


@pytest.mark.parametrize(("recipe", "overrides"), CASES)
def test_named_faces_look_out_of_the_material(recipe: Path, overrides: tuple[str, ...]) -> None:
    case = design(*overrides)
    for gear, mesh in meshes(recipe, *overrides).items():
        name, direction = ("inner", -1.0) if gear == "flexible_spline" else ("outer", 1.0)
        radius = (
            case.inner_radius
            if gear == "flexible_spline"
            else mesh.profile.r_root_circle + case.ring_gear.rim
        )
        assert set(mesh.faces) == ({name, "end"} if gear == "flexible_spline" else {name})
        x = mesh.coords[mesh.faces[name]]
        assert np.allclose(np.hypot(x[..., 0], x[..., 1]), radius, rtol=1e-13)
        assert np.abs(x[..., 2]).max() == 0.5 * case.drive.face_width
        normal = 0.5 * np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
        radial = x.mean(axis=1) * (1.0, 1.0, 0.0) / radius
        outward = direction * np.einsum("fi,fi->f", normal, radial)
        assert np.all(outward > 0.0)
        exact = 2.0 * np.pi / mesh.n_sectors * radius * case.drive.face_width
        assert outward.sum() == pytest.approx(exact, rel=2e-3)


def test_faces_of_the_closed_end_look_along_the_axis_away_from_its_middle() -> None:
    case, mesh = design(), meshes("medium")["flexible_spline"]
    corners = mesh.coords[mesh.faces["end"]]
    area = 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    outside = corners[:, :, 2].mean(axis=1) > case.cup_sizes.rest_plane
    assert np.array_equal(np.sign(area[:, 2]), np.where(outside, 1.0, -1.0))
    r_out = case.inner_radius + case.cup_sizes.thickness - case.cup.fillet_radius
    exact = np.pi * (r_out**2 - case.cup.inner_radius**2) / mesh.n_sectors
    for side in (outside, ~outside):
        assert np.abs(area[side, 2]).sum() == pytest.approx(exact, rel=1e-3)
    assert np.abs(area[:, :2]).max() < 1e-12


def test_node_sets() -> None:
    case, both = design(), meshes("coarse")
    bore = both["flexible_spline"].coords[both["flexible_spline"].node_sets["bore"]]
    assert np.allclose(np.hypot(bore[:, 0], bore[:, 1]), case.cup.inner_radius, rtol=1e-13)
    end = 0.5 * case.drive.face_width + case.cup.length
    assert bore[:, 2].max() == pytest.approx(end) and bore[:, 2].min() == pytest.approx(
        end - case.cup_sizes.thickness
    )
    ring = both["ring_gear"]
    radius = np.hypot(ring.coords[:, 0], ring.coords[:, 1])
    assert np.array_equal(
        ring.node_sets["outer"], np.flatnonzero(radius > radius.max() * (1.0 - 1e-9))
    )
    assert (both["flexible_spline"].phase, ring.phase) == (0.0, np.pi / 122)


@pytest.mark.parametrize("gear", GEARS)
def test_section_area_converges_quadratically(gear: str) -> None:
    case, recipe = design(), load_recipe("coarse")
    profile = case.profile(gear)
    exact = section_area(case, gear)
    interface, free = (
        (case.inner_radius + case.cup_sizes.thickness, case.inner_radius)
        if gear == "flexible_spline"
        else (profile.r_root_circle + 1.0, profile.r_root_circle + case.ring_gear.rim)
    )
    errors = []
    for factor in (1, 2, 4, 8):
        section = cross_section(profile, getattr(refined(recipe, factor), gear), interface, free)
        corners = section.coords[section.quads]
        errors.append(abs(sum(polygon_area(quad) for quad in corners) - exact) / exact)
    assert errors[0] < 0.02
    # chords outside hollows and inside bulges cancel in part, so look at the whole way: quadratic
    # is 64 times
    assert errors[-1] < errors[0] / 50.0, errors


@pytest.mark.parametrize("thickness_coef", [0.8, 0.95, 1.0])
def test_volumes_match_closed_forms(thickness_coef: float) -> None:
    overrides = (f"cup.thickness_coef={thickness_coef}", "micro_geometry.fs_crowning=0.0")
    case = design(*overrides)
    errors = []
    for factor in (1, 2):
        recipe = refined(load_recipe("full"), factor)
        error = []
        for gear, mesh in build_sector_meshes(case.geometry, recipe).items():
            volume = mesh.n_sectors * hex_volumes(mesh.coords, mesh.hexes).sum()
            exact = mesh.n_sectors * section_area(case, gear) * case.drive.face_width
            exact += cup_volume(case) if gear == "flexible_spline" else 0.0
            error.append(abs(volume / exact - 1.0))
        errors.append(error)
    assert np.max(errors[0]) < 1e-3 and np.max(errors[1]) < 4e-4, errors


def test_joined_columns_leave_the_teeth_and_the_surfaces_of_the_wall() -> None:
    recipe = load_recipe("medium")
    cup = recipe.cup.model_copy(update={"joined_columns": False})
    plain = build_sector_meshes(design().geometry, recipe.model_copy(update={"cup": cup}))[
        "flexible_spline"
    ]
    joined = meshes("medium")["flexible_spline"]
    assert 0.7 < len(joined.coords) / len(plain.coords) < 0.8
    behind = 0.5 * design().drive.face_width + np.pi * design().drive.module
    near = [mesh.coords[mesh.coords[:, 2] < behind] for mesh in (plain, joined)]
    assert np.array_equal(*near)
    far = [
        np.unique(
            np.round(np.column_stack([np.hypot(*mesh.coords[:, :2].T), mesh.coords[:, 2]]), 6),
            axis=0,
        )
        for mesh in (plain, joined)
    ]
    # but for the nodes inside of the transition
    assert len({tuple(p) for p in far[0]} - {tuple(p) for p in far[1]}) == 0


def test_crowning_leaves_everything_but_the_teeth() -> None:
    plain = meshes("full", "micro_geometry.fs_crowning=0.0")["flexible_spline"]
    crowned = meshes("full")["flexible_spline"]
    moved = np.linalg.norm(crowned.coords - plain.coords, axis=1)
    assert moved.max() <= 0.045 * (1.0 + 1e-12)
    radius = np.hypot(plain.coords[:, 0], plain.coords[:, 1])
    assert moved[radius < 59.0 + 1e-9].max() < 1e-12
    assert moved[radius > plain.profile.r_tip_circle * (1.0 - 1e-12)].max() < 1e-12
    assert moved[np.abs(plain.coords[:, 2]) < 1e-12].max() < 1e-12
    # the inside of the tooth follows: its outermost free nodes move by more than half of the
    # flank's way
    tooth = (np.abs(plain.coords[:, 2]) == 5.0) & (np.abs(radius - 60.0) < 0.1)
    assert np.count_nonzero(moved[tooth] > 0.02) > 4


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [("coarse", 30_000, 60_000), ("medium", 110_000, 150_000), ("full", 400_000, 470_000)],
)
def test_recipes_have_the_announced_size(name: str, low: int, high: int) -> None:
    both = meshes(name)
    assert low <= sum(len(mesh.hexes) * mesh.n_sectors for mesh in both.values()) <= high


def test_full_recipe_is_graded_as_in_table_4_2() -> None:
    recipe = load_recipe("full")
    case = design()
    for gear, mesh in meshes("full").items():
        counts = getattr(recipe, gear)
        section = cross_section(
            case.profile(gear), counts, *((59.0, 58.2) if mesh.phase == 0 else (62.8, 63.8))
        )
        root_land = 1  # from R to the middle of the root
        assert len(mesh.flanks[0].s) - 1 + root_land == 21
        assert len(section.free) - 1 >= 10
        assert counts.rim == 2
    assert recipe.face_width.elements >= 10


def test_tiny_recipe_has_about_a_hundred_elements_per_sector() -> None:
    both = meshes(RECIPE, *SMALL)
    assert all(70 <= len(mesh.hexes) <= 120 for mesh in both.values())


def test_nodes_lie_at_the_ends_of_a_narrow_wave_generator() -> None:
    for n in range(2, 14):
        for ratio in (1.0, 1.5, 3.0):
            for inner in (0.5, 3.0, 6.0, 9.9, 10.0, 12.0):
                z = axial_stations(10.0, n, ratio, inner)
                assert len(z) == n + 1 and np.all(np.diff(z) > 0.0)
                assert (z[0], z[-1]) == (-5.0, 5.0)
                assert np.allclose(z, -z[::-1], atol=1e-15)
                if n > 2 and inner < 10.0:
                    assert (
                        np.abs(z - 0.5 * inner).min() < 1e-14
                        and np.abs(z + 0.5 * inner).min() < 1e-14
                    )
    grid = meshes("full", "wave_generator.face_width=6.0")["flexible_spline"].flanks[0]
    assert np.abs(grid.z - 3.0).min() < 1e-14


def test_meshes_scale_with_the_unit_system() -> None:
    scale = 1e-3
    lengths = {
        "drive": ("module", "face_width"),
        "flexible_spline": ("rim",),
        "ring_gear": ("rim",),
        "flexible_spline.profile": ("r_tip", "r_addendum", "r_dedendum", "r_root"),
        "ring_gear.profile": ("r_tip", "r_addendum", "r_dedendum", "r_root"),
        "wave_generator": ("face_width",),
        "cup": ("length", "fillet_radius", "inner_radius"),
        "micro_geometry": ("wg_crowning", "wg_slope", "fs_crowning"),
    }
    table = design().model_dump()
    overrides = [f"load.torque={scale**3 * table['load']['torque']!r}"]  # of the same stresses
    for section, keys in lengths.items():
        values = table
        for part in section.split("."):
            values = values[part]
        overrides += [f"{section}.{key}={scale * values[key]!r}" for key in keys]
    for gear, metres in meshes("coarse", *overrides).items():
        millimetres = meshes("coarse")[gear]
        assert np.array_equal(metres.hexes, millimetres.hexes)
        assert np.allclose(
            metres.coords, scale * millimetres.coords, rtol=0.0, atol=1e-12 * scale * 60.0
        )


# the wall of forces and medium has joined columns; a thick cup continues more layers
@pytest.mark.parametrize(
    ("recipe", "overrides"),
    [
        (RECIPE, SMALL),
        ("forces", ()),
        ("medium", ("cup.thickness_coef=0.95",)),
        (RECIPE, (*SMALL, "ring_gear.housing.thickness=4")),
    ],
)
def test_whole_drive_is_watertight(recipe: Path, overrides: tuple[str, ...]) -> None:
    for mesh in meshes(recipe, *overrides).values():
        coords, hexes = whole_body(mesh)
        assert len(coords) == mesh.n_sectors * (len(mesh.coords) - len(mesh.ccw_nodes))
        assert hex_volumes(coords, hexes).min() > 0.0
        sides = np.array(
            [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
        )
        faces = hexes[:, sides].reshape(-1, 4)
        _, index, times = np.unique(
            np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
        )
        assert times.max() == 2
        skin = faces[index[times == 1]]
        edges = np.stack((skin, np.roll(skin, -1, axis=1)), axis=-1).reshape(-1, 2)
        forward = {tuple(edge) for edge in edges.tolist()}
        assert len(forward) == len(edges) and all((b, a) in forward for a, b in forward)
        # a ring of gears and a cup with a bore are both tori: Euler number 0
        assert np.unique(skin).size - len(edges) // 2 + len(skin) == 0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[cup]", "[rim]\nlayers = 2\n[cup]", ("rim", "section of a mesh recipe")),
        ("cylinder = 2", "cylinder = 0", ("cup.cylinder = 0", "1 to 400")),
        ("cylinder = 2", "cylinder = 2.5", ("cup.cylinder = 2.5", "whole number")),
        ("cylinder = 2", "cylinder = 2\nfilet = 2", ("cup.filet", "did you mean cup.fillet")),
        ("cylinder = 2", "cylinder = 2\nend_ratio = nan", ("cup.end_ratio", "finite")),
        ("elements = 2", "elements = 1", ("face_width.elements = 1", "2 to 400")),
        ("tip = 2", "tip = 1", ("flexible_spline.tip = 1", "2 to 40")),
        ("flank = 2", "flank = true", ("flexible_spline.flank = true", "whole number")),
        (
            "layers = 1",
            "layers = 1\nlayer_ratio = 0.5",
            ("flexible_spline.layer_ratio = 0.5", "1 to 3"),
        ),
        (
            "layers = 1",
            "layers = 1\nunder_ratio = 0.5",
            ("flexible_spline.under_ratio = 0.5", "1 to 20"),
        ),
        ("rim = 1\n", "", ("flexible_spline.rim is missing",)),
        ("[face_width]\nelements = 2\n", "[face_width]\n", ("face_width.elements is missing",)),
        ("[face_width]\nelements = 2\n", "face_width = 3\n", ("ring_gear.face_width = 3",)),
        ("[cup]", "[cup", ("not valid TOML",)),
    ],
)
def test_bad_recipes_are_refused_in_one_sentence(
    tmp_path: Path, old: str, new: str, words: tuple[str, ...]
) -> None:
    path = tmp_path / "recipe.toml"
    good = RECIPE.read_text()
    assert old in good
    path.write_text(good.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        load_recipe(path)
    message = str(caught.value)
    assert "\n" not in message and all(word in message for word in words), message


@pytest.mark.parametrize(
    ("section", "text"),
    [("face_width", "[face_width]\nelements = 2\n"), ("cup", "[cup]\ncylinder = 2\n")],
)
def test_a_cup_needs_all_sections_of_a_recipe(tmp_path: Path, section: str, text: str) -> None:
    path = tmp_path / "recipe.toml"
    content = RECIPE.read_text()
    assert text in content
    cut = content.index(text)
    after = content.find("\n[", cut + 1)
    path.write_text(content[:cut] + (content[after + 1 :] if after > 0 else ""))
    recipe = load_recipe(path)
    assert getattr(recipe, section) is None
    with pytest.raises(InputError) as caught:
        build_sector_meshes(design(*SMALL).geometry, recipe)
    assert f"[{section}] is missing" in str(caught.value) and "\n" not in str(caught.value)
    build_sector_meshes(plane_design(*SMALL).geometry, recipe)


def test_unreadable_recipe(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        load_recipe(tmp_path / "absent.toml")


@pytest.mark.parametrize("override", ["cup.length=1.5", "cup.inner_radius=58.0"])
def test_a_cup_that_does_not_close_is_refused(override: str) -> None:
    with pytest.raises(InputError, match=override.partition("=")[0]):
        meridian(design(override).geometry.cup, load_recipe(RECIPE).cup)


def test_exports_read_back(tmp_path: Path) -> None:
    both = meshes(RECIPE, *SMALL)
    drive = whole_drive(both)
    files = DriveMesh(both, design(*SMALL).materials, 10.0).write(tmp_path / "mesh")
    assert [path.suffix for path in files] == [".vtu", ".msh", ".inp"]
    for path in files[:2]:
        back = meshio.read(path)
        assert np.allclose(back.points, drive.points, rtol=0.0, atol=1e-12)
        assert np.array_equal(back.cells_dict["hexahedron"], drive.cells_dict["hexahedron"])
    marks = meshio.read(files[0]).point_data
    assert set(marks) == set(drive.point_sets)
    assert np.array_equal(
        np.flatnonzero(marks["flexible_spline_bore"]), drive.point_sets["flexible_spline_bore"]
    )
    physical = meshio.read(files[1]).cell_data_dict["gmsh:physical"]["hexahedron"]
    assert np.bincount(physical)[1:].tolist() == [len(m.hexes) * m.n_sectors for m in both.values()]
    assert "TYPE=C3D8I" in files[2].read_text()


def test_export_failures_are_clear(tmp_path: Path) -> None:
    mesh = DriveMesh(meshes(RECIPE, *SMALL), design(*SMALL).materials, 10.0)
    blocked = tmp_path / "file"
    blocked.write_text("")
    with pytest.raises(OutputError, match="cannot be written"):
        mesh.write(blocked)
    with pytest.raises(InputError, match='"stl"'):
        mesh.write(tmp_path, ("stl",))


def test_report_counts_the_full_drive() -> None:
    both = meshes(RECIPE, *SMALL)
    report = DriveMesh(both, {}, 10.0).quality
    drive = whole_drive(both)
    assert sum(entry["nodes"] for entry in report.values()) == len(drive.points)
    assert sum(entry["elements"] for entry in report.values()) == sum(
        len(block.data) for block in drive.cells
    )
    assert all(entry["min_jacobian"] > 0.0 and entry["volume"] > 0.0 for entry in report.values())


@lru_cache
def plane_meshes(recipe: Path, *overrides: str) -> dict[str, SectorMesh]:
    return build_sector_meshes(plane_design(*overrides).geometry, load_recipe(recipe))


PLANE_CASES = [pytest.param(RECIPE, SMALL, id="tiny")]
PLANE_CASES += [pytest.param(name, (), id=name) for name in ("plane", "plane_coarse", "coarse")]


@pytest.mark.parametrize(("recipe", "overrides"), PLANE_CASES)
def test_plane_sectors(recipe: Path, overrides: tuple[str, ...]) -> None:
    """Two layers of the same nodes, of which one moves with the other; the quadrilaterals fill the
    exact section."""
    case = plane_design(*overrides)
    for gear, mesh in plane_meshes(recipe, *overrides).items():
        lower = np.unique(mesh.lower_nodes)
        assert np.array_equal(mesh.lower_nodes[lower], lower) and 2 * len(lower) == len(mesh.coords)
        assert np.array_equal(mesh.coords[mesh.lower_nodes][:, :2], mesh.coords[:, :2])
        assert np.array_equal(np.unique(mesh.elements), lower)
        assert np.allclose(mesh.coords[lower, 2], -0.5 * case.drive.face_width)
        assert all(np.isin(nodes, lower).all() for nodes in mesh.node_sets.values())
        area = mesh.coords[mesh.elements][..., :2]
        assert sum(polygon_area(quad) for quad in area) == pytest.approx(
            section_area(case, gear), rel=5e-3
        )  # chords: 4e-3
        quality = mesh.quality
        assert quality == element_quality(mesh.coords, mesh.elements)
        assert quality["min_jacobian"] > 0.0 and quality["min_scaled_jacobian"] > 0.5
        # of the section: the thickness does not enter
        assert 1.0 <= quality["max_aspect_ratio"] < 15.0
        solid = element_quality(mesh.coords, mesh.hexes)
        assert 0.5 * case.drive.face_width * quality["min_jacobian"] == pytest.approx(
            solid["min_jacobian"], rel=1e-9
        )
        assert quality["min_scaled_jacobian"] == pytest.approx(
            solid["min_scaled_jacobian"], rel=1e-9
        )


def test_quality_of_a_trapezium() -> None:
    points = np.array([(0, 0, 0), (4, 0, 0), (3, 1, 0), (0, 1, 0)], dtype=float)
    quality = element_quality(points, np.array([[0, 1, 2, 3]], dtype=np.int32))
    # half the height times half the width at eta = -+1 / sqrt(3)
    low, high = (0.25 * (3.5 - 0.5 * eta) for eta in (1.0 / np.sqrt(3.0), -1.0 / np.sqrt(3.0)))
    assert (quality["min_jacobian"], quality["max_jacobian"]) == pytest.approx((low, high))
    assert quality["max_aspect_ratio"] == pytest.approx(4.0)
    assert quality["min_scaled_jacobian"] == pytest.approx(np.sin(0.25 * np.pi))
    assert element_quality(points, np.array([[3, 2, 1, 0]], dtype=np.int32))["min_jacobian"] < 0.0


@pytest.mark.parametrize("rim", [0.2, 1.0, 5.0, 20.0, 100.0])
def test_rims_of_any_thickness_are_meshed(rim: float) -> None:
    """In modules, of the ring gear; the module is 1 mm."""
    mesh = build_sector_meshes(
        plane_design(f"ring_gear.rim={rim}").geometry, load_recipe("plane_coarse")
    )["ring_gear"]
    assert mesh.quality["min_scaled_jacobian"] > 0.5


def coarsest(**counts: float) -> MeshRecipe:
    """The smallest recipe of the plane with other counts on both gears."""
    section = {"tip": 2, "flank": 2, "root": 2, "under": 1, "rim": 1, **counts}
    return make_recipe({"flexible_spline": section, "ring_gear": section})


@pytest.mark.parametrize("gear", ["flexible_spline", "ring_gear"])
def test_layers_below_the_root_are_graded(gear: str) -> None:
    """The lowest of three layers is four times as thick as the one at the root, twice the middle
    one; the rim below has one layer."""
    recipe = coarsest(under=3, under_ratio=4.0)
    mesh = build_sector_meshes(plane_design().geometry, recipe)[gear]
    radii = np.unique(np.hypot(*mesh.coords[mesh.ccw_nodes, :2].T).round(9))
    thickness = np.diff(radii if gear == "ring_gear" else radii[::-1])
    assert np.abs(thickness[1:3] / thickness[0]) == pytest.approx([2.0, 4.0], rel=1e-6)


def test_an_inverted_quadrilateral_is_refused() -> None:
    """Forty layers below the flank reach into a row of elements of a hundredth of the rim."""
    with pytest.raises(
        InputError, match=r"^flexible_spline has an element .* \(Jacobian -.* mm2\), with tip = 2"
    ):
        build_sector_meshes(plane_design().geometry, coarsest(layers=40, rim=100))


def test_what_gmsh_cannot_mesh_is_refused() -> None:
    """The thinnest of the layers is 3^-40 of the thickest one."""
    with pytest.raises(
        InputError, match=r"^flexible_spline cannot be meshed, with .* layer_ratio = 3, .*: allowed"
    ):
        build_sector_meshes(plane_design().geometry, coarsest(layers=40, layer_ratio=3.0))
    build_sector_meshes(plane_design().geometry, coarsest())


@pytest.mark.parametrize(
    ("name", "low", "high"), [("plane", 45_000, 49_000), ("plane_coarse", 30_000, 31_000)]
)
def test_plane_recipes_have_the_announced_size(name: str, low: int, high: int) -> None:
    both = plane_meshes(name)
    assert low <= sum(len(mesh.hexes) * mesh.n_sectors for mesh in both.values()) <= high


def test_whole_plane_drive_is_closed() -> None:
    """Every edge inside belongs to two quadrilaterals, counter-clockwise ones; two circles of edges
    are left."""
    for mesh in plane_meshes(RECIPE, *SMALL).values():
        coords, quads = whole_body(mesh)
        assert len(coords) == mesh.n_sectors * (len(mesh.coords) - len(mesh.ccw_nodes)) // 2
        assert np.array_equal(np.unique(quads), np.arange(len(coords))) and np.all(
            coords[:, 2] == 0.0
        )
        assert min(polygon_area(quad) for quad in coords[quads][..., :2]) > 0.0
        edges = np.stack((quads, np.roll(quads, -1, axis=1)), axis=-1).reshape(-1, 2)
        forward = {tuple(edge) for edge in edges.tolist()}
        assert len(forward) == len(edges)
        rim = [edge for edge in forward if edge[::-1] not in forward]
        assert len(coords) - (len(edges) + len(rim)) // 2 + len(quads) == 0
        assert sorted(a for a, _ in rim) == sorted(b for _, b in rim)


def test_plane_exports_read_back(tmp_path: Path) -> None:
    both = plane_meshes(RECIPE, *SMALL)
    drive = whole_drive(both)
    assert set(drive.cells_dict) == {"quad"}
    files = DriveMesh(both, plane_design(*SMALL).materials, 10.0).write(tmp_path / "mesh")
    for path in files[:2]:
        back = meshio.read(path)
        assert np.allclose(back.points, drive.points, rtol=0.0, atol=1e-12)
        assert np.array_equal(back.cells_dict["quad"], drive.cells_dict["quad"])
    physical = meshio.read(files[1])
    tags = physical.cell_data_dict["gmsh:physical"]["quad"]
    assert np.bincount(tags)[1:].tolist() == [len(m.hexes) * m.n_sectors for m in both.values()]
    assert {name: tuple(tag) for name, tag in physical.field_data.items()} == {
        GEARS[0]: (1, 2),
        GEARS[1]: (2, 2),
    }
    lines = files[2].read_text().splitlines()
    for gear, mesh in both.items():
        start = lines.index(f"*ELEMENT, TYPE=CPS4, ELSET={gear.upper()}") + 1
        end = next(k for k in range(start, len(lines)) if lines[k].startswith("*"))
        assert end - start == len(mesh.hexes) * mesh.n_sectors
        assert all(line.count(",") == 4 for line in lines[start:end])
        section = lines.index(
            f"*SOLID SECTION, ELSET={gear.upper()}, MATERIAL={gear.upper()}_MATERIAL"
        )
        assert lines[section + 1] == "10"
    report = DriveMesh(both, {}, 10.0).quality
    assert sum(entry["nodes"] for entry in report.values()) == len(drive.points)
    assert sum(entry["elements"] for entry in report.values()) == len(drive.cells_dict["quad"])
    for gear, entry in report.items():
        area = both[gear].n_sectors * section_area(plane_design(*SMALL), gear)
        assert entry["volume"] == pytest.approx(10.0 * area, rel=5e-3)
        assert entry["max_aspect_ratio"] == both[gear].quality["max_aspect_ratio"]
