"""The how-to pages about own parts: their steps are taken in a copy of the package, and the part
works there."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import swgpar
from support.markdown import examples
from support.page_steps import copied_package, patch, require_count
from support.paths import DRIVERS, ROOT

HOWTO = ROOT / "docs" / "howto"

SMALL = """
import sys
import numpy as np
import swgpar

gear = {"tip": 2, "layers": 1, "flank": 2, "root": 2, "under": 1, "rim": 1}
recipe = {"flexible_spline": gear, "ring_gear": gear}
plane, folder = sys.argv[1:]


def run(overrides={}):
    values = {"steps.rotation": 0.0, "output.figures": False, **overrides}
    design = swgpar.load_design(plane, values)
    return swgpar.run(design, mesh=recipe, out=folder, progress=False)
"""
"""What the scripts below begin with: a plane drive on a few elements."""


def insert(path: Path, before: str, text: str) -> None:
    """Put a text before another one, which the file has once."""
    content = path.read_text(encoding="utf-8")
    assert content.count(before) == 1, f"{path.name}: {before}"
    path.write_text(content.replace(before, text + before), encoding="utf-8")


def small_run(folder: Path) -> None:
    """Results of the package as it is."""
    gear = {"tip": 2, "layers": 1, "flank": 2, "root": 2, "under": 1, "rim": 1}
    design = swgpar.load_design(
        DRIVERS / "plane_half_turn.toml", {"steps.rotation": 0.0, "output.figures": False}
    )
    swgpar.run(
        design, mesh={"flexible_spline": gear, "ring_gear": gear}, out=folder, progress=False
    )


def execute(folder: Path, script: str) -> None:
    """Run a script with the package of a folder."""
    command = [
        sys.executable,
        "-c",
        SMALL + script,
        str(DRIVERS / "plane_half_turn.toml"),
        str(folder / "out"),
    ]
    environment = os.environ | {"PYTHONPATH": str(folder)}
    done = subprocess.run(
        command, env=environment, cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]


def test_own_cam(tmp_path: Path) -> None:
    """Distances and normals are those to the nearest of many points, and a drive runs on the
    cam."""
    curve, keys, branch, *_ = examples(HOWTO / "own_cam_or_profile.md", "python")
    package = copied_package(tmp_path)
    cams = package / "geometry" / "cams"
    (cams / "superelliptical.py").write_text(curve, encoding="utf-8")
    insert(cams / "keys.py", "class FourRoller(", f"{keys}\n\n")
    insert(cams / "keys.py", "FourRoller,\n    Field(", "Superelliptical | ")
    insert(cams / "__init__.py", '    raise TypeError(f"no curve', branch)
    insert(cams / "__init__.py", "    WaveGenerator,\n)\n", "    Superelliptical,\n")
    imported = "from swgpar.geometry.cams.superelliptical import SuperellipticalCam\n"
    insert(cams / "__init__.py", "\nOUTLINE_POINTS = ", imported)
    require_count(HOWTO / "own_cam_or_profile.md", package)
    execute(
        tmp_path,
        """
keys = {"type": "superelliptical", "p": 2.05, "C": 0.95, "face_width": 10.0}
cam = swgpar.load_design(plane, {"wave_generator": keys}).cam()
dense = cam.outline(200_000)
points = dense[2500::5000] * np.linspace(0.97, 1.03, 40)[:, None]
distance, normal, k = cam.evaluate(points)
away = points[:, None] - dense
nearest = np.argmin(np.hypot(*away.transpose(2, 0, 1)), axis=1)
found = dense[nearest]
# the dense points are 2e-3 mm apart: the nearest one is off by up to half of that along the curve
assert np.allclose(np.abs(distance), np.hypot(*(points - found).T), atol=5e-5)
assert np.allclose(points - distance[:, None] * normal, found, atol=1.2e-3)
step = 1e-4 * normal[:, ::-1] * [-1, 1]
slope = cam.evaluate(points + step)[1] - cam.evaluate(points - step)[1]
assert np.allclose(np.hypot(*slope.T) / 2e-4, np.abs(k), rtol=1e-4)
assert np.isfinite(run({"wave_generator": keys}).history["fs_s1"]).all()
""",
    )


def test_own_profile(tmp_path: Path) -> None:
    """Flanks are straight with tangent roots, refusals name the keys, and a drive runs on them."""
    *_, curve, keys, branch = examples(HOWTO / "own_cam_or_profile.md", "python")
    package = copied_package(tmp_path)
    profiles = package / "profiles"
    (profiles / "straight_sided.py").write_text(curve, encoding="utf-8")
    insert(profiles / "keys.py", "_EitherGear = ", f"{keys}\n\n")
    insert(profiles / "keys.py", "QuadrupleArc | DoubleArc | ", "StraightSided | ")
    factory = profiles / "__init__.py"
    insert(factory, "    else:\n        profile = involute(", branch)
    insert(factory, "    Trapezoid,\n)\n", "    StraightSided,\n")
    imported = "from swgpar.profiles.straight_sided import straight_sided\n"
    insert(factory, "from swgpar.profiles.teeth ", imported)
    require_count(HOWTO / "own_cam_or_profile.md", package)
    execute(
        tmp_path,
        """
