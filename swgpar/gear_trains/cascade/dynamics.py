"""Motion of the cascade gearbox: meshes with backlash and errors, flexible units, shafts,
generator.

The equations follow from the energy of meshes and shafts: their matrices are symmetric. In print
(eqs 9 to 23) backlash and errors are moved into an alternating force, and the contact function
multiplies stiffness and force once each; here a mesh has the force

    f = k g(p) + h(g) c dp/dt,    p = x_driver - x_driven - e,

p the mesh deflection, g the penetration of the flanks beyond the backlash, h the smooth step of eq.
(10). While flanks separate fast, the damper may make f pull, as in print. Load shares with f
limited to pushing are the same to 1e-5 from 120 kN on (docs/verification/gear_trains.md).
Further deviations from print:

- gaps of the two directions are given apart: the source's geometric difference lies in one;
- the phase of stiffness and error follows the displacement of the driven gear, not a constant
  frequency times the time: the rack stops and reverses. Tooth cycle and pitch error are parameters
  of the motion, as in print: the force has no terms of their derivatives by the displacement;
- G4 and flywheel are always coupled.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

from swgpar.errors import ConvergenceError
from swgpar.gear_trains.cascade.design import PINIONS, CascadeDesign
from swgpar.gear_trains.cascade.layout import DOFS, FLYWHEEL, MESHES, RACK, masses, meshes, shafts
from swgpar.gear_trains.kernel import MESH_ERROR, GearboxKernel

Force = Callable[[Any], Any]
"""Rack forces in N at times in s, any shape."""


def ramp(size: float, duration: float) -> Force:
    """A rack force that rises to `size` N within `duration` s and then stays constant."""
    return lambda t: size * np.minimum(t / duration, 1.0)


class Gearbox:
    """A gearbox in motion. braked : the flywheel is fixed"""

    def __init__(self, design: CascadeDesign, *, braked: bool = False) -> None:
        self.mass, self.braked = masses(design), braked
        self.pinion_radius = design.radius("pinion")
        self.kernel = GearboxKernel(
            self.mass,
            meshes(design),
            shafts(design),
            1e-6 * design.damping.contact_ramp,
            design.flywheel.generator / design.radius("g4") ** 2,
            braked,
        )

    def integrate(
        self,
        force: Force,
        v: np.ndarray,
        times: np.ndarray,
        *,
        rtol: float = 1e-5,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Ways (m) and velocities (m/s), (n, 23), at `times` (n,) s by LSODA with exact matrices,
        without errors of the meshes.

        v : (23,) velocities at the first of the times, where all displacements are zero
        """
        errors, inverse = no_errors(), 1.0 / self.mass
        inverse[FLYWHEEL] *= not self.braked

        def rates(t: float, y: np.ndarray) -> np.ndarray:
            pull = -self.kernel.forces(errors, y[:DOFS], y[DOFS:])
            pull[RACK] += force(t)
            return np.concatenate([y[DOFS:], inverse * pull])

        def jacobian(_: float, y: np.ndarray) -> np.ndarray:
            stiffness, damping = self.kernel.matrices(errors, y[:DOFS], y[DOFS:])
            zero, one = np.zeros((DOFS, DOFS)), np.eye(DOFS)
            column = -inverse[:, None]
            return np.block([[zero, one], [column * stiffness, column * damping]])

        span, start = (times[0], times[-1]), np.concatenate([np.zeros(DOFS), v])
        tolerances = {"rtol": rtol, "atol": np.repeat([1e-9, 1e-5], DOFS)}
        done = solve_ivp(rates, span, start, "LSODA", times, jac=jacobian, **tolerances)
        if not done.success:
            raise ConvergenceError(
                f"the motion of the gearbox could not be integrated: {done.message}"
            )
        return done.y[:DOFS].T, done.y[DOFS:].T

    def simulate(
        self,
        force: Force,
        v: np.ndarray,
        step: float,
        count: int,
        *,
        errors: np.ndarray | None = None,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Simulate `count` implicit steps of `step` s from zero displacements, velocities v (23,).

        Returns the pinion forces after each step, (count, 8) N, and displacements and velocities
        (23,) at the end.
        """
        x, v = np.zeros(DOFS), np.array(v, dtype=float)
        errors = no_errors() if errors is None else errors
        rack = np.ascontiguousarray(force(step * np.arange(count + 1)), dtype=float)
        torque = self.kernel.simulate(errors, rack, step, x, v)
        if len(torque) < count:
            raise ConvergenceError(
                f"the motion of a gearbox did not converge at {step * len(torque):g} s"
            )
        return torque[:, :PINIONS] / self.pinion_radius, x, v

    def pinion_forces(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Forces (n, 8) in N at the pitch lines that the pinions' units pass on (eq. 23).

        x, v : (n, 23) displacements and velocities
        """
        displacements, rates = np.ascontiguousarray(x), np.ascontiguousarray(v)
        return self.kernel.torques(displacements, rates)[:, :PINIONS] / self.pinion_radius


def no_errors() -> np.ndarray:
    """Meshes without errors and all in phase, (18,) of the kernel's MESH_ERROR."""
    return np.zeros(MESHES, dtype=MESH_ERROR)


def natural_frequencies(design: CascadeDesign) -> np.ndarray:
    """Frequencies in Hz (23,) of small vibrations with the mean stiffness of all meshes (eq. 25).

    The flywheel is free, so that the first is zero.
    """
    stiffness, gears = np.zeros((DOFS, DOFS)), np.eye(DOFS)
    for mesh in meshes(design):
        stretch = gears[mesh["driver"]] - gears[mesh["driven"]]
        stiffness += mesh["stiffness"] * np.outer(stretch, stretch)
    for shaft in shafts(design):
        ends = gears[shaft["first"]], gears[shaft["second"]]
        twist = ends[0] / shaft["first_radius"] - ends[1] / shaft["second_radius"]
        stiffness += shaft["stiffness"] * np.outer(twist, twist)
    squares = eigh(stiffness, np.diag(masses(design)), eigvals_only=True)
    return np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi)
