"""Whole runs of the small drive through the command: result files, kill and restart, the script in
drivers/."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
import pyvista

from support.commands import (
    assert_same_history,
    execute,
    kill_after,
    on_ranks,
    run_command,
    succeed,
)
from support.paths import DESIGN, DRIVERS, RECIPE
from support.small_drive import NO_SHORTCUTS, PLANE, SHORT
from swgpar.meshing import load_recipe
from swgpar.results import history, made_files

CUP_ROTATION = DRIVERS / "cup_rotation.py"


def test_result_files(cup: Path) -> None:
    rows = history.read_history(cup / "history.csv")
    assert [r["step"] for r in rows] == [1, 2, 3, 4, 5]
    summary = json.loads((cup / "summary.json").read_text(encoding="utf-8"))
    assert summary["numerics"]["balance_error_Nmm"] < 1e-6 * 2000.0
    assert summary["rotation"]["means"]["fs_s1"] == pytest.approx(
        np.mean([r["fs_s1"] for r in rows[3:]])
    )
    for name in ("fields.h5", "fields.xdmf", "checkpoint.h5", "run.log"):
        assert (cup / name).stat().st_size > 0
    for name in ("stress", "torque_and_transmission_error", "contact_pattern", "deformed_drive"):
        assert (cup / "figures" / f"{name}.png").stat().st_size > 5000


def test_fields_open_in_paraview(cup: Path) -> None:
    """VTK's XDMF reader is the one that ParaView offers."""
    rows = history.read_history(cup / "history.csv")
    reader = pyvista.XdmfReader(str(cup / "fields.xdmf"))
    assert reader.number_time_points == len(rows)
    reader.set_active_time_point(len(rows) - 1)
    for block, prefix in zip(reader.read(), ("fs", "rg")):
        assert {"displacement", "stress", "s1", "s3", "vm"} <= set(block.array_names)
        tensor = np.linalg.eigvalsh(block.point_data["stress"].reshape(-1, 3, 3))
        assert tensor[:, 2] == pytest.approx(block.point_data["s1"], abs=1e-3)
        assert tensor[:, 0] == pytest.approx(block.point_data["s3"], abs=1e-3)
        assert block.point_data["vm"].max() == pytest.approx(rows[-1][f"{prefix}_vm"], rel=1e-6)


def test_results_are_not_overwritten_by_accident(plain: Path) -> None:
    done = execute(run_command(plain))
    assert done.returncode == 4 and "--restart" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize(("before", "after"), [(1, 1), (2, 1), (1, 2)])
def test_kill_and_restart(plain: Path, tmp_path: Path, before: int, after: int) -> None:
    """The same history; a restart begins with a new factor, where the whole run may have kept one,
    and one state."""
    out = tmp_path / "killed"
    kill_after(run_command(out, ranks=before), out, rows=3)
    assert not (out / "summary.json").exists()
    succeed(run_command(out, "--restart", ranks=after))
    assert "restarted after increment" in (out / "run.log").read_text(encoding="utf-8")
    assert json.loads((out / "summary.json").read_text(encoding="utf-8"))["ranks"] == after
    assert_same_history(out, plain, iterations=False)


def test_restart_with_friction(tmp_path: Path) -> None:
    """The tractions of the flanks go through the checkpoint, on to another number of ranks.

    Slip turns round at the start of the rotation: flanks stick in such small increments, and
    remember.
    """
    whole, parts, more = (
        tmp_path / "whole",
        tmp_path / "parts",
        (*PLANE, "steps.increment=0.01", "contact.friction=0.1"),
    )
    succeed(run_command(whole, overrides=("steps.rotation=0.02", *more)))
    succeed(run_command(parts, ranks=2, overrides=("steps.rotation=0.01", *more)))
    succeed(run_command(parts, "--restart", overrides=("steps.rotation=0.02", *more)))
    assert_same_history(parts, whole, iterations=False)


def test_restart_before_anything_was_saved(plain: Path, tmp_path: Path) -> None:
    """As after a kill in the first increment, or between the first history and its checkpoint."""
    for k, name in enumerate(("empty", "history")):
        out = tmp_path / name
        out.mkdir()
        if k:
            made_files.begin(out)
            made_files.note(out / "history.csv")
            (out / "history.csv").write_bytes((plain / "history.csv").read_bytes())
        done = succeed(run_command(out, "--restart"))
        said = f"{out} has no increment to continue: the run begins at the start"
        assert said in done.stdout and said in (out / "run.log").read_text(encoding="utf-8")
        assert_same_history(out, plain)


