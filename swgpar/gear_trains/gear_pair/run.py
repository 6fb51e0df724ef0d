"""All results of a gear pair."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial, reduce
from itertools import product
from typing import Any

import numpy as np
from mpi4py import MPI
from scipy.stats import norm

from swgpar.gear_trains.gear_pair.design import GearPairDesign
from swgpar.gear_trains.gear_pair.model import COORDINATES, DEFLECTION_ROW, gear_pair_system, static_equilibrium
from swgpar.gear_trains.gear_pair.monte_carlo import BLOCK_SIZE, simulate
from swgpar.gear_trains.gear_pair.quantities import VALUES
from swgpar.gear_trains.linearisation import EQUIVALENT, Criterion, Moments, linearise
from swgpar.gear_trains.published import STATISTICS
from swgpar.gear_trains.result import Table, TrainResult
from swgpar.gear_trains.sample_moments import SampleMoments
from swgpar.gear_trains.sampling import block_sizes, random_stream, run_tasks
from swgpar.log import logger

METHODS = (*EQUIVALENT, "monte_carlo")

BINS = 120
"""Of the histograms of the mesh deflection."""

Statistics = dict[tuple[int, str], tuple[np.ndarray, np.ndarray]]
"""Case and method -> means and standard deviations of VALUES over time, (rows, 4) m each."""


@dataclass(frozen=True)
class Computed:
    """moments : of both linearisations, by case and criterion;  samples : of the simulations, by case

    linearised_s, simulated_s : seconds of each linearisation, and of all simulations
    """

    moments: dict[tuple[int, Criterion], Moments]
    samples: list[SampleMoments]
    linearised_s: list[float]
    simulated_s: float


def _timed(task: Callable[[], Any]) -> tuple[Any, float]:
    begin = time.perf_counter()
    return task(), time.perf_counter() - begin


def compute(design: GearPairDesign, comm: MPI.Comm) -> TrainResult:
    """All results of a design, the same on all ranks; collective."""
    cases = range(len(design.load.input))
    logger.info(
        "gear pair: %d cases, %d steps of %.3g s, %d simulations of each; %d ranks",
        len(cases),
        design.steps,
        design.step,
        design.monte_carlo.samples,
        comm.size,
    )
    computed = _compute_cases(design, comm)
    half_backlash = 1e-6 * design.mesh.half_backlash
    values: dict[str, float | list[float]] = {}
    for case in cases:
        final = computed.samples[case].final
        values[f"out_of_contact_{case + 1}"] = float((final < half_backlash).mean())
        values[f"back_flank_{case + 1}"] = float((final < -half_backlash).mean())
    statistics: Statistics = {
        (case, method): _statistics(computed.moments[case, method])
        if method in EQUIVALENT
        else (computed.samples[case].mean, computed.samples[case].deviation)
        for case in cases
        for method in METHODS
    }
    values |= _errors(statistics, len(cases))
    summary = {
        "sampling_error_percent": 100.0 / np.sqrt(2.0 * design.monte_carlo.samples),
        "task_s": {"linearised": computed.linearised_s, "monte_carlo": computed.simulated_s},
        "half_backlash_um": design.mesh.half_backlash,
    }
    tables = {f"density_{case + 1}": _density(computed, case) for case in cases}
    return TrainResult(_history(design, statistics), tables, values, summary)


def _compute_cases(design: GearPairDesign, comm: MPI.Comm) -> Computed:
    """Linearisations and simulations of all cases, shared out to the ranks; collective."""
    cases, sizes = range(len(design.load.input)), block_sizes(design.monte_carlo.samples, BLOCK_SIZE)
    grid = design.step, design.steps, design.every
    pairs = [(gear_pair_system(design, case), static_equilibrium(design, case)) for case in cases]
    linearisations = [
        partial(linearise, *pairs[case], *grid, criterion) for case, criterion in product(cases, EQUIVALENT)
    ]
    simulations = [
        partial(simulate, *pairs[case], *grid, size, random_stream(design.gear_train.seed, case, block))
        for case in cases
        for block, size in enumerate(sizes)
    ]
    tasks: list[Callable[[], Any]] = [partial(_timed, task) for task in (*linearisations, *simulations)]
    done = run_tasks(comm, tasks)
    results, seconds, first = [result for result, _ in done], [s for _, s in done], len(linearisations)
    parts = results[first:]
    return Computed(
        dict(zip(product(cases, EQUIVALENT), results[:first], strict=True)),
        [reduce(SampleMoments.merged_with, parts[c * len(sizes) : (c + 1) * len(sizes)]) for c in cases],
        seconds[:first],
        sum(seconds[first:]),
    )


def _statistics(moments: Moments) -> tuple[np.ndarray, np.ndarray]:
    """Means and standard deviations (rows, 4) of coordinates and mesh deflection, m, without the start."""
    n, rows = len(COORDINATES), np.vstack([np.eye(len(COORDINATES)), DEFLECTION_ROW])
    variances = np.einsum("ki,tij,kj->tk", rows, moments.covariance[1:, :n, :n], rows)
    return moments.mean[1:] @ rows.T, np.sqrt(np.maximum(variances, 0.0))


def _errors(statistics: Statistics, cases: int) -> dict[str, float]:
    """Errors in percent of linearised moments against Monte Carlo, averaged over the second half of the time."""
    out = {}
    for case, (k, kind) in product(range(cases), enumerate(STATISTICS)):
        settled = {m: statistics[case, m][k][len(statistics[case, m][k]) // 2 :].mean(axis=0) for m in METHODS}
        for method in EQUIVALENT:
            errors = (100.0 * (settled[method] / settled["monte_carlo"] - 1.0)).tolist()
            out |= {f"error_{kind}_{method}_{v}_{case + 1}": e for v, e in zip(VALUES, errors, strict=True)}
    return out


def _history(design: GearPairDesign, statistics: Statistics) -> Table:
    """Means and standard deviations against time, in blocks by case."""
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


def _density(computed: Computed, case: int) -> Table:
    """Probability densities of the mesh deflection at the end, per µm."""
    counts, edges = np.histogram(1e6 * computed.samples[case].final, bins=BINS, density=True)
    middle = 0.5 * (edges[1:] + edges[:-1])
    out = {"mesh_deflection_um": middle, "monte_carlo": counts}
    for method in EQUIVALENT:
        mean, deviation = _statistics(computed.moments[case, method])
        out[method] = norm.pdf(middle, 1e6 * mean[-1, -1], 1e6 * deviation[-1, -1])
    return out
