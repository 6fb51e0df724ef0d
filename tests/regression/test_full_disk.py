"""A disk that fills up in the middle of a run: one sentence, nothing lost, and it goes on once
there is room."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import h5py
import pytest
from mpi4py import MPI

from support.commands import assert_same_history, execute, run_command, succeed
from support.small_disk import Disk, mounted_disk
from support.small_drive import PLANE
from swgpar.analysis.restart import SavedRun
from swgpar.results import checkpoint, history
from swgpar.results.folder import CHECKPOINT


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Disk]:
    with mounted_disk(tmp_path / "disk", 64) as made:
        yield made


def size(folder: Path) -> int:
    return sum(p.stat().st_size for p in folder.rglob("*") if p.is_file())


def assert_one_sentence(done: subprocess.CompletedProcess[str], out: Path) -> None:
    assert done.returncode == 4, done.stderr
    assert "Traceback" not in done.stderr + done.stdout
    (sentence,) = done.stderr.splitlines()
    assert (
        sentence.startswith(f"swgpar: error: cannot write {out}/")
        and "No space left on device" in sentence
    )


def assert_readable(out: Path, plain: Path, fields: bool) -> None:
    """Everything of the increments that were finished is there, and is what it should be."""
    rows, whole = (history.read_history(p / history.NAME) for p in (out, plain))
    done = len(checkpoint.read_checkpoint(out / CHECKPOINT, MPI.COMM_SELF, SavedRun).record.rows)
    # the checkpoint is written last: the increment that it misses may be in the history already
    assert 1 <= done <= len(rows) <= done + 1 < len(whole)
    for row, exact in zip(rows, whole):
        assert row["step"] == exact["step"]
        assert row["fs_vm"] == pytest.approx(exact["fs_vm"], rel=1e-8)
    assert not list(out.rglob("*.tmp")) and not (out / "summary.json").exists()
    if fields:
        with h5py.File(out / "fields.h5", "r") as file:
            for k, row in enumerate(rows):
                assert file[f"increment_{k + 1:04d}/flexible_spline/vm"][:].max() == pytest.approx(
                    row["fs_vm"]
                )


@pytest.mark.parametrize("ranks", [1, 2])
def test_small_disk(plain: Path, disk: Disk, ranks: int) -> None:
    out = disk.place / "run"
    # figures and report are made after the last increment
    needed = size(plain) - size(plain / "figures") - (plain / "report.html").stat().st_size
    disk.grow(int(0.7 * needed / 1024))
    first = [*run_command(out, ranks=ranks), "output.fields=true"]
    assert_one_sentence(execute(first), out)
    assert_readable(out, plain, fields=True)
    disk.grow(64 * 1024)
    succeed([*run_command(out, "--restart", ranks=ranks), "output.fields=true"])
    assert_same_history(out, plain, iterations=False)  # a restart makes its first factor anew
    assert size(out) > 0.9 * needed


def test_something_else_fills_the_disk(plain: Path, disk: Disk) -> None:
    """So full that the history can still be written, the checkpoint not."""
    out = disk.place / "run"
    disk.grow(8 * 1024)
    # one increment, then a run that finds the room for its second checkpoint gone
    succeed(run_command(out, overrides=(*PLANE, "steps.rotation=2.0", "steps.increment=2.0")))
    (out / "summary.json").unlink()
    saved = (out / CHECKPOINT).read_bytes()
    room = os.statvfs(disk.place)
    with open(disk.place / "ballast", "wb") as ballast:
        os.posix_fallocate(ballast.fileno(), 0, room.f_bavail * room.f_bsize - 64 * 1024)
    assert_one_sentence(execute(run_command(out, "--restart")), out)
    assert (out / CHECKPOINT).read_bytes() == saved
    assert len(history.read_history(out / history.NAME)) == 5
    (disk.place / "ballast").unlink()
    succeed(run_command(out, "--restart"))
    assert_same_history(out, plain, iterations=False)
