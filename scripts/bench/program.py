"""One run of `swgpar run` for a benchmark."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import swgpar


def run(
    folder: Path,
    design: str | Path,
    overrides: Sequence[str],
    ranks: int,
    mesh: str | Path | None = None,
    *,
    plain: bool = True,
) -> Any:
    """Run a design from its beginning, without figures, and return its summary. Ends the benchmark
    where it fails.

    mesh : without one the run takes its own mesh, its shortcuts and windows; with one it has no
    windows
    plain : with a mesh, whether the design is taken as it is, without shortcuts
    """
    shutil.rmtree(folder, ignore_errors=True)
    command = [
        "mpirun",
        "-n",
        str(ranks),
        sys.executable,
        "-P",
        "-m",
        "swgpar.cli",
        "run",
        str(design),
    ]
    command += ["--out", str(folder), *(["--mesh", str(mesh)] if mesh is not None else [])]
    command += ["--plain"] if mesh is not None and plain else []
    windows = ["output.root_stress=false"] if mesh is not None else []
    command += ["--set", "output.figures=false", *windows, *overrides]
    # not what MPI has put into the environment of this process since its start: mpirun would take
    # itself for a rank
    done = subprocess.run(command, capture_output=True, text=True, env=dict(os.environ))
    if done.returncode:
        raise SystemExit(f"{folder.name}: {done.stderr or done.stdout}")
    return swgpar.open_result(folder).summary