def test_restart_with_more_rotation_and_fields(plain: Path, tmp_path: Path) -> None:
    out = tmp_path / "longer"
    succeed(
        run_command(
            out,
            overrides=(*PLANE, "steps.rotation=2.0", "steps.increment=2.0", "output.fields=false"),
        )
    )
    first = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    succeed([*run_command(out, "--restart"), "output.fields=true"])
    assert_same_history(out, plain, iterations=False)
    assert (
        json.loads((out / "summary.json").read_text(encoding="utf-8"))["wall_s"] > first["wall_s"]
    )
    assert pyvista.XdmfReader(str(out / "fields.xdmf")).number_time_points == 1
    refused = execute(
        run_command(
            out, "--restart", overrides=(*PLANE, "steps.rotation=3.0", "steps.increment=2.0")
        )
    )
    assert refused.returncode == 2 and "steps.rotation = 3" in refused.stderr


def test_script_of_the_reference_drive(cup: Path, tmp_path: Path) -> None:
    out = tmp_path / "script"
    arguments = ["--design", DESIGN, "--mesh", RECIPE, "--out", out, "--set", *SHORT, *NO_SHORTCUTS]
    done = succeed([*on_ranks(2), sys.executable, str(CUP_ROTATION), *map(str, arguments)])
    assert_same_history(out, cup, iterations=False)
    assert (
        "\x1b" not in done.stdout
    )  # no progress bar in a file, though mpirun gives its ranks a terminal
    printed = [line.split() for line in done.stdout.splitlines() if line.startswith("step ")]
    rows = history.read_history(cup / "history.csv")
    assert [int(words[1]) for words in printed] == [r["step"] for r in rows]
    assert [words[5] for words in printed] == [f"{r['fs_s1']:.1f}" for r in rows]


@pytest.mark.parametrize("place", ["/proc/swgpar", "/dev/null/run"])
def test_unwritable_folder(place: str) -> None:
    done = execute(run_command(Path(place)))
    assert done.returncode == 4
    assert place in done.stderr and "Traceback" not in done.stderr


def test_start_on_a_coarser_mesh_and_one_period(tmp_path: Path) -> None:
    """History from step 3 on and over the whole rotation, an error of the mesh, figures; a restart
    goes on in it."""
    out = tmp_path / "run"
    overrides = [
        "steps.start_levels=1",
        "steps.samples=2",
        "output.fields=true",
        "output.figures=true",
    ]
    command = run_command(out)
    succeed([*command, *overrides, "steps.rotation=9"])
    rows = history.read_history(out / "history.csv")
    assert [row["step"] for row in rows] == [3, 4, 5]
    assert len(list((out / "figures").glob("*.png"))) == 9
    summary = json.loads((out / "summary.json").read_text())
    assert summary["increments"] == 2 and summary["phases_s"]["start"] > 0.0
    succeed([*command, *overrides, "steps.rotation=20", "--restart"])
    longer = history.read_history(out / "history.csv")
    assert longer[:3] == rows and [row["step"] for row in longer] == [3, 4, 5, 6, 7]
    assert longer[-1]["wg_angle_deg"] == pytest.approx(2.0 * 360.0 / 42.0)
    assert longer[-1]["fs_s1"] == rows[-1]["fs_s1"]


def test_an_accuracy_is_reached_by_refinement(tmp_path: Path) -> None:
    """The estimate of the mesh that the run ends with is below what was asked for; a restart keeps
    that mesh."""
    out = tmp_path / "run"
    asked, pitch = 0.02, 360.0 / 42.0
    more = ("--mesh", str(RECIPE), "--accuracy", str(asked))
    command = run_command(out, *more, overrides=[*PLANE, "steps.rotation=9"])
    succeed(command)
    summary = json.loads((out / "summary.json").read_text())
    recipe = load_recipe(out / "recipe.toml")
    rows = history.read_history(out / "history.csv")
    root = next(answer for answer in summary["answers"] if answer["name"] == "root.s1")
    assert recipe.flexible_spline.flank > load_recipe(RECIPE).flexible_spline.flank
    assert summary["accuracy"]["asked"] == asked and summary["accuracy"]["reached"]
    assert root["error"] < asked * root["value"]
    assert set(summary["rotation"]["sampling_error"]) == set(summary["rotation"]["means"])
    restart = [word.replace("rotation=9", f"rotation={2.1 * pitch}") for word in command] + [
        "--restart"
    ]
    other = execute([word.replace(str(asked), "0.2") for word in restart])
    assert other.returncode == 2 and "(accuracy = 0.2, there 0.02)" in other.stderr
    succeed(restart)
    longer = json.loads((out / "summary.json").read_text())
    assert (
        longer["elements"] == summary["elements"]
        and longer["rotation"]["means"] == summary["rotation"]["means"]
    )
    assert len(history.read_history(out / "history.csv")) > len(rows)
