"""A warm process that computes loaded states of the designs that are shown."""

from __future__ import annotations

import gc
import logging
import os
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any

from swgpar.app.loaded_states import ShownState, StateModel, open_session, solve_state
from swgpar.design.drive_design import DriveDesign
from swgpar.results.atomic import to_json

KEPT = 50
"""States that are kept: undo and a change of the variant show them at once."""

STALE = 1.5
"""Seconds after which a state is given up whose design is not shown any more: one that is nearly
there is a start for the next one."""

PATIENCE = 10.0
"""Seconds in which a computation ends that was given up; else its process is ended, and the next
one begins without what this one knows."""

STARTS = "the solvers are loaded, once"
"""Said of the first state, before its run has a line."""

SAID = 0.5
"""Seconds from one count of residuals to the next one that is said."""

NICE = 5
"""Steps by which the priority of the process is below that of the server."""


@dataclass
class _Running:
    """The state that is computed.

    begun, given_up : s of time.monotonic, 0 of one that is not given up;  line : last one of the
    log
    """

    key: str
    begun: float
    line: str = ""
    given_up: float = 0.0


class StateWorker:
    """Computes states of one model of the designs that are shown, one at a time, and keeps the last
    ones.

    A design that is not shown any more when its turn comes is left out, and its state is given up.
    The process begins with the first design, and stays warm.
    """

    def __init__(self, model: StateModel) -> None:
        self.model = model
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None
        self._running: _Running | None = None
        self._wanted: dict[str, dict[str, Any]] = {}
        self._cancelled: set[str] = set()
        self._states: dict[str, ShownState] = {}

    @property
    def is_busy(self) -> bool:
        """Whether a state of the designs that are shown is missing."""
        return bool(self._missing)

    @property
    def is_cancelled(self) -> bool:
        """Whether a state of the designs that are shown was cancelled."""
        return any(key in self._cancelled for key in self._wanted)

    @property
    def seconds(self) -> float:
        """For how long a state is computed, s; 0 without one."""
        return time.monotonic() - self._running.begun if self._running is not None else 0.0

    @property
    def progress(self) -> str:
        """For how long the state is computed, and where the run is; empty without one."""
        if self._running is None:
            return ""
        if self._running.given_up:
            return "after the one that is given up"
        seconds = f"for {self.seconds:.0f} s"
        return f"{seconds}: {self._running.line}" if self._running.line else seconds

    @property
    def _missing(self) -> list[str]:
        known = self._states.keys() | self._cancelled
        return [key for key in self._wanted if key not in known]

    def state(self, design: DriveDesign) -> ShownState | None:
        """Of a design; None before it is computed."""
        return self._states.get(_key(self.model.table(design)))

    def want(self, designs: Sequence[DriveDesign]) -> None:
        """Ask for the states of the designs that are shown, the most important one first."""
        tables = [self.model.table(design) for design in designs]
        self._wanted = {_key(table): table for table in tables}
        self._cancelled &= self._wanted.keys()
        self.look()

    def cancel(self) -> None:
        """Give up the state; the designs that are shown are computed after a change or `go_on`."""
        self._cancelled.update(self._missing)
        self._give_up()

    def go_on(self) -> None:
        """Compute what was cancelled."""
        self._cancelled.clear()
        self.look()

    def look(self) -> bool:
        """Take over what has been computed, and begin what is asked for; whether there is a new
        state."""
        new, now = self._receive(), time.monotonic()
        missing, running = self._missing, self._running
        if running is not None and running.given_up and now > running.given_up + PATIENCE:
            self.close()
        elif running is not None and running.key not in missing and now > running.begun + STALE:
            self._give_up()
        if self._running is None and missing:
            self._begin(missing[0])
        return new

    def _give_up(self) -> None:
        """Let the computation end after its present Newton iteration."""
        if self._running is not None and self._pipe is not None and not self._running.given_up:
            self._running.given_up = time.monotonic()
            self._pipe.send(None)

    def close(self) -> None:
        """End the process."""
        if self._process is not None and self._pipe is not None:
            self._pipe.close()
            self._process.kill()
            self._process.join()
        self._process = self._pipe = self._running = None

    def _begin(self, key: str) -> None:
        line = ""
        if self._pipe is None:
            line = STARTS
            context = get_context("spawn")
            self._pipe, theirs = context.Pipe()
            self._process = context.Process(
                target=_compute, args=(theirs, self.model.mesh), daemon=True
            )
            self._process.start()
            theirs.close()
        self._pipe.send(self._wanted[key])
        self._running = _Running(key, time.monotonic(), line)

    def _receive(self) -> bool:
        """Take over lines of the log and states; whether there is a state."""
        new = False
        try:
            while self._pipe is not None and self._running is not None and self._pipe.poll():
                found = self._pipe.recv()
                if isinstance(found, str):
                    self._running.line = found
                else:
                    if found.answers or not self._running.given_up:
                        self._keep(self._running.key, found)
                    self._running, new = None, True
        except (EOFError, OSError):
            if self._running is not None:
                self._keep(self._running.key, ShownState((), 0.0, "the computation has ended"))
            self.close()
            new = True
        return new

    def _keep(self, key: str, state: ShownState) -> None:
        self._states.pop(key, None)
        self._states[key] = state
        while len(self._states) > KEPT:
            self._states.pop(next(iter(self._states)))


class RunProgress(logging.Handler):
    """Sends the lines of a run's log, and how many residuals Newton's iteration has tested
    since the last one."""

    def __init__(self, pipe: Connection) -> None:
        super().__init__(logging.INFO)
        self._pipe = pipe
        self._line, self._tested, self._said = "", 0, 0.0

    def emit(self, record: logging.LogRecord) -> None:
        """Send a line."""
        self._line, self._tested = record.getMessage().strip(), 0
        self._send(self._line)

    def stops(self) -> bool:
        """Count a test of the residual; whether the state is given up: whatever comes while one is
        computed does that."""
        self._tested += 1
        if time.monotonic() > self._said + SAID:
            self._send(f"{self._line}; {self._tested} residuals")
        return self._pipe.poll()

    def _send(self, text: str) -> None:
        self._said = time.monotonic()
        self._pipe.send(text)


def _compute(pipe: Connection, mesh: str) -> None:
    """Compute the states that are asked for, until the server ends."""
    os.nice(NICE)  # pictures of the server come first
    threading.Thread(target=_end_with_the_server, daemon=True).start()
    progress = RunProgress(pipe)
    logging.getLogger("swgpar").addHandler(progress)
    session = open_session(stop=progress.stops)
    gc.freeze()  # each run looks for what nobody refers to any more, but not among all modules
    while True:
        try:
            while (table := pipe.recv()) is None:
                pass
        except EOFError:
            return
        try:
            state = solve_state(table, mesh, session)
        except Exception as error:  # a fault of the program must not cost the next state
            state = ShownState((), 0.0, f"{type(error).__name__}: {error}")
        pipe.send(state)


def _end_with_the_server() -> None:
    """End when the server does, also where it is killed."""
    parent = parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


def _key(table: dict[str, Any]) -> str:
    return to_json(table).decode()
