"""The loaded state of a plane drive: tension at the surfaces of its gears, and the pairs of flanks
with their forces."""

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
    """Surfaces of the gears of a plane drive in its last computed state.

    place : (n, 2) mm, deformed nodes whose tension is above `SHOWN` of the largest one
    s1 : (n,) MPa, largest principal stress there, nodal averages
    pairs : of flanks in contact
    """

    place: Floats
    s1: Floats
    pairs: LoadedPairs


def loaded_outline(result: DriveData) -> LoadedOutline:
    """Of the last increment with fields; collective. Raises InputError without fields."""
    places, stresses = [], []
    for gear in result.gears:
        points, cells = result.mesh(gear)
        moved = points + result.field("displacement", -1, gear)
        body = PlaneBody.of(moved, cells, result.field("s1", -1, gear), result.summary.copies)
        surface = body.surface()
        places.append(body.points[surface])
        stresses.append(body.mises[surface])
    place, s1 = np.concatenate(places), np.concatenate(stresses)
    kept = s1 > SHOWN * s1.max()
    return LoadedOutline(place[kept], s1[kept], _pairs(result))


def _pairs(result: DriveData) -> LoadedPairs:
    """Those of the last increment, with their images where a part of the drive is modelled."""
    last = result.pairs["increment"] == result.field_increments[-1]
    own = {name: np.asarray(values)[last] for name, values in result.pairs.items()}
    copies, drive = result.summary.copies, result.summary.design.drive
    copy = np.repeat(np.arange(copies), last.sum())
    every = {name: np.tile(values, copies) for name, values in own.items()}
    angle = np.radians(every["angle_deg"]) + 2.0 * np.pi / copies * copy
    radius = every["radius_mm"]
    return LoadedPairs(
        every["tooth"] + copy * drive.teeth_fs // copies,
        every["ring_tooth"] + copy * drive.teeth_rg // copies,
        np.column_stack([-radius * np.sin(angle), radius * np.cos(angle)]),
        every["force_N"],
        every["force_share"],
        every["pressure_MPa"],
    )
