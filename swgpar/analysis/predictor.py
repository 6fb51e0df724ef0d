"""Prediction of the state at the next angle of the wave generator from the states of the period
that are known.

After one pitch of the fixed gear the drive repeats with its teeth renamed by one. Every known state
is therefore known at all angles that differ from its own by whole pitches. States between them are
interpolated over teeth and angles.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from swgpar.fem.partition import Partition
from swgpar.fem.vectors import read_field, write_field
from swgpar.geometry.rotation import rotated
from swgpar.petsc import PETSc

MIN_SPACING = 1.5
"""Smallest distance of the second state on one side over that of the first: of states close
together the difference says nothing about the state ahead."""

SAME_POSITION = 1e-6
"""Distance in pitches below which two states are at the same position of the period; the later one
counts."""


SAME_ANGLE = 1e-9
"""Difference (rad) of two angles that are the same."""


@dataclass(frozen=True)
class KnownState:
    """A state: angle of the wave generator (rad) and its vector x."""

    angle: float
    x: PETSc.Vec


@dataclass(frozen=True)
class InterpolationPoint:
    """A state that is interpolated: its index, the teeth by which it is renamed, its weight."""

    index: int
    teeth: int
    weight: float


def interpolation_points(shifts: list[float]) -> list[InterpolationPoint]:
    """The two nearest states on either side of shift 0, with the weights of a cubic polynomial.

    shifts : of the states, in teeth, the latest last
    """
    known: list[tuple[float, int, int]] = []
    for k in reversed(range(len(shifts))):
        whole = int(np.floor(-shifts[k]))
        for tooth in range(whole - 2, whole + 4):
            position = tooth + shifts[k]
            if all(abs(position - other) > SAME_POSITION for other, *_ in known):
                known.append((position, k, tooth))
    known.sort(key=lambda one: abs(one[0]))
    chosen = []
    for side in (-1.0, 1.0):
        ahead = [one for one in known if (one[0] > 0.0) == (side > 0.0)]
        second = next(one for one in ahead[1:] if abs(one[0]) >= MIN_SPACING * abs(ahead[0][0]))
        chosen += [ahead[0], second]
    positions = [position for position, *_ in chosen]
    weights = [float(np.prod([b / (b - a) for b in positions if b != a])) for a in positions]
    points = [
        InterpolationPoint(k, tooth, weight) for weight, (_, k, tooth) in zip(weights, chosen)
    ]
    return [point for point in points if point.weight != 0.0]


def predict(
    partition: Partition,
    fixed_body: str,
    known: list[KnownState],
    x: PETSc.Vec,
    angle: float,
    output_rotation: float = 0.0,
    resting: Collection[str] = (),
) -> None:
    """Set x to the state at an angle of the wave generator (rad), from others; collective.

    fixed_body : name of the gear that does not rotate
    output_rotation : rad, further rotation in its deformed pattern of what is not `resting`
    resting : names of bodies
    """
    new = []
    for body, layout in partition.layouts.items():
        own = partition.owned_indices(body)
        rotation, coords = 0.0 if body in resting else output_rotation, layout.mesh.coords
        moved = _pattern(partition, fixed_body, body, known, angle, rotation)
        at = layout.chain_angle(own)[:, None]
        new.append((body, rotated(coords + moved, at) - rotated(coords, at)))
    for body, values in new:
        write_field(partition, body, values, x)


def predict_guided(
    partition: Partition,
    fixed_body: str,
    known: list[KnownState],
    guides: list[KnownState],
    x: PETSc.Vec,
    angle: float,
) -> None:
    """Set x as `predict`, and add what the prediction from the guides misses at that angle;
    collective.

    guides : states on another mesh, interpolated to this one. Without those at the angle and at
    all angles of the known states nothing is added
    """

    def at(place: float) -> KnownState | None:
        return next((one for one in guides if abs(one.angle - place) < SAME_ANGLE), None)

    predict(partition, fixed_body, known, x, angle)
    there, before = at(angle), [one for state in known if (one := at(state.angle)) is not None]
    if there is None or len(before) < len(known):
        return
    predicted = before[-1].x.copy()
    predict(partition, fixed_body, before, predicted, angle)
    x.axpy(1.0, there.x)
    x.axpy(-1.0, predicted)
    predicted.destroy()


def add_change(
    partition: Partition,
    fixed_body: str,
    before: list[KnownState],
    after: list[KnownState],
    x: PETSc.Vec,
    angle: float,
) -> None:
    """Add to x by what a step has changed it at other angles of the wave generator, moved to this
    one (rad); collective.

    before, after : states at both ends of the step, at the same angles
    """
    start, end = x.copy(), x.copy()  # what is no displacement stays
    predict(partition, fixed_body, before, start, angle)
    predict(partition, fixed_body, after, end, angle)
    x.axpy(1.0, end)
    x.axpy(-1.0, start)
    start.destroy()
    end.destroy()


def _pattern(
    partition: Partition,
    fixed_body: str,
    body: str,
    known: list[KnownState],
    angle: float,
    rotation: float,
) -> np.ndarray:
    """Displacements (n_sectors, n_nodes, 3) mm of owned sectors, in the frames of their teeth."""
    layout = partition.layouts[body]
    teeth, fixed_teeth = layout.mesh.n_sectors, partition.layouts[fixed_body].mesh.n_sectors
    pitch = 2.0 * np.pi / fixed_teeth
    drift = 0.0 if body == fixed_body else 1.0 - fixed_teeth / teeth
    own, coords = partition.owned_indices(body), layout.mesh.coords
    moved = np.zeros((len(own), *coords.shape))
    # when the pattern rotates by `shift` teeth, a tooth takes over the displacements of the one so
    # many teeth before
    shifts = [(angle - state.angle) / pitch - rotation * teeth / (2.0 * np.pi) for state in known]
    for point in interpolation_points(shifts):
        state = known[point.index]
        turned = (angle - state.angle) * drift + rotation
        sectors = own + point.teeth
        field = read_field(partition, body, sectors, state.x)
        local = rotated(field, -layout.chain_angle(sectors)[:, None])
        moved += point.weight * (rotated(coords + local, np.full((len(own), 1), turned)) - coords)
    return moved
