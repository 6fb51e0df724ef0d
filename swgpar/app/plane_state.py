"""The loaded state of the plane model of a design, in a warm process of its own."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from multiprocessing import get_context, parent_process
from multiprocessing.connection import wait
from typing import TYPE_CHECKING, Any

from swgpar.design.drive_design import DriveDesign
from swgpar.results.atomic import to_json

if TYPE_CHECKING:
    from swgpar.answers.answer import AnswerKind
    from swgpar.api.session import Session
    from swgpar.presentation.loaded_outline import LoadedOutline

SECTIONS = ("drive", "flexible_spline", "ring_gear", "wave_generator", "material", "contact")
"""Sections that the plane model of a cup keeps."""

MESH = "plane_coarse"

MODELS = 2
"""Models that the process keeps: that of a design under several torques, and another one."""

KEPT = 50
"""States that are kept: undo and a change of the variant show them at once."""

NICE = 5
"""Steps by which the priority of the process is below that of the server."""


@dataclass(frozen=True)
class PlaneAnswer:
    """One answer, ready to be shown.

    error : with the unit of the value, None without an estimate
    """

    name: str
    text: str
    value: float
    unit: str
    error: float | None
    place: str


@dataclass(frozen=True)
class PlaneState:
    """Answers of a loaded state; none where it was not found, for a reason.

    seconds : wall seconds;  outline : stresses and pairs of flanks, at the angle 0 of the cam
    """

    answers: tuple[PlaneAnswer, ...]
    seconds: float
    reason: str = ""
    outline: LoadedOutline | None = None


def plane_table(design: DriveDesign) -> dict[str, Any]:
    """Content of the design file of the plane model under the torque of a design, at one angle,
    without windows, on a rigid cam. The plane model has no cup, no crowning and no slope."""
    table = design.model_dump(exclude_unset=True)
    kept = {name: table[name] for name in SECTIONS if name in table}
    kept["drive"] = {**kept["drive"], "model": "plane"}
    # balls take four times as long, and change the largest tension of a start by 0.1 %
    kept["wave_generator"] = {
        name: value for name, value in kept["wave_generator"].items() if name != "bearing"
    }
    return kept | {
        "load": {"torque": design.load.torque},
        "steps": {"rotation": 0.0},
        "output": {"root_stress": False},
    }


def solve_plane(table: dict[str, Any]) -> PlaneState:
    """The state of a design of `plane_table`; failures are reasons. States of one process share
    what does not change."""
    from swgpar.api.runs import load_design  # PETSc starts in the worker alone
    from swgpar.drive_results.drive_data import DriveData
    from swgpar.errors import SwgparError
    from swgpar.presentation.loaded_outline import loaded_outline

    begin = time.perf_counter()
    try:
        result = _session().run(load_design(table), MESH, progress=False)
        assert isinstance(result, DriveData)
        outline = loaded_outline(result)
    except SwgparError as error:
        return PlaneState((), time.perf_counter() - begin, str(error))
    found = map(result.summary.find, _shown())
    answers = tuple(
        PlaneAnswer(one.name, one.text, float(one.value), one.unit, one.error, one.place)
        for one in found
        if one is not None and one.value is not None
    )
    return PlaneState(answers, time.perf_counter() - begin, outline=outline)


def _shown() -> tuple[AnswerKind, ...]:
    """Answers that are shown of a state."""
    from swgpar.evaluation.largest_contact import EDGE_FORCE, FLANK_PRESSURE
    from swgpar.evaluation.load_sharing import FORCE_SHARE, PAIRS
    from swgpar.largest_stress.places import stress_kind

    stresses = stress_kind("fs", "s1"), stress_kind("rg", "s1")
    return (*stresses, FLANK_PRESSURE, EDGE_FORCE, PAIRS, FORCE_SHARE)


@cache
def _session() -> Session:
    from swgpar.api.session import Session

    return Session(models=MODELS, starts_near=True)


def _make_pool() -> ProcessPoolExecutor:
    return ProcessPoolExecutor(1, mp_context=get_context("spawn"), initializer=_start)


def _start() -> None:
    """Give way to the pictures of the server; end when it does, also where it is killed."""
    os.nice(NICE)
    parent = parent_process()
    if parent is None:
        return

    def watch() -> None:
        wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


class PlaneWorker:
    """Computes states of the designs that are shown, one at a time, and keeps the last ones.

    A design that is not shown any more when its turn comes is left out.
    """

    def __init__(self) -> None:
        self._pool = _make_pool()
        self._running: tuple[str, Future[PlaneState]] | None = None
        self._wanted: dict[str, dict[str, Any]] = {}
        self._states: dict[str, PlaneState] = {}

    @property
    def is_busy(self) -> bool:
        """Whether a state of the designs that are shown is missing."""
        return any(key not in self._states for key in self._wanted)

    def state(self, design: DriveDesign) -> PlaneState | None:
        """Of a design; None before it is computed."""
        return self._states.get(_key(plane_table(design)))

    def want(self, designs: Sequence[DriveDesign]) -> None:
        """Ask for the states of the designs that are shown, the most important one first."""
        tables = [plane_table(design) for design in designs]
        self._wanted = {_key(table): table for table in tables}
        self.look()

    def look(self) -> bool:
        """Take over what has been computed, and begin what is asked for; whether there is a new
        state."""
        new = False
        if self._running is not None and self._running[1].done():
            (key, future), self._running, new = self._running, None, True
            failure = future.exception()
            self._states.pop(key, None)
            self._states[key] = (
                future.result() if failure is None else PlaneState((), 0.0, str(failure))
            )
            if failure is not None:  # the process has ended
                self._pool.shutdown(wait=False)
                self._pool = _make_pool()
            while len(self._states) > KEPT:
                self._states.pop(next(iter(self._states)))
        missing = [key for key in self._wanted if key not in self._states]
        if self._running is None and missing:
            future = self._pool.submit(solve_plane, self._wanted[missing[0]])
            self._running = missing[0], future
        return new

    def close(self) -> None:
        """End the process."""
        self._pool.shutdown(wait=False, cancel_futures=True)


def _key(table: dict[str, Any]) -> str:
    return to_json(table).decode()
