"""Flanks from points: against the exact flanks they are sampled from, files and refusals."""

from __future__ import annotations

import tomllib
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, DRIVERS
from support.small_drive import PLANE
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.profiles import Teeth, ToothProfile, make_profile
from swgpar.profiles.from_points import FittedFlank, fitted_flank
from swgpar.profiles.keys import (
    DoubleArc,
    Points,
    QuadrupleArc,
    RackInvolute,
    ShaperInvolute,
    Trapezoid,
)

SPLINE = Teeth(120, 1.0, np.radians(20.0), 0.6, 0.8, True)
RING = Teeth(122, 1.0, np.radians(20.0), 0.6, 0.8, False)
ARCS = QuadrupleArc(r_tip=0.3, r_addendum=1.0, straight_l=0.2, r_dedendum=2.0, r_root=0.3)
FLANKS = {
    "double arc": (DoubleArc(r_addendum=1.0, r_dedendum=0.6), SPLINE),
    "double arc, ring": (DoubleArc(r_addendum=1.0, r_dedendum=0.6), RING),
    "quadruple arc": (ARCS, SPLINE),
    "rack": (RackInvolute(cutter_radius=0.2), SPLINE),
    "shaper": (ShaperInvolute(cutter_radius=0.2, cutter_teeth=80), RING),
    "trapezoid, ring": (Trapezoid(r_root=0.2), RING),
}


def exact(name: str) -> ToothProfile:
    keys, teeth = FLANKS[name]
    return make_profile(keys, teeth)


def pairs(points: np.ndarray) -> list[list[float]]:
    return np.column_stack([points.real, points.imag]).tolist()


def sampled(flank: ToothProfile, count: int) -> np.ndarray:
    return flank.point(np.linspace(0.0, flank.length, count)) @ (1.0, 1j)


def placed(flank: ToothProfile, what: str, count: int = 200) -> list[list[float]]:
    """Points of a flank, and of a space or a tooth anywhere."""
    z, half = sampled(flank, count), np.pi / flank.n_teeth
    if what == "space":
        z = np.exp(1.2j) * np.append(z, (-np.conj(z) * np.exp(-2j * half))[::-1])
    if what == "tooth":
        z = np.exp(-2.3j) * np.append((-np.conj(z))[::-1], z)
    return pairs(z)


def fitted(name: str, points: list[list[float]], **more: Any) -> FittedFlank:
    return fitted_flank(Points(points=points, **more), FLANKS[name][1], "gear.profile")


@pytest.mark.parametrize("name", FLANKS)
@pytest.mark.parametrize("what", ["flank", "space", "tooth", "backwards", "left"])
def test_200_points_give_the_flank_to_a_hundred_thousandth(name: str, what: str) -> None:
    """The largest error, 12 nm, is where the curvature jumps between two points."""
    flank = exact(name)
    points = placed(flank, what)
    if what == "backwards":
        points = points[::-1]
    if what == "left":
        points = [[-x, y] for x, y in points]
    found = fitted(name, points)
    distance, s = found.profile.distance(sampled_inside(flank))
    assert np.abs(distance).max() < 2e-5
    across = np.einsum("ij,ij->i", found.profile.normal(s), inner_tangents(flank))
    assert np.abs(across).max() < 6e-3 and np.median(np.abs(across)) < 1e-5
    assert found.deviation < 1e-12
    assert found.profile.root_start == pytest.approx(flank.root_start, abs=0.02)
    assert found.profile.thickness(0.5 * flank.n_teeth) == pytest.approx(
        flank.thickness(0.5 * flank.n_teeth), abs=1e-7
    )


def sampled_inside(flank: ToothProfile) -> np.ndarray:
    return flank.point(np.linspace(0.0, flank.length, 999)[5:-5])


def inner_tangents(flank: ToothProfile) -> np.ndarray:
    return flank.tangent(np.linspace(0.0, flank.length, 999)[5:-5])


def by_parts(flank: ToothProfile, count: int = 65) -> list[list[float]]:
    s = [np.linspace(begin, end, count) for begin, end in pairwise(flank.breaks)]
    return flank.point(np.unique(np.concatenate(s))).tolist()


