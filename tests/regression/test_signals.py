"""Signals to a run: one sentence, no waiting rank, and a restart that continues from what is
saved."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest
from mpi4py import MPI

from support.commands import (
    assert_same_history,
    environment,
    is_rank,
    of_session,
    run_command,
    succeed,
    swgpar,
)
from support.paths import DATA, DRIVERS
from swgpar.results import history

WITH_OPEN_MPI = MPI.Get_library_version().startswith("Open MPI")


def rank_of(pid: int) -> int | None:
    """Rank of a process of the run that is no mpirun; 0 without mpirun."""
    if not is_rank(pid):
        return None
    found = re.search(
        r"(?:OMPI_COMM_WORLD|PMI)_RANK=(\d+)",
        Path(f"/proc/{pid}/environ").read_text(encoding="utf-8"),
    )
    return int(found[1]) if found else 0


def test_a_reader_that_goes_ends_a_command_in_silence() -> None:
    """As with `swgpar check FILE | head -1`: PETSc, which takes the signal, must not speak of a
    failure."""
    command = swgpar("check", DRIVERS / "plane_half_turn.toml")
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment()
    ) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 1


@pytest.mark.parametrize(
    ("ranks", "number", "target", "code"),
    [
        (1, signal.SIGINT, 0, 130),
        (2, signal.SIGTERM, 0, 143),
        (2, signal.SIGINT, 1, 130),
        (2, signal.SIGHUP, None, 1),  # mpirun itself ends with 1, whatever its ranks end with
    ],
)
def test_a_signal_ends_a_run(
    plain: Path, tmp_path: Path, ranks: int, number: signal.Signals, target: int | None, code: int
) -> None:
    """target : rank that gets the signal, None for mpirun"""
    out, pipe = tmp_path / "run", subprocess.PIPE
    process = subprocess.Popen(
        run_command(out, ranks=ranks),
        cwd=DATA,
        env=environment(),
        start_new_session=True,
        stderr=pipe,
        text=True,
    )
    limit = time.monotonic() + 600.0
    while not (
        (out / "checkpoint.h5").exists() and len(history.read_history(out / "history.csv")) >= 2
    ):
        assert process.poll() is None and time.monotonic() < limit
        time.sleep(0.02)
    members = {rank_of(pid): pid for pid in of_session(process.pid)}
    os.kill(process.pid if target is None else members[target], number)
    _, stderr = process.communicate(timeout=30)
    if target is None and not WITH_OPEN_MPI:
        code = -number  # the mpirun of MPICH ends by the signal itself
    assert process.returncode == code and "Traceback" not in stderr
    sentences = [line for line in stderr.splitlines() if line.startswith("swgpar: ")]
    # mpirun may end before it has passed the sentence on; that of MPICH kills rank 0 when another
    # one has ended
    if sentences or target == 0 or (target is not None and WITH_OPEN_MPI):
        (sentence,) = sentences
        name = number.name if target == 0 else "SIGTERM"  # the one with which mpirun ends rank 0
        assert re.fullmatch(
            rf"swgpar: stopped by {name}: \d of 5 increments are saved in {re.escape(str(out))}; "
            "the same command with --restart continues",
            sentence,
        )
        assert len(history.read_history(out / "history.csv")) >= int(sentence.split()[4]) >= 1
    succeed(run_command(out, "--restart", ranks=ranks))
    assert_same_history(out, plain, iterations=False)
