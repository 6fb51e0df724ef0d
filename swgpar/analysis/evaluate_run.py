"""All evaluations of a run at its end: the summary, and the tables of fatigue and losses."""

from __future__ import annotations

import platform
import resource
from collections.abc import Mapping, Sequence

import numpy as np

from swgpar.analysis.recorder import Recorder
from swgpar.checks.clearance import clearances
from swgpar.drive_results.drive_tables import DriveTables
from swgpar.drive_results.summary import BodySizes, DriveSummary
from swgpar.evaluation.bearing_loads import BallLoads, evaluate_bearing
from swgpar.evaluation.bolt_loads import evaluate_bolts
from swgpar.evaluation.fatigue import FatigueResult, evaluate_fatigue
from swgpar.evaluation.frequencies import NaturalFrequencies
from swgpar.evaluation.housing_values import HousingStresses
from swgpar.evaluation.input_coupling import coupling_at_output
from swgpar.evaluation.largest_contact import largest_contact
from swgpar.evaluation.load_sharing import LoadSharing, load_sharing
from swgpar.evaluation.losses import DriveLosses, evaluate_losses
from swgpar.evaluation.numerics import evaluate_numerics
from swgpar.evaluation.output_bearing_loads import output_bearing_loads
from swgpar.evaluation.program_results import stage_ends
from swgpar.evaluation.ratcheting import evaluate_ratcheting
from swgpar.evaluation.rigid_clearance import rigid_clearance
from swgpar.evaluation.rotation import evaluate_rotation, sampled_rows
from swgpar.evaluation.slip_error import evaluate_slip
from swgpar.evaluation.step_values import step_values
from swgpar.evaluation.stiffness import torsional_stiffness
from swgpar.evaluation.strains import largest_strains
from swgpar.evaluation.stress_cycle import StressCycle
from swgpar.evaluation.stress_factors import root_factor, stress_factors
from swgpar.evaluation.transmission_error import evaluate_turns
from swgpar.largest_stress.places import LargestStresses
from swgpar.load.load_sequence import stiffness_program
from swgpar.petsc import PETSc
from swgpar.results.history import Row, loaded_increments
from swgpar.version import __version__

RING = "ring_gear"
"""The ring gear whose load sharing is evaluated."""


