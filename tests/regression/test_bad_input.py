"""What cannot be used as given, on two ranks: one sentence from one of them, the same exit code, no
waiting."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.commands import execute, on_ranks, swgpar
from support.paths import DATA, DESIGN, RECIPE

# mpirun passes on one exit code only and ends the others: this shell reports that of each rank and
# ends well itself
EACH = ["sh", "-c", '"$@"; echo "exit code $?"', "sh"]


def refused(command: list[str], exit_code: int) -> str:
    """The one sentence of a command that every rank must refuse."""
    done = execute([*on_ranks(2), *EACH, *command], timeout=120.0)
    assert done.stdout.splitlines() == 2 * [f"exit code {exit_code}"]
    (sentence,) = done.stderr.splitlines()
    assert sentence.startswith("swgpar: error: ")
    return sentence


@pytest.mark.parametrize(
    ("design", "recipe", "override", "words"),
    [
        (DESIGN, RECIPE, "drive.module=0", "drive.module = 0 is out of range"),
        (DESIGN, RECIPE, "drive.modul=1", "did you mean drive.module"),
        (DATA / "none.toml", RECIPE, "drive.module=1", "none.toml cannot be read"),
        (DESIGN, DATA / "none.toml", "drive.module=1", "none.toml cannot be read"),
        (DESIGN, DESIGN, "drive.module=1", "drive"),
        (
            DESIGN,
            RECIPE,
            "drive.model=plane",
            "micro_geometry.wg_crowning = 0.1 is out of range: allowed only 0",
        ),
        (DESIGN, RECIPE, "drive.layout=free", 'allowed "ring_fixed" or "spline_fixed"'),
        (DESIGN, "plane_coarse", "drive.module=1", "[face_width] is missing in the mesh recipe"),
    ],
)
def test_bad_files_and_values(
    tmp_path: Path, design: Path, recipe: Path, override: str, words: str
) -> None:
    out = tmp_path / "run"
    assert words in refused(
        swgpar("run", design, "--mesh", recipe, "--out", out, "--set", override), 2
    )
    assert not out.exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("run", DESIGN, "--mesh", RECIPE), "--out"),
        (("run",), "design"),
        (("walk", DESIGN), "walk"),
        (("run", DESIGN, "--mesh", RECIPE, "--out", "x", "--restrat"), "did you mean --restart"),
        (("run", DESIGN, "--mesh", RECIPE, "--out", "x", "-snes_monitor", "on", "off"), "off"),
    ],
)
def test_bad_command_line(arguments: tuple[object, ...], words: str) -> None:
    assert words in refused(swgpar(*arguments), 2)


def test_report_of_nothing(tmp_path: Path) -> None:
    done = execute(swgpar("report", tmp_path), timeout=120.0)
    assert (
        done.returncode == 4
        and "has no summary.json of a finished run" in done.stderr
        and not list(tmp_path.iterdir())
    )


def test_mpirun_passes_the_exit_code_on(tmp_path: Path) -> None:
    command = swgpar(
        "run", DESIGN, "--mesh", RECIPE, "--out", tmp_path / "run", "--set", "load.torque=-3"
    )
    done = execute([*on_ranks(2), *command], timeout=120.0)
    assert done.returncode == 2
    assert (
        done.stderr
        == "swgpar: error: load.torque = -3 is out of range: allowed 0 to 1000000000 N·m\n"
    )


def test_a_file_that_only_one_rank_can_read(tmp_path: Path) -> None:
    """As on a cluster whose nodes do not share the folder: the others must not wait for that
    rank."""
    good = [*EACH, *swgpar("run", DESIGN, "--mesh", RECIPE, "--out", tmp_path / "run")]
    bad = [*EACH, *swgpar("run", DATA / "none.toml", "--mesh", RECIPE, "--out", tmp_path / "run")]
    done = execute([*on_ranks(2)[:-2], "-n", "1", *good, ":", "-n", "1", *bad], timeout=120.0)
    assert done.stdout.splitlines() == 2 * ["exit code 2"]
    (sentence,) = done.stderr.splitlines()
    assert "none.toml cannot be read" in sentence


def test_a_log_that_cannot_be_written(tmp_path: Path) -> None:
    """Only the first rank writes it."""
    (tmp_path / "run.log").mkdir()
    command = swgpar("run", DESIGN, "--mesh", RECIPE, "--out", tmp_path)
    assert f"{tmp_path / 'run.log'} is there, and the folder has no list" in refused(command, 4)
