"""One run of `swgpar run` for a benchmark."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any


def run(
    folder: Path, design: str | Path, overrides: Sequence[str], ranks: int, mesh: str | Path | None = None
) -> dict[str, Any]:
    """Run a design as it is, from its beginning, without figures and windows, and return its summary.

    Ends the benchmark where it fails.
    """
    shutil.rmtree(folder, ignore_errors=True)
    command = ["mpirun", "-n", str(ranks), sys.executable, "-P", "-m", "swgpar.cli", "run", str(design)]
    command += ["--out", str(folder), *(["--mesh", str(mesh), "--plain"] if mesh is not None else [])]
    windows = ["output.root_stress=false"] if mesh is not None else []
    command += ["--set", "output.figures=false", *windows, *overrides]
    # not what MPI has put into the environment of this process since its start: mpirun would take itself for a rank
    done = subprocess.run(command, capture_output=True, text=True, env=dict(os.environ))
    if done.returncode:
        raise SystemExit(f"{folder.name}: {done.stderr or done.stdout}")
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))