def evaluate_run(
    recorder: Recorder,
    shown: list[Row],
    recipe_name: str,
    seconds: float,
    *,
    stiffness_error: Mapping[str, float] | None,
    ended_early: bool,
) -> tuple[DriveSummary, DriveTables]:
    """Evaluate what a run has recorded; collective.

    shown : rows of history.csv;  recipe_name : the mesh recipe as the user named it
    seconds : wall time of the run, restarts included
    stiffness_error : of the torsional stiffness by the mesh, if it is known
    ended_early : whether a load program has ended before its last point
    """
    model, design, record = recorder.model, recorder.model.design, recorder.record
    sequence, rows = recorder.sequence, record.rows
    program, places = recorder.program_rows(), recorder.resolved_places()
    stresses = LargestStresses.of(places)
    fatigue, losses, losses_table = _cycle_results(recorder)
    bodies = {name: BodySizes(**counts) for name, counts in model.counts().items()}
    memory = model.comm.allgather(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
    rotation = evaluate_rotation(
        sequence,
        rows,
        record.pairs,
        places,
        friction=design.contact.friction > 0.0,
        coarse=record.coarse_period,
    )
    summary = DriveSummary(
        recipe=recipe_name,
        bodies=bodies,
        nodes=sum(body.nodes_whole for body in bodies.values()),
        elements=model.n_elements(),
        dofs=sum(body.dofs for body in bodies.values()),
        copies=model.copies,
        increments=len(rows),
        ranks=model.comm.size,
        versions={
            "swgpar": __version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
        },
        wall_s=seconds,
        phases_s={
            name: round(value, 3) for name, value in model.phases.slowest(model.comm).items()
        },
        peak_memory_MB_per_rank=tuple(round(value, 1) for value in memory),
        ratio=design.kinematics.input_ratio,
        design=design,
        rotation=rotation,
        stresses=stresses,
        strains=largest_strains(stresses.places, design.materials),
        steps=step_values(shown),
        numerics=evaluate_numerics(
            rows, model.omitted_bending_stress() if design.solver.condensed_sectors else None
        ),
        accuracy=record.accuracy,
        root_stress=record.root_stress,
        contact=largest_contact(record.pairs, record.contact_errors),
        load_sharing=_load_sharing(recorder),
        transmission_error=evaluate_turns(
            sequence.kinematics,
            design.deviations,
            sequence.samples,
            record.turns,
            rotation.range_errors,
            friction=design.contact.friction > 0.0,
        ),
        stiffness=torsional_stiffness(stiffness_program(design), program, stiffness_error)
        if design.stiffness
        else None,
        input_coupling=coupling_at_output(design.input_coupling, sequence.kinematics.ratio)
        if design.input_coupling
        else None,
        ratcheting=(
            evaluate_ratcheting(
                sequence.kinematics,
                design.ratcheting,
                record.torque_points,
                design.negligible_torque_Nm,
                ended_early=ended_early,
                rows=rows,
            )
            if design.ratcheting
            else None
        ),
        slip=evaluate_slip(record.slip_checks) if design.contact.friction else None,
        program=stage_ends(program) if design.load.program and program else None,
        fatigue=None if fatigue is None else fatigue.found,
        losses=losses,
        bearing=_bearing(recorder),
        output_bearing=output_bearing_loads(
            design.output_bearing,
            design.drive.module,
            [rows[k - 1] for k in _increments_under_load(rows)],
        )
        if design.output_bearing
        else None,
        bolts=evaluate_bolts(design.cup, record.bolts, _increments_under_load(rows))
        if design.is_bolted
        else None,
        clearance=rigid_clearance(clearances(design.rigid_pairs)),
        frequencies=NaturalFrequencies(modes=record.modes) if record.modes else None,
        housing=HousingStresses(**record.housing) if record.housing else None,
    )
    tables = DriveTables(losses=losses_table)
    if fatigue is not None:
        tables.fatigue_cycle, tables.fatigue = fatigue.cycle, fatigue.sector
    return summary, tables


def _load_sharing(recorder: Recorder) -> LoadSharing | None:
    rows = recorder.record.rows
    # without a rotation the loaded state stands for it
    count = max(len(sampled_rows(recorder.sequence, rows)), 1)
    return load_sharing(
        [pair for pair in recorder.record.pairs if pair.get("ring", RING) == RING],
        [row["tooth_torque_Nmm"] for row in rows],
        range(len(rows) - count + 1, len(rows) + 1),
        recorder.sequence.kinematics.teeth_fs,
        recorder.model.copies,
        recorder.sequence.kinematics.lobes,
        recorder.record.contact_errors,
    )


def _increments_under_load(rows: Sequence[Row]) -> list[int]:
    """Numbers of the increments under load, from 1."""
    steps = np.array([int(row["step"]) for row in rows])
    return [int(k) + 1 for k in loaded_increments({"step": steps})]


def _bearing(recorder: Recorder) -> BallLoads | None:
    """Over the increments under load."""
    design = recorder.model.design
    if design.bearing is None:
        return None
    record = recorder.record
    increments = _increments_under_load(record.rows)
    return evaluate_bearing(
        design,
        record.balls,
        increments,
        record.bearing_shares,
        record.race_stress,
        record.bearing_errors,
    )


def _fatigue(recorder: Recorder, cycle: StressCycle) -> FatigueResult:
    record = recorder.record
    factors = stress_factors(record.root_stress, record.wall_stress, record.loaded)
    root = None if record.root_stress is None else root_factor(record.root_stress)
    return evaluate_fatigue(cycle, factors, root)


def _cycle_results(
    recorder: Recorder,
) -> tuple[FatigueResult | None, DriveLosses | None, Mapping[str, np.ndarray]]:
    """SafetyAndLife, losses and the columns of losses.csv over the sampled period."""
    cycle, model = recorder.cycle, recorder.model
    design = model.design
    if cycle is None or not cycle.complete:
        return None, None, {}
    with model.phases("fatigue and losses"):
        fatigue = _fatigue(recorder, cycle) if design.fatigue else None
        if not design.losses:
            return fatigue, None, {}
        count = len(recorder.record.rows)
        increments = range(count - design.steps.samples + 1, count + 1)
        return fatigue, *evaluate_losses(
            cycle, recorder.record.pairs, recorder.record.cam_forces, increments
        )
