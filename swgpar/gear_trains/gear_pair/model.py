"""Equations of motion of a gear pair with bearings along the line of action (eqs 4.1 to 4.18).

Coordinates q = (y1, y2, z), z = r1 θ1 - r2 θ2; the mesh deflection is d = y1 - y2 + z, so that its
force enters with w = (1, -1, 1). (Print has +f in all three rows of eq. 4.16 and the right signs in
eqs 4.1 to 4.7.) The two rotations become one by

    m_c z'' + f = m_c (T1 r1 / I1 + T2 r2 / I2),    m_c = 1 / (r1² / I1 + r2² / I2).

Equation (4.7) has T1 / r1 on the right, which is the same only when the torques are in the ratio of
the radii: those of the source are so to 0.4 %. The mesh's damper acts inside the gap too, as in
print.
The noise of amplitude w0 and spectral density S0 has the intensity 2 pi S0 w0².
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from swgpar.gear_trains.gear_pair.design import GearPairDesign
from swgpar.vibration.gear_mesh_system import GearMeshSystem
from swgpar.vibration.mesh_stiffness import MeshStiffness

COORDINATES = ("y1", "y2", "z")
DEFLECTION_ROW = np.array([[1.0, -1.0, 1.0]])


def combined_mass(design: GearPairDesign) -> float:
    """m_c, kg."""
    g1, g2 = design.gear_1, design.gear_2
    return 1.0 / ((1e-3 * g1.radius) ** 2 / g1.inertia + (1e-3 * g2.radius) ** 2 / g2.inertia)


def mesh_force(design: GearPairDesign, case: int) -> float:
    """The force that the mesh carries at rest under the torques of a case, N."""
    g1, g2 = design.gear_1, design.gear_2
    first = design.load.input[case] * 1e-3 * g1.radius / g1.inertia
    second = design.load.output[case] * 1e-3 * g2.radius / g2.inertia
    return combined_mass(design) * (first + second)


def gear_pair_system(design: GearPairDesign, case: int) -> GearMeshSystem:
    """The equations of motion under the torques of a case."""
    mesh = design.mesh
    mass = np.diag([design.gear_1.mass, design.gear_2.mass, combined_mass(design)])
    bearings = np.diag([design.gear_1.bearing, design.gear_2.bearing, 0.0])
    damping = design.damping.mass * mass + design.damping.stiffness * (
        bearings + mesh.stiffness * DEFLECTION_ROW.T @ DEFLECTION_ROW
    )
    mean, ratio, phase = np.array([mesh.stiffness]), np.array([mesh.contact_ratio]), np.zeros(1)
    amplitude = mesh.variation * mean
    stiffness = MeshStiffness(mean, amplitude, ratio, mesh.frequency, mesh.harmonics, phase)
    noise = design.load.noise * np.sqrt(2.0 * np.pi * design.load.spectral_density)
    return GearMeshSystem(
        mass=mass,
        damping=damping,
        stiffness=bearings,
        deflection_rows=lambda t: DEFLECTION_ROW,
        mesh_stiffness=stiffness.at,
        half_backlash=np.array([1e-6 * mesh.half_backlash]),
        force=np.array([0.0, 0.0, mesh_force(design, case)]),
        noise=np.array([[0.0], [0.0], [noise]]),
    )


def static_equilibrium(design: GearPairDesign, case: int) -> np.ndarray:
    """Coordinates (3,) in m where the pair rests under the steady torques: simulations start
    there."""
    force = mesh_force(design, case)
    stiffness = gear_pair_system(design, case).mesh_stiffness(0.0)[0]
    y1, y2 = -force / design.gear_1.bearing, force / design.gear_2.bearing
    return np.array([y1, y2, 1e-6 * design.mesh.half_backlash + force / stiffness - y1 + y2])


def pair_modes(design: GearPairDesign) -> tuple[np.ndarray, np.ndarray]:
    """Natural frequencies (3,) in rad/s of the pair in contact, and their damping ratios (3,)."""
    pair = gear_pair_system(design, 0)
    squares, shapes = eigh(pair.linear_stiffness(0.0, np.array([design.mesh.stiffness])), pair.mass)
    frequencies = np.sqrt(squares)
    return frequencies, np.einsum("ji,jk,ki->i", shapes, pair.damping, shapes) / (2.0 * frequencies)
