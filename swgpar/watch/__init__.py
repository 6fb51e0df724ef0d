"""What ends a command and what shows that it lives: signals, and a line where nothing else is
written for long.

Both work while the interpreter is in a long call of a library, a factorisation or the wait for
another rank. A signal ends the process at once: results are complete on the disk after every
increment. mpirun then ends the other ranks. The sentence comes from rank 0.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

from swgpar.errors import printable, shortened
from swgpar.watch import _watch
from swgpar.watch._watch import note_output

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)

RANK = ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK")
"""Variables with the rank of a process that mpirun has started, before MPI has started."""

INTERVAL = 25.0
"""Seconds without output after which there is a sign of life."""

PATH_LETTERS = 1000
"""Of the folder in a sentence."""

CLEAN = "\r\x1b[K\x1b[?25h"
"""Takes a progress bar off a terminal and shows the cursor again."""


@dataclass(frozen=True)
class _Command:
    """What the sentence of the present command is made of; `kind` is empty where this process says
    nothing."""

    armed: bool = False
    kind: str = ""
    saved: str = ""
    restarts: bool = False
    before: str = ""


_command = _Command()


def _set_command(command: _Command) -> None:
    global _command  # noqa: PLW0603  # a signal has one receiver in a process
    _command = command


@contextmanager
def armed() -> Iterator[None]:
    """Let signals end the process inside the block with one sentence, and exit code 130 (SIGINT) or
    143.

    A signal that the process was started to ignore (nohup) stays ignored.
    """
    earlier = {number: signal.getsignal(number) for number in SIGNALS}
    first = next((os.environ[name] for name in RANK if name in os.environ), "0") == "0"
    _watch.set_sentence(b"swgpar: stopped by ", b": nothing is written\n" if first else b"")
    _set_command(_Command(armed=True))
    rearm()
    try:
        yield
    finally:
        _watch.stop_heart()
        _watch.set_sentence(b"", b"")
        _set_command(_Command())
        for number, handler in earlier.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


def rearm() -> None:
    """Handle the signals again after a library has taken them, inside `armed`: PETSc does when it
    starts."""
    if not _command.armed:
        return
    for number in SIGNALS:
        if signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, signal.SIG_IGN)
        else:
            _watch.arm(number)
    # PETSc ends all ranks when the reader of the output has gone; Python raises BrokenPipeError
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)


def begin(kind: str, out: str, *, restarts: bool, terminal: bool) -> None:
    """Say from here on how much is saved when a signal ends the command; call it on rank 0 only.

    kind : what is counted by `saved`: "increments", "cases", "evaluations" or "runs"
    out : folder of the results;  restarts : whether --restart continues them
    terminal : whether a progress bar may be on the terminal; without one there are signs of life
    """
    folder, before = shortened(printable(out), PATH_LETTERS), CLEAN if terminal else ""
    _set_command(replace(_command, kind=kind, saved=folder, restarts=restarts, before=before))
    saved(kind, 0, 0)
    doing("still computing")
    if not terminal:
        _watch.start_heart(INTERVAL)


def saved(kind: str, done: int, total: int) -> None:
    """So many increments or cases are complete on the disk. Counts that the command does not ask
    for are left out."""
    if kind != _command.kind:
        return
    how = (
        f"{done} of {total} {kind} are saved in {_command.saved}; the same command with --restart "
        "continues"
    )
    if not (done and _command.restarts):
        how = f"nothing is saved in {_command.saved}; the same command starts again"
    _watch.set_sentence(f"{_command.before}swgpar: stopped by ".encode(), f": {how}\n".encode())


def doing(text: str) -> None:
    """What the sign of life says."""
    if _command.kind:
        _watch.set_sign_of_life(printable(text).encode())


__all__ = ["armed", "begin", "doing", "note_output", "rearm", "saved"]
