"""Tests on several ranks: only rank 0 reports, a test fails on all ranks or on none, and no failure
can hang.

A test says by `@pytest.mark.parallel` (plugin mpi-pytest) on how many ranks it runs; without that
it runs on one. The setting `-m parallel[match]` selects the tests of the number of ranks that
pytest itself was started on.

The tests that `slow.txt` names run with `--slow`, or when the command line names them.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path

import pytest
from mpi4py import MPI

WAIT = 60.0
"""s that a rank on which a test has failed waits for the other ranks, before it ends all of
them."""

ranks = (
    MPI.COMM_WORLD.Dup()
)  # not the communicator of the tests: their messages must not be taken for these

for _number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    # nohup, or a script's background job, ignores them: child processes would inherit that
    if signal.getsignal(_number) is signal.SIG_IGN:
        signal.signal(
            _number, signal.default_int_handler if _number == signal.SIGINT else signal.SIG_DFL
        )

SLOW = Path(__file__).with_name("slow.txt")
"""Tests that take ten seconds or more, and longer ones that a test of the same on fewer or more
ranks, or of another drive, stands beside; one on a line."""

OF_RANKS = "mpi", "stability"
"""Folders with tests of several ranks: under mpirun `scripts/test` collects no others."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--slow", action="store_true", help="run the tests of slow.txt too")


def pytest_itemcollected(item: pytest.Item) -> None:
    folder = item.path.relative_to(SLOW.parent).parts[0]
    if item.get_closest_marker("parallel") and folder not in OF_RANKS:
        raise pytest.UsageError(f"{item.nodeid}: tests of several ranks lie in {OF_RANKS}")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--slow") or any("::" in argument for argument in config.args):
        return
    slow = set(SLOW.read_text(encoding="utf-8").splitlines())
    left_out = [item for item in items if item.nodeid in slow]
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if item.nodeid not in slow]


@pytest.hookimpl(trylast=True)
def pytest_configure(config: pytest.Config) -> None:
    if ranks.rank != 0:
        reporter = config.pluginmanager.get_plugin("terminalreporter")
        if reporter is not None:
            reporter._tw._file = open(os.devnull, "w")  # noqa: SIM115  # until the process ends


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo):
    outcome = yield
    if call.when == "teardown" or ranks.size == 1:
        return
    report = outcome.get_result()
    meet(report)
    texts = ranks.allgather(report.longreprtext if report.failed else "")
    if any(texts) and not report.failed:
        report.outcome = "failed"
        report.longrepr = "\n".join(
            f"on rank {rank}:\n{text}" for rank, text in enumerate(texts) if text
        )


def meet(report: pytest.TestReport) -> None:
    """Wait for all ranks; a rank whose test has failed does not wait for ever, as the others may
    wait for it."""
    request, begin = ranks.Ibarrier(), time.monotonic()
    while not request.Test():
        if report.failed and time.monotonic() - begin > WAIT:
            print(
                f"rank {ranks.rank}: {report.nodeid}\n{report.longreprtext}",
                file=sys.stderr,
                flush=True,
            )
            ranks.Abort(1)
        time.sleep(1e-3)
