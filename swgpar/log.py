"""Log of a run on several ranks: only rank 0 writes, to the terminal and to run.log.

Progress is one line per increment, in both; a terminal shows a bar below it. `PhaseTimes` adds up
wall seconds by phase name.
"""

from __future__ import annotations

import logging
import os
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from mpi4py import MPI
from rich.console import Console
from rich.logging import RichHandler
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from swgpar import watch
from swgpar.errors import printable

logger = logging.getLogger("swgpar")


def ranks_text(count: int) -> str:
    """How many ranks there are, as "2 ranks"."""
    return f"{count} rank{'' if count == 1 else 's'}"


def _printable(record: logging.LogRecord) -> bool:
    """Escape what a message holds of control characters: paths and values of a user may."""
    record.msg, record.args = printable(record.getMessage()), None
    return True


logger.addFilter(_printable)


def _redirected() -> bool:
    """Whether mpirun, or its daemon on another node, writes into a file or pipe: ranks have a
    terminal all the same."""
    if "OMPI_COMM_WORLD_RANK" not in os.environ:
        return False
    try:
        return not os.readlink(f"/proc/{os.getppid()}/fd/1").startswith("/dev/")
    except OSError:
        return False


console = Console(
    file=sys.stdout,
    force_terminal=False if _redirected() else None,
    highlight=False,
    soft_wrap=True,
)


class _Ending(logging.Handler):
    """Where it cannot write the run goes on, without a traceback."""

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 (name given by logging)
        self.setLevel(logging.CRITICAL + 1)


class _RunLog(_Ending, logging.FileHandler):
    """Appends to run.log."""


class _Plain(_Ending, logging.StreamHandler):
    """Writes to a file or pipe in the place of a terminal."""

    def emit(self, record: logging.LogRecord) -> None:
        super().emit(record)
        watch.note_output()


class _ToRoot(logging.Handler):
    """Passes records to the handlers of the root logger, or Python shows warnings on stderr."""

    def emit(self, record: logging.LogRecord) -> None:
        logging.getLogger().handle(record)


@contextmanager
def session(comm: MPI.Comm, *, terminal: bool = True, shown: bool = True) -> Iterator[None]:
    """Log a run inside the `with` block: rank 0 logs, the other ranks are silent. The logger is
    restored at the end.

    Handlers that a program has attached to the logger "swgpar" stay, and get the log of rank 0.

    comm : communicator of the run;  terminal : whether rank 0 shows everything on the terminal
    shown : without `terminal`: whether messages go where those of other libraries go, as far as the
        levels that the program has set allow: warnings to stderr, if it has set nothing
    """
    level, propagate, present = logger.level, logger.propagate, logger.handlers
    handler: logging.Handler = logging.NullHandler()
    if comm.rank == 0:
        if terminal:
            handler = _terminal_handler()
        elif shown and propagate and (logging.getLogger().handlers or not present):
            handler = _ToRoot(logger.getEffectiveLevel())
        logger.setLevel(min(logging.INFO, logger.getEffectiveLevel()))
    else:
        logger.setLevel(logging.CRITICAL + 1)
    logger.propagate = False
    logger.addHandler(handler)
    try:
        yield
    finally:
        close_file()
        logger.removeHandler(handler)
        logger.propagate = propagate
        logger.setLevel(level)


def _terminal_handler() -> logging.Handler:
    if console.is_terminal:
        return RichHandler(
            console=console,
            show_path=False,
            show_level=False,
            markup=False,
            log_time_format="%H:%M:%S",
            omit_repeated_times=False,
        )
    plain = _Plain(sys.stdout)
    plain.setFormatter(logging.Formatter("%(asctime)s  %(message)s", "%H:%M:%S"))
    return plain


def to_file(path: Path, comm: MPI.Comm) -> None:
    """Append the log of rank 0 to a file as well; an earlier log file of this process is closed."""
    if comm.rank != 0:
        return
    close_file()
    handler = _RunLog(path, mode="a", encoding="utf-8")
    handler.setFormatter(logging.Formatter("%(asctime)s  %(levelname)-7s  %(message)s"))
    logger.addHandler(handler)


def close_file() -> None:
    """Close the log file of this process, if there is one."""
    for handler in [h for h in logger.handlers if isinstance(h, _RunLog)]:
        logger.removeHandler(handler)
        with suppress(OSError):  # a full disk, of which the other files tell
            handler.close()


class IncrementProgress:
    """One line per increment, and a progress bar when rank 0 has a terminal.

    total : increments of the whole run;  done : of them, by a run before;  terminal : shows a bar
    """

    def __init__(self, comm: MPI.Comm, total: int, *, done: int = 0, terminal: bool = True) -> None:
        self._bar: Progress | None = None
        self._task: TaskID | None = None
        self._total, self._count = total, done
        watch.saved("increments", done, total)
        if comm.rank == 0 and console.is_terminal and terminal:
            self._bar = progress_bar()
            self._task = self._bar.add_task("start", total=total, completed=done)

    def __enter__(self) -> IncrementProgress:
        if self._bar:
            self._bar.start()
        return self

    def __exit__(self, *exc_info: object) -> None:
        if self._bar:
            self._bar.stop()

    def newton(self, step: str, angle_deg: float, iteration: int, residual: float) -> None:
        """Report a Newton iteration on the bar, and in the log at DEBUG level."""
        if self._bar and self._task is not None:
            self._bar.update(
                self._task,
                description=f"{step} {angle_deg:.2f}° Newton {iteration} residual {residual:.1e}",
            )
        logger.debug(
            "   %s %.3f deg  Newton %d  residual %.3e", step, angle_deg, iteration, residual
        )

    def increment(
        self, step: str, angle_deg: float, iterations: int, residual: float, seconds: float
    ) -> None:
        """Report a converged increment."""
        self._count += 1
        watch.saved("increments", self._count, self._total)
        logger.info(
            "%3d/%d  %-8s %8.3f deg  %2d Newton iterations  residual %.1e  %7.1f s",
            self._count,
            self._total,
            step,
            angle_deg,
            iterations,
            residual,
            seconds,
        )
        if self._bar and self._task is not None:
            self._bar.update(self._task, completed=self._count)


def progress_bar() -> Progress:
    """A bar below the log on the terminal that disappears when it is stopped."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=console,
        transient=True,
    )


class PhaseTimes:
    """Wall seconds added up by phase name.

    Phases may be nested; each counts its full time, so that only those of one depth add up.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        """Time what is inside the `with` block."""
        begin = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] += time.perf_counter() - begin

    def slowest(self, comm: MPI.Comm) -> dict[str, float]:
        """Seconds by phase on the slowest rank of each; collective."""
        merged: dict[str, float] = {}
        for seconds in comm.allgather(dict(self.seconds)):
            for name, value in seconds.items():
                merged[name] = max(merged.get(name, 0.0), value)
        return merged
