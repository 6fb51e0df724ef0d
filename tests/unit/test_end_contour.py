"""Contours of closed end and flange: thin diaphragms, hubs, steps to the ring of the bolts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_bvp, trapezoid

from support.cup_shapes import (
    BOSS,
    DIAPHRAGM,
    DISHED,
    HAT,
    RING,
    Changes,
    bolted,
    shaped,
)
from support.sector_motion import AXIAL, TANGENTIAL, stiffness_between
from swgpar.checks.derived_geometry import derived_geometry
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.exchange.dxf import write_dxf
from swgpar.exchange.points import write_points
from swgpar.meshing import load_recipe
from swgpar.meshing.tooth_sector import build_sector
from swgpar.meshing.wall_sector import WallCounts, wall_sector

FLAT = [{"radius": 12.0, "thickness": 0.48, "rounding": 1.0}, {"radius": 9.0, "thickness": 0.48}]
HAT_FLAT = [{"radius": 23.0, "distance": 12.0, "thickness": 0.8, "rounding": 1.0}]


@pytest.mark.parametrize(
    "changes, contour",
    [
        ({}, FLAT),
        (bolted(8), FLAT),
        ({"attachment": "clamped", "clamping_radius": 10.0}, FLAT),
        (HAT, HAT_FLAT),
    ],
    ids=["cup", "bolts", "clamped", "hat"],
)
def test_a_contour_that_is_flat_changes_no_bit_of_the_meshes(
    changes: Changes, contour: list[dict[str, float]]
) -> None:
    plain, drawn = shaped(changes), shaped(changes | {"end_contour": contour})
    for name in ("coarse", "full"):
        one, other = (
            build_sector(case.geometry, load_recipe(name), "flexible_spline")
            for case in (plain, drawn)
        )
        assert np.array_equal(one.coords, other.coords) and np.array_equal(one.hexes, other.hexes)
    one, other = (wall_sector(each.geometry, WallCounts(4, 2), 0.3).mesh for each in (plain, drawn))
    assert np.array_equal(one.coords, other.coords) and np.array_equal(one.hexes, other.hexes)


def files(path: Path) -> Changes:
    """Keys that read both faces from a DXF file."""
    return {
        f"end_{side}_{key}": value
        for side in ("far", "near")
        for key, value in (("file", str(path)), ("layer", f"end_{side}"))
    }


@pytest.mark.parametrize("changes", [DIAPHRAGM, BOSS, DISHED, RING, {}])
def test_there_and_back(changes: Changes, tmp_path: Path) -> None:
    """Export and import of wall.dxf, and of its tables: the same faces."""
    case = shaped(changes)
    path = write_dxf(case, tmp_path)[-1]
    again = shaped({**changes, "end_contour": None, **files(path)})
    plates = [each.cup_sizes.wall.plate for each in (case, again)]
    for side in ("inner", "outer"):
        lines = [getattr(plate, side) for plate in plates]
        way = np.linspace(0.0, lines[0].points[-1, 0], 801)
        assert lines[1].radius(way) == pytest.approx(lines[0].radius(way), abs=1e-9)
        assert len(lines[1].arcs()) == len(lines[0].arcs())
    assert again.cup.end_far_file is None and again.cup.end_contour
    write_points(case, tmp_path)
    names = ("end_far", "end_near")
    tables = {f"{name}_file": str(tmp_path / f"wall_{name}.csv") for name in names}
    by_table = shaped({**changes, "end_contour": None, **tables}).cup.end_contour
    for one, other in zip(by_table, again.cup.end_contour, strict=True):
        assert one.model_dump() == pytest.approx(other.model_dump(), abs=1e-8)
    meshes = [
        build_sector(each.geometry, load_recipe("medium"), "flexible_spline")
        for each in (case, again)
    ]
    assert meshes[1].coords == pytest.approx(meshes[0].coords, abs=1e-7)


def test_corners_of_csv_files(tmp_path: Path) -> None:
    """As many corners or not; in the order of the radii."""
    far, near = tmp_path / "far.csv", tmp_path / "near.csv"
    far.write_text("12,6\n12,14\n", encoding="utf-8")
    near.write_text("distance,radius\n11.6,14\n11.6,12\n10.4,10\n10.4,6\n", encoding="utf-8")
    case = shaped({"end_far_file": str(far), "end_near_file": str(near)})
    assert [point.radius for point in case.cup.end_contour] == [14.0, 12.0, 10.0, 6.0]
    wall = case.cup_sizes.wall
    found = [wall.thickness_at(radius) for radius in (14.0, 13.0, 11.0, 7.0)]
    assert found == pytest.approx([0.4, 0.4, 1.0, 1.6])


def test_files_that_do_not_begin_at_the_fillet_with_its_thickness_are_refused(
    tmp_path: Path,
) -> None:
    path = write_dxf(shaped(DIAPHRAGM), tmp_path)[-1]
    with pytest.raises(InputError) as refusal:
        shaped({**DIAPHRAGM, "end_contour": None, "end_thickness": 0.5, **files(path)})
    assert str(refusal.value) == (
        "cup.end_contour.1.near_distance = 11.2 is out of range: allowed 11.5 mm (cup.length less "
        "cup.end_thickness) where the fillet ends"
    )


def end(*points: dict[str, float], **keys: float | str) -> Changes:
    """A closed end with these points and keys."""
    return {"end_contour": list(points), **keys}


HUB = end({"radius": 14.0, "thickness": 0.48}, {"radius": 13.0, "thickness": 1.4})
WAIST = end(
    {"radius": 16.0, "thickness": 0.48},
    {"radius": 12.6, "distance": 10.0, "near_radius": 13.0, "near_distance": 9.6},
    length=20.0,
) | {
    "contour": [
        {"distance": 1.0, "thickness": 0.48},
        {"distance": 8.6, "radius": 11.0, "thickness": 0.48},
        {"distance": 16.2, "thickness": 0.48},
    ]
}
"""The end is a cone that reaches through the waist of the wall."""

REFUSED = [
    (end({"radius": 12.0}), "cup.end_contour.1.thickness is missing", "without near_distance"),
    (
        end({"radius": 12.0, "thickness": 0.4, "near_distance": 11.0}),
        "cup.end_contour.1.thickness = 0.4 ",
        "only without near_distance",
    ),
    (
        end({"radius": 12.0, "thickness": 0.4, "near_radius": 11.0}),
        "cup.end_contour.1.near_radius = 11 ",
        "only with near_distance",
    ),
    (
        end({"radius": 17.05, "thickness": 0.4}),
        "cup.end_contour.1.radius = 17.05 ",
        "17.02 (0.1 rims behind the point before) to 6 mm (the edge of the closed end)",
    ),
    (
        end({"radius": 5.0, "thickness": 0.4}),
        "cup.end_contour.1.radius = 5 ",
        "to 6 mm (the edge of the closed end)",
    ),
    (
        RING | end({"radius": 27.0, "thickness": 0.5}),
        "cup.end_contour.1.radius = 27 ",
        "20.66 (0.1 rims behind the point before) to 26 mm (the edge of the flange)",
    ),
    (
        end({"radius": 16.0, "thickness": 3.0}),
        "cup.end_contour.1.thickness = 3 ",
        "0.06 to 1.56 mm (no steeper than 45 degrees from 17.08 mm on, 80 with near_radius and "
        "near_distance, 0.1 rims)",
    ),
    (
        end({"radius": 16.0, "thickness": 0.4, "distance": 9.0}),
        "cup.end_contour.1.distance = 9 ",
        "10.92 to 13.08 mm",
    ),
    (
        end({"radius": 16.0, "distance": 12.0, "near_distance": 3.0}),
        "cup.end_contour.1.near_distance = 3 ",
        "no steeper than 80 degrees",
    ),
    (
        end({"radius": 16.0, "near_distance": 11.95}),
        "cup.end_contour.1.near_distance = 11.95 ",
        "a corner 0.06 mm (0.1 rims) or more from that on the far face",
    ),
    (
        end({"radius": 16.0, "distance": 16.0, "near_distance": 15.5}),
        "cup.end_contour.1: the line between",
        "square to the closed end beside it: allowed up to 50 degrees, by near_radius",
    ),
    (
        end({"radius": 12.0, "near_distance": 12.5}),
        "cup.end_contour.1: its corner of near_radius and near_distance ",
        "lies beyond that on the far face",
    ),
    (
        end({"radius": 16.0, "thickness": 0.6, "rounding": 90.0}),
        "cup.end_contour.1.rounding = 90 ",
        "half of the shorter side",
    ),
    (
        end({"radius": 8.0, "thickness": 4.5}, length=4.0),
        "cup.end_contour.1.thickness = 4.5 ",
        "a near face behind the teeth, where this one is 0.5 mm in front of their back",
    ),
    (
        HUB | {"contour": [{"distance": 6.0, "radius": 13.6, "thickness": 0.48}]},
        "cup.end_contour.1.radius = 14 ",
        "12.02 (0.1 rims behind the point before) to 6 mm",
    ),
    (
        WAIST,
        "cup.end_contour.2.near_distance = 9.6 ",
        "a near face that does not meet the wall",
    ),
    (HUB | bolted(8) | {"bolt_circle": 27.0}, "cup.bolt_circle = 27 ", "washers on a part of the"),
    (
        HUB | bolted(8) | {"bolt_circle": 12.5},
        "cup.bolt_circle = 12.5 ",
        "14 to 24 or 30 to 32.16 mm",
    ),
    (
        end({"radius": 6.0, "thickness": 1.4}) | bolted(8),
        "cup.washer_diameter = 2 ",
        "0 mm (a part of the closed end whose faces are both flat)",
    ),
    (
        HUB | {"attachment": "clamped", "clamping_radius": 18.0},
        "cup.clamping_radius = 18 ",
        "6 to 17.08 mm (a face of the closed end that is flat as far as its edge)",
    ),
    (
        end({"radius": 10.0, "thickness": 1.4}, {"radius": 6.0, "thickness": 1.2, "distance": 12.1})
        | {"attachment": "clamped", "clamping_radius": 9.0},
        "cup.clamping_radius = 9 ",
        "only with a face of the closed end that is flat as far as its edge",
    ),
]


@pytest.mark.parametrize(("changes", "key", "words"), REFUSED)
def test_what_does_not_fit_is_refused_in_one_sentence(
    changes: Changes, key: str, words: str
) -> None:
    with pytest.raises(InputError) as refusal:
        shaped(changes)
    print(refusal.value)
    assert str(refusal.value).startswith(key) and words in str(refusal.value), str(refusal.value)


def plate_stiffness(case: DriveDesign, component: int) -> float:
    """Of closed end or flange between the fillet and its edge, both rigid, on a fine mesh."""
    mesh = wall_sector(case.geometry, WallCounts(8, 6, 0.35), 0.3).mesh
    wall, radius = case.cup_sizes.wall, np.hypot(*mesh.coords[:, :2].T)
    on_plate = wall.is_on_plate(radius, mesh.coords[:, 2])
    begin = np.abs(radius - wall.center[0]) < 1e-9
    at = np.where(np.abs(radius - wall.edge) < 1e-9, 1.0, np.where(begin, 0.0, np.nan))
    used = (on_plate | begin)[mesh.hexes].all(axis=1)
    return stiffness_between(mesh, case.material, used, at, component)


def thickness(case: DriveDesign, radius: np.ndarray) -> np.ndarray:
    wall = case.cup_sizes.wall
    way, _ = wall.on_plate(radius, np.zeros_like(radius))
    found: np.ndarray = wall.plate.outer.radius(way) - wall.plate.inner.radius(way)
    return found


def symmetric(*points: tuple[float, float], begin: float) -> Changes:
    """Thicknesses at radii, half on each side of the middle."""
    corners = [
        {"radius": r, "thickness": t, "distance": 12.0 + 0.5 * (t - begin)} for r, t in points
    ]
    return {"end_thickness": begin, "end_contour": corners}


LINEAR = symmetric((6.0, 1.2), begin=0.4)
STEPPED = symmetric((14.0, 0.4), (10.0, 1.2), begin=0.4)


@pytest.mark.parametrize(
    ("changes", "less"),
    [
        ({}, 0.0),
        (LINEAR, 0.001),
        (STEPPED, 0.003),
        ({"end_thickness": 0.4} | end({"radius": 6.0, "thickness": 1.6}), 0.004),
        (DIAPHRAGM, 0.02),
        (RING, 0.025),
    ],
    ids=["flat", "linear", "stepped", "linear, one face", "diaphragm", "ring"],
)
def test_torsion_is_that_of_the_shear_flow(changes: Changes, less: float) -> None:
    """A shear stress T / (2 pi r² t): the rotation is the integral of T / (2 pi G r³ t).

    That takes cylinders to stay cylinders, which makes the end stiffer: for a slope of one face by
    a third of its square (6 degrees: 0.4 %), and outer corners of slopes of 31 and 45
    degrees, of diaphragm and ring, carry nothing. Chords around the axis add 2e-4.
    """
    case = shaped(changes)
    wall, shear = case.cup_sizes.wall, 0.5 * 210e3 / 1.29
    radius = np.linspace(*sorted((wall.center[0], wall.edge)), 4001)
    exact = 2.0 * np.pi * shear / trapezoid(1.0 / (radius**3 * thickness(case, radius)), radius)
    found = plate_stiffness(case, TANGENTIAL)
    print(f"torsional stiffness over that of the shear flow: {found / exact:.5f}")
    assert 1.0 - less - 3e-4 < found / exact < 1.0003


def bending_stiffness(case: DriveDesign) -> float:
    """Axial force over motion (N / mm) of an annular plate with the thicknesses of the closed end,
    clamped at both edges, by integration of the equations of a plate with shear:
    (r M_r)' = M_t - r Q with Q = P / (2 pi r), M_r = D (f' + nu f / r), w' = -f - Q / (5/6 G t)."""
    wall, modulus, nu = case.cup_sizes.wall, 210e3, 0.29
    inner, outer = wall.edge, wall.center[0]

    def slopes(r: np.ndarray, y: np.ndarray) -> np.ndarray:
        _, lean, moment = y
        t = thickness(case, r)
        rigidity, shear = modulus * t**3 / (12.0 * (1.0 - nu**2)), 1.0 / (2.0 * np.pi * r)
        around = nu * moment + rigidity * (1.0 - nu**2) * lean / r
        by_shear = shear * 1.2 * 2.0 * (1.0 + nu) / (modulus * t)
        return np.stack(
            [
                -lean - by_shear,
                moment / rigidity - nu * lean / r,
                (around - moment) / r - shear,
            ]
        )

    mesh = np.linspace(inner, outer, 101)
    solved = solve_bvp(
        slopes,
        lambda a, b: np.array([a[1], b[1], b[0]]),
        mesh,
        np.zeros((3, len(mesh))),
        tol=1e-6,
        max_nodes=20000,
    )
    assert solved.success
    return 1.0 / float(solved.y[0, 0])


