"""Signals and signs of life while the interpreter answers nothing: it is in a call that keeps its
lock."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

import pytest
from mpi4py import MPI

from support.cam_ring import ring_on_cam
from support.commands import environment
from swgpar import watch

# PyDLL keeps the interpreter's lock: no Python code runs in these seconds, no handler either
BUSY = """
import ctypes
from swgpar import watch
from swgpar.watch import _watch
watch.INTERVAL = 0.5
with watch.armed():
    print("begun", flush=True)
    {begin}
    ctypes.PyDLL(None).sleep({seconds})
"""
BEGIN = (
    "watch.begin('increments', 'results', restarts=True, terminal={terminal}); "
    "watch.saved('increments', 3, 7)"
)


def busy(
    begin: str = "", seconds: int = 60, rank: int = 0, **more: object
) -> subprocess.Popen[str]:
    command = [sys.executable, "-P", "-c", BUSY.format(begin=begin, seconds=seconds)]
    pipe = subprocess.PIPE
    process = subprocess.Popen(
        command,
        stdout=pipe,
        stderr=pipe,
        text=True,
        env={**environment(), "PMI_RANK": str(rank)},
        **more,
    )
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    time.sleep(0.5)
    return process


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_a_process_at_once(number: signal.Signals) -> None:
    process = busy(BEGIN.format(terminal=True))
    process.send_signal(number)
    _, stderr = process.communicate(timeout=20)
    assert process.returncode == (130 if number == signal.SIGINT else 143)
    words = "3 of 7 increments are saved in results; the same command with --restart continues"
    assert stderr.endswith(f"swgpar: stopped by {number.name}: {words}\n") and "\x1b[?25h" in stderr


@pytest.mark.parametrize(
    ("begin", "words"),
    [
        ("", "nothing is written"),
        (
            "watch.begin('increments', 'a\\x1bb', restarts=True, terminal=False)",
            r"nothing is saved in a\x1bb; the same",
        ),
        (
            "watch.begin('increments', 'x', restarts=False, terminal=False); "
            "watch.saved('increments', 1, 1)",
            "again",
        ),
        (
            "watch.begin('cases', 'x', restarts=True, terminal=False); watch.saved('increments', "
            "1, 1)",
            "nothing is",
        ),
        (
            "watch.begin('cases', 'x', restarts=True, terminal=False); watch.saved('cases', 1, 9)",
            "1 of 9 cases are",
        ),
    ],
)
def test_the_sentence_says_what_is_saved(begin: str, words: str) -> None:
    process = busy(begin)
    process.terminate()
    _, stderr = process.communicate(timeout=20)
    (sentence,) = stderr.splitlines()
    assert process.returncode == 143 and words in sentence


def test_other_ranks_say_nothing() -> None:
    process = busy(rank=1)
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=20)[1] == "" and process.returncode == 130


def test_ignored_signals_stay_ignored() -> None:
    """As under nohup."""
    process = busy(seconds=2, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    process.send_signal(signal.SIGHUP)
    assert process.communicate(timeout=20)[1] == "" and process.returncode == 0


def test_handlers_are_restored() -> None:
    code = (
        "import signal\nfrom swgpar import watch\nwith watch.armed():\n    pass\nwatch.rearm()\n"
        "try:\n    signal.raise_signal(signal.SIGINT)\nexcept KeyboardInterrupt:\n    "
        "print('interrupted')"
    )
    done = subprocess.run(
        [sys.executable, "-P", "-c", code], capture_output=True, text=True, timeout=60
    )
    assert done.stdout == "interrupted\n" and not done.stderr


def test_there_is_a_sign_of_life_without_a_terminal() -> None:
    process = busy(BEGIN.format(terminal=False) + "; watch.doing('load 1.5 degrees')", seconds=2)
    stdout, stderr = process.communicate(timeout=20)
    lines = stdout.splitlines()
    assert process.returncode == 0 and not stderr and 2 <= len(lines) <= 4
    assert all("  load 1.5 degrees, no news for " in line for line in lines)


def test_there_is_none_on_a_terminal_or_after_other_output() -> None:
    quiet = "\n    ".join(["", *3 * ["watch.note_output(); ctypes.PyDLL(None).usleep(300000)"]])
    for begin in (BEGIN.format(terminal=True), BEGIN.format(terminal=False) + quiet):
        process = busy(begin, seconds=0 if quiet in begin else 1)
        assert process.communicate(timeout=20) == ("", "") and process.returncode == 0


def test_every_newton_iteration_is_a_sign_of_life(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of every model: a run also solves on coarser meshes and in windows."""
    said: list[str] = []
    monkeypatch.setattr(watch, "doing", said.append)
    ring_on_cam(0, True, True, 2, "direct", MPI.COMM_SELF)
    assert said[0].startswith("deflect 0.00 degrees, ") and ", Newton iteration 0, " in said[0]
    assert ", Newton iteration 1, " in said[1]
