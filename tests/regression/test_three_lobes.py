"""Runs of a drive with three lobes through the command: the design file of drivers/, restart,
fields of the whole."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import swgpar
from support.commands import assert_same_history, run_command, succeed
from support.commands import swgpar as program
from support.paths import DRIVERS, RECIPE
from support.small_drive import SHORT
from support.three_lobes import MODELS


def test_the_design_file_in_drivers(tmp_path: Path) -> None:
    out, design = tmp_path / "out", DRIVERS / "three_lobes.toml"
    checked = succeed(program("check", design)).stdout
    assert "-40" in checked and "warning" not in checked
    quick = ("steps.rotation=3", "output.root_stress=false", "output.figures=false")
    succeed(program("run", design, "--mesh", RECIPE, "--out", out, "--set", *quick))
    summary = swgpar.open_result(out).summary
    assert summary.copies == 3
    assert abs(summary.numerics.balance_error_Nmm) < 1e-2


def test_restart_on_other_ranks_and_fields_of_the_whole(tmp_path: Path) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    keys = (*MODELS["plane"], *SHORT, "output.fields=true")
    succeed(run_command(whole, overrides=keys))
    succeed(run_command(parts, overrides=(*keys, "steps.rotation=2.0")))
    succeed(run_command(parts, "--restart", ranks=2, overrides=keys))
    assert_same_history(parts, whole, iterations=False)
    result = swgpar.open_result(whole)
    part, full = (
        result.grid(body="flexible_spline", whole=all_of_it) for all_of_it in (False, True)
    )
    assert full.n_cells == 3 * part.n_cells
    # the deformed parts join: the first nodes of an image lie on the last ones of the part before
    # it
    for grid in (full, full.warp_by_vector("displacement")):
        first, second, third = np.split(np.asarray(grid.points), 3)
        turn = np.array([[-0.5, -np.sqrt(0.75), 0.0], [np.sqrt(0.75), -0.5, 0.0], [0.0, 0.0, 1.0]])
        assert np.abs(second - first @ turn.T).max() < 1e-5
        assert np.abs(third - second @ turn.T).max() < 1e-5
        # the node on the border of two parts
        assert np.abs(first[:, None] - second).sum(axis=2).min() < 1e-5
    stress = np.asarray(full.point_data["stress"]).reshape(3, -1, 6)
    trace = stress[..., 0] + stress[..., 3] + stress[..., 5]
    assert np.abs(trace - trace[0]).max() < 1e-5 * np.abs(trace).max()
    assert np.abs(stress[1] - stress[0]).max() > 0.1 * np.abs(stress).max()


def test_a_bearing_with_losses_and_fatigue(tmp_path: Path) -> None:
    """Loads that repeat after a third of the balls, their life, their friction and the report."""
    out = tmp_path / "out"
    keys = (
        "wave_generator.bearing={balls=33, ball_diameter=8.0, race_thickness=1.2}",
        "steps.rotation=3",
        "steps.samples=3",
        "losses.bearing_friction=0.002",
        "fatigue.fatigue_limit=480",
        "output.root_stress=false",
        "output.figures=false",
    )
    run = ("run", DRIVERS / "three_lobes.toml", "--mesh", RECIPE, "--out", out, "--set", *keys)
    assert "rating life L10 of the bearing" in succeed(program(*run)).stdout
    result = swgpar.open_result(out)
    bearing, losses = result.summary.bearing, result.summary.losses
    assert result.summary.copies == 3
    assert abs(result.summary.numerics.balance_error_Nmm) < 1e-2
    thirds = result.balls["load_N"].reshape(-1, 3, 11)
    assert np.abs(thirds - thirds[:, :1]).max() == 0.0
    assert bearing.ball_places == 3 and bearing.life.L10_hours > 0.0
    assert bearing.largest_load_N == thirds.max() and thirds.min() == 0.0
    # Coulomb's friction of the sum of the loads on the circle of the centres; the race turns
    # against the wave generator, by 1/40 of it
    arm = 0.5 * result.summary.design.bearing_sizes.pitch_diameter
    expected = 0.002 * 3.0 * thirds[:, 0].sum(axis=1).mean() * arm * (1.0 + 1.0 / 40.0)
    assert losses.parts_Nmm.bearing == pytest.approx(expected, rel=1e-9)
