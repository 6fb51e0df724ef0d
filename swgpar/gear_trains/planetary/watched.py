"""What is watched of a planetary gear train: coordinates of its parts, and the ways of two meshes."""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.planetary.model import Train, carrier, nodes, planet
from swgpar.gear_trains.planetary.steps import Steps

WATCHED = {
    "sun_u": "the turn of the sun at its radius",
    "carrier_u": "the turn of the carrier at its radius",
    "planet_eta": "the way of planet 1 along its circle",
    "node_w": "ring node 3 along the motion",
    "contact_v": "the ring outward at planet 1",
    "sun_mesh": "the way of the sun's mesh of planet 1",
    "ring_mesh": "the way of the ring's mesh of planet 1",
}
"""Name -> meaning; all in m."""

NAMES = tuple(WATCHED)

NODE = 2
"""The ring's node 3, from 0."""


def watched(train: Train, steps: Steps, step: int) -> np.ndarray:
    """(watched, n): values per mode at the end of a step."""
    design, first = train.design, nodes(train.design)
    fixed = [2, carrier(design) + 2, planet(0) + 1, first + 3 * NODE + 1]
    contact = train.ring.at(design.carrier.speed * step * steps.h)[0] @ train.shapes[first:]
    ways = steps.ways[step]
    return np.vstack([train.shapes[fixed], contact, ways[0], ways[design.planet.count]])
