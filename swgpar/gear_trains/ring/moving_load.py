"""Mean and covariance of a ring under equally spaced loads that move around in it (chapter 6).

Each load is F0 + f sin(w t) + b W(t) with a white noise W of its own, of unit intensity. The
harmonic part of load k is that of the first load at the time when the first load reaches the
initial position of load k (eq. 6.16). A load acts outward with the sine and along the motion with
the cosine of the pressure angle, as in eq. 3.21, on the radius `moving_load.radius` (in print the
centre line). (Eq. 6.14 has it against the motion; but the
planets drive the ring along.) Damping is proportional, so that the modes of the ring separate; all
of them are kept. A step is exact for forces that vary linearly within it and for noise that acts at
the middle of the step. Steps have to resolve only the travel of the loads.

The source takes the stochastic Newmark scheme (eqs 6.28 to 6.32; P. Bernard, G. Fleury, Stochastic
Newmark scheme, Probabilistic Engineering Mechanics 17 (2002) 45-61), whose variance depends on the
step unless that resolves the ring's vibrations: it is the check of this
(tests/verification/test_ring.py).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from swgpar.gear_trains.ring.design import RingDesign
from swgpar.vibration.modal_stepping import ModalStepper
from swgpar.vibration.moments import Moments, SampleMoments


@dataclass(frozen=True)
class Response(Moments):
    """Outward displacements (rows, 2) in the last revolution: at the first load, at the middle
    node. angle : (rows,) rad, of the first load"""

    angle: np.ndarray


def middle_node(design: RingDesign) -> int:
    """The node in the middle between the first two supports, or the one before it."""
    return design.ring.elements // design.supports.count // 2


class MovingLoads:
    """Loads on the modes of a ring."""

    def __init__(self, design: RingDesign) -> None:
        self.load, ring = design.moving_load, design.elastic_ring()
        self.frequencies, self.shapes = ring.modes()
        alpha, n = np.radians(self.load.pressure_angle), self.load.steps
        centre = ring.section.radius
        radius = centre if self.load.radius is None else 1e-3 * self.load.radius
        direction = np.array([np.sin(alpha), np.cos(alpha), (radius - centre) * np.cos(alpha)])
        # at the ends of all steps, and in their middle for the noise
        at = [ring.interpolation(np.pi * k / n) for k in range(2 * n)]
        self.load_vectors = np.array([direction @ rows for rows in at]) @ self.shapes
        self.outward = np.array([rows[0] for rows in at[::2]]) @ self.shapes
        self.middle = self.shapes[3 * middle_node(design)]

    def forces(self, step: int, time: float, speed: float) -> np.ndarray:
        """Modal forces (modes,) of the steady and harmonic parts after a step, at a time in s."""
        load = self.load
        ahead = 2.0 * np.pi * np.arange(load.loads) / load.loads
        frequency = load.frequency if load.cycles is None else load.cycles * speed
        sizes = load.force + load.harmonic * np.sin(frequency * (time + ahead / speed))
        return sizes @ self._at_loads(2 * step)

    def noises(self, step: int) -> np.ndarray:
        """Modal forces (modes, loads) of unit white noises, in the middle of a step."""
        return self.load.noise * self._at_loads(2 * step - 1).T

    def _at_loads(self, half_steps: int) -> np.ndarray:
        """Modal forces (loads, modes) of unit loads after so many half steps."""
        count, loads = len(self.load_vectors), self.load.loads
        return self.load_vectors[(half_steps + np.arange(loads) * count // loads) % count]

    def _modes(self, speed: float) -> ModalStepper:
        """The modes with the steps of a speed (rad/s)."""
        stiffness = self.frequencies**2
        damping = self.load.damping_mass + self.load.damping_stiffness * stiffness
        return ModalStepper(stiffness, damping, 2.0 * np.pi / speed / self.load.steps)

    def _monitored(self, step: int) -> np.ndarray:
        """Outward displacements (2, modes) of `Response` per mode, at the end of a step."""
        return np.stack([self.outward[step % self.load.steps], self.middle])

    def respond(self, speed: float) -> Response:
        """Response at a speed (rad/s), from the static deflection under the loads at the start."""
        load, n, modes = self.load, self.load.steps, self._modes(speed)
        force = self.forces(0, 0.0, speed)
        q, v = force / modes.k, np.zeros_like(force)
        spread = np.zeros((2, 2, len(q), len(q)))
        mean, deviation = np.empty((n, 2)), np.empty((n, 2))
        for step in range(1, load.revolutions * n + 1):
            before, force = force, self.forces(step % n, step * modes.h, speed)
            q, v = modes.step(q, v, before, force)
            spread = modes.spread(spread, self.noises(step % n))
            row = step - (load.revolutions - 1) * n - 1
            if row >= 0:
                monitored = self._monitored(step)
                mean[row] = monitored @ q
                variance = np.einsum("pi,ij,pj->p", monitored, spread[0, 0], monitored)
                deviation[row] = np.sqrt(np.maximum(variance, 0.0))
        return Response(mean, deviation, 2.0 * np.pi * np.arange(1, n + 1) / n)

    def quasi_static(self, speed: float) -> np.ndarray:
        """Mean displacements (rows, 2) m of a ring without inertia and damping."""
        load, n = self.load, self.load.steps
        h, mean = 2.0 * np.pi / speed / n, np.empty((n, 2))
        for row in range(n):
            step = (load.revolutions - 1) * n + row + 1
            force = self.forces(step % n, step * h, speed)
            mean[row] = self._monitored(step) @ (force / self.frequencies**2)
        return mean

    def simulate(self, speed: float, samples: int, random: np.random.Generator) -> SampleMoments:
        """The displacements (rows, 2) of `Response` in `samples` simulations; noise alone
        varies."""
        load, n, modes = self.load, self.load.steps, self._modes(speed)
        root = modes.noise_root()
        force = self.forces(0, 0.0, speed)
        q, v = np.tile(force / modes.k, (samples, 1)), np.zeros((samples, len(force)))

        def rows() -> Iterator[np.ndarray]:
            nonlocal q, v, force
            for step in range(1, load.revolutions * n + 1):
                before, force = force, self.forces(step % n, step * modes.h, speed)
                q, v = modes.step(q, v, before, force)
                for noise in self.noises(step % n).T:
                    shaken = random.standard_normal((samples, root.shape[1])) @ root.T
                    q += noise * shaken[:, : len(noise)]
                    v += noise * shaken[:, len(noise) :]
                if step > (load.revolutions - 1) * n:
                    yield self._monitored(step) @ q.T

        return SampleMoments.of(rows())
