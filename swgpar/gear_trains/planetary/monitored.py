"""What is watched of a planetary gear train: coordinates of its parts, and the ways of two meshes."""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.planetary.model import PlanetaryModel, carrier_index, planet_index, ring_index
from swgpar.gear_trains.planetary.time_stepping import TimeStepper

MONITORED = {
    "sun_u": "the turn of the sun at its radius",
    "carrier_u": "the turn of the carrier at its radius",
    "planet_eta": "the way of planet 1 along its circle",
    "node_w": "ring node 3 along the motion",
    "contact_v": "the ring outward at planet 1",
    "sun_mesh": "the way of the sun's mesh of planet 1",
    "ring_mesh": "the way of the ring's mesh of planet 1",
}
"""Name -> meaning; all in m."""

MONITORED_NAMES = tuple(MONITORED)

NODE = 2
"""The ring's node 3, from 0."""


def monitored_rows(train: PlanetaryModel, steps: TimeStepper, step: int) -> np.ndarray:
    """(monitored, n): values per mode at the end of a step."""
    design, first = train.design, ring_index(train.design)
    fixed = [2, carrier_index(design) + 2, planet_index(0) + 1, first + 3 * NODE + 1]
    contact = train.ring.interpolation(design.carrier.speed * step * steps.h)[0] @ train.shapes[first:]
    deflection_rows = steps.deflection_rows[step]
    return np.vstack([train.shapes[fixed], contact, deflection_rows[0], deflection_rows[design.planet.count]])
