"""Simulations of the nonlinear planetary gear train in the wind, many at once."""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.planetary.monitored import MONITORED_NAMES, monitored_rows
from swgpar.gear_trains.planetary.time_stepping import ModalStates, TimeStepper
from swgpar.gear_trains.planetary.wind_load import WindLoad
from swgpar.gear_trains.sample_moments import SampleMoments

BLOCK_SIZE = 256


def simulate(
    steps: TimeStepper, wind: WindLoad, every: int, samples: int, random: np.random.Generator
) -> tuple[SampleMoments, int]:
    """Move `samples` trains on from rest under the steady wind, watching them at every so many steps.

    Returns their sums, and in how many steps of how many samples some mesh did not touch on its loaded flank.
    """
    start, flanks = steps.static_equilibrium(wind.steady)
    states = ModalStates(*(np.repeat(part, samples, axis=1) for part in (start.q, start.y, start.mesh_term)))
    turbulence, torque = np.zeros((2, samples)), np.full(samples, wind.steady)
    rows, separated, torques = steps.count // every, 0, np.empty((every, samples))
    mean, squares = np.empty((rows, len(MONITORED_NAMES))), np.empty((rows, len(MONITORED_NAMES)))
    last = np.empty(samples)
    for row in range(rows):
        for k in range(every):
            turbulence = wind.transition @ turbulence + wind.noise_root @ random.standard_normal((2, samples))
            before, torque = torque, wind.steady + wind.turbulent @ turbulence
            np.add(before, torque, out=torques[k])
        separated += steps.simulate(row * every, states, torques, flanks)
        values = monitored_rows(steps.train, steps, (row + 1) * every) @ states.q
        mean[row], squares[row] = values.mean(axis=1), values.var(axis=1) * samples
        last = values[-1]
    return SampleMoments(samples, mean, squares, last), separated
