"""All results of a planetary stage."""

from __future__ import annotations

from functools import partial

import numpy as np
from mpi4py import MPI

from swgpar.gear_trains.planetary_parts.model import PlanetaryModel, carrier_index
from swgpar.gear_trains.planetary_parts.natural_modes import mode_table, natural_modes
from swgpar.gear_trains.planetary_stage.design import PlanetaryStageDesign
from swgpar.gear_trains.planetary_stage.errors import given_errors
from swgpar.gear_trains.planetary_stage.frequency_response import frequency_response
from swgpar.gear_trains.planetary_stage.load_sharing import (
    BLOCK_SIZE,
    Revolution,
    random_factors,
    revolution,
)
from swgpar.gear_trains.planetary_stage.quantities import LISTED, QUANTILES, of_teeth
from swgpar.gear_trains.result import Computed
from swgpar.log import logger, ranks_text
from swgpar.results.table import Columns
from swgpar.vibration.sampling import Tasks, block_sizes, run_tasks

FREQUENCIES, HIGHEST = 800, 5.0
"""Number of frequencies of the response; the highest in mesh frequencies, at least."""


def compute(design: PlanetaryStageDesign, comm: MPI.Comm) -> Computed:
    """All results of a design, the same on all ranks; collective."""
    tolerances, places = design.tolerances, design.load.positions
    samples = tolerances.samples if tolerances else 0
    logger.info(
        "planetary stage: %d planets, %d places of the carrier, %d trains with random errors; %s",
        *(design.planet.count, places, samples, ranks_text(comm.size)),
    )
    groups: Tasks = {
        "revolution": [partial(revolution, design, given_errors(design), places)],
        "random": [
            partial(random_factors, design, tolerances, block, size)
            for block, size in enumerate(block_sizes(samples, BLOCK_SIZE))
            if tolerances
        ],
    }
    done, seconds = run_tasks(comm, groups)
    (found,) = done["revolution"]
    for sentence in found.remarks():
        logger.warning(sentence)
    modes = mode_table(PlanetaryModel(design))
    tables = {"planets": _planets(found), "spectrum": _spectrum(found), "modes": modes}
    tables["response"] = _response(design)
    values = _values(design, found) | of_teeth(design)
    values["natural_frequencies"] = modes["frequency_Hz"][:LISTED].tolist()
    if tolerances:
        factors = np.concatenate(done["random"])
        number = np.arange(1, len(factors) + 1)
        names = "load_sharing_factor", "mean_load_sharing_factor"
        tables["random"] = {"train": number, **dict(zip(names, factors.T, strict=True))}
        for name, level in QUANTILES.items():
            values[f"random_factor_{name}"] = float(np.quantile(factors[:, 0], level))
        values["random_factor_largest"] = float(factors[:, 0].max())
    return Computed(_history(design, found), tables, values, seconds)


def _values(design: PlanetaryStageDesign, found: Revolution) -> dict[str, float | list[float]]:
    share, sun, ring = found.share[:, 0], found.sun[:, 0], found.ring[:, 0]
    tangential = np.cos(np.radians(design.mesh.pressure_angle))
    axial = float(sun.max()) * tangential * np.tan(np.radians(design.mesh.helix))
    turn = found.displacements[:, 0, carrier_index(design) + 2]
    return {
        "load_sharing_factor": float(found.factors()[0]),
        "mean_load_sharing_factor": float(found.mean_factors()[0]),
        "mean_share": share.mean(axis=0).tolist(),
        "largest_share": share.max(axis=0).tolist(),
        "largest_sun_force": sun.max(axis=0).tolist(),
        "largest_ring_force": ring.max(axis=0).tolist(),
        "largest_bearing_force": np.linalg.norm(found.pin[:, 0], axis=2).max(axis=0).tolist(),
        "axial_force": axial,
        "tilting_moment": axial * 1e-3 * design.planet.pitch_diameter,
        "sun_orbit": float(np.linalg.norm(found.displacements[:, 0, :2], axis=1).max()),
        "transmission_error": float(np.ptp(turn)),
        "out_of_contact": float(np.mean(np.concatenate([sun, ring]) <= 0.0)),
        "back_flank": float(np.mean(np.concatenate([sun, ring]) < 0.0)),
    }


def _history(design: PlanetaryStageDesign, found: Revolution) -> Columns:
    carrier = carrier_index(design)
    at = {"sun_x": 0, "sun_y": 1, "sun_rotation": 2}
    at |= {"carrier_x": carrier, "carrier_y": carrier + 1, "carrier_rotation": carrier + 2}
    moved = {f"{name}_um": 1e6 * found.displacements[:, 0, i] for name, i in at.items()}
    return {"carrier_deg": np.degrees(found.angle), **moved}


def _planets(found: Revolution) -> Columns:
    """Loads of every planet at all places of the carrier."""
    table = {"carrier_deg": np.degrees(found.angle)}
    for k in range(found.sun.shape[2]):
        table[f"share_{k + 1}"] = found.share[:, 0, k]
        table[f"sun_force_{k + 1}_N"] = found.sun[:, 0, k]
        table[f"ring_force_{k + 1}_N"] = found.ring[:, 0, k]
        table[f"bearing_radial_{k + 1}_N"] = found.pin[:, 0, k, 0]
        table[f"bearing_tangential_{k + 1}_N"] = found.pin[:, 0, k, 1]
    return table


def _spectrum(found: Revolution) -> Columns:
    """Amplitudes by cycles in a revolution of the carrier, up to half of the number of places."""
    places = len(found.angle)
    cycles = np.arange((places + 1) // 2)

    def amplitudes(values: np.ndarray) -> np.ndarray:
        size = np.abs(np.fft.rfft(values, axis=0))[: len(cycles)] / places
        size[1:] *= 2.0
        return size

    table = {"cycles": cycles}
    for k in range(found.sun.shape[2]):
        table[f"sun_force_{k + 1}_N"] = amplitudes(found.sun[:, 0, k])
        table[f"ring_force_{k + 1}_N"] = amplitudes(found.ring[:, 0, k])
    return table


def _response(design: PlanetaryStageDesign) -> Columns:
    """Amplitudes of the mesh forces of every planet by a torque of 1 N·m and by a transmission
    error of 1 µm of the sun meshes."""
    train = PlanetaryModel(design)
    mesh = train.mesh.frequency / (2.0 * np.pi)
    highest = max(HIGHEST * mesh, natural_modes(train).frequency[LISTED - 1])
    found = frequency_response(train, np.geomspace(1e-3 * highest, highest, FREQUENCIES))
    table = {"frequency_Hz": found.frequency}
    for j, gear in enumerate(("sun", "ring")):
        for k in range(design.planet.count):
            one = j * design.planet.count + k
            table[f"{gear}_{k + 1}_N_by_Nm"] = found.mesh_by_torque[:, one]
            table[f"{gear}_{k + 1}_N_by_um"] = 1e-6 * found.mesh_by_error[:, one]
    return table
