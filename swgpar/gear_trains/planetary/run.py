"""All results of a planetary gear train."""

from __future__ import annotations

from functools import cached_property, partial, reduce

import numpy as np
from mpi4py import MPI

from swgpar.gear_trains.planetary.design import PlanetaryDesign
from swgpar.gear_trains.planetary.linearisation import TrainMoments, linearise_train
from swgpar.gear_trains.planetary.monitored import MONITORED, MONITORED_NAMES, RECORDED
from swgpar.gear_trains.planetary.monte_carlo import BLOCK_SIZE, simulate
from swgpar.gear_trains.planetary.quantities import LISTED, OF_RING
from swgpar.gear_trains.planetary.time_stepping import TimeStepper
from swgpar.gear_trains.planetary.wind_load import WindLoad
from swgpar.gear_trains.planetary_parts.model import PlanetaryModel, ring_pitch_radius
from swgpar.gear_trains.planetary_parts.natural_modes import mode_table
from swgpar.gear_trains.published import number_label
from swgpar.gear_trains.result import Computed
from swgpar.log import logger, ranks_text
from swgpar.results.table import Columns
from swgpar.vibration.dominant_cycles import dominant_cycles
from swgpar.vibration.moments import (
    SampleMoments,
    columns,
    deviation_error,
    largest_moments,
    percent_errors,
)
from swgpar.vibration.sampling import Tasks, block_sizes, random_stream, run_tasks
from swgpar.vibration.thickness_limit import size_remark

DOMINANT = {"ring_contact": "ring_contact_radial", "ring_node": "ring_node_tangential"}
"""Quantities of slow cycles, and whose they are."""


class _Case:
    """A gear train with its time steps. count : of the steps"""

    def __init__(self, design: PlanetaryDesign, rim: float, count: int) -> None:
        ring = design.ring.model_copy(update={"rim": rim})
        self.design, self.count = design.model_copy(update={"ring": ring}), count
        self.every = count // design.time.rows

    @cached_property
    def steps(self) -> tuple[TimeStepper, WindLoad]:
        """Built when needed: the matrices take about ten megabytes."""
        h = self.design.end / self.count
        stepper = TimeStepper(PlanetaryModel(self.design), h, self.count)
        return stepper, WindLoad.of(self.design, h)

    def linearised(self) -> TrainMoments:
        return linearise_train(*self.steps, self.every)

    def simulated(self, block: int, size: int) -> tuple[SampleMoments, int]:
        random = random_stream(self.design.gear_train.seed, block)
        return simulate(*self.steps, self.every, size, random)


def compute(design: PlanetaryDesign, comm: MPI.Comm) -> Computed:
    """All results of a design, the same on all ranks; collective."""
    rims = list(dict.fromkeys([design.ring.rim, *design.ring.rims]))
    logger.info(
        "planetary gear train: %d coordinates, %d steps of %.3g s, %d simulations, %d rims; %s",
        PlanetaryModel(design).size,
        design.time.steps,
        design.end / design.time.steps,
        design.monte_carlo.samples,
        len(rims),
        ranks_text(comm.size),
    )
    whole = _Case(design, design.ring.rim, design.time.steps)
    blocks = enumerate(block_sizes(design.monte_carlo.samples, BLOCK_SIZE))
    groups: Tasks = {
        "linearised": [_Case(design, r, design.time.linearised_steps).linearised for r in rims],
        "monte_carlo": [partial(whole.simulated, block, size) for block, size in blocks],
    }
    done, seconds = run_tasks(comm, groups)
    moments: dict[float, TrainMoments] = dict(zip(rims, done["linearised"], strict=True))
    simulated, separated = zip(*done["monte_carlo"], strict=True)
    samples, own = reduce(SampleMoments.merged_with, simulated), moments[design.ring.rim]
    of_ring = [MONITORED_NAMES.index(name) for name in OF_RING]
    largest = max(
        float((np.abs(one.mean) + one.deviation)[:, of_ring].max()) for one in moments.values()
    )
    if sentence := size_remark(largest, ring_pitch_radius(design)):
        logger.warning(sentence)
    history = {
        "time_s": _times(design),
        **columns([own], RECORDED, "um", "linearised_"),
        **columns([samples], RECORDED, "um", "monte_carlo_"),
    }
    tables = {
        "rims": _rims(design, moments),
        "mesh_forces": _forces(design, own),
        "modes": mode_table(PlanetaryModel(design)),
    }
    values = _values(design, moments, samples, sum(separated))
    values["natural_frequencies"] = tables["modes"]["frequency_Hz"][:LISTED].tolist()
    return Computed(history, tables, values, seconds)


def _values(
    design: PlanetaryDesign,
    moments: dict[float, TrainMoments],
    samples: SampleMoments,
    separated: int,
) -> dict[str, float | list[float]]:
    """The quantities. separated : steps of samples with a mesh that was off its loaded flank"""
    own, revolutions = moments[design.ring.rim], design.time.revolutions
    values: dict[str, float | list[float]] = {
        "sampling_error_percent": deviation_error(samples.count),
        "least_eigenvalue_over_largest": own.smallest_eigenvalue,
        "asymmetry_of_correlations": own.asymmetry,
    }
    for name, column in DOMINANT.items():
        mean = own.mean[:, MONITORED_NAMES.index(column)]
        values[f"dominant_cycles_{name}"] = dominant_cycles(mean, revolutions)
    values["out_of_contact"] = separated / (design.time.steps * design.monte_carlo.samples)
    values |= largest_moments(own, MONITORED) | percent_errors(own, samples, MONITORED_NAMES)
    for rim in design.ring.rims:
        values |= largest_moments(
            moments[rim], [f"{name}_{number_label(rim)}" for name in MONITORED]
        )
    return values


def _times(design: PlanetaryDesign) -> np.ndarray:
    return design.end * np.arange(1, design.time.rows + 1) / design.time.rows


def _forces(design: PlanetaryDesign, moments: TrainMoments) -> Columns:
    """Mean and mean square of the linearised forces of the meshes of planet 1 after every step."""
    steps = len(moments.force)
    table = {"time_s": design.end * np.arange(1, steps + 1) / steps}
    for k, name in enumerate(("sun", "ring")):
        table[f"mean_{name}_force_N"] = moments.force[:, k]
        table[f"mean_square_{name}_force_N2"] = moments.square[:, k]
    return table


def _rims(design: PlanetaryDesign, moments: dict[float, TrainMoments]) -> Columns:
    """Means and standard deviations of the linearisation in blocks by rim, µm."""
    return {
        "rim_mm": np.repeat(design.ring.rims, design.time.rows),
        "time_s": np.tile(_times(design), len(design.ring.rims)),
        **columns([moments[rim] for rim in design.ring.rims], RECORDED, "um"),
    }
