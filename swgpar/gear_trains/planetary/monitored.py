"""Monitored quantities of a planetary gear train: coordinates and deflections of two meshes."""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.planetary.model import (
    PlanetaryModel,
    carrier_index,
    planet_index,
    ring_index,
)
from swgpar.gear_trains.planetary.time_stepping import TimeStepper

MONITORED = {
    "sun_rotation": "rotation of the sun times its base radius",
    "carrier_rotation": "rotation of the carrier times the radius of the planet centres",
    "planet_tangential": "tangential displacement of planet 1 in the frame of the carrier",
    "ring_node_tangential": "tangential displacement of node 3 of the ring",
    "ring_contact_radial": "outward displacement of the ring at the mesh with planet 1",
    "sun_mesh_deflection": "deflection of the mesh of sun and planet 1",
    "ring_mesh_deflection": "deflection of the mesh of ring and planet 1",
}
"""Name -> meaning; all in m."""

MONITORED_NAMES = tuple(MONITORED)

RING_NODE = 2
"""Node 3 of the ring, counted from 0."""


def monitored_rows(train: PlanetaryModel, steps: TimeStepper, step: int) -> np.ndarray:
    """(monitored, n): monitored quantities per unit of each mode, at the end of a step."""
    design, first = train.design, ring_index(train.design)
    fixed = [2, carrier_index(design) + 2, planet_index(0) + 1, first + 3 * RING_NODE + 1]
    outward = train.ring.interpolation(design.carrier.speed * step * steps.h)[0]
    meshes = steps.deflection_rows[step, [0, design.planet.count]]
    return np.vstack([train.shapes[fixed], outward @ train.shapes[first:], meshes])