@pytest.mark.parametrize("name", FLANKS)
def test_joints_make_it_exact(name: str) -> None:
    """Parts that join where arcs and lines do: the same points, curvatures and breaks."""
    flank = exact(name)
    joints = np.hypot(*flank.point(flank.breaks[1:-1]).T).tolist()
    found = fitted(name, by_parts(flank), joints=joints, rounded_tip=flank.tip_end > 0.0).profile
    assert found.breaks == pytest.approx(flank.breaks, abs=1e-8)
    s = np.concatenate([np.linspace(a, b, 40)[1:-1] for a, b in pairwise(flank.breaks)])
    assert found.point(s) == pytest.approx(flank.point(s), abs=1e-8)
    assert found.curvature(s) == pytest.approx(flank.curvature(s), abs=1e-3)
    assert (found.tip_end > 0.0) == (flank.tip_end > 0.0)


def test_estimates_of_the_error_follow_it() -> None:
    """The estimated error between points falls with their distance, as the true one does."""
    flank = exact("rack")
    for count, most in ((50, 1e-3), (200, 1e-4)):
        found = fitted("rack", pairs(sampled(flank, count)))
        error = np.abs(found.profile.distance(sampled_inside(flank))[0]).max()
        assert 0.1 * error < found.between < 20.0 * error and error < most


def test_corners_stay_corners() -> None:
    """A trapezoid of lines with a chamfer: straight pieces that meet at their points."""
    flank = exact("trapezoid, ring")
    root = flank.point(np.linspace(flank.root_start, flank.length, 30))
    top, low = flank.point([0.1, flank.root_start])
    edge = flank.point(0.0)[0] + (-0.08, 0.0)
    edge *= flank.r_tip_circle / np.hypot(*edge)
    points = [edge.tolist(), top.tolist(), low.tolist(), *root[1:].tolist()]
    found = fitted("trapezoid, ring", points)
    assert len(found.corners) == 1 and found.corners[0] == pytest.approx(np.hypot(*top))
    profile = found.profile
    at = profile.breaks[1]
    angle = profile.tangent([at - 1e-9, at + 1e-9])
    assert np.degrees(np.arccos(angle[0] @ angle[1])) > 20.0
    assert profile.distance(np.array([top]))[0] == pytest.approx(0.0, abs=1e-12)
    middle = 0.5 * (top + low)
    assert profile.distance(np.array([middle]))[0] == pytest.approx(0.0, abs=1e-9)


def test_scattered_points_need_a_tolerance() -> None:
    flank = exact("double arc")
    rng = np.random.default_rng(5)
    points = np.array(pairs(sampled(flank, 300))) + rng.normal(0.0, 2e-4, (300, 2))
    points = points[np.argsort(-np.hypot(*points.T))]
    with pytest.raises(InputError, match="scatter|cross|go back"):
        fitted("double arc", points.tolist())
    found = fitted("double arc", points.tolist(), tolerance=4e-4)
    assert 1e-4 < found.deviation < 3e-3
    # at the root points within the tolerance of the circle are taken for its land
    inside = flank.point(np.linspace(0.0, flank.length - 0.05, 500))
    assert np.abs(found.profile.distance(inside)[0]).max() < 4.0 * 4e-4


def refusal(points: Any, **more: Any) -> str:
    with pytest.raises(InputError) as caught:
        fitted("double arc", points, **more)
    return str(caught.value)


def test_refusals_have_the_place() -> None:
    flank = exact("double arc")
    good = pairs(sampled(flank, 40))
    swapped = [*good[:20], good[21], good[20], *good[22:]]
    assert "go back towards the tip at (0.8" in refusal(swapped)
    looped = [*good[:10], *good[20:24], *good[8:20], *good[25:]]
    assert "at (0." in refusal(looped) and "order" in refusal(looped)
    assert "are 3 different points" in refusal(good[:3])
    assert "points.2 has 3 numbers" in refusal([good[0], [1.0, 2.0, 3.0], *good[2:]])
    away = [[x + 1.0, y] for x, y in good]
    assert "degrees from the middle of the tooth at (" in refusal(away)
    shifted = [[x, y - 60.0] for x, y in good]
    assert "allowed" in refusal(shifted)
    space = np.array(placed(flank, "space"))
    space[300:] += 0.01
    assert "two flanks of the space that differ by 0.0" in refusal(space.tolist())
    two = placed(flank, "space") + (np.array(placed(flank, "space")) @ rotation(3.0)).tolist()
    assert "pass the middle of the tooth height" in refusal(two)
    assert "joints has 70 mm" in refusal(good, joints=[70.0])
    bare = [point for point in good if np.hypot(*point) > 60.0 - 0.2]
    assert "no fillet at the root" in refusal(bare)


def rotation(degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s], [s, c]])


