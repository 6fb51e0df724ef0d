"""All computations of a gear pair: what `swgpar run` and `swgpar check` do with one."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial, reduce
from itertools import product
from typing import Any

import numpy as np
from mpi4py import MPI
from scipy.stats import norm

from swgpar.gear_trains.gear_pair.design import GearPairDesign
from swgpar.gear_trains.gear_pair.model import (
    COORDINATES,
    DEFLECTION_ROW,
    gear_pair_system,
    mesh_force,
    natural_modes,
    static_equilibrium,
)
from swgpar.gear_trains.gear_pair.monte_carlo import BLOCK_SIZE, simulate
from swgpar.gear_trains.linearisation import EQUIVALENT, Moments, linearise
from swgpar.gear_trains.published import STATISTICS, Quantities
from swgpar.gear_trains.result import Table, TrainResult
from swgpar.gear_trains.sample_moments import SampleMoments
from swgpar.gear_trains.sampling import block_sizes, random_stream, run_tasks
from swgpar.log import logger

METHODS = (*EQUIVALENT, "monte_carlo")
VALUES = (*COORDINATES, "mesh")
"""Coordinates, and the way of the mesh."""

BINS = 120


def quantities(design: GearPairDesign) -> Quantities:
    """What can be compared with published values."""
    known = {}
    for case in range(1, len(design.load.input) + 1):
        known[f"out_of_contact_{case}"] = (f"share of samples of case {case} out of contact at the end", 1)
        known[f"far_flank_{case}"] = (f"share of samples of case {case} on the far flank at the end", 1)
        for kind, method, name in product(STATISTICS, EQUIVALENT, VALUES):
            text = f"difference of the {method}-based {kind} of {name} from Monte Carlo's, case {case} (%)"
            known[f"error_{kind}_{method}_{name}_{case}"] = (text, 1)
    return known


def derived(design: GearPairDesign) -> dict[str, float]:
    """What follows from the design file at once, for `swgpar check`."""
    frequencies, ratios = natural_modes(design)
    out = {f"natural frequency {k} (rad/s)": float(w) for k, w in enumerate(frequencies, start=1)}
    out |= {f"damping ratio {k}": float(r) for k, r in enumerate(ratios, start=1)}
    for case in range(len(design.load.input)):
        out[f"mesh force of case {case + 1} (N)"] = mesh_force(design, case)
    out["time step times the highest frequency"] = design.step * frequencies[-1]
    return out


def _timed(task: Callable[[], Any]) -> tuple[Any, float]:
    begin = time.perf_counter()
    return task(), time.perf_counter() - begin


def compute(design: GearPairDesign, comm: MPI.Comm) -> TrainResult:
    """All results of a design, the same on all ranks; collective."""
    cases, every = range(len(design.load.input)), design.every
    sizes = block_sizes(design.monte_carlo.samples, BLOCK_SIZE)
    grid = (design.step, design.steps, every)
    tasks: list[Callable[[], Any]] = [
        partial(linearise, gear_pair_system(design, case), static_equilibrium(design, case), *grid, criterion)
        for case in cases
        for criterion in EQUIVALENT
    ]
    simulated: list[Callable[[], Any]] = [
        partial(
            simulate,
            gear_pair_system(design, case),
            static_equilibrium(design, case),
            *grid,
            size,
            random_stream(design.gear_train.seed, case, block),
        )
        for case in cases
        for block, size in enumerate(sizes)
    ]
    logger.info(
        "gear pair: %d cases, %d steps of %.3g s, %d simulations of each; %d ranks",
        len(cases),
        design.steps,
        design.step,
        design.monte_carlo.samples,
        comm.size,
    )
    done = run_tasks(comm, [partial(_timed, task) for task in (*tasks, *simulated)])
    results, seconds = [result for result, _ in done], [s for _, s in done]
    moments = {key: results[k] for k, key in enumerate((c, m) for c in cases for m in EQUIVALENT)}
    parts = results[len(tasks) :]
    sums = [reduce(SampleMoments.merged_with, parts[c * len(sizes) : (c + 1) * len(sizes)]) for c in cases]

    half_backlash = 1e-6 * design.mesh.half_backlash
    values: dict[str, float | list[float]] = {}
    for case in cases:
        values[f"out_of_contact_{case + 1}"] = float((sums[case].last < half_backlash).mean())
        values[f"far_flank_{case + 1}"] = float((sums[case].last < -half_backlash).mean())
    statistics = {
        (case, method): _statistics(moments[case, method])
        if method in EQUIVALENT
        else (sums[case].mean, sums[case].deviation)
        for case in cases
        for method in METHODS
    }
    values |= _errors(statistics, len(cases))
    summary = {
        "sampling_error_percent": 100.0 / np.sqrt(2.0 * design.monte_carlo.samples),
        "task_s": {"linearised": seconds[: len(tasks)], "monte_carlo": sum(seconds[len(tasks) :])},
        "half_backlash_um": design.mesh.half_backlash,
    }
    tables = {f"density_{case + 1}": _density(sums[case], case, moments) for case in cases}
    return TrainResult(_history(design, statistics), tables, values, summary)


def _statistics(moments: Moments) -> tuple[np.ndarray, np.ndarray]:
    """Means and deviations (rows, 4) of coordinates and mesh, without the start."""
    n, deflection_rows = len(COORDINATES), np.vstack([np.eye(len(COORDINATES)), DEFLECTION_ROW])
    variances = np.einsum("ki,tij,kj->tk", deflection_rows, moments.covariance[1:, :n, :n], deflection_rows)
    return moments.mean[1:] @ deflection_rows.T, np.sqrt(np.maximum(variances, 0.0))


def _errors(statistics: dict[tuple[int, str], tuple[np.ndarray, np.ndarray]], cases: int) -> dict[str, float]:
    """Mean and deviation over the second half of the time: percent by which they differ from Monte Carlo's."""
    out = {}
    for case, (k, kind) in product(range(cases), enumerate(STATISTICS)):
        settled = {m: statistics[case, m][k][len(statistics[case, m][k]) // 2 :].mean(axis=0) for m in METHODS}
        for method in EQUIVALENT:
            errors = (100.0 * (settled[method] / settled["monte_carlo"] - 1.0)).tolist()
            out |= {f"error_{kind}_{method}_{v}_{case + 1}": e for v, e in zip(VALUES, errors, strict=True)}
    return out


def _history(design: GearPairDesign, statistics: dict[tuple[int, str], tuple[np.ndarray, np.ndarray]]) -> Table:
    """Means and deviations against time, case below case."""
    rows, cases = design.time.rows, len(design.load.input)
    out: dict[str, np.ndarray] = {
        "case": np.repeat(np.arange(1, cases + 1), rows),
        "time_s": np.tile(design.time.end * np.arange(1, rows + 1) / rows, cases),
    }
    for method in METHODS:
        for k, kind in enumerate(STATISTICS):
            columns = np.concatenate([statistics[case, method][k] for case in range(cases)])
            out |= {f"{method}_{kind}_{v}_um": 1e6 * c for v, c in zip(VALUES, columns.T, strict=True)}
    return out


def _density(sums: SampleMoments, case: int, moments: dict[tuple[int, str], Moments]) -> Table:
    """Densities of the mesh's way at the end, per µm."""
    counts, edges = np.histogram(1e6 * sums.last, bins=BINS, density=True)
    middle = 0.5 * (edges[1:] + edges[:-1])
    out = {"mesh_way_um": middle, "monte_carlo": counts}
    for method in EQUIVALENT:
        mean, deviation = _statistics(moments[case, method])
        out[method] = norm.pdf(middle, 1e6 * mean[-1, -1], 1e6 * deviation[-1, -1])
    return out
