"""All results of a planetary gear train."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial, reduce
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.gear_trains.dominant_cycles import dominant_cycles
from swgpar.gear_trains.planetary.design import PlanetaryDesign
from swgpar.gear_trains.planetary.linearisation import Moments, linearise
from swgpar.gear_trains.planetary.model import PlanetaryModel
from swgpar.gear_trains.planetary.monitored import MONITORED_NAMES
from swgpar.gear_trains.planetary.monte_carlo import BLOCK_SIZE, simulate
from swgpar.gear_trains.planetary.time_stepping import TimeStepper
from swgpar.gear_trains.planetary.wind_load import WindLoad
from swgpar.gear_trains.published import STATISTICS, number_label
from swgpar.gear_trains.result import Table, TrainResult
from swgpar.gear_trains.sample_moments import SampleMoments
from swgpar.gear_trains.sampling import block_sizes, random_stream, run_tasks
from swgpar.log import logger


class _Case:
    """A gear train with its time steps. They are built when needed: their matrices take about ten megabytes."""

    def __init__(self, design: PlanetaryDesign, rim: float, count: int) -> None:
        self.design = design.model_copy(update={"ring": design.ring.model_copy(update={"rim": rim})})
        self.count = count
        self._built: tuple[TimeStepper, WindLoad] | None = None

    def build(self) -> tuple[TimeStepper, WindLoad]:
        if self._built is None:
            h = self.design.end / self.count
            self._built = TimeStepper(PlanetaryModel(self.design), h, self.count), WindLoad.of(self.design, h)
        return self._built


def _linearised(case: _Case) -> tuple[Moments, float]:
    begin = time.perf_counter()
    return linearise(*case.build(), case.count // case.design.time.rows), time.perf_counter() - begin


def _simulated(case: _Case, block: int, size: int) -> tuple[tuple[SampleMoments, int], float]:
    begin, design = time.perf_counter(), case.design
    random = random_stream(design.gear_train.seed, block)
    return simulate(*case.build(), case.count // design.time.rows, size, random), time.perf_counter() - begin


def compute(design: PlanetaryDesign, comm: MPI.Comm) -> TrainResult:
    """All results of a design, the same on all ranks; collective."""
    rims = list(dict.fromkeys([design.ring.rim, *design.ring.rims]))
    logger.info(
        "planetary gear train: %d coordinates, %d steps of %.3g s, %d simulations, %d rims; %d ranks",
        PlanetaryModel(design).size,
        design.time.steps,
        design.end / design.time.steps,
        design.monte_carlo.samples,
        len(rims),
        comm.size,
    )
    whole = _Case(design, design.ring.rim, design.time.steps)
    linearisations: list[Callable[[], Any]] = [
        partial(_linearised, _Case(design, rim, design.time.linearised_steps)) for rim in rims
    ]
    sizes = block_sizes(design.monte_carlo.samples, BLOCK_SIZE)
    done = run_tasks(comm, [*linearisations, *(partial(_simulated, whole, b, size) for b, size in enumerate(sizes))])
    moments = dict(zip(rims, (result for result, _ in done[: len(rims)]), strict=True))
    simulated = [result for result, _ in done[len(rims) :]]
    samples = reduce(SampleMoments.merged_with, (part for part, _ in simulated))
    own = moments[design.ring.rim]
    summary = {
        "sampling_error_percent": 100.0 / np.sqrt(2.0 * samples.count),
        "least_eigenvalue_over_largest": own.smallest_eigenvalue,
        "asymmetry_of_correlations": own.asymmetry,
        "task_s": {
            "linearised": [s for _, s in done[: len(rims)]],
            "monte_carlo": sum(s for _, s in done[len(rims) :]),
        },
    }
    values = _values(design, moments, samples, sum(separated for _, separated in simulated))
    tables = {"rims": _rims(design, moments), "mesh_forces": _forces(design, own)}
    return TrainResult(_history(design, own, samples), tables, values, summary)


def _values(
    design: PlanetaryDesign, moments: dict[float, Moments], samples: SampleMoments, separated: int
) -> dict[str, float | list[float]]:
    """The quantities. separated : number of steps of samples in which some mesh was not on its loaded flank"""
    own, revolutions = moments[design.ring.rim], design.time.revolutions
    values: dict[str, float | list[float]] = {
        f"dominant_cycles_{name}": dominant_cycles(own.mean[:, MONITORED_NAMES.index(column)], revolutions)
        for name, column in (("ring_contact", "ring_contact_radial"), ("ring_node", "ring_node_tangential"))
    }
    values["out_of_contact"] = separated / (design.time.steps * design.monte_carlo.samples)
    values |= _extremes(own) | _errors("mean", own.mean, samples.mean)
    values |= _errors("deviation", own.deviation, samples.deviation)
    for rim in design.ring.rims:
        values |= {f"{name}_{number_label(rim)}": value for name, value in _extremes(moments[rim]).items()}
    return values


def _extremes(moments: Moments) -> dict[str, float]:
    """Largest means and deviations over the time, m."""
    columns = {"mean": np.abs(moments.mean).max(axis=0), "deviation": moments.deviation.max(axis=0)}
    return {f"{kind}_{name}": float(columns[kind][k]) for kind in STATISTICS for k, name in enumerate(MONITORED_NAMES)}


def _errors(kind: str, linearised: np.ndarray, simulated: np.ndarray) -> dict[str, float]:
    """Errors in percent of linearised values (rows, monitored), averaged over the second half of the time."""
    later = slice(len(linearised) // 2, None)
    percent = (100.0 * (linearised[later].mean(axis=0) / simulated[later].mean(axis=0) - 1.0)).tolist()
    return {f"error_{kind}_{name}": value for name, value in zip(MONITORED_NAMES, percent, strict=True)}


def _times(design: PlanetaryDesign) -> np.ndarray:
    return design.end * np.arange(1, design.time.rows + 1) / design.time.rows


def _history(design: PlanetaryDesign, moments: Moments, sums: SampleMoments) -> Table:
    """Means and standard deviations over time, µm."""
    out = {"time_s": _times(design)}
    for k, name in enumerate(MONITORED_NAMES):
        out |= {
            f"linearised_mean_{name}_um": 1e6 * moments.mean[:, k],
            f"linearised_deviation_{name}_um": 1e6 * moments.deviation[:, k],
            f"monte_carlo_mean_{name}_um": 1e6 * sums.mean[:, k],
            f"monte_carlo_deviation_{name}_um": 1e6 * sums.deviation[:, k],
        }
    return out


def _forces(design: PlanetaryDesign, moments: Moments) -> Table:
    """Mean and mean square of the linearised forces of the meshes of planet 1 after every step."""
    steps = len(moments.force)
    out = {"time_s": design.end * np.arange(1, steps + 1) / steps}
    for k, name in enumerate(("sun", "ring")):
        out |= {f"mean_{name}_force_N": moments.force[:, k], f"mean_square_{name}_force_N2": moments.square[:, k]}
    return out


def _rims(design: PlanetaryDesign, moments: dict[float, Moments]) -> Table:
    """Means and standard deviations of the linearisation in blocks by rim, µm."""
    out = {
        "rim_mm": np.repeat(design.ring.rims, design.time.rows),
        "time_s": np.tile(_times(design), len(design.ring.rims)),
    }
    for k, name in enumerate(MONITORED_NAMES):
        out[f"mean_{name}_um"] = 1e6 * np.concatenate([moments[r].mean[:, k] for r in design.ring.rims])
        out[f"deviation_{name}_um"] = 1e6 * np.concatenate([moments[r].deviation[:, k] for r in design.ring.rims])
    return out
