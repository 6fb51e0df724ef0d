"""What studies and optimisations do alike: they claim a folder, and share many runs among ranks."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path

from mpi4py import MPI

from swgpar import log, watch
from swgpar.errors import OutputError
from swgpar.log import console
from swgpar.results import made_files
from swgpar.results.atomic import agreed
from swgpar.results.lock import acquire
from swgpar.run_options import RunOptions
from swgpar.studies.job import remove_runs
from swgpar.tasks import Send, share_tasks


def claim_folder(
    out: Path,
    options: RunOptions,
    what: str,
    marks: Iterable[str],
    written: Iterable[str],
    runs: str = "",
) -> None:
    """Make and lock a folder. `releasing` must decorate the caller; collective.

    what : the folder holds, in messages;  marks : names in it of which one is there then
    written : patterns of the names of its own files;  runs : folder in it of the runs
    """
    restart, overwrite = options.restart, options.overwrite
    with agreed(options.comm, out):
        if options.comm.rank == 0:
            out.mkdir(parents=True, exist_ok=True)
            acquire(out)
            if not overwrite and not restart and any((out / mark).exists() for mark in marks):
                raise OutputError(
                    f"{out} already holds {what}: continue it with restart = true (--restart), "
                    "replace it with overwrite = true (--overwrite), or choose another folder"
                )
            if restart:
                made_files.begin(out, written)
            made_files.require_own(out, written)
            made_files.begin(out)
            if runs:
                made_files.refuse_link(out / runs)
                (out / runs).mkdir(exist_ok=True)
            if overwrite and not restart:
                if runs:
                    remove_runs(out / runs)
                made_files.remove(out, written)


def do_runs(
    comm: MPI.Comm,
    parallel: str,
    count: int,
    run: Callable[[int, MPI.Comm, Send], None],
    receive: Send | None,
) -> None:
    """Do the runs 0 to `count` - 1: each on one rank ("cases"), or on all ranks ("ranks");
    collective.

    run : called with a number, the communicator of the run, and what sends a message to rank 0
    receive : takes the messages on rank 0, None on other ranks
    """
    alone, send = parallel == "cases", receive or (lambda _: None)
    with log.session(MPI.COMM_SELF if alone else comm, terminal=False, shown=False):
        if alone:
            share_tasks(comm, count, lambda number, send: run(number, MPI.COMM_SELF, send), send)
        else:
            for number in range(count):
                run(number, comm, send)


def note_ended(kind: str, ended: int, count: int) -> None:
    """So many of the "cases", "evaluations" or "runs" have ended, for `watch`."""
    watch.saved(kind, ended, count)
    watch.doing(f"{ended} of {count} {kind} have ended")


def print_line(words: list[str]) -> None:
    """Print a line. Where the reader of the output has gone, the other ranks are at work still."""
    with suppress(OSError, SystemExit):
        console.print("  ".join(words), markup=False)
        watch.note_output()
