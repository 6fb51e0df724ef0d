"""What inertia does to the rim of the flexible spline: a thin ring that bends without extension.

The rim rotates at a speed r and its wave of n lobes at a speed w. A point of the rim sees the wave
pass at w - r and moves by u cos n a outward and (u / n) sin n a along. The kinetic energy of second
order in u, with the mean radius that shrinks by (n² - 1)² u² / (4 n² R) because the rim does not
stretch, is half of

    pi R rho A u² [(n² + 1) (w - r)² + 4 r (w - r) + (3 - n²) r²],

and the energy of bending half of pi R u² E I (n² - 1)² / R⁴. The quotient is the share of the
forces that bend the rim which inertia makes. With r = 0 it is the square of n w over the natural
frequency of the ring. With w = 0 it is zero: a stretched ring that flows along its own curve, at
any speed, needs no force (J. W. S. Rayleigh's and G. H. Bryan's ring). Rotation alone stretches the
rim by the hoop stress rho (R r)².
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class RimInertia:
    """A rim.

    radius, thickness : mm, of its middle line, and of what bends
    mass_thickness : mm, of the rim and of teeth that go with it
    modulus : MPa;  density : kg/m³;  lobes : of the wave;  amplitude : mm, radial, of the wave
    """

    radius: float
    thickness: float
    mass_thickness: float
    modulus: float
    density: float
    lobes: int
    amplitude: float

    def share_of_bending(self, rim: float, wave: float) -> float:
        """Forces of inertia over those that bend the rim; rim, wave : rad/s"""
        squared, passing = self.lobes**2, wave - rim
        inertia = (squared + 1) * passing**2 + 4.0 * rim * passing + (3 - squared) * rim**2
        mass = 1e-12 * self.density * self.mass_thickness  # t/mm²
        stiffness = self.modulus * self.thickness**3 / 12.0 * (squared - 1) ** 2 / self.radius**4
        return mass * inertia / stiffness

    def hoop_stress(self, rim: float) -> float:
        """Hoop stress (MPa) by the rotation. rim : rad/s"""
        mass = 1e-12 * self.density * self.mass_thickness / self.thickness
        return mass * (self.radius * rim) ** 2

    @property
    def bending_stress(self) -> float:
        """Bending stress (MPa) at the tip of a lobe."""
        curvature = (self.lobes**2 - 1) * self.amplitude / self.radius**2
        return 0.5 * self.modulus * self.thickness * curvature