def plane(**values: Any) -> DriveDesign:
    base = {"steps.rotation": 0.0, "load.torque": 3.0, "output.figures": False}
    base |= {"ring_gear.c_P": 0.98, "flexible_spline.c_l": 0.3, "ring_gear.c_l": 0.3}
    arcs = {"type": "double_arc", "r_addendum": 1.0, "r_dedendum": 0.5}
    base |= {"flexible_spline.profile": arcs, "ring_gear.profile": arcs, **values}
    return swgpar.load_design(DESIGN, list(PLANE)).with_values(base)


def from_points(design: DriveDesign, count: int) -> DriveDesign:
    """The design with the flanks of both gears from points."""
    values: dict[str, Any] = {}
    for gear in ("flexible_spline", "ring_gear"):
        points = pairs(sampled(design.profile(gear), count))
        values[f"{gear}.profile"] = {"type": "points", "points": points}
        values |= {f"{gear}.c_P": 1.0, f"{gear}.c_l": 0.5}
    return design.with_values(values)


FINE = {"tip": 2, "layers": 1, "flank": 10, "root": 6, "under": 3, "rim": 3}


def run(design: DriveDesign) -> tuple[float, float]:
    """Tension in a tooth root and largest pressure, MPa."""
    recipe = {"flexible_spline": FINE, "ring_gear": FINE}
    summary = swgpar.run(design, mesh=recipe, progress=False).summary
    return summary["largest.fs_s1"].value, summary["contact.pressure"].value


def test_a_drive_from_points_has_the_stresses_of_the_drive_from_arcs() -> None:
    """Root stress within 0.2 %, pressure within 1 % (2.4e-5 and 0.12 %)."""
    arcs = plane()
    (stress, pressure), (other, found) = run(arcs), run(from_points(arcs, 200))
    assert other == pytest.approx(stress, rel=2e-3)
    assert found == pytest.approx(pressure, rel=1e-2)


@pytest.mark.parametrize("kind", ["csv", "dxf"])
def test_exported_flanks_come_back(tmp_path: Path, kind: str) -> None:
    """Export, import, the same run to 1e-4."""
    pytest.importorskip("ezdxf")
    given = plane()
    paths = swgpar.export(given, tmp_path, ["teeth"])
    assert {path.name for path in paths} == {
        *(f"{gear}.{end}" for gear in ("flexible_spline", "ring_gear") for end in ("csv", "dxf")),
        "teeth.toml",
    }
    sections = tomllib.loads((tmp_path / "teeth.toml").read_text(encoding="utf-8"))
    values: dict[str, Any] = {}
    for gear, section in sections.items():
        profile = {**section["profile"], "file": str(tmp_path / f"{gear}.{kind}")}
        values |= {f"{gear}.profile": profile, f"{gear}.c_P": section["c_P"], f"{gear}.c_l": 0.5}
    again = given.with_values(values)
    assert again.flexible_spline.profile.file is None
    assert run(again) == pytest.approx(run(given), rel=1e-4)
    # what a result keeps needs no file
    for path in paths:
        path.unlink()
    kept = swgpar.load_design(again.model_dump(exclude_unset=True))
    assert kept.profile("ring_gear").breaks == pytest.approx(again.profile("ring_gear").breaks)


def test_the_example() -> None:
    """Teeth of the plane reference drive from the files of drivers/teeth."""
    path = DRIVERS / "teeth" / "from_points.toml"
    found, given = swgpar.load_design(path), swgpar.load_design(DRIVERS / "plane_half_turn.toml")
    for gear in ("flexible_spline", "ring_gear"):
        profile, flank = found.profile(gear), given.profile(gear)
        assert profile.r_tip_circle == pytest.approx(flank.r_tip_circle, abs=1e-8)
        assert profile.r_root_circle == pytest.approx(flank.r_root_circle, abs=1e-8)
    assert found.inner_radius == pytest.approx(given.inner_radius, abs=1e-8)
    lost = found.backlash - given.backlash
    assert lost == pytest.approx(0.01 * 0.5 * np.pi, abs=1e-5)


def test_heights_beside_points_are_refused() -> None:
    design = from_points(plane(), 100)
    with pytest.raises(InputError, match="ring_gear.addendum_coef = 0.5 .* set the height"):
        design.with_values({"ring_gear.addendum_coef": 0.5})
    with pytest.raises(InputError, match="that the pitch circle"):
        design.with_values({"ring_gear.profile.scale": 1.2})
