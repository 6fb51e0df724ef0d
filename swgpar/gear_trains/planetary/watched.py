"""What is watched of a planetary gear train: coordinates of its parts, and the ways of two meshes."""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.planetary.model import Train, carrier, nodes, planet
from swgpar.gear_trains.planetary.steps import Steps

NAMES = ("sun_u", "carrier_u", "planet_eta", "node_w", "contact_v", "sun_mesh", "ring_mesh")
"""Turn of the sun and the carrier (m at their radius), tangential way of planet 1, ring node 3 along the motion, ring
outward at planet 1, ways of the meshes of planet 1."""

NODE = 2
"""The ring's node 3, from 0."""


def watched(train: Train, steps: Steps, step: int) -> np.ndarray:
    """(watched, n): values per mode at the end of a step."""
    design, first = train.design, nodes(train.design)
    fixed = [2, carrier(design) + 2, planet(0) + 1, first + 3 * NODE + 1]
    contact = train.ring.at(design.carrier.speed * step * steps.h)[0] @ train.shapes[first:]
    ways = steps.ways[step]
    return np.vstack([train.shapes[fixed], contact, ways[0], ways[design.planet.count]])
