"""Section [output_bearing] of the drive's design file."""

from __future__ import annotations

from typing import Any

import numpy as np

from swgpar.input.quantities import Section, not_negative, positive, quantity
from swgpar.profiles.flank_deviations import direction

PER_METRE = 1000.0
"""N·mm in a N·m."""


def _stiffness(unit: str, text: str, most: float) -> Any:
    return positive(text, unit, le=most)


class OutputBearing(Section):
    """Section [output_bearing]: the bearing that carries the output, and the forces on it. Without
    it the output only rotates."""

    radial_stiffness: float = _stiffness("N/mm", "radial force over radial displacement", 1e9)
    axial_stiffness: float = _stiffness("N/mm", "axial force over axial displacement", 1e9)
    tilting_stiffness: float = _stiffness("N·m/rad", "tilting moment over tilt", 1e12)
    position: float | None = quantity(
        None,
        unit="mm",
        text="of its middle along z, from the middle of the face width towards the closed end; "
        "without it in the middle of the surface that is the output",
    )
    radial_force: float = not_negative("radial force on the output", "N", 0.0)
    radial_direction: float = quantity(
        0.0, unit="deg", text="of the radial force in space, counter-clockwise from +y"
    )
    axial_force: float = quantity(0.0, unit="N", text="axial force on the output, along +z")
    tilting_moment: float = not_negative(
        "tilting moment on the output, in the middle of the bearing", "N·m", 0.0
    )
    tilting_direction: float = quantity(
        0.0,
        unit="deg",
        text="to which the moment leans the axis at positive z, counter-clockwise from +y",
    )

    @property
    def is_loaded_sideways(self) -> bool:
        """Whether forces act that do not go round with the wave generator."""
        return self.radial_force > 0.0 or self.tilting_moment > 0.0

    @property
    def stiffness(self) -> np.ndarray:
        """Stiffnesses (5,): N/mm along x, y and z, N·mm of the tilts about x and y."""
        radial, tilting = self.radial_stiffness, PER_METRE * self.tilting_stiffness
        return np.array([radial, radial, self.axial_stiffness, tilting, tilting])

    @property
    def load(self) -> np.ndarray:
        """Forces (N) along x, y and z and moments (N·mm) about x and y on the output, (5,)."""
        radial = self.radial_force * direction(float(np.radians(self.radial_direction)))
        lean = direction(float(np.radians(self.tilting_direction)))
        moment = PER_METRE * self.tilting_moment * np.array([-lean[1], lean[0]])
        return np.array([*radial, self.axial_force, *moment])
