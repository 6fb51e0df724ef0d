"""Locks on results folders: held by a live process, given up by one that was killed; folders
without a name."""

from __future__ import annotations

import errno
import fcntl
import os
import platform
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from filelock import FileLock, SoftFileLock

from support.commands import environment, execute, on_ranks, run_command, swgpar
from support.paths import DESIGN, RECIPE
from swgpar.errors import OutputError
from swgpar.results import lock

HOLD = """
from pathlib import Path
from swgpar.results import lock
lock.acquire(Path({!r}))
print(1, flush=True)
input()
"""


@pytest.fixture
def holder(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that holds the lock of `tmp_path`."""
    pipe = subprocess.PIPE
    command = [sys.executable, "-P", "-c", HOLD.format(str(tmp_path))]
    process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, env=environment())
    assert process.stdout is not None and process.stdout.readline() == "1\n"
    yield process
    process.kill()
    process.communicate()


@lock.releasing
def use(folder: Path) -> None:
    lock.acquire(folder)
    lock.acquire(folder)  # its own lock is none for a process
    assert (folder / lock.NAME).exists()


def test_a_folder_in_use_is_refused(tmp_path: Path, holder: subprocess.Popen[str]) -> None:
    with pytest.raises(
        OutputError, match=f"is in use by process {holder.pid} on {platform.node()} since "
    ):
        use(tmp_path)
    holder.kill()
    holder.wait()
    assert (tmp_path / lock.NAME).exists()
    use(tmp_path)
    assert not (tmp_path / lock.NAME).exists()


def test_the_lock_is_released_after_an_error(tmp_path: Path) -> None:
    @lock.releasing
    def fail() -> None:
        lock.acquire(tmp_path)
        raise OSError

    with pytest.raises(OSError):
        fail()
    use(tmp_path)


@pytest.mark.parametrize(
    ("host", "process", "begun", "refused"),
    [
        ("", os.getpid(), None, True),
        ("", os.getpid(), 1, False),  # the number of an ended process was given to another one
        ("", 2**22 + 1, 1, False),
        ("elsewhere", 2**22 + 1, 1, True),
    ],
    ids=["this process", "its number before", "an ended process", "another machine"],
)
def test_without_locks_the_record_decides(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    host: str,
    process: int,
    begun: int | None,
    refused: bool,
) -> None:
    """As on file systems that are mounted without them."""

    def without(*_: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", without)
    owner = tmp_path / lock.OWNER
    with SoftFileLock(owner):
        _, here, start = owner.read_text(encoding="utf-8").split()
    owner.write_text(f"{process}\n{host or here}\n{begun or start}\n", encoding="utf-8")
    if refused:
        name = host or platform.node()
        with pytest.raises(
            OutputError, match=f"process {process} on {name} since .*remove .*{lock.OWNER}"
        ):
            use(tmp_path)
    else:
        use(tmp_path)


def test_a_lock_file_that_cannot_be_opened_is_no_missing_lock(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def forbidden(*_: object) -> None:
        raise PermissionError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(fcntl, "flock", forbidden)
    with pytest.raises(PermissionError):
        use(tmp_path)


def test_records_of_anything_are_read(tmp_path: Path) -> None:
    for text in ("", "[1]", "\x00\xff", "x\ny\n", 5000 * "{"):
        (tmp_path / lock.NAME).write_text(text, encoding="latin-1")
        use(tmp_path)
        with FileLock(tmp_path / lock.NAME):
            (tmp_path / lock.NAME).write_text(text, encoding="latin-1")
            with pytest.raises(OutputError, match="is in use by another process: "):
                lock.acquire(tmp_path)


@pytest.mark.parametrize("ranks", [1, 2])
def test_two_runs_cannot_write_into_one_folder(
    tmp_path: Path, holder: subprocess.Popen[str], ranks: int
) -> None:
    for more in ((), ("--restart",), ("--overwrite",)):
        done = execute(run_command(tmp_path, *more, ranks=ranks), timeout=120.0)
        (sentence,) = done.stderr.splitlines()
        assert done.returncode == 4
        assert sentence.startswith(
            f"swgpar: error: {tmp_path} is in use by process {holder.pid} on "
        )
    assert sorted(path.name for path in tmp_path.iterdir()) == [lock.NAME]


@pytest.mark.parametrize("command", ["run", "study", "mesh"])
def test_a_folder_needs_a_name(tmp_path: Path, command: str) -> None:
    mesh = ["--mesh", RECIPE] if command != "study" else []
    done = execute(
        [*on_ranks(1), *swgpar(command, DESIGN, *mesh, "--out", "")], cwd=tmp_path, timeout=120.0
    )
    (sentence,) = done.stderr.splitlines()
    assert (
        done.returncode == 2
        and 'out = "" names no folder' in sentence
        and not list(tmp_path.iterdir())
    )
