"""Coulomb friction between flanks: the history of the last converged state, at fixed points of the
material.

Segments are cut anew in every increment, so that their quadrature points are not the same material
points. The tangential traction therefore lives on a uniform grid of `SAMPLES` x `SAMPLES` points of
every slave face, between which it is interpolated. The foot point of that state is not stored: the
point is projected again at the converged displacement, exactly. Components are those of the
master's undeformed coordinates, arc length and z, with the current base vectors (see
kernel/friction.hpp).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from swgpar.contact.segments import Segments

SAMPLES = 8
"""Points per direction of a face on which the traction is stored, at the middles of equal cells."""

STIFFNESS = 1.0
"""Tangential stiffness over the normal penalty: a point that sticks has moved less than mu times
its penetration."""

PairKey = tuple[int, int, int]
"""Sector of the flexible spline, side of its tooth, number of the ring gear's tooth."""


@dataclass
class Friction:
    """Law and history at the quadrature points of the present segments; see
    `swgpar.kernel.contact_flanks`.

    coefficient : of friction;  stiffness : MPa / mm
    foot_point (n_face, n_q, 2) mm, gap (n_face, n_q) mm : of the last converged state, nan and inf
    without a foot traction (n_face, n_q, 2) MPa : of the last converged state
    current (n_face, n_q, 2) MPa : set by the kernel
    lagged (n_face, n_q) MPa : pressures that stand for the present ones in the law, or None
    """

    coefficient: float
    stiffness: float
    foot_point: np.ndarray
    gap: np.ndarray
    traction: np.ndarray
    current: np.ndarray
    lagged: np.ndarray | None = None

    def subset(self, rows: np.ndarray) -> Friction:
        """The same of some of the faces."""
        lagged = None if self.lagged is None else np.ascontiguousarray(self.lagged[rows])
        return replace(
            self,
            foot_point=np.ascontiguousarray(self.foot_point[rows]),
            gap=np.ascontiguousarray(self.gap[rows]),
            traction=np.ascontiguousarray(self.traction[rows]),
            current=np.ascontiguousarray(self.current[rows]),
            lagged=lagged,
        )


def begin(
    coefficient: float, foot_point: np.ndarray, gap: np.ndarray, traction: np.ndarray
) -> Friction:
    """Friction at points whose last converged state is given; see `Friction`."""
    return Friction(coefficient, 0.0, foot_point, gap, traction, np.zeros_like(traction))


def sampled(segments: Segments, values: np.ndarray, face: int) -> np.ndarray:
    """Values (n, n_q, k) at the points of segments of one face, taken to its samples (SAMPLES,
    SAMPLES, k).

    The points of a face form a grid: linear interpolation in both directions, constant beyond the
    outermost ones.
    """
    mine = segments.parent == face
    a, i = np.unique(segments.a[mine], return_inverse=True)
    b, j = np.unique(segments.b[mine], return_inverse=True)
    grid = np.zeros((len(a), len(b), values.shape[2]))
    grid[i.ravel(), j.ravel()] = values[mine].reshape(-1, values.shape[2])
    at = (np.arange(SAMPLES) + 0.5) / SAMPLES
    to_a, to_b = (
        np.stack([np.interp(at, x, unit) for unit in np.eye(len(x))], axis=1) for x in (a, b)
    )
    return np.einsum("ai,bj,ijk->abk", to_a, to_b, grid)


def interpolated(samples: np.ndarray, segments: Segments) -> np.ndarray:
    """Values (n, n_q, k) at the points of segments from samples (n_face, SAMPLES, SAMPLES, k) of
    all faces."""
    low, share = [], []
    for x in (segments.a, segments.b):
        position = np.clip(SAMPLES * x - 0.5, 0.0, SAMPLES - 1.0)
        low.append(np.minimum(position.astype(np.int64), SAMPLES - 2))
        share.append((position - low[-1])[..., None])
    (i, j), (s, t), face = low, share, segments.parent[:, None]
    return (1 - s) * ((1 - t) * samples[face, i, j] + t * samples[face, i, j + 1]) + s * (
        (1 - t) * samples[face, i + 1, j] + t * samples[face, i + 1, j + 1]
    )


NO_TOOTH = np.iinfo(np.int64).min
"""Stands in a file where a flank has no traction."""

ROWS = ("friction/tooth", "friction/traction")
"""Names of the rows in a file, by sector of the flexible spline."""


def to_rows(
    store: Mapping[PairKey, np.ndarray], first: int, end: int, n_face: int
) -> dict[str, np.ndarray]:
    """The tractions of the sectors first .. end - 1 as rows for a file.

    Returns teeth (end - first, 2) of the ring gear that the flanks of side +1 and -1 touch, and
    their tractions (end - first, 2, n_face, SAMPLES, SAMPLES, 2) MPa.
    """
    tooth = np.full((end - first, 2), NO_TOOTH)
    traction = np.zeros((end - first, 2, n_face, SAMPLES, SAMPLES, 2))
    for (sector, side, ring_tooth), values in store.items():
        if first <= sector < end:
            entry = sector - first, int(side < 0)
            tooth[entry], traction[entry] = ring_tooth, values
    return dict(zip(ROWS, (tooth, traction)))


def from_rows(rows: Mapping[str, np.ndarray]) -> dict[PairKey, np.ndarray]:
    """The tractions that `to_rows` made rows of, those of all sectors from 0 on."""
    tooth, traction = (rows[name] for name in ROWS)
    present = zip(*np.nonzero(tooth != NO_TOOTH))
    return {(int(k), (1, -1)[side], int(tooth[k, side])): traction[k, side] for k, side in present}
