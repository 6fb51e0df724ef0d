"""Fatigue criteria of stress histories: Goodman's line on the critical plane, Crossland's
criterion, Basquin's life."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.design.sections import Fatigue
from swgpar.fem.stress import principal

IN_PLANE = 36
"""Directions of the normal of a plane, evenly over half a turn in the plane model."""

IN_SPACE = 150
"""Directions on half a sphere. Principal directions of each point are tried as well."""

BALL_TOLERANCE, BALL_ITERATIONS = 1e-4, 2000
"""Relative tolerance of the radius of the smallest ball around a history, and iterations at
most."""


@dataclass(frozen=True)
class CriticalPlane:
    """Normal stress on the plane with the least safety by Goodman's line, of n points.

    utilisation : (n,) its inverse;  amplitude, mean : (n,) MPa;  normal : (n, 3)
    """

    utilisation: np.ndarray
    amplitude: np.ndarray
    mean: np.ndarray
    normal: np.ndarray


def fatigue_limits(fatigue: Fatigue) -> tuple[float, float]:
    """Fatigue limits (MPa) of the part under alternating tension and torsion."""
    factor = fatigue.surface_factor * fatigue.size_factor
    return factor * fatigue.fatigue_limit, factor * fatigue.shear_fatigue_limit


def goodman(amplitude: np.ndarray, mean: np.ndarray, fatigue: Fatigue) -> np.ndarray:
    """Utilisation by Goodman's line: amplitude over the fatigue limit, and tensile mean over the
    tensile strength.

    A compressive mean has no effect. The safety factor, its inverse, holds for amplitude and mean
    that grow together.
    """
    return (
        amplitude / fatigue_limits(fatigue)[0] + np.clip(mean, 0.0, None) / fatigue.tensile_strength
    )


def critical_plane(stress: np.ndarray, fatigue: Fatigue, plane: bool) -> CriticalPlane:
    """Plane with the largest utilisation by `goodman` of its normal stress.

    stress : (n_phases, n, 6) MPa, xx yy zz xy yz zx;  plane : plane stress, with normals in the
    plane only
    """
    n = stress.shape[1]
    found = CriticalPlane(np.full(n, -1.0), np.zeros(n), np.zeros(n), np.zeros((n, 3)))
    for normal in _directions(plane):
        found = _worse(found, stress, np.broadcast_to(normal, (n, 3)), fatigue)
    for normal in _principal_directions(stress):
        found = _worse(found, stress, normal, fatigue)
    return found


def normal_stress(stress: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Normal stress (n_phases, n) MPa of tensors (n_phases, n, 6) on planes with normals (n, 3)."""
    x, y, z = normal.T
    weight = np.stack([x * x, y * y, z * z, 2.0 * x * y, 2.0 * y * z, 2.0 * z * x], axis=-1)
    return np.einsum("tnc,nc->tn", stress, weight)


def _worse(
    found: CriticalPlane, stress: np.ndarray, normal: np.ndarray, fatigue: Fatigue
) -> CriticalPlane:
    """`found`, with another normal (n, 3) where that has the larger utilisation."""
    values = normal_stress(stress, normal)
    high, low = values.max(axis=0), values.min(axis=0)
    amplitude, mean = 0.5 * (high - low), 0.5 * (high + low)
    utilisation = goodman(amplitude, mean, fatigue)
    more = utilisation > found.utilisation
    return CriticalPlane(
        np.where(more, utilisation, found.utilisation),
        np.where(more, amplitude, found.amplitude),
        np.where(more, mean, found.mean),
        np.where(more[:, None], normal, found.normal),
    )


def _directions(plane: bool) -> np.ndarray:
    """Unit vectors (m, 3): over half a turn in the plane, or over half a sphere along Fibonacci's
    spiral."""
    if plane:
        angle = np.pi * np.arange(IN_PLANE) / IN_PLANE
        return np.column_stack([np.cos(angle), np.sin(angle), np.zeros(IN_PLANE)])
    k = np.arange(IN_SPACE)
    z, angle = (k + 0.5) / IN_SPACE, np.pi * (1.0 + np.sqrt(5.0)) * k
    radius = np.sqrt(1.0 - z**2)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])


def _principal_directions(stress: np.ndarray) -> list[np.ndarray]:
    """Principal directions, each (n, 3), of points at their largest tension, and of the largest
    change from there."""
    at = np.arange(stress.shape[1])
    top = stress[principal(stress)[0].argmax(axis=0), at]
    change = stress - top
    far = change[
        np.einsum("tnc,tnc,c->tn", change, change, np.array([1, 1, 1, 2, 2, 2])).argmax(axis=0), at
    ]
    found = []
    for tensor in (top, far):
        xx, yy, zz, xy, yz, zx = tensor.T
        matrix = np.stack(
            [np.stack([xx, xy, zx], -1), np.stack([xy, yy, yz], -1), np.stack([zx, yz, zz], -1)], -2
        )
        found += list(np.moveaxis(np.linalg.eigh(matrix)[1], -1, 0))
    return found


