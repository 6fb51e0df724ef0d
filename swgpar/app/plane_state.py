"""The loaded state of the plane model of a design, in a warm process of its own."""

from __future__ import annotations

import os
import threading
import time
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from multiprocessing.connection import wait
from typing import Any

from swgpar.design.drive_design import DriveDesign

SECTIONS = ("drive", "flexible_spline", "ring_gear", "wave_generator", "material", "contact")
"""Sections that the plane model of a cup keeps."""

MESH = "plane_coarse"

SHOWN = (
    "largest.fs_s1",
    "largest.rg_s1",
    "contact.pressure",
    "contact.edge_force",
    "sharing.pairs",
    "sharing.largest_force_share",
    "bearing.largest_load",
    "bearing.pressure",
)
"""Answers of the state, by name."""


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

    seconds : wall seconds
    """

    answers: tuple[PlaneAnswer, ...]
    seconds: float
    reason: str = ""


def plane_table(design: DriveDesign) -> dict[str, Any]:
    """Content of the design file of the plane model under the torque of a design, at one angle,
    without windows. The plane model has no cup, no crowning and no slope."""
    table = design.model_dump(exclude_unset=True)
    kept = {name: table[name] for name in SECTIONS if name in table}
    kept["drive"] = {**kept["drive"], "model": "plane"}
    if "bearing" in kept["wave_generator"]:
        bearing = dict(kept["wave_generator"]["bearing"])
        bearing.pop("race_taper", None)
        kept["wave_generator"] = {**kept["wave_generator"], "bearing": bearing}
    return kept | {
        "load": {"torque": design.load.torque},
        "steps": {"rotation": 0.0},
        "output": {"root_stress": False},
    }


def solve_plane(table: dict[str, Any]) -> PlaneState:
    """The state of a design of `plane_table`; failures are reasons."""
    from swgpar.api.runs import load_design, run  # PETSc starts in the worker alone
    from swgpar.errors import SwgparError

    begin = time.perf_counter()
    try:
        result = run(load_design(table), MESH, progress=False)
    except SwgparError as error:
        return PlaneState((), time.perf_counter() - begin, str(error))
    found = (result.summary.get(name) for name in SHOWN)
    answers = tuple(
        PlaneAnswer(one.name, one.text, float(one.value), one.unit, one.error, one.place)
        for one in found
        if one is not None and one.value is not None
    )
    return PlaneState(answers, time.perf_counter() - begin)


def _make_pool() -> ProcessPoolExecutor:
    return ProcessPoolExecutor(1, mp_context=get_context("spawn"), initializer=_end_with_parent)


def _end_with_parent() -> None:
    """Let this process end when the server does, also where that is killed."""
    parent = parent_process()
    if parent is None:
        return

    def watch() -> None:
        wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


class PlaneWorker:
    """Computes one state at a time; the latest design that is asked for comes next, those between
    are left out."""

    def __init__(self) -> None:
        self._pool = _make_pool()
        self._running: Future[PlaneState] | None = None
        self._next: dict[str, Any] | None = None
        self._wanted: dict[str, Any] | None = None
        self.state: PlaneState | None = None

    @property
    def is_busy(self) -> bool:
        """Whether the state is not that of the design asked for last."""
        return self._running is not None

    def want(self, design: DriveDesign) -> None:
        """Ask for the state of a design, unless it is that asked for last."""
        table = plane_table(design)
        if table == self._wanted:
            return
        self._wanted = self._next = table
        self.look()

    def look(self) -> bool:
        """Take over what has been computed, and begin what is asked for; whether the state is a new
        one."""
        new = False
        if self._running is not None and self._running.done():
            failure = self._running.exception()
            self.state = (
                self._running.result() if failure is None else PlaneState((), 0.0, str(failure))
            )
            if failure is not None:  # the process has ended
                self._pool.shutdown(wait=False)
                self._pool = _make_pool()
            self._running, new = None, True
        if self._running is None and self._next is not None:
            self._running = self._pool.submit(solve_plane, self._next)
            self._next = None
        return new

    def close(self) -> None:
        """End the process."""
        self._pool.shutdown(wait=False, cancel_futures=True)
