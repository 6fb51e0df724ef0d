"""Simulations of the nonlinear planetary gear train in the wind, many at once."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from swgpar.gear_trains.planetary.monitored import monitored
from swgpar.gear_trains.planetary.time_stepping import ModalStates, TimeStepper
from swgpar.gear_trains.planetary.wind_load import WindLoad
from swgpar.vibration.moments import SampleMoments

BLOCK_SIZE = 256


def simulate(
    steps: TimeStepper, wind: WindLoad, every: int, samples: int, random: np.random.Generator
) -> tuple[SampleMoments, int]:
    """Move `samples` trains on from rest under the steady wind, watched after every `every` steps.

    Returns their moments, and in how many steps of samples a mesh was off its loaded flank.
    """
    start, flanks = steps.static_equilibrium(wind.steady)
    states = ModalStates(
        *(np.repeat(part, samples, axis=1) for part in (start.q, start.y, start.mesh_term))
    )
    turbulence, torque = np.zeros((2, samples)), np.full(samples, wind.steady)
    separated, torques = 0, np.empty((every, samples))

    def rows() -> Iterator[np.ndarray]:
        nonlocal turbulence, torque, separated
        for row in range(steps.count // every):
            for k in range(every):
                noise = wind.noise_root @ random.standard_normal((2, samples))
                turbulence = wind.transition @ turbulence + noise
                before, torque = torque, wind.steady + wind.turbulent @ turbulence
                np.add(before, torque, out=torques[k])
            separated += steps.simulate(row * every, states, torques, flanks)
            of_modes, added = monitored(steps.train, steps, (row + 1) * every, flanks)
            yield of_modes @ states.q + added[:, None]

    return SampleMoments.of(rows()), separated
