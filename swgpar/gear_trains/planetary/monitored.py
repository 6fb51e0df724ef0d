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


def monitored(
    train: PlanetaryModel, steps: TimeStepper, step: int, flanks: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Monitored quantities per unit of each mode (monitored, n), and what is added (monitored,) m,
    at the end of a step.

    Meshes are taken as in contact on their loaded flanks (m,), 1 or -1: force and deflection of the
    ring between its nodes follow from the deflection with that of the nodes.
    """
    design, first, count = train.design, ring_index(train.design), train.design.planet.count
    time = step * steps.h
    fixed = [2, carrier_index(design) + 2, planet_index(0) + 1, first + 3 * RING_NODE + 1]
    outward = train.ring.interpolation(design.carrier.speed * time)[0] @ train.shapes[first:]
    sun, ring = steps.deflection_rows[step, [0, count]]
    stiffness = steps.stiffness[step, count]
    closed = train.half_backlash * flanks[count]
    bulge = stiffness * train.local_flexibility(np.array([time]))[0, 0, 0]
    share = stiffness / train.mesh.at(time)[count]
    rows = np.vstack([train.shapes[fixed], outward - bulge * ring, sun, share * ring])
    constants = np.zeros(len(rows))
    constants[-3:] = bulge * closed, 0.0, (1.0 - share) * closed
    return rows, constants
