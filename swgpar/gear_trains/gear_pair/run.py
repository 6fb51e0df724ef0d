"""All results of a gear pair."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial, reduce
from itertools import product

import numpy as np
from mpi4py import MPI
from scipy.stats import norm

from swgpar.gear_trains.gear_pair.design import GearPairDesign
from swgpar.gear_trains.gear_pair.model import (
    COORDINATES,
    DEFLECTION_ROW,
    gear_pair_system,
    static_equilibrium,
)
from swgpar.gear_trains.gear_pair.monte_carlo import BLOCK_SIZE, simulate
from swgpar.gear_trains.gear_pair.quantities import VALUES
from swgpar.gear_trains.result import Table, TrainResult
from swgpar.log import logger
from swgpar.vibration.linearisation import EQUIVALENT, Criterion, linearise
from swgpar.vibration.moments import Moments, SampleMoments, columns, percent_errors
from swgpar.vibration.sampling import block_sizes, random_stream, run_tasks

BINS = 120
"""Of the histograms of the mesh deflection."""


def compute(design: GearPairDesign, comm: MPI.Comm) -> TrainResult:
    """All results of a design, the same on all ranks; collective."""
    cases, sizes = (
        range(len(design.load.input)),
        block_sizes(design.monte_carlo.samples, BLOCK_SIZE),
    )
    logger.info(
        "gear pair: %d cases, %d steps of %.3g s, %d simulations of each; %d ranks",
        len(cases),
        design.steps,
        design.step,
        design.monte_carlo.samples,
        comm.size,
    )
    pairs = [(gear_pair_system(design, case), static_equilibrium(design, case)) for case in cases]
    keys = list(product(cases, EQUIVALENT))
    tasks: list[Callable[[], object]] = []
    for case, criterion in keys:
        system, start = pairs[case]
        tasks.append(
            partial(linearise, system, start, design.step, design.steps, design.every, criterion)
        )
    for case in cases:
        system, start = pairs[case]
        for block, size in enumerate(sizes):
            random = random_stream(design.gear_train.seed, case, block)
            tasks.append(
                partial(
                    simulate, system, start, design.step, design.steps, design.every, size, random
                )
            )
    done, seconds = run_tasks(comm, tasks)
    first, rows = len(keys), np.vstack([np.eye(len(COORDINATES)), DEFLECTION_ROW])
    linearised = {key: found.of(rows) for key, found in zip(keys, done[:first], strict=True)}
    blocks = [done[first + case * len(sizes) : first + (case + 1) * len(sizes)] for case in cases]
    samples = [reduce(SampleMoments.merged_with, parts) for parts in blocks]
    values: dict[str, float | list[float]] = {}
    tables = {}
    for case in cases:
        by_method = {method: linearised[case, method] for method in EQUIVALENT}
        final, half_backlash = samples[case].final, 1e-6 * design.mesh.half_backlash
        values[f"out_of_contact_{case + 1}"] = float((final < half_backlash).mean())
        values[f"back_flank_{case + 1}"] = float((final < -half_backlash).mean())
        for method, moments in by_method.items():
            for kind, errors in percent_errors(moments, samples[case]).items():
                values |= {
                    f"error_{kind}_{method}_{v}_{case + 1}": e
                    for v, e in zip(VALUES, errors, strict=True)
                }
        tables[f"density_{case + 1}"] = _density(final, by_method)
    history: dict[str, np.ndarray] = {
        "case": np.repeat([case + 1 for case in cases], design.time.rows),
        "time_s": np.tile(
            design.time.end * np.arange(1, design.time.rows + 1) / design.time.rows, len(cases)
        ),
    }
    for method in EQUIVALENT:
        history |= columns(
            [linearised[case, method] for case in cases], VALUES, "um", 1e6, f"{method}_"
        )
    history |= columns(samples, VALUES, "um", 1e6, "monte_carlo_")
    summary = {
        "sampling_error_percent": 100.0 / np.sqrt(2.0 * design.monte_carlo.samples),
        "task_s": {"linearised": seconds[:first], "monte_carlo": sum(seconds[first:])},
        "half_backlash_um": design.mesh.half_backlash,
    }
    return TrainResult(history, tables, values, summary)


def _density(final: np.ndarray, by_method: Mapping[Criterion, Moments]) -> Table:
    """Probability densities of the mesh deflection at the end, per µm. final : (samples,) m"""
    counts, edges = np.histogram(1e6 * final, bins=BINS, density=True)
    middle = 0.5 * (edges[1:] + edges[:-1])
    out = {"mesh_deflection_um": middle, "monte_carlo": counts}
    for method, moments in by_method.items():
        out[method] = norm.pdf(middle, 1e6 * moments.mean[-1, -1], 1e6 * moments.deviation[-1, -1])
    return out
