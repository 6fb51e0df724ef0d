"""Implicit time steps of the planetary gear train in modal coordinates, for many states at once.

The trapezoidal rule, as in `swgpar/vibration/gear_mesh_system.py`. Each mode q has its own scalar
equation. The m meshes couple the modes by their elastic forces f and damping forces at the end of
the step:

    q1 = D⁻¹ (r - h/2 Wᵀ g),    g = f(d1) + c d1',    D = 2/h + damping + h/2 stiffness,

W (m, n) are the mesh deflections per mode at that time. Multiplied by W this is a system for the m
mesh deflections d1:

    (1 + 2/h G c) d1 + G f(d1) = d,    G = h/2 W D⁻¹ Wᵀ.

Its matrices are the same for all states. A step needs a few products with W and sums over the
modes: they are compiled (kernel/planetary_steps.hpp). Instead of velocities v the states hold y =
2/h q + v: then y1 = 4/h q1 - y0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.errors import ConvergenceError
from swgpar.gear_trains.kernel import PlanetaryStepKernel
from swgpar.gear_trains.planetary_parts.model import PlanetaryModel
from swgpar.vibration.backlash import force

MeshLaw = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Linear law of the meshes at the end of a step: solution matrix (1, m, m) of the deflections,
stiffnesses (1, m) in N/m and constant forces (1, m) in N."""


@dataclass
class ModalStates:
    """q : (n, states) modal displacements;  y : 2/h q + velocities;  mesh_term : h/2 D⁻¹ Wᵀ g"""

    q: np.ndarray
    y: np.ndarray
    mesh_term: np.ndarray


class TimeStepper:
    """All time steps of a run.

    Parameters
    ----------
    train : the gear train
    h : time step, s
    count : number of steps

    Attributes
    ----------
    deflection_rows : (count + 1, m, n), W;  stiffness : (count + 1, m) N/m, mesh stiffnesses
    from_q, from_y, from_torque, from_force : (n,), coefficients of a step
    compliance : (count + 1, m, m), G;  damped : (count + 1, m, m), 1 + 2/h G c
    contact_inverse : (count + 1, m, m), inverse of 1 + 2/h G c + G k: all meshes in contact
    """

    def __init__(self, train: PlanetaryModel, h: float, count: int) -> None:
        self.train, self.h, self.count = train, h, count
        times = h * np.arange(count + 1)
        self.deflection_rows = train.modal_deflection_rows(times)
        self.stiffness = train.mesh_stiffness(times)
        inverse = 1.0 / (2.0 / h + train.damping + 0.5 * h * train.stiffness)
        self.from_q = inverse * (train.damping - 2.0 / h - 0.5 * h * train.stiffness)
        self.from_y = 2.0 * inverse
        self.from_torque = 0.5 * h * inverse * train.torque_vector
        self.from_force = 0.5 * h * inverse
        w = self.deflection_rows
        self.compliance = (w * self.from_force) @ w.transpose(0, 2, 1)
        self.damped = np.eye(w.shape[1]) + 2.0 / h * self.compliance * train.mesh_damping
        in_contact = self.damped + self.compliance * self.stiffness[:, None, :]
        self.contact_inverse = np.linalg.inv(in_contact)
        self.kernel = PlanetaryStepKernel(
            h,
            train.half_backlash,
            self.from_q,
            self.from_y,
            self.from_torque,
            self.from_force,
            self.deflection_rows,
            self.compliance,
            train.mesh_damping,
        )

    def simulate(
        self, first: int, states: ModalStates, torques: np.ndarray, flanks: np.ndarray
    ) -> int:
        """Advance states in place by the steps after step `first`, one for each row of torques;
        meshes with backlash.

        torques : (steps, states) N·m, sum of the torques at the start and the end of each step
        flanks : (m,) 1 or -1, the flanks that carry the steady load. States with all meshes in
        contact there need one product, the others Newton's method on the piecewise linear forces.
        Returns the number of the latter.
        Raises ConvergenceError.
        """
        rows = slice(first + 1, first + 1 + len(torques))
        k = self.stiffness[rows]
        law = self.contact_inverse[rows], k, -self.train.half_backlash * k * flanks
        separated = self.kernel.advance(
            first, states.q, states.y, states.mesh_term, torques, *law, flanks
        )
        if separated < 0:
            raise ConvergenceError(
                f"the motion of the gear train did not converge at {-separated * self.h:g} s"
            )
        return separated

    def law(self, step: int, stiffness: np.ndarray, constant: np.ndarray | None = None) -> MeshLaw:
        """Mesh forces stiffness * d + constant at the end of a step; both (m,), N/m and N."""
        constant = np.zeros_like(stiffness) if constant is None else constant
        solution = np.linalg.inv(self.damped[step] + self.compliance[step] * stiffness)
        return solution[None], stiffness[None], constant[None]

    def linear(self, step: int, states: ModalStates, torques: np.ndarray, law: MeshLaw) -> None:
        """Advance states in place by step number `step` with a linear `law` at its end.

        torques : (states,) N·m, sum of the torques at the start and the end
        """
        self.kernel.advance(step - 1, states.q, states.y, states.mesh_term, torques[None], *law)

    def free_deflections(self, step: int, states: ModalStates, torques: np.ndarray) -> np.ndarray:
        """d (m, states) m: right side of the system for the mesh deflections after a step."""
        modes = self.from_q[:, None] * states.q + self.from_y[:, None] * states.y
        modes -= states.mesh_term
        modes += self.from_torque[:, None] * torques
        w, c = self.deflection_rows[step], self.train.mesh_damping[:, None]
        return w @ modes + self.compliance[step] @ (c * (w @ states.y))

    def mesh_term(self, step: int, q: np.ndarray, y: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """The term h/2 D⁻¹ Wᵀ g (n, states) for elastic forces (m, states) after a step."""
        w = self.deflection_rows[step]
        damping = self.train.mesh_damping[:, None] * (w @ y - 2.0 / self.h * (w @ q))
        return self.from_force[:, None] * (w.T @ (forces + damping))

    def static_equilibrium(self, torque: float) -> tuple[ModalStates, np.ndarray]:
        """State (one column) at rest under a steady torque (N·m) at time 0, and the flanks (m,).

        The flanks, 1 or -1, are those that carry the load in the train without backlash.
        """
        train, w, k = self.train, self.deflection_rows[0], self.stiffness[0]
        stiffness = np.diag(train.stiffness) + w.T @ (k[:, None] * w)
        load = train.torque_vector * torque
        flanks = np.sign(w @ np.linalg.solve(stiffness, load))
        q = np.linalg.solve(stiffness, load + w.T @ (k * flanks * train.half_backlash))[:, None]
        y, forces = 2.0 / self.h * q, force(k[:, None], w @ q, train.half_backlash)
        return ModalStates(q, y, self.mesh_term(0, q, y, forces)), flanks
