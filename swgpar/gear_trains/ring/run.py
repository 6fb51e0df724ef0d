"""All computations of an elastic ring: what `swgpar run` and `swgpar check` do with one."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial, reduce
from itertools import product
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.gear_trains.dominant_cycles import dominant_cycles
from swgpar.gear_trains.published import STATISTICS, Quantities, number_label
from swgpar.gear_trains.result import Table, TrainResult
from swgpar.gear_trains.ring.curved_beam import BeamSection, Ring, free_frequencies
from swgpar.gear_trains.ring.design import RingDesign
from swgpar.gear_trains.ring.moving_load import MovingLoads, Response
from swgpar.gear_trains.sample_moments import SampleMoments
from swgpar.gear_trains.sampling import block_sizes, random_stream, run_tasks
from swgpar.log import logger

POINTS = ("moving_point", "middle_node")
ROWS = 400
"""Of the history of each speed."""

SHAPES, AROUND = 6, 361
"""Modes that are drawn, and points around each."""

BLOCK_SIZE = 50
RIGID = 1e-3
"""Modes below this share of the first free bending frequency are rigid motions."""


def quantities(design: RingDesign) -> Quantities:
    """What can be compared with published values."""
    known = {
        "frequencies": ("natural frequencies of bending in the plane, equal ones once (Hz)", design.ring.modes),
        "dimensionless": ("the same times 2 pi sqrt(density A R⁴ / (E I))", design.ring.modes),
    }
    load = design.moving_load
    if load is not None:
        for point in POINTS:
            name = point.replace("_", " ")
            for speed, kind in product(load.speeds, STATISTICS):
                known[f"{kind}_{point}_{number_label(speed)}"] = (
                    f"largest {kind} of the {name} at {speed:g} rad/s (m)",
                    1,
                )
            known[f"cycles_{point}"] = (f"dominant slow cycles of the {name} in a revolution at the first speed", 1)
        known["critical_speeds"] = ("the five highest peaks of the mean of the middle node, by speed (rad/s)", 5)
    return known


def distinct_frequencies(design: RingDesign, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Lowest bending frequencies (count,) in Hz, equal ones once, and a mode of each (unknowns, count)."""
    ring = Ring.of(design)
    rate, shapes = ring.modes()
    bent = (rate > RIGID * free_frequencies(ring.section, 2)[0]) & (ring.bending_share(shapes) > 0.5)
    number = np.flatnonzero(bent)
    kept = number[np.diff(rate[number], prepend=0.0) > 1e-6 * rate[number]][:count]
    return rate[kept] / (2.0 * np.pi), shapes[:, kept]


def derived(design: RingDesign) -> dict[str, float]:
    """What follows from the design file at once, for `swgpar check`."""
    section = BeamSection.of(design)
    out = {
        "radius of the centre line (mm)": 1e3 * section.radius,
        "mass (kg)": 2.0 * np.pi * section.radius * section.density * section.area,
        "bending stiffness (N·m²)": section.E * section.inertia,
        "I / (A R²)": section.slenderness,
    }
    for n in range(2, 5):
        out[f"free ring, {n} waves (Hz)"] = free_frequencies(section, n)[0] / (2.0 * np.pi)
    for k, f in enumerate(distinct_frequencies(design, min(3, design.ring.modes))[0], start=1):
        out[f"natural frequency {k} (Hz)"] = f
    return {name: float(value) for name, value in out.items()}


def compute(design: RingDesign, comm: MPI.Comm) -> TrainResult:
    """All results of a design, the same on all ranks; collective."""
    logger.info("elastic ring: %d elements; %d ranks", design.ring.elements, comm.size)
    frequencies, shapes = distinct_frequencies(design, design.ring.modes)
    section = BeamSection.of(design)
    unit = np.sqrt(section.density * section.area * section.radius**4 / (section.E * section.inertia))
    values: dict[str, float | list[float]] = {
        "frequencies": frequencies.tolist(),
        "dimensionless": (2.0 * np.pi * frequencies * unit).tolist(),
    }
    free = np.array([free_frequencies(section, n)[0] for n in range(2, 2 + len(frequencies))]) / (2.0 * np.pi)
    modes = {"mode": np.arange(1, len(frequencies) + 1), "frequency_Hz": frequencies, "free_ring_Hz": free}
    tables = {"modes": modes, "mode_shapes": _shapes(design, shapes[:, :SHAPES])}
    if design.moving_load is None:
        return TrainResult(modes, tables, values)
    responses, curve, simulated = _moving(design, comm)
    values |= _extremes(design.moving_load.speeds, responses) | {"critical_speeds": _peaks(curve)}
    values |= {f"cycles_{point}": dominant_cycles(responses[0].mean[:, k]) for k, point in enumerate(POINTS)}
    tables |= {"critical_speeds": curve, "monte_carlo": simulated}
    return TrainResult(_history(design, responses), tables, values)


