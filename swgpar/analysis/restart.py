"""Checkpoint of a run: what is written after every increment, and how a run continues from it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from swgpar.analysis.identity import RunContent
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.run_record import RunRecord
from swgpar.analysis.saved_state import SolvedState, restore_state, state_rows
from swgpar.errors import InputError
from swgpar.evaluation.stress_cycle import StressCycle
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel
from swgpar.results import checkpoint, parallel_hdf5
from swgpar.results.folder import CHECKPOINT
from swgpar.results.parallel_hdf5 import Block


@dataclass(frozen=True)
class SavedRun:
    """Content of a checkpoint beside the rows of the state.

    identity : of what is computed;  load_state : that is reached
    computed : content of the `RunContent` of that identity; None in older files
    cycle : of `StressCycle.state`
    wall_s : of the run so far;  phases_s : by name
    """

    identity: str
    record: RunRecord
    load_state: LoadState
    solved: SolvedState
    cycle: dict[str, list[int]] | None
    wall_s: float
    phases_s: dict[str, float]
    computed: dict[str, Any] | None = None


def save_run(
    out: Path,
    computed: RunContent,
    stepper: LoadStepper,
    record: RunRecord,
    cycle: StressCycle | None,
    displacement: Mapping[str, np.ndarray],
    elapsed: float,
) -> None:
    """Write the checkpoint of the present state; collective.

    displacement : as `state_rows` takes it;  elapsed : wall seconds of the whole run
    """
    model = stepper.model
    blocks = state_rows(model, displacement)
    if cycle is not None:
        first, _ = model.partition.owned_sectors(FLEXIBLE_SPLINE)
        count = model.partition.layouts[FLEXIBLE_SPLINE].count
        blocks |= {name: Block(values, first, count) for name, values in cycle.rows().items()}
    content = SavedRun(
        computed.identity,
        record,
        stepper.load_state,
        SolvedState.of(model),
        None if cycle is None else cycle.state(),
        elapsed,
        model.phases.slowest(model.comm),
        dict(computed.content),
    )
    checkpoint.write_checkpoint(out / CHECKPOINT, model.comm, blocks, content)


def resume_run(
    out: Path,
    computed: RunContent,
    stepper: LoadStepper,
    cycle: StressCycle | None,
) -> tuple[SavedRun, tuple[LoadState, ...]]:
    """Bring back the state of the checkpoint, on any number of ranks; collective.

    computed : by the run that is to be continued

    Returns what is saved, and the load states of the run: without those on other meshes.
    """
    model, path = stepper.model, out / CHECKPOINT
    saved = checkpoint.read_checkpoint(path, model.comm, SavedRun)
    if saved.identity != computed.identity:
        there = None if saved.computed is None else RunContent(saved.computed)
        differs = "" if there is None else f" ({computed.differs_from(there)})"
        raise InputError(
            f"restart: {path} belongs to another design, recipe, accuracy or solver setting"
            f"{differs}; allowed are the same ones (--plain as before), only steps.rotation, the "
            "output, solver.linear, keep_factor, far_teeth and limits may differ"
        )
    checkpoint.require_undamaged(path, model.comm)
    record, last, sequence = saved.record, saved.load_state, stepper.sequence
    states = sequence.from_loaded if record.starts_loaded or record.accuracy else sequence.states
    if not _continues(record, last, states):
        raise InputError(
            f"restart: steps.rotation = {model.design.steps.rotation:g} does not continue {path}, "
            f"which ends at {np.degrees(last.angle):g} degrees; allowed are values with this angle "
            "among their increments"
        )
    restore_state(model, path, saved.solved)
    if cycle is not None:
        _resume_cycle(cycle, saved, path, model)
    stepper.resume_at(last)
    for name, value in saved.phases_s.items():
        model.phases.seconds[name] += value
    return saved, states


def _continues(record: RunRecord, last: LoadState, states: Sequence[LoadState]) -> bool:
    """Whether the increments of the record are the first ones of these states."""
    done = len(record.rows)
    # a rotation that has ended where the torque fell is within its last increment
    if done > len(states) or (states[done - 1] != last and not record.torque_points):
        return False
    angles = [float(np.radians(row["wg_angle_deg"])) for row in record.rows]
    return np.allclose(angles, [state.angle for state in states[:done]])


def _resume_cycle(cycle: StressCycle, saved: SavedRun, path: Path, model: DriveModel) -> None:
    first, end = model.partition.owned_sectors(FLEXIBLE_SPLINE)
    ranges = dict.fromkeys(cycle.names(saved.cycle), (first, end - first))
    cycle.resume(saved.cycle, parallel_hdf5.read_rows(path, model.comm, ranges))
