"""Shapes of the flexible spline: contours of the wall, silk hats, short cups."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI
from scipy.integrate import trapezoid

import swgpar
from support.cup_shapes import (
    CLAMPED,
    HAT,
    HAT_CLAMPED,
    SHAPES,
    SHORT_WALL,
    WALLS,
    Changes,
    bolted,
    cone,
    shaped,
    wall_volume,
)
from support.paths import DRIVERS, RECIPE
from support.sector_motion import TANGENTIAL, stiffness_between
from support.stepping import loaded
from swgpar.analysis.accuracy import require_refinable, with_accuracy
from swgpar.analysis.bent_spline import BentSpline
from swgpar.analysis.forecast import forecast
from swgpar.checks.derived_geometry import derived_geometry
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.geometry.paired_lines import RoundedLine, thicknesses
from swgpar.meshing import SectorMesh, load_recipe
from swgpar.meshing.cup import GROWTH, LONG, cylinder_stations, meridian
from swgpar.meshing.quality import hex_volumes
from swgpar.meshing.tooth_sector import build_sector
from swgpar.model.drive_model import build_drive_model

shapes = pytest.mark.parametrize("shape", list(SHAPES))
walls = pytest.mark.parametrize("shape", list(WALLS))


def spline(case: DriveDesign, recipe: str = "full") -> SectorMesh:
    return build_sector(case.geometry, load_recipe(recipe), "flexible_spline")


@pytest.mark.parametrize("recipe", ["coarse", "medium", "full"])
def test_a_contour_that_is_straight_changes_no_bit_of_the_mesh(recipe: str) -> None:
    thickness = shaped({}).cup_sizes.thickness
    points = [{"distance": at, "thickness": thickness, "rounding": 2.0} for at in (3.1, 7.0)]
    plain, drawn = spline(shaped({}), recipe), spline(shaped({"contour": points}), recipe)
    assert np.array_equal(plain.coords, drawn.coords) and np.array_equal(plain.hexes, drawn.hexes)


@pytest.mark.parametrize("changes", [CLAMPED, HAT_CLAMPED], ids=["cup", "hat"])
def test_elements_of_a_clamped_end_lie_where_it_bends(changes: Changes) -> None:
    """Those in the clamped ring left one in the flange of the silk hat: its tooth roots had 10 %
    too much."""
    recipe = load_recipe("forces").cup
    case = shaped(changes)
    lines = meridian(case.geometry.cup, recipe)
    radius = lines.inner[lines.end :, 0]
    begin, clamped = radius[0], case.cup.clamping_radius
    assert len(radius) == recipe.closed_end + 2 and radius[-2] == pytest.approx(clamped)
    assert radius[-1] == pytest.approx(case.cup.edge)
    assert np.abs(np.diff(radius))[:-1].max() < 0.6 * abs(clamped - begin)


@pytest.mark.parametrize("length", [6.1, 11.0, 25.0])
@pytest.mark.parametrize("name", ["forces", "full"])
def test_elements_at_the_ends_of_a_long_wall_are_those_of_a_short_one(
    name: str, length: float
) -> None:
    """Four elements along 20 decay lengths left one of 4 of them behind the teeth: the largest
    stress there was off by 40 %."""
    recipe = load_recipe(name).cup
    short, long = (np.diff(cylinder_stations(of, recipe, 1.0, 0.0, 1)) for of in (LONG, length))
    assert long.sum() == pytest.approx(length)
    assert np.allclose(long, long[::-1])
    assert 0.4 * short[0] < long[0] <= short[0] * (1.0 + 1e-9)
    assert (long[1:] / long[:-1]).max() < GROWTH * (1.0 + 1e-9)
    assert long.max() <= length / LONG * short.max() * (1.0 + 1e-9)


@walls
def test_volume_behind_the_teeth_tends_to_that_of_the_solid_of_revolution(shape: str) -> None:
    case, recipe, errors = shaped(WALLS[shape]), load_recipe("full"), []
    for factor in (1, 2, 4):
        counts = {
            name: factor * getattr(recipe.cup, name)
            for name in ("cylinder", "fillet", "closed_end")
        }
        cup = recipe.cup.model_copy(update=counts | {"joined_columns": False})
        finer = recipe.model_copy(update={"cup": cup})
        mesh = build_sector(case.geometry, finer, "flexible_spline")
        behind = mesh.coords[mesh.hexes, 2].min(axis=1) > 0.5 * case.drive.face_width * (1.0 - 1e-9)
        volume = mesh.n_sectors * hex_volumes(mesh.coords, mesh.hexes[behind]).sum()
        errors.append(abs(volume / wall_volume(case) - 1.0))
        assert factor > 1 or mesh.quality["min_scaled_jacobian"] > 0.3
    # chords of arcs: quadratic, 16 times less; short ones have one or two elements at first
    less = {"cone": 8.0, "boss": 8.0, "ring": 6.0}.get(shape, 12.0)
    assert errors[0] < 6e-3 and errors[2] < 5e-4 and errors[2] < errors[0] / less, errors


@walls
def test_surfaces_of_the_mesh_are_those_of_the_drawing(shape: str) -> None:
    """Every corner of the contour is a node; the last nodes are those of the bore, or of the rim of
    the flange."""
    case = shaped(WALLS[shape])
    mesh, end = spline(case, "medium"), case.cup_sizes.wall.farthest
    radius, z = np.hypot(*mesh.coords[:, :2].T), mesh.coords[:, 2]
    assert radius[mesh.node_sets["bore"]] == pytest.approx(case.cup.edge, rel=1e-12)
    assert z.max() == pytest.approx(end)
    for point in case.cup.contour:
        if point.rounding == 0.0 and point.thickness:
            at = np.abs(z - 0.5 * case.drive.face_width - point.distance) < 1e-9
            assert radius[at].min() == pytest.approx(point.radius or case.inner_radius, rel=1e-12)
            assert np.ptp(radius[at]) == pytest.approx(point.thickness, rel=1e-9)
    for corner in case.cup.end_contour:
        if corner.rounding == 0.0:
            far = corner.distance or case.cup.length
            near = corner.near_distance or far - corner.thickness
            for r, distance in ((corner.radius, far), (corner.near_radius or corner.radius, near)):
                off = np.hypot(radius - r, z - 0.5 * case.drive.face_width - distance)
                assert off.min() < 1e-9


@pytest.mark.parametrize("recipe", ["coarse", "medium", "full"])
def test_teeth_may_end_shortly_before_the_closed_end(recipe: str) -> None:
    """0.2 modules of wall: its elements are fewer, and none is folded."""
    case = shaped(SHORT_WALL)
    assert case.cup_sizes.wall_length == pytest.approx(0.2)
    mesh = spline(case, recipe)
    assert mesh.quality["min_scaled_jacobian"] > 0.1
    lines = meridian(case.geometry.cup, load_recipe(recipe).cup)
    # at most five elements of a quarter of the thickness
    assert lines.wall <= 5


def test_corners_of_a_cone_are_nodes_and_its_wall_is_as_thick_as_the_cylinders() -> None:
    case = shaped(cone(79.0))
    mesh, back = spline(case, "coarse"), 0.5 * case.drive.face_width
    places = np.column_stack([mesh.coords[:, 2] - back, np.hypot(*mesh.coords[:, :2].T)])
    for point in case.cup.contour[:2]:
        for corner in (
            (point.distance, point.radius),
            (point.outer_distance, point.outer_radius),
        ):
            assert np.linalg.norm(places - corner, axis=1).min() < 1e-9
    assert thicknesses(case.cup_sizes.points) == pytest.approx([0.48] * 4)
    assert mesh.quality["min_scaled_jacobian"] > 0.3


@pytest.mark.parametrize("degrees", [45.0, 79.0])
def test_torsion_of_a_steep_cone(degrees: float) -> None:
    """The angle is the integral of T / (2 pi r³ t G) along the middle of the wall, less what
    corners shorten the way of the shear flow: by 0.44 t at most, that of a corner of 90 degrees."""
    changes = cone(degrees)
    # nodes where the wall begins to be thinner
    ends = [
        {"distance": at, "radius": 13.6, "thickness": t} for at, t in ((10.0, 0.48), (10.8, 0.46))
    ]
    case = shaped(changes | {"contour": [*changes["contour"], *ends]})
    recipe = load_recipe("full")
    fine = recipe.cup.model_copy(update={"cylinder": 4 * recipe.cup.cylinder})
    mesh = build_sector(case.geometry, recipe.model_copy(update={"cup": fine}), "flexible_spline")
    back, thickness = 0.5 * case.drive.face_width, 0.48
    points = case.cup_sizes.points[:4]
    middle = np.array(
        [[0.5 * (p.distance + p.outer_distance), 0.5 * (p.radius + p.outer_radius)] for p in points]
    )
    share, way = np.linspace(0.0, 1.0, 2001), 0.0
    for begin, stop in zip(middle[:-1], middle[1:], strict=True):
        radius = begin[1] + share * (stop[1] - begin[1])
        way += float(np.linalg.norm(stop - begin) * trapezoid(radius**-3.0, share))
    shorter = 0.44 * thickness * float((middle[1:3, 1] ** -3.0).sum())
    shear = 0.5 * 210e3 / 1.29
    exact = 2.0 * np.pi * thickness * shear / way
    found = torsional_stiffness(mesh, case, back, back + 10.0)
    print(f"{degrees} degrees: torsional stiffness over the integral {found / exact:.5f}")
    assert 1.0 < found / exact < 1.002 * way / (way - shorter)


def test_rounded_corners_are_arcs_that_are_tangent_to_both_sides() -> None:
    line = RoundedLine(
        np.array([[0.0, 5.0], [3.0, 5.0], [6.0, 7.0], [9.0, 6.0]]), np.array([0.0, 2.0, 1.5, 0.0])
    )
    assert np.sign(line.turning()).tolist() == [1.0, -1.0]
    for arc, radius, before, after in zip(
        line.arcs(), (2.0, 1.5), (0.0, 2.0 / 3.0), (2.0 / 3.0, -1.0 / 3.0)
    ):
        s = np.linspace(arc.start[0], arc.end[0], 101)
        r = line.radius(s)
        assert np.hypot(s - arc.center[0], r - arc.center[1]) == pytest.approx(radius, rel=1e-12)
        for at, slope in ((arc.start[0], before), (arc.end[0], after)):
            near = line.radius(at + np.array([-1e-5, 1e-5]))
            assert np.diff(near)[0] / 2e-5 == pytest.approx(slope, abs=1e-4)


@walls
def test_counts_are_those_of_the_model(shape: str) -> None:
    case, recipe = shaped(WALLS[shape]), load_recipe(RECIPE)
    found = forecast(case, recipe)
    model = build_drive_model(case, recipe, comm=MPI.COMM_SELF)
    counts = model.counts().values()
    assert (found.elements, found.unknowns) == (
        model.n_elements(),
        sum(count["dofs"] for count in counts),
    )
    model.destroy()


@walls
def test_torques_balance(shape: str) -> None:
    _, row = loaded(shaped(WALLS[shape]), MPI.COMM_SELF)
    total = row["wg_torque_Nmm"] + row["tooth_torque_Nmm"] + row["output_torque_Nmm"]
    assert row["output_torque_Nmm"] == pytest.approx(2000.0) and abs(total) < 2e-3
    assert row["pairs_in_contact"] > 0


@shapes
def test_the_bent_start_is_continuous_where_the_plate_begins(shape: str) -> None:
    """The plate has the wall's deflection; the shape has no jump larger than its slope explains."""
    case = shaped(SHAPES[shape])
    bent, lines = BentSpline(case), meridian(case.geometry.cup, load_recipe("full").cup)
    path = 0.5 * (lines.inner + lines.outer)
    dense = np.concatenate([np.linspace(a, b, 50) for a, b in zip(path[:-1], path[1:])])
    moved = bent.displacement(np.column_stack([0.0 * dense[:, 0], dense]))
    step = np.linalg.norm(np.diff(moved, axis=0), axis=1)
    assert step.max() < 0.1 * 0.5 * case.deflection
    assert np.abs(moved[-1]).max() < 0.5 * case.deflection


