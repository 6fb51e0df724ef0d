"""All results of a gear pair."""

from __future__ import annotations

from collections.abc import Mapping
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
from swgpar.gear_trains.result import Computed
from swgpar.log import logger, ranks_text
from swgpar.results.table import Columns
from swgpar.vibration.linearisation import EQUIVALENT, Criterion, linearise
from swgpar.vibration.moments import (
    Moments,
    SampleMoments,
    columns,
    deviation_error,
    percent_errors,
)
from swgpar.vibration.sampling import Tasks, block_sizes, random_stream, run_tasks

BINS = 120
"""Of the histograms of the mesh deflection."""


def compute(design: GearPairDesign, comm: MPI.Comm) -> Computed:
    """All results of a design, the same on all ranks; collective."""
    cases, seed = range(len(design.load.input)), design.gear_train.seed
    steps = design.step, design.steps, design.every
    logger.info(
        "gear pair: %d cases, %d steps of %.3g s, %d simulations of each; %s",
        len(cases),
        design.steps,
        design.step,
        design.monte_carlo.samples,
        ranks_text(comm.size),
    )
    pairs = [(gear_pair_system(design, case), static_equilibrium(design, case)) for case in cases]
    keys = list(product(cases, EQUIVALENT))
    sizes = list(enumerate(block_sizes(design.monte_carlo.samples, BLOCK_SIZE)))
    groups: Tasks = {
        "linearised": [
            partial(linearise, system, start, *steps, criterion)
            for case, criterion in keys
            for system, start in [pairs[case]]
        ],
        "monte_carlo": [
            partial(simulate, system, start, *steps, size, random_stream(seed, case, block))
            for case, (system, start) in enumerate(pairs)
            for block, size in sizes
        ],
    }
    done, seconds = run_tasks(comm, groups)
    rows = np.vstack([np.eye(len(COORDINATES)), DEFLECTION_ROW])
    moments = {key: part.of(rows) for key, part in zip(keys, done["linearised"], strict=True)}
    blocks = [done["monte_carlo"][case * len(sizes) :][: len(sizes)] for case in cases]
    samples = [reduce(SampleMoments.merged_with, parts) for parts in blocks]
    values: dict[str, float | list[float]] = {
        "sampling_error_percent": deviation_error(design.monte_carlo.samples)
    }
    tables = {}
    for case in cases:
        final, half_backlash = samples[case].final, 1e-6 * design.mesh.half_backlash
        values[f"out_of_contact_{case + 1}"] = float((final < half_backlash).mean())
        values[f"back_flank_{case + 1}"] = float((final < -half_backlash).mean())
        for method in EQUIVALENT:
            names = [f"{method}_{value}_{case + 1}" for value in VALUES]
            values |= percent_errors(moments[case, method], samples[case], names)
        ends = {method: moments[case, method] for method in EQUIVALENT}
        tables[f"density_{case + 1}"] = _density(final, ends)
    times = design.time.end * np.arange(1, design.time.rows + 1) / design.time.rows
    history = {
        "case": np.repeat([case + 1 for case in cases], design.time.rows),
        "time_s": np.tile(times, len(cases)),
    }
    for method in EQUIVALENT:
        parts = [moments[case, method] for case in cases]
        history |= columns(parts, VALUES, "um", f"{method}_")
    history |= columns(samples, VALUES, "um", "monte_carlo_")
    return Computed(history, tables, values, seconds)


def _density(final: np.ndarray, ends: Mapping[Criterion, Moments]) -> Columns:
    """Probability densities of the mesh deflection at the end, per µm. final : (samples,) m"""
    counts, edges = np.histogram(1e6 * final, bins=BINS, density=True)
    middle = 0.5 * (edges[1:] + edges[:-1])
    table = {"mesh_deflection_um": middle, "monte_carlo": counts}
    for method, moments in ends.items():
        mean, deviation = 1e6 * moments.mean[-1, -1], 1e6 * moments.deviation[-1, -1]
        table[method] = norm.pdf(middle, mean, deviation)
    return table
