"""Where a drive will be when the wave generator has turned on: states of a period, interpolated over teeth and angles.

After one pitch of the fixed gear the drive repeats with its teeth renamed by one. Every state known is therefore known
at all angles that differ from its own by whole pitches, and what lies between them is interpolated.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from swgpar.fem.partition import Partition
from swgpar.fem.vectors import read_field, write_field
from swgpar.geometry.rotation import rotated

APART = 1.5
"""How many times farther away than the first the second state on one side is, at least: of states close together the
difference says nothing about the way ahead."""

SAME = 1e-6
"""Distance in pitches below which two states are at the same place of the period, and the later one counts."""

State = tuple[float, PETSc.Vec]
"""Angle of the wave generator (rad) and displacement there."""


def supports(shifts: list[float]) -> list[tuple[int, int, float]]:
    """Which states, renamed by how many teeth, and with which weights give the one at shift 0.

    shifts : of the states, in teeth, the latest last. The two nearest on either side are taken with the weights of a
    cubic polynomial.
    """
    known: list[tuple[float, int, int]] = []
    for k in reversed(range(len(shifts))):
        whole = int(np.floor(-shifts[k]))
        for tooth in range(whole - 2, whole + 4):
            place = tooth + shifts[k]
            if all(abs(place - other) > SAME for other, *_ in known):
                known.append((place, k, tooth))
    known.sort(key=lambda one: abs(one[0]))
    chosen = []
    for side in (-1.0, 1.0):
        ahead = [one for one in known if (one[0] > 0.0) == (side > 0.0)]
        second = next(one for one in ahead[1:] if abs(one[0]) >= APART * abs(ahead[0][0]))
        chosen += [ahead[0], second]
    places = [place for place, *_ in chosen]
    weights = [float(np.prod([other / (other - place) for other in places if other != place])) for place in places]
    return [(k, tooth, weight) for weight, (_, k, tooth) in zip(weights, chosen) if weight != 0.0]


def predict(
    partition: Partition, fixed: int, states: list[State], x: PETSc.Vec, angle: float, slip: float = 0.0
) -> None:
    """Set x to the state at an angle of the wave generator (rad), from states at others; collective.

    fixed : body that stands still;  slip : turn (rad) of the other body in its pattern
    """
    teeth = [layout.mesh.n_sectors for layout in partition.layouts]
    pitch = 2.0 * np.pi / teeth[fixed]
    new = []
    for body, layout in enumerate(partition.layouts):
        own_slip = 0.0 if body == fixed else slip
        drift = 0.0 if body == fixed else 1.0 - teeth[fixed] / teeth[body]
        first, end = partition.owned_sectors(body)
        own = np.arange(first, end)
        coords = layout.mesh.coords
        moved = np.zeros((end - first, *coords.shape))
        # a state that turns by `shift` teeth hands the pattern of a tooth to the one so many teeth on
        shifts = [(angle - there) / pitch - own_slip * teeth[body] / (2.0 * np.pi) for there, _ in states]
        for k, tooth, weight in supports(shifts):
            there, state = states[k]
            turn = (angle - there) * drift + own_slip
            sectors = own + tooth
            local = rotated(
                read_field(partition, body, sectors, state), -layout.sector_angle(layout.first_tooth + sectors)[:, None]
            )
            moved += weight * (rotated(coords + local, np.full((len(own), 1), turn)) - coords)
        at = layout.sector_angle(layout.first_tooth + own)[:, None]
        new.append((body, own, rotated(coords + moved, at) - rotated(coords, at)))
    for body, own, values in new:
        write_field(partition, body, own, values, x)
