"""Temperatures as `swgpar export --format inp` writes them: CalculiX gives free gears their growth,
without stress."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.exchange.calculix import MESH, write_calculix
from swgpar.exchange.calculix_growth import initial_temperature, temperatures
from swgpar.exchange.calculix_model import JobModel
from swgpar.meshing import load_recipe

EXPANSION = 12e-6
RISES = {"flexible_spline": 80.0, "ring_gear": 40.0}
HEATED = (
    f"material.expansion={EXPANSION}",
    *(f"{gear}.temperature={20.0 + rise}" for gear, rise in RISES.items()),
)


def _supports(points: np.ndarray, first: int, *, plane: bool) -> list[str]:
    """A free ring that keeps its centre: radial motion alone on both axes, none along z at one
    end."""
    x, y, z = points.T
    end = np.abs(z - z.min()) < 1e-9
    on_x, on_y = end & (np.abs(y) < 1e-9), end & (np.abs(x) < 1e-9)
    held = [(on_y, 1), (on_x, 2), *([] if plane else [(on_x | on_y, 3)])]
    return [
        f"{first + node + 1}, {axis}, {axis}"
        for where, axis in held
        for node in np.flatnonzero(where)
    ]


def _displacements(path: Path, n: int) -> np.ndarray:
    """Displacements (n, 3) mm of the first n nodes, the last of drive.dat's printed table."""
    rows = [line.split() for line in path.read_text(encoding="ascii").splitlines()]
    values = np.full((n, 3), np.nan)
    for row in rows:
        if len(row) == 4 and row[0].isdigit() and int(row[0]) <= n:
            values[int(row[0]) - 1] = [float(value) for value in row[1:]]
    return values


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
@pytest.mark.parametrize("overrides", [PLANE, ()], ids=["plane", "cup"])
def test_free_gears_grow(tmp_path: Path, overrides: tuple[str, ...]) -> None:
    design, recipe = swgpar.load_design(DESIGN, [*overrides, *HEATED]), load_recipe(RECIPE)
    write_calculix(design, tmp_path, recipe)
    model = JobModel(design, recipe)
    points, n = model.points, model.n_spline
    parts = {"flexible_spline": slice(0, n), "ring_gear": slice(n, None)}
    job = [f"*INCLUDE, INPUT={MESH}"]
    for terms in model.ties() if model.plane else ():
        job += ["*EQUATION", str(len(terms))]
        job += [", ".join(f"{node + 1}, {axis}, {factor}" for node, axis, factor in terms)]
    job += [*initial_temperature(model), "*BOUNDARY"]
    job += ["ALL_NODES, 3, 3"] if model.plane else []
    for part in parts.values():
        job += _supports(points[part], part.start, plane=model.plane)
    job += ["*STEP, NLGEOM", "*STATIC", "1., 1.", *temperatures(model)]
    job += ["*NODE PRINT, NSET=ALL_NODES", "U", "*END STEP"]
    (tmp_path / "free.inp").write_text("\n".join(job) + "\n", encoding="ascii")
    subprocess.run(["ccx", "free"], cwd=tmp_path, check=True, stdout=subprocess.DEVNULL)
    u = _displacements(tmp_path / "free.dat", len(points))
    for gear, part in parts.items():
        x = points[part] - [0.0, 0.0, points[part][:, 2].min()]
        expected = EXPANSION * RISES[gear] * x * [1.0, 1.0, 0.0 if model.plane else 1.0]
        assert np.isfinite(u[part]).all()
        # the file has seven digits; Green's strain in place of the stretch would be 5e-4 off
        assert np.abs(u[part] - expected).max() < 2e-5 * np.abs(expected).max()
