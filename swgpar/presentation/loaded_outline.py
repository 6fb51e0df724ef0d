"""The loaded state of a drive in the section at mid-width of its teeth: tension at the surfaces of
its gears, and the pairs of flanks with their forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from swgpar.geometry.arrays import Floats
from swgpar.presentation.sections import PlaneBody

if TYPE_CHECKING:
    from swgpar.drive_results.drive_data import DriveData

SHOWN = 0.25
"""Share of the largest tension from which nodes of the surfaces are kept."""


SAME_LAYER = 1e-6
"""Distance (mm) along the axis of nodes that lie in one layer."""


@dataclass(frozen=True)
class LoadedPairs:
    """Pairs of flanks in contact, in the whole drive.

    tooth : (n,) of the flexible spline, counter-clockwise from +y;  ring_tooth : (n,)
    place : (n, 2) mm;  force : (n,) N;  share : (n,) of the sum of all forces
    pressure : (n,) MPa, nan of pairs that carry almost nothing
    """

    tooth: np.ndarray
    ring_tooth: np.ndarray
    place: Floats
    force: Floats
    share: Floats
    pressure: Floats


@dataclass(frozen=True)
class LoadedOutline:
    """Surfaces of the gears of a drive in its last computed state, at mid-width of the teeth.

    place : (n, 2) mm, deformed nodes whose tension is above `SHOWN` of the largest one
    s1 : (n,) MPa, largest principal stress there, nodal averages
    pairs : of flanks in contact
    """

    place: Floats
    s1: Floats
    pairs: LoadedPairs


def loaded_outline(result: DriveData) -> LoadedOutline:
    """Of the last increment with fields; collective. A mesh without nodes at mid-width gives the
    section through the nodes that are nearest to it. Raises InputError without fields."""
    copies, places, stresses = result.summary.copies, [], []
    for gear in result.gears:
        points, cells = result.mesh(gear)
        if not result.is_plane:
            cells = _at_mid_width(points, cells)
        moved = points + result.field("displacement", -1, gear)
        body = PlaneBody.of(moved, cells, result.field("s1", -1, gear), copies)
        surface = body.surface()
        if gear == "flexible_spline":
            before = PlaneBody.of(moved, cells, np.hypot(*points[:, :2].T), copies).mises
            spline = body.points[surface], before[surface]
        places.append(body.points[surface])
        stresses.append(body.mises[surface])
    place, s1 = np.concatenate(places), np.concatenate(stresses)
    kept = s1 > SHOWN * s1.max()
    return LoadedOutline(place[kept], s1[kept], _pairs(result, *spline))


def _at_mid_width(points: Floats, cells: np.ndarray) -> np.ndarray:
    """The hexahedra (k, 8) whose first faces lie in the layer of nodes next to z = 0.

    points : (n, 3) mm, undeformed;  cells : (m, 8)
    """
    z = points[cells[:, :4], 2]
    flat = np.ptp(z, axis=1) < SAME_LAYER
    layer = z[flat, 0][np.argmin(np.abs(z[flat, 0]))]
    found: np.ndarray = cells[flat & (np.abs(z[:, 0] - layer) < SAME_LAYER)]
    return found


def _pairs(result: DriveData, points: Floats, before: Floats) -> LoadedPairs:
    """Those of the last increment, with their images where a part of the drive is modelled.

    points : (n, 2) mm, deformed nodes on the surface of the flexible spline
    before : (n,) mm, their radii in the undeformed one
    """
    if not result.pairs:  # no flanks touch, as without a torque
        none = np.empty(0)
        return LoadedPairs(none, none, np.empty((0, 2)), none, none, none)
    last = result.pairs["increment"] == result.field_increments[-1]
    own = {name: np.asarray(values)[last] for name, values in result.pairs.items()}
    copies, drive = result.summary.copies, result.summary.design.drive
    copy = np.repeat(np.arange(copies), last.sum())
    every = {name: np.tile(values, copies) for name, values in own.items()}
    angle = np.radians(every["angle_deg"]) + 2.0 * np.pi / copies * copy
    # contacts have their radius in the undeformed spline: it moves with the nodes beside them
    turned = np.angle(np.exp(1j * (np.arctan2(-points[:, 0], points[:, 1]) - angle[:, None])))
    there = every["radius_mm"][:, None]
    nearest = np.hypot(there * turned, before - there).argmin(axis=1)
    radius = every["radius_mm"] + np.hypot(*points[nearest].T) - before[nearest]
    return LoadedPairs(
        every["tooth"] + copy * drive.teeth_fs // copies,
        every["ring_tooth"] + copy * drive.teeth_rg // copies,
        np.column_stack([-radius * np.sin(angle), radius * np.cos(angle)]),
        every["force_N"],
        every["force_share"],
        every["pressure_MPa"],
    )
