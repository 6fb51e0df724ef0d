"""Implicit steps of the planetary gear train in modal coordinates, for one state or many at once.

The trapezoidal rule, as in `meshed_system.py`. Each mode has its own scalar equation; the m meshes couple them by what
their forces f and damping forces do at the end of the step,

    q1 = D⁻¹ (r - h/2 Wᵀ g),    g = f(d1) + c d1',    D = 2/h + damping + h/2 stiffness,

W their ways then. Multiplied by W this is a system for the m ways d1 alone,

    (1 + 2/h G c) d1 + G f(d1) = d,    G = h/2 W D⁻¹ Wᵀ,

whose matrices are the same for all states. So a step costs a few products with W and some sums over the modes: they are
compiled (kernel/planetary_steps.hpp). Instead of the velocities v the states hold y = 2/h q + v: then y1 = 4/h q1 - y0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.errors import ConvergenceError
from swgpar.gear_trains.backlash import force
from swgpar.gear_trains.kernel import PlanetaryStepKernel
from swgpar.gear_trains.planetary.model import Train

Law = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Of the meshes at the end of a step: (1, m, m) from their forces to their ways; springs and constants (1, m)."""


@dataclass
class States:
    """q : modal displacements (n, states);  y : 2/h q + velocities;  push : h/2 D⁻¹ Wᵀ g at the moment"""

    q: np.ndarray
    y: np.ndarray
    push: np.ndarray


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
        self.of_q = inverse * (train.damping - 2.0 / h - 0.5 * h * train.stiffness)
        self.of_y = 2.0 * inverse
        self.of_torque = 0.5 * h * inverse * train.torque_push
        self.scale = 0.5 * h * inverse
        self.give = (self.ways * self.scale) @ self.ways.transpose(0, 2, 1)
        self.damped = np.eye(self.ways.shape[1]) + 2.0 / h * self.give * train.mesh_damping
        self.touching = np.linalg.inv(self.damped + self.give * self.stiffness[:, None, :])
        self.kernel = PlanetaryStepKernel(
            h,
            train.half,
            self.of_q,
            self.of_y,
            self.of_torque,
            self.scale,
            self.ways,
            self.give,
            train.mesh_damping,
        )

    def simulate(self, first: int, states: States, torques: np.ndarray, sides: np.ndarray) -> int:
        """Move states on by the steps after number `first`, one for each row of torques, meshes with backlash.

        torques : (steps, states) N·m, those at the start and the end of each step added up
        sides : (m,) 1 or -1, the flanks that carry the steady load; states whose meshes all touch there need one
        product, the others Newton's method on the pieces of f. Returns in how many steps of how many states that was.
        """
        rows = slice(first + 1, first + 1 + len(torques))
        k = self.stiffness[rows]
        law = self.touching[rows], k, -self.train.half * k * sides
        lost = self.kernel.advance(first, states.q, states.y, states.push, torques, *law, sides)
        if lost < 0:
            raise ConvergenceError(f"the motion of the gear train did not converge at {-lost * self.h:g} s")
        return lost

    def law(self, step: int, spring: np.ndarray, constant: np.ndarray | None = None) -> Law:
        """Mesh forces spring d + constant at the end of a step, (m,) N/m and N."""
        constant = np.zeros_like(spring) if constant is None else constant
        return np.linalg.inv(self.damped[step] + self.give[step] * spring)[None], spring[None], constant[None]

    def linear(self, step: int, states: States, torques: np.ndarray, law: Law) -> None:
        """Move states on by step number `step` for mesh forces of a `law` there.

        torques : (states,) N·m, those at the start and the end added up
        """
        self.kernel.advance(step - 1, states.q, states.y, states.push, torques[None], *law)

    def free_ways(self, step: int, states: States, torques: np.ndarray) -> np.ndarray:
        """d (m, states): what the ways would be at the end of a step but for the meshes' forces there."""
        q, y, push = states.q, states.y, states.push
        modes = self.of_q[:, None] * q + self.of_y[:, None] * y - push + self.of_torque[:, None] * torques
        w, c = self.ways[step], self.train.mesh_damping[:, None]
        return w @ modes + self.give[step] @ (c * (w @ y))

    def push(self, step: int, q: np.ndarray, y: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """The push (n, states) of meshes with forces (m, states) in states (q, y) at the end of a step."""
        w = self.ways[step]
        damping = self.train.mesh_damping[:, None] * (w @ y - 2.0 / self.h * (w @ q))
        return self.scale[:, None] * (w.T @ (forces + damping))

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