def crossland(stress: np.ndarray, fatigue: Fatigue) -> np.ndarray:
    """Utilisation (n,) by the criterion of Crossland (1956) of histories (n_phases, n, 6) MPa.

    It is (a + alpha p) / t with the amplitude a of the root of the second invariant of the stress
    deviator, that is the radius of the smallest ball around its path, the largest hydrostatic
    stress p, and alpha = 3 t / f - sqrt(3), where t and f are the fatigue limits under torsion and
    tension.
    """
    tension, shear = fatigue_limits(fatigue)
    xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
    pressure = (xx + yy + zz) / 3.0
    # coordinates whose scalar product is half of that of the deviators
    path = np.stack(
        [0.5 * np.sqrt(3.0) * (xx - pressure), 0.5 * (yy - zz), xy, yz, zx],
        axis=-1,
    )
    radius = smallest_ball(path)
    alpha = 3.0 * shear / tension - np.sqrt(3.0)
    return np.clip(radius + alpha * pressure.max(axis=0), 0.0, None) / shear


def smallest_ball(points: np.ndarray) -> np.ndarray:
    """Radius (n,) of the smallest balls around points (m, n, d), from above within
    `BALL_TOLERANCE`.

    Frank and Wolfe's method with away steps: E. A. Yildirim, SIAM Journal on Optimization 19
    (2008), 1368-1391, algorithm 4.1.
    """
    m, n, d = points.shape
    out, active, at = np.zeros(n), np.arange(n), np.arange(n)
    shift = points.mean(axis=0)
    p = points - shift
    size = (p**2).sum(axis=2)
    first = size.argmax(axis=0)
    second = ((p - p[first, at]) ** 2).sum(axis=2).argmax(axis=0)
    weight = np.zeros((m, n))
    np.add.at(weight, (first, at), 0.5)
    np.add.at(weight, (second, at), 0.5)
    for _ in range(BALL_ITERATIONS):
        at = np.arange(len(active))
        center = np.einsum("mn,mnd->nd", weight, p)
        distance = ((p - center) ** 2).sum(axis=2)
        squared = np.einsum("mn,mn->n", weight, size) - (center**2).sum(axis=1)
        far, near = distance.argmax(axis=0), np.where(weight > 0.0, distance, np.inf).argmin(axis=0)
        largest, smallest = distance[far, at], distance[near, at]
        out[active] = np.sqrt(largest)
        scale = np.where(squared > 0.0, squared, 1.0)
        gain, loss = largest / scale - 1.0, 1.0 - smallest / scale
        going = (gain > (1.0 + BALL_TOLERANCE) ** 2 - 1.0) & (squared > 0.0)
        if not going.any():
            break
        towards = gain >= loss
        own = weight[near, at]
        back = np.minimum(
            loss / np.clip(2.0 * (1.0 - loss), 1e-300, None), own / np.clip(1.0 - own, 1e-300, None)
        )
        step = np.where(towards, gain / np.clip(2.0 * (1.0 + gain), 1e-300, None), -back)
        weight *= 1.0 - step
        chosen = np.where(towards, far, near)
        weight[chosen, at] = np.clip(weight[chosen, at] + step, 0.0, None)
        if not going.all():
            active = active[going]
            weight = weight[:, going]
            p = p[:, going]
            size = size[:, going]
    return out


def damage(history: np.ndarray, fatigue: Fatigue) -> float:
    """Damage by one passage of a closed history (n,) MPa of a normal stress; Miner's sum over the
    cycles by rainflow.

    Amplitudes are taken to zero mean by Goodman's line. A cycle below the fatigue limit does no
    damage. The others have Basquin's life of ``0.5 (amplitude / coefficient)^(1 / exponent)``
    cycles.
    """
    import rainflow  # runs without fatigue need it not

    start = int(np.argmax(history))
    closed = np.append(np.roll(history, -start), history[start])
    limit, _ = fatigue_limits(fatigue)
    coefficient = fatigue.surface_factor * fatigue.size_factor * fatigue.basquin_coefficient
    total = 0.0
    for extent, mean, count, _, _ in rainflow.extract_cycles(closed):
        reserve = 1.0 - max(mean, 0.0) / fatigue.tensile_strength
        if reserve <= 0.0:
            return float("inf")
        amplitude = 0.5 * extent / reserve
        if amplitude > limit:
            total += 2.0 * count * (amplitude / coefficient) ** (-1.0 / fatigue.basquin_exponent)
    return total
