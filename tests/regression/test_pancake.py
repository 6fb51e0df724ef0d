"""The pancake drive through the command: `drivers/pancake.toml`, exports, restart on another number
of ranks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyvista

import swgpar
from support.commands import assert_same_history, execute, on_ranks, succeed
from support.commands import swgpar as command
from support.paths import DATA, DRIVERS, RECIPE
from swgpar.meshing.sector_counts import sector_counts

DRIVER = DRIVERS / "pancake.toml"
GEARS = ("flexible_spline", "ring_gear", "dynamic_spline")


def run(design: Path, out: Path, *more: str, ranks: int = 1) -> list[str]:
    return on_ranks(ranks) + command("run", design, "--mesh", RECIPE, "--out", out, *more)


def test_driver(tmp_path: Path) -> None:
    """Loaded state of the driver on the smallest mesh, with fields of three bodies, figures and
    report."""
    out = tmp_path / "driver"
    succeed(run(DRIVER, out, "--set", "steps.rotation=0"))
    result = swgpar.open_result(out)
    assert result.summary.numerics.balance_error_Nmm < 1e-4 * 20_000.0
    torque = {
        name: result.history[f"{name}_torque_Nmm"][-1] for name in ("wg", "tooth", "ds_tooth")
    }
    assert np.isclose(torque["ds_tooth"], 20_000.0, rtol=1e-5) and torque["wg"] > 0.0
    assert abs(sum(torque.values())) < 1e-4 * 20_000.0
    assert result.gears == GEARS
    for name, prefix in zip(GEARS, ("fs", "rg", "ds"), strict=True):
        assert np.isclose(
            result.field("vm", body=name).max(), result.history[f"{prefix}_vm"][-1], rtol=1e-6
        )
    assert set(np.unique(result.grid().cell_data["body"])) == {0, 1, 2}
    reader = pyvista.XdmfReader(str(out / "fields.xdmf"))
    assert len(reader.read()) == 3
    for name in ("figures/deformed_drive.png", "report.html"):
        assert (out / name).stat().st_size > 5000


def test_mesh_and_exchange(tmp_path: Path) -> None:
    """Both ring gears lie side by side, with the gap between them; the flexible spline has the
    stations of both."""
    mesh = swgpar.mesh(DATA / "pancake.toml", RECIPE)
    stations = {
        name: np.unique(np.round(body.points[:, 2], 9)) for name, body in mesh.bodies.items()
    }
    assert tuple(stations) == GEARS
    assert (stations["ring_gear"][[0, -1]] == [-3.0, -0.25]).all()
    assert (stations["dynamic_spline"][[0, -1]] == [0.25, 3.0]).all()
    both = np.concatenate([stations["ring_gear"], stations["dynamic_spline"]])
    assert np.isin(both, stations["flexible_spline"]).all()
    counted = {name: quality["elements"] for name, quality in mesh.quality.items()}
    assert counted == {name: len(body.cells) for name, body in mesh.bodies.items()}
    design, recipe = swgpar.load_design(DATA / "pancake.toml"), swgpar.load_mesh(RECIPE)
    for name, counts in sector_counts(design.geometry, recipe).items():
        sector = mesh.sectors[name]
        assert (counts.n_sectors, counts.elements) == (sector.n_sectors, len(sector.hexes))
        assert (counts.nodes, counts.shared) == (len(sector.coords), len(sector.ccw_nodes))
    succeed(command("export", DATA / "pancake.toml", "--format", "step", "--out", tmp_path))
    assert (tmp_path / "dynamic_spline.step").stat().st_size > 5000


def test_what_is_refused(tmp_path: Path) -> None:
    """In one sentence: jobs of other programs know one ring gear."""
    done = execute(
        command(
            "export", DATA / "pancake.toml", "--format", "inp", "--mesh", RECIPE, "--out", tmp_path
        )
    )
    assert (
        done.returncode == 2
        and "[dynamic_spline] is not available with the format inp" in done.stderr
    )


def test_restart(tmp_path: Path) -> None:
    """From one rank to two, with the same history as a run without a stop."""
    whole, parts, increment = tmp_path / "whole", tmp_path / "parts", "steps.increment=0.5"
    succeed(
        run(
            DATA / "pancake.toml", whole, "--set", "steps.rotation=1", increment, "solver.rtol=1e-9"
        )
    )
    succeed(
        run(
            DATA / "pancake.toml",
            parts,
            "--set",
            "steps.rotation=0.5",
            increment,
            "solver.rtol=1e-9",
        )
    )
    more = ("--restart", "--set", "steps.rotation=1", increment, "solver.rtol=1e-9")
    succeed(run(DATA / "pancake.toml", parts, *more, ranks=2))
    assert json.loads((parts / "summary.json").read_text(encoding="utf-8"))["ranks"] == 2
    assert_same_history(parts, whole, iterations=False)
