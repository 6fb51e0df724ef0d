"""Commands as child processes: runs of the small drive, on ranks, to the end or killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from support.paths import DATA, DESIGN, RECIPE
from support.small_drive import PLANE, SHORT
from swgpar.app.jobs import shell_environment
from swgpar.results import history

# Open MPI runs more ranks than there are cores, and does not comment on exit codes; MPICH has no
# such settings
OPEN_MPI = {"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_orte_execute_quiet": "1"}


def environment() -> dict[str, str]:
    """Of a command that is started outside of the job of this process."""
    return shell_environment() | OPEN_MPI


def on_ranks(ranks: int) -> list[str]:
    """What goes before a command; one rank runs without mpirun."""
    return ["mpirun", "-n", str(ranks)] if ranks > 1 else []


def swgpar(*arguments: object) -> list[str]:
    return [sys.executable, "-P", "-m", "swgpar.cli", *map(str, arguments)]


def run_command(
    out: Path, *more: str, ranks: int = 1, overrides: Sequence[str] = (*PLANE, *SHORT)
) -> list[str]:
    """A run of the small drive without shortcuts, a plane one unless the overrides say
    otherwise."""
    arguments = (
        "run",
        DESIGN,
        "--mesh",
        RECIPE,
        "--plain",
        "--out",
        out,
        *more,
        "--set",
        *overrides,
    )
    return on_ranks(ranks) + swgpar(*arguments)


def execute(
    command: list[str], *, timeout: float = 900.0, cwd: Path = DATA, **variables: str
) -> subprocess.CompletedProcess[str]:
    """Run to the end, keeping both streams.

    cwd : not the root of a checkout, from which python -m would take the source tree, whose kernels
    are not built
    variables : of the environment, beside those of this process
    """
    variables = {**environment(), **variables}
    return subprocess.run(
        command, capture_output=True, text=True, timeout=timeout, cwd=cwd, env=variables
    )


def succeed(
    command: list[str], *, timeout: float = 900.0, cwd: Path = DATA, **variables: str
) -> subprocess.CompletedProcess[str]:
    done = execute(command, timeout=timeout, cwd=cwd, **variables)
    assert done.returncode == 0, done.stderr + done.stdout
    return done


def assert_same_history(
    folder: Path, other: Path, rel: float | None = None, *, iterations: bool = True
) -> None:
    """Rows agree within `rel` of the largest value of their column: entries that vanish are
    round-off.

    rel : default 1e-8, and 1e-7 with other iterations: these end anywhere below a residual of 1e-9
    of the contact force, of which the torque on the wave generator is a small difference
    iterations : compare Newton iterations too; on other numbers of ranks round-off may cost or save
    one, and a restart predicts its first states from one alone
    """
    rel = rel or (1e-8 if iterations else 1e-7)
    a, b = (history.read_history(path / history.NAME) for path in (folder, other))
    assert [r["step"] for r in a] == [r["step"] for r in b]
    for name in a[0]:
        if name in ("step", "wall_s") or (name == "newton_iterations" and not iterations):
            continue
        left, right = history.column(a, name), history.column(b, name)
        # the balance is nothing but round-off, of the torques
        scale = right if name != "torque_balance_Nmm" else history.column(b, "output_torque_Nmm")
        assert np.abs(left - right).max() <= rel * np.abs(scale).max(), (name, left, right)


def of_session(leader: int) -> list[int]:
    """Processes of a session, and their descendants: the mpirun of MPICH gives its ranks a session
    of their own."""
    parents, found = {}, set()
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                session = os.getsid(int(entry.name))
                status = (entry / "stat").read_text(encoding="utf-8", errors="replace")
            except (ProcessLookupError, FileNotFoundError):  # ended meanwhile
                continue
            parents[int(entry.name)] = int(status.rpartition(")")[2].split()[1])
            if session == leader:
                found.add(int(entry.name))
    while more := {pid for pid, parent in parents.items() if parent in found} - found:
        found |= more
    return sorted(found)


def is_rank(pid: int) -> bool:
    """Whether this process is a rank of a command, and not its mpirun."""
    try:
        words = Path(f"/proc/{pid}/cmdline").read_text(encoding="utf-8").split("\0")
    except (OSError, UnicodeDecodeError):  # ended meanwhile, or another program
        return False
    return "swgpar.cli" in words and not words[0].endswith("mpirun")


def kill_after(command: list[str], out: Path, rows: int) -> None:
    """Start a run and kill all its processes once its history has `rows` rows."""
    process = subprocess.Popen(command, cwd=DATA, env=environment(), start_new_session=True)
    limit = time.monotonic() + 600.0
    try:
        while not (
            (out / "history.csv").exists()
            and len(history.read_history(out / "history.csv")) >= rows
        ):
            assert process.poll() is None and time.monotonic() < limit
            time.sleep(0.05)
    finally:
        for pid in of_session(process.pid):
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        process.wait()
