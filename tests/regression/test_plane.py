"""Whole runs of the plane model through the command: result files, fields, figures, the spline
fixed."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import pyvista

from support.commands import assert_same_history, run_command, succeed
from support.paths import RECIPE
from support.small_drive import PLANE
from swgpar.meshing import load_recipe
from swgpar.results import history


def test_result_files(plain: Path) -> None:
    rows = history.read_history(plain / "history.csv")
    assert [r["step"] for r in rows] == [1, 2, 3, 4, 5]
    summary = json.loads((plain / "summary.json").read_text(encoding="utf-8"))
    assert summary["numerics"]["balance_error_Nmm"] < 1e-6 * 200.0
    recipe = load_recipe(RECIPE).flexible_spline
    for body in summary["bodies"].values():
        # half of the drive is modelled; two unknowns a node, on the ring gear none on its outer
        # circle
        assert (
            body["nodes_whole"] == 2 * body["nodes"]
            and body["elements_whole"] == 2 * body["elements"]
        )
        assert body["quality"]["max_aspect_ratio"] < 10.0
    spline = summary["bodies"]["flexible_spline"]
    assert spline["dofs"] == 2 * spline["nodes"]
    around = 2 * (recipe.tip + recipe.layers + recipe.root)
    ring = summary["bodies"]["ring_gear"]
    assert ring["dofs"] == 2 * (ring["nodes"] - 21 * around)
    for name in ("stress", "torque_and_transmission_error", "contact_pattern", "deformed_drive"):
        assert (plain / "figures" / f"{name}.png").stat().st_size > 5000


def test_fields_open_in_paraview(plain: Path) -> None:
    """Plane stress: one principal stress is zero; both layers of nodes move alike, and not along
    the axis."""
    rows = history.read_history(plain / "history.csv")
    reader = pyvista.XdmfReader(str(plain / "fields.xdmf"))
    assert reader.number_time_points == len(rows)
    reader.set_active_time_point(len(rows) - 1)
    for block, prefix in zip(reader.read(), ("fs", "rg")):
        assert block.n_cells > 0 and set(block.celltypes) == {pyvista.CellType.HEXAHEDRON}
        u = block.point_data["displacement"]
        assert np.abs(u[:, 2]).max() == 0.0 < np.abs(u[:, :2]).max()
        tensor = block.point_data["stress"].reshape(-1, 3, 3)
        assert np.abs(tensor[:, 2]).max() == 0.0
        assert np.linalg.eigvalsh(tensor)[:, 2] == pytest.approx(block.point_data["s1"], abs=1e-3)
        assert block.point_data["vm"].max() == pytest.approx(rows[-1][f"{prefix}_vm"], rel=1e-6)
        order = np.lexsort(np.round(block.points.T, 6))  # by z first
        lower, upper = np.split(order, 2)
        # points of neighbouring sectors coincide, with the same values
        for name in ("displacement", "vm", "s1"):
            values = block.point_data[name]
            assert values[lower] == pytest.approx(values[upper], rel=1e-6, abs=1e-9), name


def test_restart_with_the_spline_fixed(tmp_path: Path) -> None:
    layout = (*PLANE, "drive.layout=spline_fixed", "steps.increment=2.0")
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    succeed(run_command(whole, overrides=(*layout, "steps.rotation=4.0")))
    succeed(run_command(parts, overrides=(*layout, "steps.rotation=2.0")))
    succeed(run_command(parts, "--restart", overrides=(*layout, "steps.rotation=4.0")))
    assert_same_history(parts, whole, iterations=False)
