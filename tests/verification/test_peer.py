"""CalculiX solves the same ring to the same displacements: the benchmark's command on its coarsest
mesh."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from support.commands import environment
from support.paths import ROOT


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
def test_pinched_rings_agree_with_calculix(tmp_path: Path) -> None:
    command = [
        sys.executable,
        str(ROOT / "scripts/bench/peer.py"),
        "--only",
        "linear",
        "finite",
        "--levels",
        "0",
    ]
    page = shutil.copy(ROOT / "docs/verification/peer.md", tmp_path)
    command += ["--out", str(tmp_path / "jobs"), "--tables", str(tmp_path), "--page", page]
    subprocess.run(command, check=True, cwd=ROOT, env=environment(), stdout=subprocess.DEVNULL)
    rows = json.loads((tmp_path / "peer.json").read_text(encoding="utf-8"))
    assert [row["problem"].split(":")[0] for row in rows] == ["linear", "finite rotation"]
    for row in rows:
        assert row["field_difference"] < 5e-3
        assert abs(row["s1_difference"]) < 5e-3
    # of a radius of 59 mm: a finite rotation
    assert rows[1]["swgpar_displacement_mm"] > 8.0
