"""Checkpoint of a run: what is written after every increment, and how a run continues from it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from swgpar.analysis.load_stepping import LoadStepper
from swgpar.contact import friction
from swgpar.drive_results.summary import Accuracy
from swgpar.errors import InputError
from swgpar.evaluation.bearing_loads import ComplianceShares
from swgpar.evaluation.places import Place
from swgpar.evaluation.windows.root_stress import RootStress
from swgpar.fem.body_layout import FLEXIBLE_SPLINE
from swgpar.fem.vectors import write_field
from swgpar.load.load_sequence import LoadSequence
from swgpar.load.load_states import LoadState
from swgpar.results import checkpoint

if TYPE_CHECKING:
    from swgpar.analysis.recorder import FolderRecorder


def write_state(
    recorder: FolderRecorder, stepper: LoadStepper, displacement: Mapping[str, np.ndarray], elapsed: float
) -> None:
    """Write the checkpoint of the present state; collective.

    displacement : body -> (n_sectors, n_local, 3) mm of the owned sectors;  elapsed : wall seconds of the whole run
    """
    model, problem = recorder.model, recorder.model.problem
    blocks = {}
    for k, body in enumerate(model.elements.bodies):
        first, _ = model.partition.owned_sectors(k)
        blocks[body.layout.name] = (np.ascontiguousarray(displacement[body.layout.name]), first, body.layout.count)
    if model.design.contact.friction:
        first, end = model.partition.owned_sectors(FLEXIBLE_SPLINE)
        for name, values in problem.flanks[0].traction_rows(first, end).items():
            blocks[name] = values, first, model.partition.layouts[FLEXIBLE_SPLINE].count
    cycle = recorder.cycle
    if cycle is not None:
        first, _ = model.partition.owned_sectors(FLEXIBLE_SPLINE)
        count = model.partition.layouts[FLEXIBLE_SPLINE].count
        blocks |= {name: (values, first, count) for name, values in cycle.rows().items()}
    state = {
        "cycle": None if cycle is None else cycle.state(),
        "cam_forces": recorder.cam_forces,
        "identity": recorder.identity,
        "done": len(recorder.rows),
        "rows": recorder.rows,
        "names": recorder.names,
        "load_state": stepper.load_state.to_dict(),
        "multipliers": problem.multipliers().tolist(),
        "modelled_sectors": problem.modelled_sectors(),
        "wall_s": elapsed,
        "phases_s": model.phases.slowest(model.comm),
        "starts_loaded": recorder.starts_loaded,
        "accuracy": recorder.accuracy and asdict(recorder.accuracy),
        "root_stress": recorder.root_stress and asdict(recorder.root_stress),
        "pairs": recorder.pairs,
        "contact_lines": recorder.contact_lines,
        "tooth_rotations": recorder.tooth_rotations,
        "balls": recorder.balls,
        "race_stress": recorder.race_stress,
        "housing": recorder.housing,
        "bearing_shares": {name: asdict(share) for name, share in recorder.bearing_shares.items()},
        "stress_errors": recorder.stress_errors,
        "places": {name: asdict(place) for name, place in recorder.places.items()},
    }
    checkpoint.write_checkpoint(recorder.out, model.comm, blocks, state)


def resume(
    recorder: FolderRecorder, stepper: LoadStepper, sequence: LoadSequence
) -> tuple[tuple[LoadState, ...], float]:
    """Bring back the state of the checkpoint, on any number of ranks; collective.

    sequence : that is to be continued. Returns those of its states that the run consists of, without the first ones
    where they were computed on other meshes, and the wall seconds spent so far.
    """
    model, path = recorder.model, recorder.out / checkpoint.NAME
    _, state = checkpoint.read_checkpoint(path, model.comm)
    if state.get("identity") != recorder.identity:
        raise InputError(
            f"restart: {path} belongs to another design, recipe, accuracy or solver setting; allowed are the "
            "same ones (--plain as before), only steps.rotation, the output, solver.linear, keep_factor, far_teeth and "
            "limits may differ"
        )
    checkpoint.require_undamaged(path, model.comm)
    last = LoadState.from_dict(state["load_state"])
    items = sequence.from_loaded if state["starts_loaded"] or state["accuracy"] else sequence.states
    computed = [float(np.radians(row["wg_angle_deg"])) for row in state["rows"]]
    same = (
        np.allclose(computed, [item.angle for item in items[: len(computed)]]) if len(computed) <= len(items) else False
    )
    if state["done"] > len(items) or items[state["done"] - 1] != last or not same:
        raise InputError(
            f"restart: steps.rotation = {model.design.steps.rotation:g} does not continue {path}, which "
            f"ends at {np.degrees(last.angle):g} degrees; allowed are values with this angle among their increments"
        )
    _restore_vector(recorder, state)
    if recorder.cycle is not None:
        first, end = model.partition.owned_sectors(FLEXIBLE_SPLINE)
        ranges = dict.fromkeys(recorder.cycle.names(state["cycle"]), (first, end - first))
        recorder.cycle.resume(state["cycle"], checkpoint.read_checkpoint(path, model.comm, ranges)[0])
    recorder.cam_forces = state["cam_forces"]
    recorder.rows, recorder.names = state["rows"], state["names"]
    recorder.starts_loaded = state["starts_loaded"]
    recorder.accuracy = state["accuracy"] and Accuracy(**state["accuracy"])
    recorder.places = {name: Place(**place) for name, place in state.get("places", {}).items()}
    recorder.stress_errors = state.get("stress_errors", {})
    recorder.pairs, recorder.contact_lines = state.get("pairs", []), state.get("contact_lines", [])
    recorder.tooth_rotations = state.get("tooth_rotations", [])
    recorder.balls, recorder.race_stress = state.get("balls", []), state.get("race_stress", {})
    recorder.housing = state.get("housing", {})
    shares = state.get("bearing_shares", {})
    recorder.bearing_shares = {name: ComplianceShares(**share) for name, share in shares.items()}
    recorder.root_stress = state.get("root_stress") and RootStress(**state["root_stress"])
    stepper.resume_at(last)
    for name, value in state["phases_s"].items():
        model.phases.seconds[name] += value
    recorder.write_index()
    return items, float(state["wall_s"])


def _restore_vector(recorder: FolderRecorder, state: dict[str, Any]) -> None:
    """Displacements, multipliers and friction's history of the checkpoint."""
    model, path = recorder.model, recorder.out / checkpoint.NAME
    ranges = {}
    for k, body in enumerate(model.elements.bodies):
        first, end = model.partition.owned_sectors(k)
        ranges[body.layout.name] = (first, end - first)
    arrays, _ = checkpoint.read_checkpoint(path, model.comm, ranges)
    x = model.problem.x
    for k, body in enumerate(model.elements.bodies):
        first, end = model.partition.owned_sectors(k)
        write_field(model.partition, k, np.arange(first, end), arrays[body.layout.name], x)
    if model.comm.rank == model.comm.size - 1:
        x.array[-model.partition.n_multipliers :] = state["multipliers"]
    model.problem.resume_sectors(state["modelled_sectors"])
    if model.design.contact.friction:
        # a rank needs the flanks that its ring teeth face too
        indices = (0, model.partition.layouts[FLEXIBLE_SPLINE].count)
        rows, _ = checkpoint.read_checkpoint(path, model.comm, dict.fromkeys(friction.ROWS, indices))
        model.problem.resume(friction.from_rows(rows))
