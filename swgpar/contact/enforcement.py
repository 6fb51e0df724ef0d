"""Hard contact by augmented multipliers: the pressure is p = max(0, lambda - epsilon g).

epsilon is a stiffness per area near E / h; lambda, one number per quadrature point, starts at zero in every
increment and is set to p until the remaining penetration is below a tolerance, so that neither shows in the
results. Friction acts at the same points (see friction.py).
"""

from __future__ import annotations

import numpy as np


def pressure(gap: np.ndarray, multiplier: np.ndarray, penalty: float) -> np.ndarray:
    """Contact pressure (MPa) at gaps (mm; negative is penetration); inf gap gives zero."""
    return np.maximum(0.0, multiplier - penalty * gap)


def penetration(gap: np.ndarray, pressure_: np.ndarray) -> float:
    """Largest penetration (mm) where there is pressure."""
    touching = pressure_ > 0.0
    return float(max(0.0, -gap[touching].min())) if touching.any() else 0.0
