"""Growth of a body that is free: strains without stress, by its temperature or by a fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Growth:
    """Strains of a body that is free of stress, the same everywhere.

    across : in all directions across the axis of the drive;  along : along the axis
    """

    across: float = 0.0
    along: float = 0.0

    def __bool__(self) -> bool:
        return self.across != 0.0 or self.along != 0.0

    @property
    def largest(self) -> float:
        """Largest magnitude of the strains."""
        return max(abs(self.across), abs(self.along))

    def __add__(self, other: Growth) -> Growth:
        """One growth after the other."""
        return Growth(
            self.across + other.across + self.across * other.across,
            self.along + other.along + self.along * other.along,
        )

    def of(self, points: np.ndarray) -> np.ndarray:
        """Displacement (..., 3) mm of points (..., 3) mm; the origin stays."""
        return points * np.array([self.across, self.across, self.along])


NO_GROWTH = Growth()
"""At the temperature at which sizes hold, without a fit."""
