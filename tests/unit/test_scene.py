"""The view in a report: what it stores of fields and rigid bodies, and that a browser draws it."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, RECIPE, ROOT
from support.small_drive import PLANE, SHORT
from swgpar.presentation import scene as scene_module
from swgpar.presentation.drive_report import drive_report
from swgpar.presentation.scene import scene
from swgpar.presentation.scene_solids import RigidSolid, ball_solids, cam_solid, turned

BEARING = [
    "wave_generator.bearing.race_thickness=0.6",
    "wave_generator.bearing.balls=22",
    "wave_generator.bearing.ball_diameter=4.0",
]

CHROMIUM = shutil.which("chromium")


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> swgpar.DriveResult:
    out = tmp_path_factory.mktemp("scene") / "run"
    changes = [*PLANE, *SHORT, "output.figures=false", "output.fields=true"]
    return swgpar.run(swgpar.load_design(DESIGN, changes), RECIPE, out)


def _numbers(text: str, kind: str, width: int = 1) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), kind).reshape(-1, width)


def test_the_view_has_the_places_and_values_of_the_fields(result: swgpar.DriveResult) -> None:
    shown = scene(result)
    assert shown is not None and shown.increments == result.increments
    content = shown.content
    assert shown.bodies == ["flexible spline", "ring gear", "wave generator"]
    body, fields = content["bodies"][0], content["increments"][-1]["bodies"][0]
    one = _numbers(body["points"], "<f4", 3).astype(float)
    angle = 2.0 * np.pi * np.arange(body["sectors"]) / (body["sectors"] * body["copies"])
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x, y = c * one[:, 0] - s * one[:, 1], s * one[:, 0] + c * one[:, 1]
    places = np.stack([x, y, np.broadcast_to(one[:, 2], x.shape)], axis=2).reshape(-1, 3)
    points, _ = result.mesh()
    assert np.abs(places - points).max() < 1e-5  # float32 of some 60 mm
    shift = _numbers(fields["shifts"], "<i2", 3) * np.array(fields["reach"]) / 32767.0
    assert np.abs(shift - result.field("displacement")).max() <= max(fields["reach"]) / 65534.0
    for name, stored in zip(scene_module.COLOURED, fields["values"], strict=True):
        values = _numbers(stored["values"], "<u2")[:, 0] * stored["most"] / 65535.0
        exact = result.field(name)
        assert np.abs(values - exact).max() <= exact.max() / 1e5


def test_increments_that_do_not_fit_are_left_out(
    result: swgpar.DriveResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = scene(result)
    assert whole is not None and result.increments > 1
    size = len(json.dumps(whole.content["increments"][-1]["bodies"][:2]))
    monkeypatch.setattr(scene_module, "LARGEST", 1.2 * size)
    shown = scene(result)
    assert shown is not None and shown.increments == 1
    assert shown.left_out == result.increments - 1
    assert shown.content["increments"] == whole.content["increments"][-1:]
    monkeypatch.setattr(scene_module, "LARGEST", 0.5 * size)
    assert scene(result) is None


def _volume(solid: RigidSolid) -> float:
    """Of the pyramids between its surfaces and the points inside, mm³."""
    a, b, c = (solid.points[solid.triangles[:, k]] for k in range(3))
    inside = solid.points[np.tile(solid.middles, 2)]
    return (
        float(np.abs(np.einsum("ni,ni->n", a - inside, np.cross(b - inside, c - inside))).sum()) / 6
    )


def test_cam_and_balls_have_their_sizes_and_places() -> None:
    design = swgpar.load_design(DESIGN, PLANE)
    cam, width = cam_solid(design.rigid_parts), design.wave_generator.face_width
    x, y = design.cam().outline(3600).T
    area = 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    assert _volume(cam) == pytest.approx(area * width, rel=1e-3)
    tip = turned(cam, 0.5 * np.pi)[np.argmax(np.linalg.norm(cam.points[:, :2], axis=1))]
    assert abs(tip[0]) == pytest.approx(design.major_semi_axis, rel=1e-6)
    on_balls = swgpar.load_design(DESIGN, [*PLANE, *BEARING])
    balls = {"increment": np.full(22, 1), "cam_angle_deg": np.arange(22) * 360.0 / 22}
    solid = ball_solids(on_balls.rigid_parts, balls, 0)
    assert solid is not None and ball_solids(on_balls.rigid_parts, balls, 1) is None
    assert _volume(solid) == pytest.approx(22 * np.pi / 6.0 * 4.0**3, rel=0.05)  # 12 by 24 facets
    surface = np.unique(solid.quads)
    gap = on_balls.cam().evaluate(solid.points[surface, :2])[0]
    assert gap.max() == pytest.approx(-0.6, abs=0.02) and gap.min() == pytest.approx(-4.6, abs=0.02)
    inner = cam_solid(on_balls.rigid_parts)
    edge = np.unique(inner.quads[: len(inner.quads) // 3])
    assert np.abs(on_balls.cam().evaluate(inner.points[edge, :2])[0] + 4.6).max() < 1e-6


CUBES = """
const cells = new Uint32Array([0, 1, 2, 3, 4, 5, 6, 7]), n = [0.3, 0.5, 0.81];
const corners = [[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,1]];
const places = [...corners, ...corners.map(([x, y, z]) => [x + 1, y, z])];
const of = at => places.map(p => p[0] * n[0] + p[1] * n[1] + p[2] * n[2] - at);
const area = at => {
  const { ends, share } = cutCells(cells, 2, 8, of(at)), found = [];
  for (let k = 0; k < share.length; k++) {
    const a = places[ends[2 * k]], b = places[ends[2 * k + 1]];
    found.push(a.map((v, i) => v + share[k] * (b[i] - v)));
  }
  let sum = 0;
  for (let k = 0; k < found.length; k += 3) {
    const u = found[k + 1].map((v, i) => v - found[k][i]);
    const w = found[k + 2].map((v, i) => v - found[k][i]);
    sum += Math.hypot(u[1]*w[2] - u[2]*w[1], u[2]*w[0] - u[0]*w[2], u[0]*w[1] - u[1]*w[0]) / 2;
  }
  return sum;
};
document.body.textContent = JSON.stringify([0.05, 0.4, 0.9, 1.5, 3.0].map(area));
"""


def _opened(path: Path, profile: Path) -> str:
    """The page as Chromium has it after its scripts."""
    assert CHROMIUM is not None
    options = ["--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", "--dump-dom"]
    command = [CHROMIUM, *options, f"--user-data-dir={profile}", path.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=120).stdout


@pytest.mark.skipif(CHROMIUM is None, reason="needs chromium")
def test_a_browser_cuts_cells_and_draws_the_view(
    result: swgpar.DriveResult, tmp_path: Path
) -> None:
    source = (ROOT / "swgpar" / "presentation" / "section_cut.js").read_text()
    page = tmp_path / "cut.html"
    page.write_text(f"<html><body><script>{source}{CUBES}</script></body></html>")
    found = re.search(r"<body>(\[.*?\])</body>", _opened(page, tmp_path / "profile"))
    assert found is not None
    assert json.loads(found[1]) == pytest.approx([_area(at) for at in (0.05, 0.4, 0.9, 1.5, 3.0)])
    report = tmp_path / "report.html"
    report.write_bytes(drive_report(result))
    drawn = _opened(report, tmp_path / "profile")
    number, angle = result.field_increments[-1], result.history["wg_angle_deg"][-1]
    assert f">increment {number}, wave generator at {angle:.4g}°</span>" in drawn
    assert re.search(r'class="limit">[\d.]+ and more<', drawn)


def _area(at: float) -> float:
    """Of the plane n x = at in the box (2, 1, 1): |n| times the slope of the volume below it."""
    normal: Any = np.array([0.3, 0.5, 0.81])
    edges = normal * [2.0, 1.0, 1.0]
    sums = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    terms = (-1.0) ** sums.sum(axis=1) * np.maximum(at - sums @ edges, 0.0) ** 2
    return float(terms.sum() / (2.0 * normal.prod()) * np.linalg.norm(normal))