def point(**keys: float) -> Changes:
    """A contour whose second point has these keys."""
    return {"contour": [{"distance": 2.0, "thickness": 0.48}, keys]}


def test_corners_that_are_close_to_each_other_are_in_the_mesh() -> None:
    """A thick ring that begins and ends within a third of a millimetre keeps its thickness."""
    corners = [(3.0, 0.4), (3.3, 0.7), (6.0, 0.7), (6.3, 0.4)]
    contour = [{"distance": distance, "thickness": thickness} for distance, thickness in corners]
    case = shaped({"contour": contour})
    for name in ("coarse", "medium"):
        lines = meridian(case.geometry.cup, load_recipe(name).cup)
        distance = lines.outer[:, 1] - 0.5 * case.drive.face_width
        thickness = np.hypot(*(lines.outer - lines.inner).T)
        for at, expected in corners:
            k = int(np.abs(distance - at).argmin())
            assert distance[k] == pytest.approx(at) and thickness[k] == pytest.approx(expected), (
                name,
                at,
            )


def corner(**keys: float) -> Changes:
    """A contour whose second point has a corner outside with these keys."""
    return point(**{"distance": 4.0, "radius": 17.0, "outer_radius": 17.48, **keys})


REFUSED = [
    (point(distance=4.0), "cup.contour.2.thickness is missing", "without outer_radius"),
    (corner(thickness=0.4), "cup.contour.2.thickness = 0.4 ", "only without outer_radius"),
    (
        point(distance=4.0, thickness=0.4, outer_distance=4.1),
        "cup.contour.2.outer_distance = 4.1 ",
        "only with outer_radius",
    ),
    (corner(radius=6.0), "cup.contour.2.radius = 6 ", "no steeper than 80 degrees"),
    (corner(outer_distance=1.9), "cup.contour.2.outer_distance = 1.9 ", "to 10 mm"),
    (corner(outer_radius=32.0), "cup.contour.2.outer_radius = 32 ", "no steeper than 80"),
    (corner(outer_radius=17.01), "cup.contour.2.outer_radius = 17.01 ", "a corner 0.06 mm"),
    (corner(radius=14.0, outer_radius=14.48), "cup.contour.2: the line between", "up to 50"),
    (
        point(distance=1.0, thickness=0.4),
        "cup.contour.2.distance = 1 ",
        "2.06 (0.1 rims behind the point before) to",
    ),
    (point(distance=11.0, thickness=0.4), "cup.contour.2.distance = 11 ", "to 10 mm (the fillet)"),
    (point(distance=4.0, thickness=0.03), "cup.contour.2.thickness = 0.03 ", "0.06 to 2.48 mm"),
    (point(distance=3.0, thickness=1.6), "cup.contour.2.thickness = 1.6 ", "0.06 to 1.48 mm"),
    (
        point(distance=3.0, thickness=0.4, radius=16.0),
        "cup.contour.2.radius = 16 ",
        "17.6 to 19.6 mm",
    ),
    (
        point(distance=3.0, thickness=0.4, rounding=90.0),
        "cup.contour.2.rounding = 90 ",
        "half of the shorter side",
    ),
    (
        {"end_thickness": 2.5},
        "cup.end_thickness = 2.5 ",
        "0.06 (0.1 rims) to 1.90476 mm (cup.fillet_radius",
    ),
    (
        {"fillet_radius": 0.48},
        "cup.fillet_radius = 0.48 ",
        "0.504 mm (1.05 times the cup's thickness) and more",
    ),
    ({"shape": "hat"}, "cup.inner_radius = 6 is not available", 'cup.shape = "cup"'),
    (
        HAT | {"flange_radius": None},
        "cup.flange_radius is missing",
        'needed with cup.shape = "hat"',
    ),
    ({"inner_radius": None}, "cup.inner_radius is missing", 'needed with cup.shape = "cup"'),
    (HAT | {"flange_radius": 20.0}, "cup.flange_radius = 20 ", "above 20.6 mm"),
    (
        {"fillet_radius": 0.0, "inside_radius": 0.05},
        "cup.inside_radius = 0.05 ",
        "0.096 mm (0.2 times the thinner of wall and end) and more",
    ),
    (
        {"fillet_radius": 1.0, "inside_radius": 0.4},
        "cup.fillet_radius = 1 ",
        "0 to 0.88 mm (cup.inside_radius and the thinner of wall and end)",
    ),
    ({"fillet_radius": 0.0}, "cup.fillet_radius = 0 ", "0.504 mm (1.05 times the cup's thickness)"),
    (
        {"fillet_radius": 0.0, "inside_radius": 1.0, "end_thickness": 11.5},
        "cup.length = 12 ",
        "12.7 mm and more (0.2 modules, end_thickness and inside_radius): teeth end before",
    ),
]


