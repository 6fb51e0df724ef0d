"""Torque of the wind on the carrier: steady, and turbulent through a filter of white noise (section
3.3).

The torque is T = C (V0² / 2 + V0 V), C = density x swept area x radius x power coefficient / tip
speed ratio, to the first order in the turbulence V. V comes from white noise W by

    a2 T² c'' + (a2 T + T) c' + c = W,    V = gain (c + a1 T c'),    T = length / V0

(eqs 3.30, 3.31). The source gives neither the intensity of turbulence nor the gain k_v: here the
gain is what makes the deviation of V the given share of V0 in the long run, for W of unit
intensity. The filter starts at rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm, solve_continuous_lyapunov

from swgpar.gear_trains.planetary.design import PlanetaryDesign


@dataclass(frozen=True)
class WindLoad:
    """Torque = steady + turbulent . (c, c'), N·m; the filter state (c, c') is advanced exactly over
    a step.

    Attributes
    ----------
    steady : N·m;  turbulent : (2,) N·m per unit of c and c'
    transition : (2, 2), of (c, c') over a step
    noise_root : (2, 2), lower triangular; noise_root noise_rootᵀ is the covariance that a step adds
    """

    steady: float
    turbulent: np.ndarray
    transition: np.ndarray
    noise_root: np.ndarray

    @classmethod
    def of(cls, design: PlanetaryDesign, h: float) -> WindLoad:
        """The wind of a design with steps of h seconds."""
        wind, v0 = design.wind, design.wind.speed / 3.6
        period = wind.length / v0
        rates = np.array(
            [[0.0, 1.0], [-1.0 / (wind.a2 * period**2), -(1.0 + 1.0 / wind.a2) / period]]
        )
        noise = np.array([[0.0], [1.0 / (wind.a2 * period**2)]])
        stationary = solve_continuous_lyapunov(rates, -noise @ noise.T)
        output = np.array([1.0, wind.a1 * period])
        gain = wind.turbulence * v0 / np.sqrt(output @ stationary @ output)
        ratio = design.carrier.speed * wind.rotor_radius / v0
        factor = wind.air_density * np.pi * wind.rotor_radius**3 * wind.power_coefficient / ratio
        # van Loan's block exponential: the difference of stationary covariances would be round-off
        # for small steps
        blocks = expm(h * np.block([[-rates, noise @ noise.T], [np.zeros((2, 2)), rates.T]]))
        transition = blocks[2:, 2:].T
        return cls(
            0.5 * factor * v0**2,
            factor * v0 * gain * output,
            transition,
            np.linalg.cholesky(transition @ blocks[:2, 2:]),
        )
