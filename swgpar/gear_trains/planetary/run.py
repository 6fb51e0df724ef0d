"""All computations of a planetary gear train: what `swgpar run` and `swgpar check` do with one."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial, reduce
from itertools import product
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.gear_trains.backlash import force
from swgpar.gear_trains.dominant_cycles import dominant_cycles
from swgpar.gear_trains.planetary.design import PlanetaryDesign
from swgpar.gear_trains.planetary.linearisation import Moments, linearise
from swgpar.gear_trains.planetary.model import PlanetaryModel, elastic_ring, radii
from swgpar.gear_trains.planetary.monitored import MONITORED, MONITORED_NAMES
from swgpar.gear_trains.planetary.monte_carlo import BLOCK_SIZE, simulate
from swgpar.gear_trains.planetary.time_stepping import TimeStepper
from swgpar.gear_trains.planetary.wind_load import WindLoad
from swgpar.gear_trains.published import STATISTICS, Quantities, number_label
from swgpar.gear_trains.result import Table, TrainResult
from swgpar.gear_trains.sample_moments import SampleMoments
from swgpar.gear_trains.sampling import block_sizes, random_stream, run_tasks
from swgpar.log import logger


def quantities(design: PlanetaryDesign) -> Quantities:
    """What can be compared with published values."""
    known = {
        "cycles_contact": ("dominant slow cycles of the ring under planet 1 in a carrier revolution", 1),
        "cycles_node": ("dominant slow cycles of a node of the ring in a carrier revolution", 1),
        "out_of_contact": ("share of steps and samples in which a mesh is not on its loaded flank", 1),
    }
    for kind, (name, what) in product(STATISTICS, MONITORED.items()):
        known[f"{kind}_{name}"] = (f"largest {kind} of {what} (m)", 1)
        known[f"error_{kind}_{name}"] = (f"difference of the linearised {kind} of {what} from Monte Carlo's (%)", 1)
    for rim, kind, (name, what) in product(design.ring.rims, STATISTICS, MONITORED.items()):
        known[f"{kind}_{name}_{number_label(rim)}"] = (f"largest {kind} of {what} with a rim of {rim:g} mm (m)", 1)
    return known


def derived(design: PlanetaryDesign) -> dict[str, float]:
    """What follows from the design file at once, for `swgpar check`."""
    step = design.end / design.time.steps
    train, wind = PlanetaryModel(design), WindLoad.of(design, step)
    start, flanks = TimeStepper(train, step, 1).static_equilibrium(wind.steady)
    deflection_rows, k = train.modal_deflection_rows(np.zeros(1))[0], train.mesh.at(0.0)
    forces = force(k, deflection_rows @ start.q[:, 0], train.half_backlash)
    whole = np.diag(train.stiffness) + deflection_rows.T @ (k[:, None] * deflection_rows)
    frequencies = np.sqrt(np.linalg.eigvalsh(whole).clip(0.0)) / (2.0 * np.pi)
    sun, planets, centres = radii(design)
    return {
        "coordinates": train.size,
        "base radius of the sun (mm)": 1e3 * sun,
        "base radius of the planets (mm)": 1e3 * planets,
        "radius of the planets' centres (mm)": 1e3 * centres,
        "radius of the ring's centre line (mm)": 1e3 * elastic_ring(design).section.radius,
        "carrier period (s)": 2.0 * np.pi / design.carrier.speed,
        "mesh frequency (rad/s)": train.mesh.frequency,
        "time step (s)": step,
        "steady torque of the wind (N·m)": wind.steady,
        "flank that carries the load": float(flanks[0]),
        "largest mesh force at rest (N)": float(np.abs(forces).max()),
        "lowest natural frequency above 1 Hz, all meshes touching (Hz)": float(frequencies[frequencies > 1.0][0]),
        "highest natural frequency (Hz)": float(frequencies[-1]),
    }


class _Case:
    """A gear train with its steps, made where and when it is needed: its matrices fill some ten megabytes."""

    def __init__(self, design: PlanetaryDesign, rim: float, count: int) -> None:
        self.design = design.model_copy(update={"ring": design.ring.model_copy(update={"rim": rim})})
        self.count, self._made = count, None

    def made(self) -> tuple[TimeStepper, WindLoad]:
        if self._made is None:
            h = self.design.end / self.count
            self._made = TimeStepper(PlanetaryModel(self.design), h, self.count), WindLoad.of(self.design, h)
        return self._made


def _linearised(case: _Case) -> tuple[Moments, float]:
    begin = time.perf_counter()
    return linearise(*case.made(), case.count // case.design.time.rows), time.perf_counter() - begin


def _simulated(case: _Case, block: int, size: int) -> tuple[tuple[SampleMoments, int], float]:
    begin, design = time.perf_counter(), case.design
    random = random_stream(design.gear_train.seed, block)
    return simulate(*case.made(), case.count // design.time.rows, size, random), time.perf_counter() - begin


def compute(design: PlanetaryDesign, comm: MPI.Comm) -> TrainResult:
    """All results of a design, the same on all ranks; collective."""
    rims = list(dict.fromkeys([design.ring.rim, *design.ring.rims]))
    whole = _Case(design, design.ring.rim, design.time.steps)
    tasks: list[Callable[[], Any]] = [
        partial(_linearised, _Case(design, r, design.time.linearised_steps)) for r in rims
    ]
    sizes = block_sizes(design.monte_carlo.samples, BLOCK_SIZE)
    logger.info(
        "planetary gear train: %d coordinates, %d steps of %.3g s, %d simulations, %d rims; %d ranks",
        PlanetaryModel(design).size,
        design.time.steps,
        design.end / design.time.steps,
        design.monte_carlo.samples,
        len(rims),
        comm.size,
    )
    done = run_tasks(comm, [*tasks, *(partial(_simulated, whole, b, size) for b, size in enumerate(sizes))])
    moments = dict(zip(rims, (result for result, _ in done[: len(rims)]), strict=True))
    simulated = [result for result, _ in done[len(rims) :]]
    sums = reduce(SampleMoments.merged_with, (part for part, _ in simulated))
    moments_here = moments[design.ring.rim]
    values: dict[str, float | list[float]] = {
        "cycles_contact": dominant_cycles(
            moments_here.mean[:, MONITORED_NAMES.index("contact_v")], design.time.revolutions
        ),
        "cycles_node": dominant_cycles(moments_here.mean[:, MONITORED_NAMES.index("node_w")], design.time.revolutions),
        "out_of_contact": sum(lost for _, lost in simulated) / (design.time.steps * design.monte_carlo.samples),
    }
    values |= _extremes(moments_here) | _errors("mean", moments_here.mean, sums.mean)
    values |= _errors("deviation", moments_here.deviation, sums.deviation)
    for rim in design.ring.rims:
        values |= {f"{name}_{number_label(rim)}": value for name, value in _extremes(moments[rim]).items()}
    summary = {
        "sampling_error_percent": 100.0 / np.sqrt(2.0 * sums.count),
        "least_eigenvalue_over_largest": moments_here.smallest_eigenvalue,
        "asymmetry_of_correlations": moments_here.asymmetry,
        "task_s": {
            "linearised": [s for _, s in done[: len(rims)]],
            "monte_carlo": sum(s for _, s in done[len(rims) :]),
        },
    }
    tables = {"rims": _rims(design, moments), "mesh_forces": _forces(design, moments_here)}
    return TrainResult(_history(design, moments_here, sums), tables, values, summary)


def _extremes(moments: Moments) -> dict[str, float]:
    """Largest means and deviations over the time, m."""
    columns = {"mean": np.abs(moments.mean).max(axis=0), "deviation": moments.deviation.max(axis=0)}
    return {f"{kind}_{name}": float(columns[kind][k]) for kind in STATISTICS for k, name in enumerate(MONITORED_NAMES)}


def _errors(kind: str, moments_here: np.ndarray, there: np.ndarray) -> dict[str, float]:
    """Percent by which values (rows, monitored) differ from others over the second half of the time."""
    later = slice(len(moments_here) // 2, None)
    percent = (100.0 * (moments_here[later].mean(axis=0) / there[later].mean(axis=0) - 1.0)).tolist()
    return {f"error_{kind}_{name}": value for name, value in zip(MONITORED_NAMES, percent, strict=True)}


def _times(design: PlanetaryDesign) -> np.ndarray:
    return design.end * np.arange(1, design.time.rows + 1) / design.time.rows


def _history(design: PlanetaryDesign, moments: Moments, sums: SampleMoments) -> Table:
    """Means and deviations in µm."""
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
    """Means and deviations of the linearisation for all rims, rim below rim."""
    out = {
        "rim_mm": np.repeat(design.ring.rims, design.time.rows),
        "time_s": np.tile(_times(design), len(design.ring.rims)),
    }
    for k, name in enumerate(MONITORED_NAMES):
        out[f"mean_{name}_um"] = 1e6 * np.concatenate([moments[r].mean[:, k] for r in design.ring.rims])
        out[f"deviation_{name}_um"] = 1e6 * np.concatenate([moments[r].deviation[:, k] for r in design.ring.rims])
    return out