def assert_refused(changes: Changes, key: str, words: str) -> None:
    """The small drive with these keys of the cup is refused in a sentence that begins with the
    key."""
    with pytest.raises(InputError) as refusal:
        shaped(changes)
    assert str(refusal.value).startswith(key) and words in str(refusal.value), str(refusal.value)


@pytest.mark.parametrize(("changes", "key", "words"), REFUSED)
def test_what_does_not_fit_is_refused_in_one_sentence(
    changes: Changes, key: str, words: str
) -> None:
    assert_refused(changes, key, words)


def test_a_contour_that_slopes_from_the_teeth_on_leaves_no_room_for_a_fillet_there() -> None:
    with pytest.raises(
        InputError, match=r"cup.back_fillet = 0.1 is .*as far as cup.contour is straight"
    ):
        shaped({"contour": [{"distance": 4.0, "thickness": 0.4}], "back_fillet": 0.1})


def torsional_stiffness(mesh: SectorMesh, case: DriveDesign, begin: float, end: float) -> float:
    """Torque over angle (N mm / rad) of the wall between two planes z (mm) that rotate rigidly, of
    small rotations."""
    z = mesh.coords[:, 2]
    used = (z[mesh.hexes].min(axis=1) > begin - 1e-6) & (z[mesh.hexes].max(axis=1) < end + 1e-6)
    at = np.where(np.abs(z - begin) < 1e-6, 0.0, np.where(np.abs(z - end) < 1e-6, 1.0, np.nan))
    return stiffness_between(mesh, case.material, used, at, TANGENTIAL)


