"""All results of a planetary gear train."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial, reduce
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.gear_trains.planetary.design import PlanetaryDesign
from swgpar.gear_trains.planetary.linearisation import TrainMoments, linearise
from swgpar.gear_trains.planetary.model import PlanetaryModel
from swgpar.gear_trains.planetary.monitored import MONITORED, MONITORED_NAMES
from swgpar.gear_trains.planetary.monte_carlo import BLOCK_SIZE, simulate
from swgpar.gear_trains.planetary.time_stepping import TimeStepper
from swgpar.gear_trains.planetary.wind_load import WindLoad
from swgpar.gear_trains.published import number_label
from swgpar.gear_trains.result import Table, TrainResult
from swgpar.log import logger
from swgpar.vibration.dominant_cycles import dominant_cycles
from swgpar.vibration.moments import SampleMoments, columns, largest, percent_errors
from swgpar.vibration.sampling import block_sizes, random_stream, run_tasks


class _Case:
    """A gear train with its time steps. They are built when needed: their matrices take about ten
    megabytes."""

    def __init__(self, design: PlanetaryDesign, rim: float, count: int) -> None:
        self.design = design.model_copy(
            update={"ring": design.ring.model_copy(update={"rim": rim})}
        )
        self.count = count
        self._built: tuple[TimeStepper, WindLoad] | None = None

    def build(self) -> tuple[TimeStepper, WindLoad]:
        if self._built is None:
            h = self.design.end / self.count
            self._built = (
                TimeStepper(PlanetaryModel(self.design), h, self.count),
                WindLoad.of(self.design, h),
            )
        return self._built


def _linearised(case: _Case) -> TrainMoments:
    return linearise(*case.build(), case.count // case.design.time.rows)


def _simulated(case: _Case, block: int, size: int) -> tuple[SampleMoments, int]:
    design, random = case.design, random_stream(case.design.gear_train.seed, block)
    return simulate(*case.build(), case.count // design.time.rows, size, random)


def compute(design: PlanetaryDesign, comm: MPI.Comm) -> TrainResult:
    """All results of a design, the same on all ranks; collective."""
    rims = list(dict.fromkeys([design.ring.rim, *design.ring.rims]))
    logger.info(
        "planetary gear train: %d coordinates, %d steps of %.3g s, %d simulations, %d rims; %d "
        "ranks",
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
    simulations = [partial(_simulated, whole, block, size) for block, size in enumerate(sizes)]
    done, seconds = run_tasks(comm, [*linearisations, *simulations])
    moments, simulated = dict(zip(rims, done, strict=False)), done[len(rims) :]
    samples = reduce(SampleMoments.merged_with, (part for part, _ in simulated))
    own = moments[design.ring.rim]
    summary = {
        "sampling_error_percent": 100.0 / np.sqrt(2.0 * samples.count),
        "least_eigenvalue_over_largest": own.smallest_eigenvalue,
        "asymmetry_of_correlations": own.asymmetry,
        "task_s": {"linearised": seconds[: len(rims)], "monte_carlo": sum(seconds[len(rims) :])},
    }
    values = _values(design, moments, samples, sum(separated for _, separated in simulated))
    tables = {"rims": _rims(design, moments), "mesh_forces": _forces(design, own)}
    return TrainResult(_history(design, own, samples), tables, values, summary)


def _values(
    design: PlanetaryDesign,
    moments: dict[float, TrainMoments],
    samples: SampleMoments,
    separated: int,
) -> dict[str, float | list[float]]:
    """The quantities. separated : number of steps of samples in which some mesh was not on its
    loaded flank"""
    own, revolutions = moments[design.ring.rim], design.time.revolutions
    values: dict[str, float | list[float]] = {
        f"dominant_cycles_{name}": dominant_cycles(
            own.mean[:, MONITORED_NAMES.index(column)], revolutions
        )
        for name, column in (
            ("ring_contact", "ring_contact_radial"),
            ("ring_node", "ring_node_tangential"),
        )
    }
    values["out_of_contact"] = separated / (design.time.steps * design.monte_carlo.samples)
    values |= largest(own, MONITORED)
    for kind, errors in percent_errors(own, samples).items():
        values |= {
            f"error_{kind}_{name}": error for name, error in zip(MONITORED, errors, strict=True)
        }
    for rim in design.ring.rims:
        values |= largest(moments[rim], [f"{name}_{number_label(rim)}" for name in MONITORED])
    return values


def _times(design: PlanetaryDesign) -> np.ndarray:
    return design.end * np.arange(1, design.time.rows + 1) / design.time.rows


def _history(design: PlanetaryDesign, moments: TrainMoments, samples: SampleMoments) -> Table:
    """Means and standard deviations over time, µm."""
    linearised = columns([moments], MONITORED, "um", 1e6, "linearised_")
    return {
        "time_s": _times(design),
        **linearised,
        **columns([samples], MONITORED, "um", 1e6, "monte_carlo_"),
    }


def _forces(design: PlanetaryDesign, moments: TrainMoments) -> Table:
    """Mean and mean square of the linearised forces of the meshes of planet 1 after every step."""
    steps = len(moments.force)
    out = {"time_s": design.end * np.arange(1, steps + 1) / steps}
    for k, name in enumerate(("sun", "ring")):
        out |= {
            f"mean_{name}_force_N": moments.force[:, k],
            f"mean_square_{name}_force_N2": moments.square[:, k],
        }
    return out


def _rims(design: PlanetaryDesign, moments: dict[float, TrainMoments]) -> Table:
    """Means and standard deviations of the linearisation in blocks by rim, µm."""
    out = {
        "rim_mm": np.repeat(design.ring.rims, design.time.rows),
        "time_s": np.tile(_times(design), len(design.ring.rims)),
    }
    return out | columns([moments[rim] for rim in design.ring.rims], MONITORED, "um", 1e6)
