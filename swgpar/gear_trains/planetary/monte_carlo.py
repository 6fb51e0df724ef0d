"""Simulations of the nonlinear planetary gear train in the wind, many at once."""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.planetary.steps import States, Steps
from swgpar.gear_trains.planetary.watched import NAMES, watched
from swgpar.gear_trains.planetary.wind import Wind
from swgpar.gear_trains.sums import Sums

BLOCK = 256


def simulate(steps: Steps, wind: Wind, every: int, samples: int, random: np.random.Generator) -> tuple[Sums, int]:
    """Move `samples` trains on from rest under the steady wind, watching them at every so many steps.

    Returns their sums, and in how many steps of how many samples some mesh did not touch on its loaded flank.
    """
    start, sides = steps.at_rest(wind.steady)
    states = States(*(np.repeat(part, samples, axis=1) for part in (start.q, start.y, start.push)))
    turbulence, torque = np.zeros((2, samples)), np.full(samples, wind.steady)
    rows, lost, torques = steps.count // every, 0, np.empty((every, samples))
    mean, squares = np.empty((rows, len(NAMES))), np.empty((rows, len(NAMES)))
    last = np.empty(samples)
    for row in range(rows):
        for k in range(every):
            turbulence = wind.moved @ turbulence + wind.root @ random.standard_normal((2, samples))
            before, torque = torque, wind.steady + wind.turbulent @ turbulence
            np.add(before, torque, out=torques[k])
        lost += steps.simulate(row * every, states, torques, sides)
        values = watched(steps.train, steps, (row + 1) * every) @ states.q
        mean[row], squares[row] = values.mean(axis=1), values.var(axis=1) * samples
        last = values[-1]
    return Sums(samples, mean, squares, last), lost
