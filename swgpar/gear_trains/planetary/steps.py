"""Implicit steps of the planetary gear train in modal coordinates, for one state or many at once.

The trapezoidal rule, as in `meshed_system.py`. Each mode has its own scalar equation; the m meshes couple them by what
their forces f and damping forces do at the end of the step,

    q1 = D⁻¹ (r - h/2 Wᵀ g),    g = f(d1) + c d1',    D = 2/h + damping + h/2 stiffness,

W their ways then. Multiplied by W this is a system for the m ways d1 alone,

    (1 + 2/h G c) d1 + G f(d1) = d,    G = h/2 W D⁻¹ Wᵀ,

whose matrices are the same for all states. So a step costs a few products with W and some sums over the modes. Instead
of the velocities v the states hold y = 2/h q + v: then y1 = 4/h q1 - y0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.gear_trains.backlash import force
from swgpar.gear_trains.planetary.model import Train

MAX_ITERATIONS = 50


@dataclass
class States:
    """q : modal displacements (n, states);  y : 2/h q + velocities;  push : h/2 D⁻¹ Wᵀ g at the moment"""

    q: np.ndarray
    y: np.ndarray
    push: np.ndarray


@dataclass(frozen=True)
class Trial:
    """A step without the forces of the meshes at its end: D⁻¹ r (n, states), W y and d (m, states)."""

    modes: np.ndarray
    rate: np.ndarray
    ways: np.ndarray


class Steps:
    """All steps of a run.

    Parameters
    ----------
    train : the gear train
    h : step, s
    count : number of steps
    """

    def __init__(self, train: Train, h: float, count: int) -> None:
        self.train, self.h, self.count = train, h, count
        times = h * np.arange(count + 1)
        self.ways = train.modal_ways(times)
        self.stiffness = np.array([train.mesh.at(t) for t in times])
        inverse = 1.0 / (2.0 / h + train.damping + 0.5 * h * train.stiffness)
        self.of_q = (inverse * (train.damping - 2.0 / h - 0.5 * h * train.stiffness))[:, None]
        self.of_y = 2.0 * inverse[:, None]
        self.of_torque = (0.5 * h * inverse * train.torque_push)[:, None]
        self.pushes = 0.5 * h * inverse[:, None] * self.ways.transpose(0, 2, 1)
        self.give = self.ways @ self.pushes
        self.damped = np.eye(self.ways.shape[1]) + 2.0 / h * self.give * train.mesh_damping
        self.touching = np.linalg.inv(self.damped + self.give * self.stiffness[:, None, :])
        self.damping = train.mesh_damping[:, None]

    def trial(self, step: int, states: States, torques: np.ndarray) -> Trial:
        """The trial of step `step`; torques : (states,) N·m, those at its start and end added up."""
        w = self.ways[step]
        modes = self.of_q * states.q
        modes += self.of_y * states.y
        modes -= states.push
        modes += self.of_torque * torques
        rate = w @ states.y
        return Trial(modes, rate, w @ modes + self.give[step] @ (self.damping * rate))

    def finish(self, step: int, states: States, trial: Trial, ways: np.ndarray, forces: np.ndarray) -> None:
        """Turn the states into those at the end of a step, where the meshes have given ways and forces (m, states)."""
        states.push = self.pushes[step] @ (forces + self.damping * (2.0 / self.h * ways - trial.rate))
        states.q = np.subtract(trial.modes, states.push, out=trial.modes)
        states.y = 4.0 / self.h * states.q - states.y

    def linear(self, step: int, stiffness: np.ndarray, right: np.ndarray) -> np.ndarray:
        """Ways (m, states) at the end of a step for f = stiffness d; right : d of the trial (m, states)."""
        return np.linalg.solve(self.damped[step] + self.give[step] * stiffness, right)

    def with_backlash(self, step: int, sides: np.ndarray, right: np.ndarray) -> tuple[np.ndarray, int]:
        """Ways (m, states) at the end of a step for meshes with backlash, and in how many states one does not touch.

        sides : (m,) 1 or -1, the flanks that carry the steady load; states whose meshes all touch there need one
        product, the others Newton's method on the pieces of f
        """
        k, half = self.stiffness[step], self.train.half
        ways = self.touching[step] @ (right + (self.give[step] @ (k * sides * half))[:, None])
        left = np.flatnonzero((sides[:, None] * ways < half).any(axis=0))
        if len(left):
            ways[:, left] = self._pieces(step, ways[:, left], right[:, left])
        return ways, len(left)

    def _pieces(self, step: int, ways: np.ndarray, right: np.ndarray) -> np.ndarray:
        k, half = self.stiffness[step][:, None], self.train.half
        give, damped = self.give[step], self.damped[step]
        pieces = np.sign(ways) * (np.abs(ways) > half)
        for _ in range(MAX_ITERATIONS):
            matrix = damped + give * (k * np.abs(pieces)).T[:, None, :]
            ways = np.linalg.solve(matrix, (right + give @ (k * half * pieces)).T[..., None])[..., 0].T
            before, pieces = pieces, np.sign(ways) * (np.abs(ways) > half)
            if (pieces == before).all():
                break
        return ways

    def push(self, step: int, q: np.ndarray, y: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """The push (n, states) of meshes with forces (m, states) in states (q, y) at the end of a step."""
        w = self.ways[step]
        return self.pushes[step] @ (forces + self.damping * (w @ y - 2.0 / self.h * (w @ q)))

    def at_rest(self, torque: float) -> tuple[States, np.ndarray]:
        """The state (one column) at rest under a steady torque at the start, and the sides (m,) the meshes touch on.

        These are found from the train without backlash, which carries the load by the same flanks.
        """
        train, w, k = self.train, self.ways[0], self.stiffness[0]
        whole = np.diag(train.stiffness) + w.T @ (k[:, None] * w)
        load = train.torque_push * torque
        sides = np.sign(w @ np.linalg.solve(whole, load))
        q = np.linalg.solve(whole, load + w.T @ (k * sides * train.half))[:, None]
        y = 2.0 / self.h * q
        return States(q, y, self.push(0, q, y, force(k[:, None], w @ q, train.half))), sides
