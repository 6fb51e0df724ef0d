"""The results folder of a run."""

from __future__ import annotations

from pathlib import Path

from mpi4py import MPI

from swgpar.errors import OutputError
from swgpar.results import checkpoint, history
from swgpar.results.atomic import TEMPORARY, agreed, discard, write_file


def prepare(out: Path, comm: MPI.Comm, restart: bool, overwrite: bool) -> None:
    """Make the folder and try to write in it; raises OutputError on all ranks.

    Results of an earlier run are kept: continue them with `restart`, or say `overwrite`.
    """
    with agreed(comm, out):
        if comm.rank == 0:
            out.mkdir(parents=True, exist_ok=True)
            probe = out / f"probe{TEMPORARY}"
            write_file(probe, b"swgpar")
            probe.unlink()
            for left in out.glob(f"*{TEMPORARY}"):
                discard(left)
    there = comm.bcast((out / history.NAME).exists() if comm.rank == 0 else None)
    saved = comm.bcast((out / checkpoint.NAME).exists() if comm.rank == 0 else None)
    if restart and not saved:
        raise OutputError(f"cannot restart from {out}: it has no {checkpoint.NAME}")
    if there and not restart and not overwrite:
        raise OutputError(
            f"{out} already holds results: continue them with --restart, replace them with --overwrite, "
            "or choose another --out"
        )
    if overwrite and not restart:
        with agreed(comm, out):
            if comm.rank == 0:
                for name in (history.NAME, checkpoint.NAME, "summary.json", "fields.xdmf", "fields.h5"):
                    (out / name).unlink(missing_ok=True)
