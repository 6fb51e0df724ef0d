"""All results of an elastic ring."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial, reduce

import numpy as np
from mpi4py import MPI

from swgpar.gear_trains.published import number_label
from swgpar.gear_trains.result import Computed
from swgpar.gear_trains.ring.design import MovingLoad, RingDesign
from swgpar.gear_trains.ring.moving_load import MovingLoads, Response
from swgpar.gear_trains.ring.natural_frequencies import distinct_frequencies
from swgpar.gear_trains.ring.quantities import POINTS
from swgpar.log import logger, ranks_text
from swgpar.results.table import Columns
from swgpar.vibration.curved_beam import BeamSection, free_frequencies
from swgpar.vibration.dominant_cycles import dominant_cycles
from swgpar.vibration.moments import HasMoments, Moments, SampleMoments, columns, largest_moments
from swgpar.vibration.sampling import Tasks, TaskSeconds, block_sizes, random_stream, run_tasks
from swgpar.vibration.thickness_limit import size_remark

ROWS = 400
"""Of the history of each speed."""

PEAKS = 5
"""Number of critical speeds that are listed."""

SHAPES, AROUND = 6, 361
"""Modes that are drawn, and points around each."""

BLOCK_SIZE = 50


def compute(design: RingDesign, comm: MPI.Comm) -> Computed:
    """All results of a design, the same on all ranks; collective."""
    logger.info("elastic ring: %d elements; %s", design.ring.elements, ranks_text(comm.size))
    frequencies, shapes = distinct_frequencies(design, design.ring.modes)
    section, number = design.beam_section(), np.arange(1, len(frequencies) + 1)
    stiffness, line_mass = section.E * section.inertia, section.density * section.area
    unit = np.sqrt(line_mass * section.radius**4 / stiffness)
    values: dict[str, float | list[float]] = {
        "frequencies": frequencies.tolist(),
        "dimensionless_frequencies": (2.0 * np.pi * frequencies * unit).tolist(),
    }
    waves = _waves(shapes)
    free = np.array([_free_frequency(section, n) for n in waves])
    modes = {"mode": number, "waves": waves, "frequency_Hz": frequencies, "free_ring_Hz": free}
    tables = {"modes": modes, "mode_shapes": _shapes(design, shapes[:, :SHAPES])}
    if design.moving_load is None:
        return Computed(modes, tables, values, {})
    responses, curve, simulated, seconds = _moving(design, comm)
    largest = max(float((np.abs(one.mean) + one.deviation).max()) for one in responses)
    if sentence := size_remark(largest, section.radius):
        logger.warning(sentence)
    for speed, response in zip(design.moving_load.speeds, responses, strict=True):
        values |= largest_moments(response, [f"{point}_{number_label(speed)}" for point in POINTS])
    values["critical_speeds"] = _peaks(curve)
    for point, mean in zip(POINTS, responses[0].mean.T, strict=True):
        values[f"dominant_cycles_{point}"] = dominant_cycles(mean)
    tables |= {"critical_speeds": curve, "monte_carlo": simulated}
    return Computed(_history(design, responses), tables, values, seconds)


def _moving(
    design: RingDesign, comm: MPI.Comm
) -> tuple[list[Response], Columns, Columns, Mapping[str, TaskSeconds]]:
    """Responses at all speeds, the curve of critical speeds, Monte Carlo at the first speed, and
    the times of all tasks."""
    load, loads, seed = design.moving_load, MovingLoads(design), design.gear_train.seed
    sweep = np.linspace(load.sweep[0], load.sweep[1], load.sweep_speeds)
    groups: Tasks = {
        "speeds": [partial(loads.respond, speed) for speed in load.speeds],
        "sweep": [partial(loads.respond, float(speed)) for speed in sweep],
        "monte_carlo": [
            partial(loads.simulate, load.speeds[0], size, random_stream(seed, block))
            for block, size in enumerate(block_sizes(load.samples, BLOCK_SIZE))
        ],
    }
    done, seconds = run_tasks(comm, groups)
    still = np.array([np.abs(loads.quasi_static(speed)).max(axis=0) for speed in sweep])
    mean = np.array([np.abs(part.mean).max(axis=0) for part in done["sweep"]])
    deviation = np.array([part.deviation.max(axis=0) for part in done["sweep"]])
    curve = {"speed_rad_s": sweep}
    for k, point in enumerate(POINTS):
        curve[f"mean_{point}_m"] = mean[:, k]
        curve[f"deviation_{point}_m"] = deviation[:, k]
        curve[f"without_inertia_{point}_m"] = still[:, k]
    responses = done["speeds"]
    samples = _thinned(load, reduce(SampleMoments.merged_with, done["monte_carlo"]))
    simulated = {"angle_rad": responses[0].angle[_rows(load)], **columns([samples], POINTS, "m")}
    return responses, curve, simulated, seconds


def _peaks(curve: Columns) -> list[float]:
    """Speeds of the highest local peaks of the middle node, ascending, NaN for
    those that there are not."""
    speed, mean = curve["speed_rad_s"], curve["mean_middle_node_m"]
    inner = 1 + np.flatnonzero((mean[1:-1] > mean[:-2]) & (mean[1:-1] >= mean[2:]))
    highest = np.sort(speed[inner[np.argsort(mean[inner])[::-1][:PEAKS]]])
    return [*highest.tolist(), *[float("nan")] * (PEAKS - len(highest))]


def _waves(shapes: np.ndarray) -> np.ndarray:
    """Number of waves (modes,), from 1 up, with the largest outward amplitude in the nodes of each
    shape (unknowns, modes)."""
    amplitudes = np.abs(np.fft.rfft(shapes[::3], axis=0))
    return np.asarray(1 + np.argmax(amplitudes[1:], axis=0))


def _free_frequency(section: BeamSection, waves: int) -> float:
    """Of the bending of the free ring, Hz; NaN for one wave, a rigid motion."""
    rate = free_frequencies(section, waves)[0] if waves > 1 else np.nan
    return float(rate / (2.0 * np.pi))


def _shapes(design: RingDesign, shapes: np.ndarray) -> Columns:
    """Outward and tangential displacement around the ring, the largest of each mode is 1."""
    ring, angle = design.elastic_ring(), np.linspace(0.0, 2.0 * np.pi, AROUND)
    values = np.array([ring.interpolation(a)[:2] @ shapes for a in angle])
    values /= np.abs(values).max(axis=(0, 1))
    table = {"angle_rad": angle}
    for k, (outward, tangential) in enumerate(values.transpose(2, 1, 0), start=1):
        table |= {f"outward_{k}": outward, f"tangential_{k}": tangential}
    return table


def _history(design: RingDesign, responses: list[Response]) -> Columns:
    """Means and standard deviations in the last revolution, in blocks by speed."""
    load = design.moving_load
    angle = responses[0].angle[_rows(load)]
    return {
        "speed_rad_s": np.repeat(load.speeds, len(angle)),
        "angle_rad": np.tile(angle, len(responses)),
        **columns([_thinned(load, response) for response in responses], POINTS, "m"),
    }


def _rows(load: MovingLoad) -> slice:
    """The rows of a revolution that tables have."""
    every = max(1, load.steps // ROWS)
    return slice(every - 1, None, every)


def _thinned(load: MovingLoad, moments: HasMoments) -> Moments:
    return Moments(moments.mean[_rows(load)], moments.deviation[_rows(load)])