from swgpar.errors import InputError

section = {"type": "straight_sided", "flank_angle": 20.0, "r_root": 0.3}
keys = {
    "flexible_spline.profile": {**section, "thickness": 1.5},
    "ring_gear.profile": {**section, "thickness": 1.4},
}
design = swgpar.load_design(plane, keys)
for gear, thickness in (("flexible_spline", 1.5), ("ring_gear", 1.4)):
    flank = design.profile(gear)
    assert abs(flank.thickness(0.5 * flank.n_teeth) - thickness) < 1e-12
    across, height = np.abs(flank.normal(np.linspace(0.0, flank.root_start, 9))).T
    assert np.allclose(height / across, np.tan(np.radians(20.0)), rtol=1e-12)
    assert abs(flank.tangent(flank.length)[0] @ flank.point(flank.length)[0]) < 1e-9
    assert flank is design.profile(gear)  # kept


def refusal(key, value):
    try:
        swgpar.load_design(plane, {**keys, key: value})
    except InputError as error:
        return str(error)


root = refusal("ring_gear.profile", {**section, "thickness": 1.4, "r_root": 4.0})
assert "leaves no straight flank above the root arc; make ring_gear.profile.r_root smaller" in root
wide = refusal("ring_gear.profile", {**section, "thickness": 4.0})
assert "cannot be built: the root end crosses" in wide and "c_P" not in wide
assert "thickness follows from ring_gear.profile.thickness" in refusal("ring_gear.c_P", 0.95)
assert "ring_gear.c_l = 0 is out of range: allowed 0.5" in refusal("ring_gear.c_l", 0.0)
assert np.isfinite(run(keys).history["fs_s1"]).all()
""",
    )


def test_own_column(tmp_path: Path) -> None:
    """The column is in the history and in its file, and folders without it open."""
    declaration, value = examples(HOWTO / "own_column.md", "diff")
    package = copied_package(tmp_path)
    patch(package / "results" / "history.py", declaration)
    patch(package / "analysis" / "load_stepping.py", value)
    require_count(HOWTO / "own_column.md", package)
    small_run(tmp_path / "old")
    execute(
        tmp_path,
        """
run()
residual = swgpar.open_result(folder).history["residual"]
assert len(residual) and (0.0 < residual).all() and (residual < 1e-3).all()
assert "residual" not in swgpar.open_result(folder.replace("out", "old")).history
""",
    )


def test_own_answer(tmp_path: Path) -> None:
    """Both answers are in the summary, in its file, among the quantities and in the report; earlier
    results open."""
    field, value, type_import, attribute, function_import, call = examples(
        HOWTO / "own_answer.md", "diff"
    )
    (evaluation,) = examples(HOWTO / "own_answer.md", "python")
    package = copied_package(tmp_path)
    for difference in (field, value):
        patch(package / "evaluation" / "numerics.py", difference)
    (package / "evaluation" / "time_shares.py").write_text(evaluation, encoding="utf-8")
    for difference in (type_import, attribute):
        patch(package / "drive_results" / "summary.py", difference)
    for difference in (function_import, call):
        patch(package / "analysis" / "evaluate_run.py", difference)
    small_run(tmp_path / "old")
    execute(
        tmp_path,
        """
from swgpar.systems import system_of_section

run()
found = swgpar.open_result(folder)
design = found.summary.design
system = system_of_section(design.system)
iterations = found.summary["residue.iterations"]
assert iterations.value == found.history["newton_iterations"].sum() > 0
assert 0.0 < found.summary["time.increments"].value <= 1.0
assert {"residue.iterations", "time.increments"} <= set(system.quantities(design))
assert "Newton iterations of the run" in system.report(found).decode()
assert "time.increments" not in swgpar.open_result(folder.replace("out", "old")).summary
""",
    )
