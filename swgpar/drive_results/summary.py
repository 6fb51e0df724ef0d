"""Summary of a run: sizes, means and extremes over the rotation, error estimates; the content of summary.json."""

from __future__ import annotations

import platform
import resource
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from swgpar.evaluation.jamming import jamming_remark
from swgpar.evaluation.load_sharing import load_sharing
from swgpar.evaluation.period import of_period, sampling_error
from swgpar.evaluation.places import OF_REGION, Place
from swgpar.evaluation.program_results import point_rows, summarise_program
from swgpar.evaluation.ratcheting import summarise_ratcheting
from swgpar.evaluation.result_frame import summarise_input
from swgpar.evaluation.stiffness import summarise_stiffness
from swgpar.evaluation.transmission_error import summarise_turns
from swgpar.evaluation.windows.root_stress import RootStress
from swgpar.load.load_states import Stage
from swgpar.model.drive_model import DriveModel
from swgpar.petsc import PETSc
from swgpar.results.history import Row, column, transmission_error
from swgpar.version import __version__

STRESSES = ("fs_s1", "fs_s3", "fs_vm", "rg_s1", "rg_s3", "rg_vm")
"""Columns of the history with the largest stresses of both bodies."""

PANCAKE_STRESSES = ("ds_s1", "ds_s3", "ds_vm")
"""Those of the dynamic spline of a pancake drive."""

RING = "ring_gear"
"""The ring gear whose load sharing is summarised."""

INPUT_TORQUE = "wg_torque_Nmm"

MEANS = (*STRESSES, INPUT_TORQUE)
"""Columns of the history whose means and maxima over the rotation are taken."""


@dataclass(frozen=True)
class Accuracy:
    """Relative accuracy of the largest tensile stress at the teeth under load.

    asked : what was asked for;  estimated : by refinement;  reached : whether the estimate is small enough
    """

    asked: float
    estimated: float
    reached: bool


def mesh_error(
    root_stress: RootStress | None, means: Mapping[str, float], places: Mapping[str, Place]
) -> dict[str, float]:
    """Errors (MPa) of the means of nodal stresses by the drive's mesh, by column of the history, where they are known.

    That of s1 is how far windows are from it, and their own error. Others are in proportion to those of the largest
    stresses under load, which a coarser mesh gives.
    """
    found = {
        name: means[name] * place.error / place.value for name, place in places.items() if name in means and place.error
    }
    if root_stress is not None:
        found["fs_s1"] = abs(root_stress.on_mesh - root_stress.s1) + root_stress.total_error
    return found


def mean_columns(rows: Sequence[Row]) -> tuple[str, ...]:
    """Columns whose means and maxima are taken: `MEANS`, and the stresses of a dynamic spline."""
    return (*MEANS, *(name for name in PANCAKE_STRESSES if rows and name in rows[0]))


def over_rotation(rows: Sequence[Row], ratio: float) -> dict[str, Any]:
    """Means, maxima, torque ripple and transmission error over the increments `rows` of the rotation.

    `torque_ripple` is the largest less the smallest input torque, over the mean; `transmission_error_arcsec` is the
    largest less the smallest transmission error. ratio : speed of the wave generator over that of the output
    """
    if not rows:
        return {"means": {}, "maxima": {}, "torque_ripple": None, "transmission_error_arcsec": None}
    torque = column(rows, INPUT_TORQUE)
    error = transmission_error(column(rows, "wg_angle_deg"), column(rows, "output_angle_deg"), ratio)
    mean = float(torque.mean())
    return {
        "means": {name: float(np.mean([row[name] for row in rows])) for name in mean_columns(rows)},
        "maxima": {name: float(column(rows, name).max()) for name in mean_columns(rows)},
        "torque_ripple": float(np.ptp(torque)) / abs(mean) if mean else None,
        "transmission_error_arcsec": float(np.ptp(error)),
    }