@pytest.mark.parametrize(
    "changes",
    [
        {},
        symmetric((6.0, 1.2), begin=0.4),
        symmetric((13.0, 0.3), (9.0, 0.3), (7.0, 1.0), begin=0.6),
    ],
    ids=["flat", "linear", "diaphragm"],
)
def test_bending_is_that_of_a_plate_of_varying_thickness(changes: Changes) -> None:
    case = shaped(changes)
    found, exact = plate_stiffness(case, AXIAL), bending_stiffness(case)
    print(f"axial stiffness over that of the plate: {found / exact:.5f}")
    assert found == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize(
    ("changes", "calculix"),
    [({}, 1392.5), (DIAPHRAGM, 9007.0), (BOSS, 9178.4)],
    ids=["flat", "diaphragm", "boss"],
)
def test_axial_stiffness_is_that_of_calculix(changes: Changes, calculix: float) -> None:
    """CalculiX 2.20: 700 by 8 axisymmetric elements with eight nodes, arcs constructed anew. The
    mesh here is coarser than that, and stiffer."""
    found = plate_stiffness(shaped(changes), AXIAL)
    print(f"axial stiffness over that by CalculiX: {found / calculix:.5f}")
    assert 0.999 < found / calculix < 1.01


def test_check_shows_the_thinnest_place() -> None:
    assert derived_geometry(shaped(DIAPHRAGM))["thinnest place of the closed end (mm)"] == 0.4
    assert "thinnest place of the closed end (mm)" not in derived_geometry(shaped({}))


def test_washers_lie_on_a_flat_part() -> None:
    """The moment that tilts a washer is about the faces there."""
    case = shaped(HUB | bolted(8))
    assert case.cup_sizes.wall.faces_at(10.0) == pytest.approx((12.6, 14.0))
    shaped(HUB | {"attachment": "clamped", "clamping_radius": 12.0})
