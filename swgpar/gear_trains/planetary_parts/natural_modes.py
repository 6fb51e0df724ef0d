"""Natural modes of a planetary train with all meshes in contact, and their kinds.

With equal planets at equal angles the motions of the planets in a mode repeat from one planet to
the next, turned by a phase of 2 pi n / N (J. Lin, R. G. Parker, Analytical characterization of the
unique properties of planetary gear free vibration, Journal of Vibration and Acoustics 121 (1999)
316-321). All planets move alike in rotational modes (n = 0), in which sun, carrier and ring turn
only. Sun, carrier and ring stay in translational modes (n = 1) without turning. In planet modes
(other n, of four planets and more) they are at rest. An elastic ring adds modes of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.gear_trains.planetary_parts.model import (
    SUN,
    PlanetaryModel,
    carrier_index,
    planet_index,
    ring_index,
)
from swgpar.results.table import Columns

KINDS = ("rotational", "translational", "planet", "ring")

PARTS_OF_ENERGY = "sun", "planets", "carrier", "ring"


@dataclass(frozen=True)
class PlanetaryModes:
    """Modes of ascending frequency, with the planets where they are at the start.

    frequency : (n,) Hz;  shapes : (n, n), columns are modes of unit mass in the coordinates of the
        parts;  kind : (n,) of `KINDS`
    energy : (n, 4) kinetic energy of sun, planets, carrier and ring over the whole; the rest is
        that of rotor and generator
    """

    frequency: np.ndarray
    shapes: np.ndarray
    kind: np.ndarray
    energy: np.ndarray


def natural_modes(train: PlanetaryModel) -> PlanetaryModes:
    """All modes, with the mean stiffness of the meshes; gyroscopic terms are left out."""
    rows, k = train.modal_deflection_rows(np.zeros(1))[0], train.mean_stiffness(0.0)
    squares, modal = np.linalg.eigh(np.diag(train.stiffness) + rows.T @ (k[:, None] * rows))
    shapes = train.shapes @ modal
    first, count = ring_index(train.design), train.design.planet.count
    ring = train.mass[first:, first:]
    kinetic = shapes * (train.mass @ shapes)
    planets = kinetic[planet_index(0) : planet_index(count)]
    carrier = carrier_index(train.design)
    parts = kinetic[SUN : SUN + 3], planets, kinetic[carrier : carrier + 3]
    energy = [part.sum(axis=0) for part in parts] + [kinetic[first:].sum(axis=0)]
    rigid = _rigid_ring(train)
    along = np.linalg.solve(rigid.T @ ring @ rigid, rigid.T @ ring @ shapes[first:])
    elastic = energy[3] - (along * (rigid.T @ ring @ rigid @ along)).sum(axis=0)
    harmonic = _planet_harmonic(train, shapes)
    kind = np.where(elastic > 0.5, "ring", np.array(KINDS)[np.minimum(harmonic, 2)])
    frequency = np.sqrt(squares.clip(0.0)) / (2.0 * np.pi)
    return PlanetaryModes(frequency, shapes, kind, np.array(energy).T)


def mode_table(train: PlanetaryModel) -> Columns:
    """Natural modes with all meshes in contact, as columns of a table.

    mesh_resonance_rad_s : speed of the carrier at which the tooth meshes have the frequency
    """
    modes = natural_modes(train)
    return {
        "mode": np.arange(1, len(modes.frequency) + 1),
        "kind": modes.kind,
        "frequency_Hz": modes.frequency,
        "mesh_resonance_rad_s": 2.0 * np.pi * modes.frequency / train.design.ring.teeth,
        **{f"energy_{part}": share for part, share in zip(PARTS_OF_ENERGY, modes.energy.T)},
    }


def _planet_harmonic(train: PlanetaryModel, shapes: np.ndarray) -> np.ndarray:
    """n (modes,) of the largest part of the planets' motions, 0 to half of their number."""
    count = train.design.planet.count
    of_planets = shapes[planet_index(0) : planet_index(count)].reshape(count, 3, -1)
    mass = np.diag(train.mass)[planet_index(0) : planet_index(1), None]
    parts = (mass * np.abs(np.fft.fft(of_planets, axis=0)) ** 2).sum(axis=1)
    folded = [parts[n] + (parts[-n] if 0 < 2 * n < count else 0.0) for n in range(count // 2 + 1)]
    return np.argmax(folded, axis=0)


def _rigid_ring(train: PlanetaryModel) -> np.ndarray:
    """Displacements (unknowns, 3) of the ring when it moves along x, along y, and turns."""
    count, radius = train.design.ring.elements, train.ring.section.radius
    node = 2.0 * np.pi * np.arange(count) / count
    zero, one = np.zeros(count), np.ones(count)
    x, y = (np.cos(node), -np.sin(node), zero), (np.sin(node), np.cos(node), zero)
    return np.array([np.stack(m, axis=1).ravel() for m in (x, y, (zero, radius * one, one))]).T
