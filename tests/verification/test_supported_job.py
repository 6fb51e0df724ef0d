"""Supports of the output as `swgpar export --format inp` writes them, in jobs of CalculiX in which
nothing touches."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import swgpar
from support.cup_shapes import ATTACHED
from support.paths import DESIGN, RECIPE
from swgpar.exchange.calculix import MESH, write_calculix
from swgpar.exchange.calculix_growth import initial_temperature, temperatures
from swgpar.exchange.calculix_model import JobModel
from swgpar.exchange.calculix_supports import JobSupports
from swgpar.meshing import load_recipe

PLACE = 20.0
"""Of the bearing along z, mm: behind the closed end."""

CARRIED = (
    "load.torque=1e-3",
    "output_bearing.radial_stiffness=2e4",
    "output_bearing.axial_stiffness=1e4",
    "output_bearing.tilting_stiffness=2e3",
    f"output_bearing.position={PLACE}",
    "output_bearing.radial_force=60",
    "output_bearing.radial_direction=30",
    "output_bearing.axial_force=20",
    "output_bearing.tilting_moment=1",
    "output_bearing.tilting_direction=70",
)

ATTACHMENTS: dict[str, tuple[str, ...]] = {"edge": (), **ATTACHED}


def _printed(path: Path, count: int) -> np.ndarray:
    """Displacements (count, 3) mm and rad of the nodes 1 to count, the last that are printed."""
    values = np.full((count, 3), np.nan)
    for line in path.read_text(encoding="ascii").splitlines():
        row = line.split()
        if len(row) == 4 and row[0].isdigit() and int(row[0]) <= count:
            values[int(row[0]) - 1] = [float(value) for value in row[1:]]
    return values


def _moved(folder: Path, model: JobModel, supports: JobSupports, *step: str) -> np.ndarray:
    """Displacements (n + 2, 3) of all nodes and of the two of the output by one step of a job in
    which nothing touches."""
    job = [f"*INCLUDE, INPUT={MESH}", *supports.lines()]
    for terms in supports.equations:
        job += ["*EQUATION", str(len(terms))]
        job += [f"{node + 1}, {axis}, {factor:.12e}" for node, axis, factor in terms]
    job += [*initial_temperature(model, "OUTPUT"), "*BOUNDARY", "RING_GEAR_OUTER, 1, 3"]
    job += ["*STEP, NLGEOM", "*STATIC", "1., 1.", *step, "*BOUNDARY", f"{supports.turn}, 3"]
    job += ["*NODE PRINT, NSET=OUTPUT", "U", "*NODE PRINT, NSET=ALL_NODES", "U", "*END STEP"]
    (folder / "free.inp").write_text("\n".join(job) + "\n", encoding="ascii")
    subprocess.run(["ccx", "free"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return _printed(folder / "free.dat", len(model.points) + 2)


def _job(folder: Path, *overrides: str) -> tuple[JobModel, JobSupports]:
    """The mesh in a folder, and what a job of the small cup has."""
    design, recipe = swgpar.load_design(DESIGN, overrides), load_recipe(RECIPE)
    write_calculix(design, folder, recipe)
    model = JobModel(design, recipe)
    return model, JobSupports(model, len(model.points) + 1, model.n_elements + 1)


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
@pytest.mark.parametrize("attachment", ATTACHMENTS)
def test_forces_move_a_free_output_by_its_springs(tmp_path: Path, attachment: str) -> None:
    model, supports = _job(tmp_path, *ATTACHMENTS[attachment], *CARRIED)
    # a small torque acts on the rotation, which is held
    u = _moved(tmp_path, model, supports, *supports.loads())
    n, bearing = len(model.points), model.design.output_bearing
    moved = np.array([*u[n], *u[n + 1, :2]])
    print(f"{attachment}: {moved / (bearing.load / bearing.stiffness) - 1.0}")
    assert moved == pytest.approx(bearing.load / bearing.stiffness, rel=1e-4)
    x, middle = model.points[: model.n_spline], np.array([0.0, 0.0, PLACE])
    rigid = Rotation.from_rotvec(u[n + 1]).apply(x - middle) + middle + u[n]
    off = np.linalg.norm(x + u[: model.n_spline] - rigid, axis=1)
    print(f"{attachment}: largest distance from a rigid motion {off.max():.1e} mm")
    assert off.max() < 1e-5  # of 1e-2 mm


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
@pytest.mark.parametrize("attachment", ["clamped", "bolted"])
def test_a_flange_grows_with_the_flexible_spline(tmp_path: Path, attachment: str) -> None:
    warm = ("material.expansion=12e-6", "flexible_spline.temperature=70")
    model, supports = _job(tmp_path, *ATTACHMENTS[attachment], *CARRIED, *warm)
    u = _moved(tmp_path, model, supports, *temperatures(model), *supports.flange.forces())
    x = model.points[: model.n_spline] - [0.0, 0.0, supports.flange.middle]
    grown = model.design.growths["flexible_spline"].of(x)
    # rigid flanges of the old size would press the ring outwards or inwards
    off = np.linalg.norm(u[: model.n_spline] - grown, axis=1)
    print(f"{attachment}: {off.max():.1e} mm of {np.abs(grown).max():.1e} mm")
    assert off.max() < 2e-5 * np.abs(grown).max()
