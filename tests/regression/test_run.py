"""Whole runs of the small drive through the command: result files, kill and restart, full disk."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from swgpar.results import history

DATA = Path(__file__).parents[1] / "data"
SHORT = ["steps.rotation=4.0", "steps.increment=2.0"]


# every run starts in DATA: from the root of a checkout, python -m would pick up its source tree, which is not built
def command(out: Path, *more: str) -> list[str]:
    return [
        sys.executable,
        "-m",
        "swgpar.cli",
        "run",
        str(DATA / "small.toml"),
        "--mesh",
        str(DATA / "tiny.toml"),
        "--out",
        str(out),
        *more,
        "--set",
        *SHORT,
    ]


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("plain") / "run"
    subprocess.run([*command(out), "output.fields=true", "output.figures=true"], check=True, timeout=600, cwd=DATA)
    return out


def test_result_files(plain: Path) -> None:
    rows = history.read_history(plain / "history.csv")
    assert [r["step"] for r in rows] == ["1", "2", "3", "4", "5"]
    summary = json.loads((plain / "summary.json").read_text(encoding="utf-8"))
    assert summary["balance_error_Nmm"] < 1e-6 * 2000.0
    assert summary["means"]["fs_s1"] == pytest.approx(np.mean([r["fs_s1"] for r in rows[3:]]))
    for name in ("fields.h5", "fields.xdmf", "checkpoint.h5", "run.log"):
        assert (plain / name).stat().st_size > 0
    for name in ("stress", "torque_and_transmission_error", "contact_pattern", "deformed_drive"):
        assert (plain / "figures" / f"{name}.png").stat().st_size > 5000


def test_results_are_not_overwritten_by_accident(plain: Path) -> None:
    done = subprocess.run(command(plain), capture_output=True, text=True, timeout=120, cwd=DATA)
    assert done.returncode == 4 and "--restart" in done.stderr and "Traceback" not in done.stderr


def test_kill_and_restart(plain: Path, tmp_path: Path) -> None:
    out = tmp_path / "killed"
    process = subprocess.Popen(command(out), cwd=DATA)
    limit = time.monotonic() + 300.0
    while time.monotonic() < limit:
        if (out / "history.csv").exists() and len(history.read_history(out / "history.csv")) >= 3:
            break
        time.sleep(0.1)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    subprocess.run(command(out, "--restart"), check=True, timeout=600, cwd=DATA)
    again, before = (history.read_history(p / "history.csv") for p in (out, plain))
    assert len(again) == len(before)
    for a, b in zip(again, before):
        for name in history.COLUMNS:
            if name not in ("step", "wall_s"):
                assert a[name] == pytest.approx(b[name], rel=1e-8, abs=1e-9), name


@pytest.mark.parametrize("place", ["/proc/swgpar", "/dev/null/run"])
def test_unwritable_folder(place: str) -> None:
    done = subprocess.run(command(Path(place)), capture_output=True, text=True, timeout=120, cwd=DATA)
    assert done.returncode == 4
    assert place in done.stderr and "Traceback" not in done.stderr