@pytest.mark.parametrize("shape", ["straight", "thicker", "conical"])
def test_torsion_of_a_wall_of_varying_thickness(shape: str) -> None:
    """The angle is that of the integral of T / (G J) along the wall; where it is a cone, of its
    sections."""
    changes = {
        "straight": {
            "contour": [{"distance": 5.0, "thickness": 0.48}, {"distance": 9.0, "thickness": 0.3}]
        },
        "thicker": {
            "contour": [{"distance": 1.0, "thickness": 0.48}, {"distance": 9.0, "thickness": 0.9}]
        },
        "conical": {
            "contour": [
                {"distance": 1.0, "thickness": 0.48},
                {"distance": 9.0, "thickness": 0.9, "radius": 18},
            ]
        },
    }[shape]
    begin, end = {"straight": (0.0, 5.0), "thicker": (1.0, 9.0), "conical": (1.0, 9.0)}[shape]
    case = shaped(changes)
    mesh, back = spline(case), 0.5 * case.drive.face_width
    s = np.linspace(begin, end, 2001)
    (inner, outer), shear = (
        (line.radius(s) for line in (case.cup_sizes.wall.inner, case.cup_sizes.wall.outer)),
        0.5 * 210e3 / 1.29,
    )
    exact = shear / trapezoid(2.0 / np.pi / (outer**4 - inner**4), s)
    found = torsional_stiffness(mesh, case, back + begin, back + end)
    print(f"{shape}: torsional stiffness over the integral {found / exact:.5f}")
    assert found == pytest.approx(exact, rel=5e-3 if shape == "conical" else 2e-3)


