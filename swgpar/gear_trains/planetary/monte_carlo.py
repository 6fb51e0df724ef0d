"""Simulations of the nonlinear planetary gear train in the wind, many at once."""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.backlash import force
from swgpar.gear_trains.planetary.steps import States, Steps
from swgpar.gear_trains.planetary.watched import NAMES, watched
from swgpar.gear_trains.planetary.wind import Wind
from swgpar.gear_trains.sums import Sums

BLOCK = 256


def simulate(steps: Steps, wind: Wind, every: int, samples: int, random: np.random.Generator) -> tuple[Sums, int]:
    """Move `samples` trains on from rest under the steady wind, watching them at every so many steps.

    Returns their sums, and in how many steps of how many samples some mesh did not touch on its loaded flank.
    """
    train = steps.train
    start, sides = steps.at_rest(wind.steady)
    states = States(*(np.repeat(part, samples, axis=1) for part in (start.q, start.y, start.push)))
    turbulence, torque = np.zeros((2, samples)), np.full(samples, wind.steady)
    half, rows, lost = train.half, steps.count // every, 0
    mean, squares = np.empty((rows, len(NAMES))), np.empty((rows, len(NAMES)))
    last = np.empty(samples)
    for step in range(1, steps.count + 1):
        turbulence = wind.moved @ turbulence + wind.root @ random.standard_normal((2, samples))
        before, torque = torque, wind.steady + wind.turbulent @ turbulence
        trial = steps.trial(step, states, before + torque)
        ways, apart = steps.with_backlash(step, sides, trial.ways)
        lost += apart
        steps.finish(step, states, trial, ways, force(steps.stiffness[step][:, None], ways, half))
        if step % every == 0:
            values = watched(train, steps, step) @ states.q
            mean[step // every - 1], squares[step // every - 1] = values.mean(axis=1), values.var(axis=1) * samples
            last = values[-1]
    return Sums(samples, mean, squares, last), lost
