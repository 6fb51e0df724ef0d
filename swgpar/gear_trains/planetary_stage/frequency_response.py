"""Response of a planetary stage to harmonic torques and transmission errors, all meshes in contact.

The ring meshes are where they are at the start, with mean stiffnesses. A transmission error of the
sun meshes acts in all of them with the phases of their tooth cycles, that of one harmonic of the
mesh frequency.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.gear_trains.planetary_parts.model import PlanetaryModel


@dataclass(frozen=True)
class FrequencyResponse:
    """Amplitudes at frequencies (n,) in Hz, beginning with (n,).

    mesh_by_torque : (n, m) N of mesh force per N·m of torque on the rotor, or on the carrier
    mesh_by_error : (n, m) N of mesh force per m of transmission error of the sun meshes
    """

    frequency: np.ndarray
    mesh_by_torque: np.ndarray
    mesh_by_error: np.ndarray


def frequency_response(train: PlanetaryModel, frequency: np.ndarray) -> FrequencyResponse:
    """At frequencies (n,) in Hz."""
    count, rows = train.design.planet.count, train.modal_deflection_rows(np.zeros(1))[0]
    stiffness, omega = train.mean_stiffness(0.0), 2.0 * np.pi * frequency
    error = np.zeros(2 * count, dtype=complex)
    error[:count] = np.exp(-1j * train.mesh.phase[:count])
    by_torque, by_error = np.empty((2, len(omega), 2 * count))
    for k, w in enumerate(omega):
        meshes = stiffness + 1j * w * train.mesh_damping
        dynamic = np.diag(train.stiffness - w**2 + 1j * w * train.damping).astype(complex)
        dynamic += rows.T @ (meshes[:, None] * rows)
        load = np.stack([train.torque_vector, -rows.T @ (meshes * error)], axis=1)
        moved = rows @ np.linalg.solve(dynamic, load)
        by_torque[k] = np.abs(meshes * moved[:, 0])
        by_error[k] = np.abs(meshes * (moved[:, 1] + error))
    return FrequencyResponse(frequency, by_torque, by_error)