def test_the_silk_hat_of_the_drivers_runs(tmp_path: Path) -> None:
    """One period without fields and figures on the smallest mesh: the mean input torque is that of
    the energy."""
    overrides = {"output.fields": False, "output.figures": False, "output.root_stress": False}
    case = swgpar.load_design(DRIVERS / "silk_hat.toml").with_values(overrides)
    result = swgpar.run(case, RECIPE, tmp_path / "run")
    mean = float(np.mean(result.history["wg_torque_Nmm"]))
    assert mean == pytest.approx(1000.0 * case.load.torque / 50.0, rel=0.01)
    page = (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    assert (
        "flange r 34" in page
        and "clamped r 29" in page
        and "wall 0.4 / 0.55, flange 0.8, fillet r 1" in page
    )


@pytest.mark.parametrize("shape", ["short", "hat"])
def test_starters_of_other_shapes(shape: str) -> None:
    case = swgpar.new(ratio=100.0, diameter=50.8, torque=20.0, shape=shape)
    assert case.cup.shape == ("hat" if shape == "hat" else "cup")
    usual = swgpar.new(ratio=100.0, diameter=50.8, torque=20.0)
    assert case.cup.length == pytest.approx(
        (0.5 if shape == "short" else 1.0) * usual.cup.length, rel=1e-3
    )
    with pytest.raises(InputError, match='shape = "hat" is not available with model = "plane"'):
        swgpar.new(ratio=100.0, diameter=50.8, torque=20.0, shape="hat", model="plane")


ATTACHED = bolted(8)
BAD_ATTACHMENTS = [
    (
        {"clamping_radius": 8.0},
        "cup.clamping_radius = 8 is not available",
        'cup.attachment = "clamped"',
    ),
    (
        {"attachment": "clamped"},
        "cup.clamping_radius is missing",
        'needed with cup.attachment = "clamped"',
    ),
    (CLAMPED | {"clamping_radius": 18.0}, "cup.clamping_radius = 18 ", "6 to 17.08 mm"),
    (
        CLAMPED | {"clamping_radius": 6.0},
        "cup.clamping_radius = 6 ",
        "0.048 mm or more from its edge",
    ),
    (
        CLAMPED | {"clamping_radius": 6.01},
        "cup.clamping_radius = 6.01 ",
        "0.048 mm or more from its edge",
    ),
    (ATTACHED | {"bolt_circle": 13.0}, "cup.bolt_circle = 13 ", "14 to 32.16 mm"),
    (ATTACHED | {"washer_diameter": 12.0}, "cup.washer_diameter = 12 ", "0.048 to 11.08 mm"),
    (ATTACHED | {"washer_diameter": 0.01}, "cup.washer_diameter = 0.01 ", "0.048 to 11.08 mm"),
    (ATTACHED | {"bolts": 40}, "cup.bolts = 40 ", "3 to 31 (washers beside each other)"),
]


@pytest.mark.parametrize(("changes", "key", "words"), BAD_ATTACHMENTS)
def test_attachments_that_do_not_fit_are_refused(changes: Changes, key: str, words: str) -> None:
    assert_refused(changes, key, words)


@pytest.mark.parametrize(
    ("bolts", "pitches", "repeats"), [(8, 5, 1), (9, 40, 2), (12, 10, 1), (25, 8, 2), (40, 1, 1)]
)
def test_the_period_of_teeth_and_bolts(bolts: int, pitches: int, repeats: int) -> None:
    """40 teeth; an odd number of bolts is the same after half a turn of two lobes."""
    kinematics, alike = shaped(bolted(bolts, 1.0)).kinematics, shaped(CLAMPED).kinematics
    assert (kinematics.pitches, kinematics.repeats(0)) == (pitches, repeats)
    assert kinematics.period_angle == pytest.approx(pitches * alike.period_angle)
    assert kinematics.pitch_angle == alike.pitch_angle == alike.period_angle


@pytest.mark.parametrize("override", ["steps.samples=10", "stiffness.positions=5"])
def test_angles_show_different_places_of_a_tooth(override: str) -> None:
    with pytest.raises(InputError, match="without a common divisor with 5, the pitches in a"):
        shaped(bolted(8), "steps.rotation=45.0", override)
    shaped(bolted(8), "steps.rotation=45.0", "steps.samples=6")
    shaped(bolted(40, 1.0), "steps.rotation=45.0", "steps.samples=10")


@pytest.mark.parametrize("override", ["fatigue.size_factor=1.0", "losses.loss_factor=0.001"])
def test_a_stress_cycle_has_a_value_at_every_pitch(override: str) -> None:
    with pytest.raises(InputError, match="steps.samples = 4 is out of range: allowed 5 and more"):
        shaped(bolted(8), "steps.rotation=45.0", "steps.samples=4", override)


def test_a_period_of_teeth_and_bolts_is_covered() -> None:
    """Five pitches of 360 / 42 degrees."""
    with pytest.raises(InputError, match="42.8571 deg"):
        shaped(bolted(8), "steps.rotation=42.0", "steps.samples=4")


def test_an_accuracy_chooses_no_angles_with_bolts() -> None:
    """Few angles do not show the period of teeth and bolts; with a bolt for every tooth it is a
    pitch."""
    require_refinable(shaped(bolted(8)), 0.01)
    for bolts, samples in ((8, 0), (40, 4)):
        design = shaped(bolted(bolts, 1.0), "steps.rotation=45.0")
        assert with_accuracy(design, 0.02).steps.samples == samples


@pytest.mark.parametrize("closed_end", [1, 4, 9])
@pytest.mark.parametrize("changes", [bolted(8), HAT | bolted(10, 3.0) | {"bolt_circle": 47.0}])
def test_elements_end_at_the_washers(changes: Changes, closed_end: int) -> None:
    """Nodes on both edges of their ring and between; more elements elsewhere with more of them."""
    cup = shaped(changes).geometry.cup
    recipe = load_recipe(RECIPE).cup.model_copy(update={"closed_end": closed_end})
    lines = meridian(cup, recipe)
    radii, (low, high) = lines.inner[lines.end :, 0], cup.attached_ring
    assert all(np.abs(radii - edge).min() < 1e-9 for edge in (low, high))
    assert np.sum((radii > low + 1e-9) & (radii < high - 1e-9)) >= 1
    assert radii[-1] == cup.wall.edge and np.all(np.diff(radii) * (radii[-1] - radii[0]) > 0.0)
    assert len(radii) - 1 == pytest.approx(max(closed_end, 4), abs=1)


def test_check_shows_the_period() -> None:
    assert derived_geometry(shaped(bolted(8)))["period of teeth and bolts (pitches)"] == 5


PERIOD = ("steps.samples=6", "steps.rotation=45.0")
BEARING = '{"balls": 20, "race_thickness": 0.5, "ball_diameter": 2.0}'


@pytest.mark.parametrize(
    "overrides",
    [
        (*PERIOD, "fatigue.size_factor=1.0"),
        (*PERIOD, "losses.loss_factor=0.001"),
        (*PERIOD, 'drive.layout="spline_fixed"'),
        (*PERIOD, 'drive.layout="wave_generator_fixed"'),
        ("output.root_stress=true",),
        ("stiffness.positions=3",),
        ("ratcheting.increment=0.1",),
        ("material.density=7850.0", "frequencies.number=4"),
        ("micro_geometry.wg_slope=0.0", f"wave_generator.bearing={BEARING}"),
        ("contact.friction=0.1",),
        ('deviations.ring_gear={"eccentricity": 0.01}',),
        ("material.expansion=12e-6", "flexible_spline.temperature=60.0"),
        (
            "output_bearing.radial_stiffness=1e5",
            "output_bearing.axial_stiffness=1e5",
            "output_bearing.tilting_stiffness=1e8",
        ),
    ],
    ids=lambda overrides: overrides[-1].split("=")[0],
)
def test_what_goes_with_bolts(overrides: tuple[str, ...]) -> None:
    assert shaped(bolted(8), *overrides).kinematics.pitches == 5


@pytest.mark.parametrize(("washer", "warned"), [(0.1, True), (6.0, False)])
def test_elements_wider_than_a_washer_are_warned_of(
    washer: float, warned: bool, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level("WARNING"):
        design, recipe = shaped(bolted(4, washer)), load_recipe(RECIPE)
        build_drive_model(design, recipe, comm=MPI.COMM_SELF).destroy()
    assert (f"a washer is {washer:g} mm wide" in caplog.text) == warned
    assert len(caplog.records) == warned
