"""Loaded states of a design, of the plane model and of the drive in 3D: what is computed, and what
of it is shown."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from swgpar.design.drive_design import DriveDesign

if TYPE_CHECKING:
    from swgpar.answers.answer import AnswerKind
    from swgpar.api.runs import MeshLike
    from swgpar.api.session import Session
    from swgpar.presentation.loaded_outline import LoadedOutline

PLANE_SECTIONS = "drive", "flexible_spline", "ring_gear", "wave_generator", "material", "contact"
"""Sections that the plane model of a cup keeps."""

MORE = "stiffness", "ratcheting", "fatigue", "losses", "frequencies", "rating"
"""Sections that ask for more than the loaded state."""

ONE_STATE = {
    "steps": {"rotation": 0.0},
    "output": {"root_stress": False, "bearing_shares": False},
}
"""One angle of the cam, without windows and without what is not shown."""

KEPT_MODELS = 2
"""Models that a process keeps: that of a design under several torques, and another one."""


@dataclass(frozen=True)
class ShownAnswer:
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
class ShownState:
    """Answers of a loaded state; none where it was not found, for a reason.

    seconds : wall seconds;  outline : stresses and pairs of flanks, at the angle 0 of the cam
    """

    answers: tuple[ShownAnswer, ...]
    seconds: float
    reason: str = ""
    outline: LoadedOutline | None = None


def plane_table(design: DriveDesign) -> dict[str, Any]:
    """Content of the design file of the plane model under the torque of a design, at one angle,
    without windows, on a rigid cam. The plane model has no cup, no crowning and no slope."""
    table = design.model_dump(exclude_unset=True)
    kept = {name: table[name] for name in PLANE_SECTIONS if name in table}
    kept["drive"] = {**kept["drive"], "model": "plane"}
    # balls take four times as long, and change the largest tension of a start by 0.1 %
    kept["wave_generator"] = {
        name: value for name, value in kept["wave_generator"].items() if name != "bearing"
    }
    return kept | {"load": {"torque": design.load.torque}} | ONE_STATE


def solid_table(design: DriveDesign) -> dict[str, Any]:
    """Content of the design file of the drive itself under its torque, at one angle, without
    windows: with its cup, its bearing, crowning and slope."""
    table = design.model_dump(exclude_unset=True)
    kept = {name: value for name, value in table.items() if name not in MORE}
    load = {name: value for name, value in kept.get("load", {}).items() if name != "program"}
    return kept | {"load": load} | ONE_STATE


@dataclass(frozen=True)
class StateModel:
    """A model whose loaded state is computed beside a design.

    name : that is shown;  mesh : recipe;  table : content of the design file that is run
    """

    name: str
    mesh: str
    table: Callable[[DriveDesign], dict[str, Any]]


PLANE = StateModel("plane model", "plane_coarse", plane_table)
SOLID = StateModel("3D model", "coarse", solid_table)


def solve_state(table: dict[str, Any], mesh: MeshLike, session: Session) -> ShownState:
    """The state of a design that `StateModel.table` gives; failures are reasons. States of one
    session share what does not change."""
    from swgpar.api.runs import load_design  # PETSc starts in the worker alone
    from swgpar.drive_results.drive_data import DriveData
    from swgpar.errors import SwgparError
    from swgpar.presentation.loaded_outline import loaded_outline

    begin = time.perf_counter()
    try:
        result = session.run(load_design(table), mesh, progress=False)
        assert isinstance(result, DriveData)
        outline = loaded_outline(result)
    except SwgparError as error:
        return ShownState((), time.perf_counter() - begin, str(error))
    found = map(result.summary.find, _shown())
    answers = tuple(
        ShownAnswer(one.name, one.text, float(one.value), one.unit, one.error, one.place)
        for one in found
        if one is not None and one.value is not None
    )
    return ShownState(answers, time.perf_counter() - begin, outline=outline)


def _shown() -> tuple[AnswerKind, ...]:
    """Answers that are shown of a state."""
    from swgpar.evaluation.largest_contact import EDGE_FORCE, FLANK_PRESSURE
    from swgpar.evaluation.load_sharing import FORCE_SHARE, PAIRS
    from swgpar.largest_stress.places import stress_kind

    stresses = stress_kind("fs", "s1"), stress_kind("fs", "vm"), stress_kind("rg", "s1")
    return (*stresses, FLANK_PRESSURE, EDGE_FORCE, PAIRS, FORCE_SHARE)


def open_session(stop: Callable[[], bool] | None = None) -> Session:
    """A session for loaded states. stop : see `Session`"""
    from swgpar.analysis import run_drive  # noqa: F401  (here, not within the first state)
    from swgpar.api.session import Session

    return Session(models=KEPT_MODELS, starts_near=True, stop=stop)