def _moving(design: RingDesign, comm: MPI.Comm) -> tuple[list[Response], Table, Table]:
    """Responses at all speeds, the curve of critical speeds, and Monte Carlo at the first speed."""
    load = design.moving_load
    loads = MovingLoads(design)
    sweep = np.linspace(*load.sweep, load.sweep_speeds)
    sizes = block_sizes(load.samples, BLOCK_SIZE)
    tasks: list[Callable[[], Any]] = [partial(loads.respond, float(speed)) for speed in (*load.speeds, *sweep)]
    simulations = [
        partial(loads.simulate, load.speeds[0], size, random_stream(design.gear_train.seed, block))
        for block, size in enumerate(sizes)
    ]
    done = run_tasks(comm, [*tasks, *simulations])
    responses, parts = done[: len(load.speeds)], done[len(load.speeds) : len(tasks)]
    curve = {"speed_rad_s": sweep}
    for k, point in enumerate(POINTS):
        curve |= {
            f"mean_{point}_m": np.array([np.abs(part.mean[:, k]).max() for part in parts]),
            f"deviation_{point}_m": np.array([part.deviation[:, k].max() for part in parts]),
            f"without_inertia_{point}_m": np.array([np.abs(loads.quasi_static(s)[:, k]).max() for s in sweep]),
        }
    sums = reduce(SampleMoments.merged_with, done[len(tasks) :])
    every = max(1, load.steps // ROWS)
    rows = slice(every - 1, None, every)
    simulated = {"angle_rad": responses[0].angle[rows]}
    for k, point in enumerate(POINTS):
        simulated |= {f"mean_{point}_m": sums.mean[rows, k], f"deviation_{point}_m": sums.deviation[rows, k]}
    return responses, curve, simulated


def _extremes(speeds: list[float], responses: list[Response]) -> dict[str, float]:
    out = {}
    for speed, response in zip(speeds, responses, strict=True):
        for k, point in enumerate(POINTS):
            out[f"mean_{point}_{number_label(speed)}"] = float(np.abs(response.mean[:, k]).max())
            out[f"deviation_{point}_{number_label(speed)}"] = float(response.deviation[:, k].max())
    return out


def _peaks(curve: Table) -> list[float]:
    """Speeds of the five highest local peaks, in the order of the speeds; NaN for those that are not there."""
    speed, mean = curve["speed_rad_s"], curve[f"mean_{POINTS[1]}_m"]
    inner = 1 + np.flatnonzero((mean[1:-1] > mean[:-2]) & (mean[1:-1] >= mean[2:]))
    highest = np.sort(speed[inner[np.argsort(mean[inner])[::-1][:5]]])
    return [*highest.tolist(), *[float("nan")] * (5 - len(highest))]


def _shapes(design: RingDesign, shapes: np.ndarray) -> Table:
    """Outward and tangential displacement around the ring, each mode with its largest displacement 1."""
    ring, angle = Ring.of(design), np.linspace(0.0, 2.0 * np.pi, AROUND)
    values = np.array([ring.interpolation(a)[:2] @ shapes for a in angle])
    values /= np.abs(values).max(axis=(0, 1))
    out = {"angle_rad": angle}
    for k in range(shapes.shape[1]):
        out |= {f"outward_{k + 1}": values[:, 0, k], f"tangential_{k + 1}": values[:, 1, k]}
    return out


def _history(design: RingDesign, responses: list[Response]) -> Table:
    """Means and deviations in the last revolution, speed below speed."""
    load = design.moving_load
    every = max(1, load.steps // ROWS)
    rows = slice(every - 1, None, every)
    angle = responses[0].angle[rows]
    out = {"speed_rad_s": np.repeat(load.speeds, len(angle)), "angle_rad": np.tile(angle, len(responses))}
    for k, point in enumerate(POINTS):
        out[f"mean_{point}_m"] = np.concatenate([r.mean[rows, k] for r in responses])
        out[f"deviation_{point}_m"] = np.concatenate([r.deviation[rows, k] for r in responses])
    return out