def summarise(
    model: DriveModel,
    rows: list[Row],
    recipe_name: str,
    accuracy: Accuracy | None,
    root_stress: RootStress | None,
    places: Mapping[str, Place],
    pairs: Sequence[Row],
    turns: Sequence[Row],
    bearing: dict[str, Any] | None,
    housing: Mapping[str, float],
    seconds: float,
    *,
    tooth_rotations: Sequence[float] = (),
    stiffness_error: Mapping[str, float] | None = None,
    ended_early: bool = False,
) -> dict[str, Any]:
    """Content of summary.json; collective.

    Parameters
    ----------
    rows : history of the increments that were computed
    recipe_name : the mesh recipe as the user named it
    accuracy : what was asked for and reached
    root_stress : largest tensile stress at the teeth, by windows
    places : of the largest stresses under load, those of regions included
    pairs : contacts of the flanks under load;  bearing : loads of its balls, None without one
    housing : largest stresses and radial displacement under load, empty without one
    turns : transmission error over the sampled period, or over whole turns with deviations
    seconds : wall time of the run, restarts included
    tooth_rotations : (n,) deg, of the flexible spline's teeth, with [ratcheting]
    stiffness_error : of the torsional stiffness by the mesh, if it is known
    ended_early : whether a load program has ended before its last point
    """
    design = model.design
    program = point_rows(design, rows)
    rotation = [] if program else [row for row in rows if int(row["step"]) >= Stage.ROTATE]
    sampled = of_period(design, rows) if design.steps.samples else rotation
    values, driven = over_rotation(sampled, design.ratio), summarise_input(design, sampled)
    if driven:
        values["torque_ripple"] = driven.pop("torque_ripple")
    sampled_period = design.steps.samples and values["means"]
    return {
        "recipe": recipe_name,
        **_sizes(model),
        "increments": len(rows),
        **_program(model, seconds),
        **values,
        "transmission_error": summarise_turns(design, turns),
        "accuracy": accuracy and asdict(accuracy),
        "places": {name: asdict(place) for name, place in places.items() if OF_REGION not in name},
        "regions": {name: asdict(place) for name, place in places.items() if OF_REGION in name},
        "root_stress": root_stress and _resolved(root_stress),
        "contact": max(
            (pair for pair in pairs if np.isfinite(pair["pressure_MPa"])),
            key=lambda pair: (not pair["edge"], pair["pressure_MPa"]),
            default=None,
        ),
        "load_sharing": load_sharing(
            [pair for pair in pairs if pair.get("ring", RING) == RING],
            [row["tooth_torque_Nmm"] for row in rows],
            # without a rotation the loaded state stands for it
            range(len(rows) - max(len(sampled), 1) + 1, len(rows) + 1),
            design.drive.teeth_fs,
            model.copies,
        ),
        "bearing": bearing,
        "housing": dict(housing) or None,
        "mesh_error": mesh_error(root_stress, values["means"], places),
        "condensed_MPa": model.omitted_bending_stress() if design.solver.condensed_sectors else None,
        "sampling_error": sampling_error(design, rows, mean_columns(rows)) if sampled_period else None,
        "newton_iterations_mean": float(np.mean([r["newton_iterations"] for r in rotation])) if rotation else None,
        "balance_error_Nmm": max((r["torque_balance_Nmm"] for r in rows), default=0.0),
        "program": summarise_program(program),
        "stiffness": summarise_stiffness(design, program, stiffness_error),
        "ratcheting": summarise_ratcheting(design, program, tooth_rotations, ended_early=ended_early),
        "input": driven,
        "wg_torque_expected_Nmm": 1000.0 * design.load.torque / abs(design.ratio),
        "jammed": jamming_remark(design, sampled, values["means"]),
        "ratio": design.input_ratio,
        "design": design.model_dump(),
    }


def _resolved(found: RootStress) -> dict[str, Any]:
    return {
        **asdict(found),
        "levels": found.levels,
        "total_error": found.total_error,
        "over_period": found.over_period(),
    }


def _sizes(model: DriveModel) -> dict[str, Any]:
    counts = model.counts()
    return {
        "bodies": counts,
        "nodes": sum(body["nodes_whole"] for body in counts.values()),
        "elements": model.n_elements(),
        "dofs": sum(body["dofs"] for body in counts.values()),
        "copies": model.copies,
    }


def _program(model: DriveModel, seconds: float) -> dict[str, Any]:
    """Versions, times and memory; collective."""
    memory = model.comm.allgather(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
    return {
        "ranks": model.comm.size,
        "versions": {
            "swgpar": __version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
        },
        "wall_s": seconds,
        "phases_s": {name: round(value, 3) for name, value in model.phases.slowest(model.comm).items()},
        "peak_memory_MB_per_rank": [round(value, 1) for value in memory],
    }
