"""Torque up to which a drive counts as unloaded."""

from __future__ import annotations

import numpy as np

RING_FLEXIBILITY = 0.25 * np.pi - 2.0 / np.pi
"""Change of the diameter of a ring under two opposed forces F, over F r^3 / (E I) (Timoshenko)."""

NEGLIGIBLE = 1e-4
"""Share of the bending force up to which a force on the teeth counts as none.

Newton's iteration balances it together with the forces that bend the flexible spline: far below
them, the flanks that carry it do not settle. The stresses by bending are larger by the same ratio.
"""


def negligible_torque(
    modulus: float, deflection: float, width: float, rim: float, radius: float
) -> float:
    """Output torque (N·mm) up to which a drive counts as unloaded: that of `NEGLIGIBLE` at the
    radius (mm) of the middle of the flexible spline's rim.

    The bending force is that of a ring with the section of the rim, between two opposed forces.

    modulus : MPa;  deflection : mm, of the diameter;  width, rim : mm
    """
    stiffness = modulus * width * rim**3 / 12.0
    force = deflection * stiffness / (RING_FLEXIBILITY * radius**3)
    return NEGLIGIBLE * force * radius
