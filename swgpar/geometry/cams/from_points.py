"""Cams through points, by a smoothing spline of the radius over the polar angle."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy

from swgpar.errors import InputError
from swgpar.geometry.arrays import Floats
from swgpar.geometry.cams.keys import CamPoints
from swgpar.geometry.cams.polar import PolarCam, mirrored_lobe

STEPS = 2048
"""Intervals of the curve in half a lobe."""

FEWEST, DEGREE = 8, 5
"""Points of a curve, at least; degree of the spline."""

WIDEST_GAP = np.radians(20.0)
"""Largest angle between neighbouring points."""

FARTHEST = 5.0
"""Largest distance of a point from the curve over the tolerance: what lies farther off is no
scatter."""

ROUNDS, CLOSER = 6, 0.25
"""Fits, each with this share of the mean square distance of the one before, until no point is
farther off: where the curvature jumps, the largest distance is far above the mean."""

MOST_KNOTS = 0.7
"""Knots of a smooth curve over its points, at most: with more it follows their scatter."""

SAME = 1e-9
"""Angles (rad) that count as the same."""

FARTHEST_OFF = 10.0
"""Largest angle (deg) of the major axis from +y; lobes whose sides differ need not be upright."""

ALONG = 0.9
"""Radius on +y, from the smallest one on, over the largest: the major axis lies there."""


@lru_cache(maxsize=16)
def points_cam(keys: CamPoints, name: str = "wave_generator") -> PolarCam:
    """Curve of the section [wave_generator].

    Raises InputError where the points give no curve around the axis, with the place.
    """
    key, lobe = f"{name}.points", 2.0 * np.pi / keys.lobes
    theta, radius, numbers = _polar(keys, key)
    covered = _covered(theta, numbers, key)
    whole, half = abs(covered - 2.0 * np.pi) < 1e-6, 0.5 * lobe
    if not whole and covered < (half if keys.symmetric else lobe) - 1e-6:
        raise InputError(
            f"{key} cover {np.degrees(covered):.4g} degrees: allowed are 360, or "
            f"{np.degrees(lobe):g} from one minor axis to the next"
            + (f", or {np.degrees(half):g} from the major axis to a minor one" * keys.symmetric)
        )
    if whole:
        ends = np.append(theta, theta[0] + 2.0 * np.pi), np.append(radius, radius[0])
        _require_upright(*ends, keys, name)
    elif covered >= lobe - 1e-6:
        _require_upright(theta, radius, keys, name)
    place = np.mod(theta + half, lobe) - half  # from the tip of the lobe
    if keys.symmetric:
        place = np.abs(place)
    cam, worst, scattered = _fitted(place, radius, keys)
    if scattered or cam.deviation > FARTHEST * keys.tolerance + 1e-9 * radius[worst]:
        alike = "equal lobes and sides" if keys.symmetric else "equal lobes"
        raise InputError(
            f"{key} scatter about a smooth curve with {alike}: {key}.{numbers[worst]}, "
            f"{np.degrees(theta[worst]):.4g} degrees from the major axis, lies {cam.deviation:.3g} "
            f"mm off one that is smooth to {name}.tolerance = {keys.tolerance:g} mm; allowed are "
            f"smoother points, a larger tolerance"
            + (f" and {name}.symmetric = false" * keys.symmetric)
        )
    values = cam.values[0]
    if values[0] - values.min() < ALONG * np.ptp(values):
        raise InputError(
            f"{key} have the radius {values[0]:.6g} mm on +y and {values.max():.6g} mm elsewhere: "
            f"allowed is the major axis on +y, by {name}.rotation"
        )
    return cam


def _require_upright(theta: Floats, radius: Floats, keys: CamPoints, name: str) -> None:
    """Refuse a major axis that is not near +y: it lies where the first harmonic of the lobes has
    its maximum."""
    away = radius - radius.mean()
    wave = scipy.integrate.trapezoid(away * np.exp(1j * keys.lobes * theta), theta)
    off = float(np.degrees(np.angle(wave)) / keys.lobes)
    if abs(off) > FARTHEST_OFF:
        fitting = round(keys.rotation - off, 3)
        raise InputError(
            f"{name}.rotation = {keys.rotation:g} leaves the major axis {off:.4g} degrees away "
            f"from +y: allowed within {FARTHEST_OFF:g}, for example {fitting:g}"
        )


def _polar(keys: CamPoints, key: str) -> tuple[Floats, Floats, np.ndarray]:
    """Angles (n,) rad from +y, counter-clockwise and growing by less than half a turn from point
    to point, radii (n,) mm, and the numbers (n,) of the points, from 1."""
    if len(keys.points) < FEWEST:
        raise InputError(f"{key} has {len(keys.points)} points: allowed {FEWEST} and more")
    for number, point in enumerate(keys.points, 1):
        if len(point) != 2:
            raise InputError(f"{key}.{number} has {len(point)} numbers: allowed two")
    first, second = np.array(keys.points).T
    turn = np.radians(keys.rotation)
    if keys.coordinates == "polar":
        theta, radius = np.radians(first), second
    else:
        theta, radius = np.arctan2(-first, second), np.hypot(first, second)
    theta, numbers = np.unwrap(theta) + turn, np.arange(1, len(theta) + 1)
    if not (radius > 0.0).all():
        at = int(np.argmin(radius > 0.0))
        raise InputError(f"{key}.{at + 1} has the radius {radius[at]:g} mm: allowed above 0")
    if theta[-1] < theta[0]:
        theta, radius, numbers = theta[::-1], radius[::-1], numbers[::-1]
    return theta, radius, numbers


def _covered(theta: Floats, numbers: np.ndarray, key: str) -> float:
    """Angle that the points cover, rad; two pi for a closed curve.

    Refuses angles that do not grow from point to point: the radius is then no function of the
    angle, or the points are not in their order.
    """
    step = np.diff(theta)
    if step.min() <= 0.0:
        at = int(step.argmin())
        raise InputError(
            f"{key}.{numbers[at]} and its neighbour, {np.degrees(theta[at]):.4g} degrees from the "
            "major axis, go back around the axis: allowed are points in their order around it, "
            "each at another angle"
        )
    covered = float(theta[-1] - theta[0])
    if covered > 2.0 * np.pi + 1e-6:
        raise InputError(
            f"{key} go around the axis {covered / (2.0 * np.pi):.3g} times: allowed once"
        )
    if covered > 2.0 * np.pi - WIDEST_GAP:  # closed, with or without its first point again
        step, covered = np.append(step, 2.0 * np.pi - covered), 2.0 * np.pi
    if step.max() > WIDEST_GAP:
        at = int(step.argmax())
        raise InputError(
            f"{key}.{numbers[at]} and its neighbour are {np.degrees(step.max()):.3g} degrees "
            f"apart: allowed up to {np.degrees(WIDEST_GAP):.3g}"
        )
    return covered


def _fitted(place: Floats, radius: Floats, keys: CamPoints) -> tuple[PolarCam, int, bool]:
    """Curve through points at the angles `place` (n,) rad from the tip of a lobe, the point that
    is farthest from it, and whether the points scatter by more than the tolerance."""
    samples = _samples(place, radius, keys)
    count = len(samples[0]) - 1
    scatter = keys.tolerance**2 * count
    for _ in range(ROUNDS):
        spline, *_ = scipy.interpolate.splrep(
            *samples, k=DEGREE, s=scatter, per=1, full_output=1, quiet=1
        )
        values = _values(spline, float(samples[0][0]), keys)
        away = np.abs(PolarCam(values, keys.lobes, 0.0).radius(place)[0] - radius)
        worst = int(away.argmax())
        scatter *= CLOSER
        inner = len(spline[0]) - 2 * (DEGREE + 1)  # a periodic spline repeats knots at its ends
        scattered = keys.tolerance > 0.0 and inner > MOST_KNOTS * count
        if scattered or away[worst] <= FARTHEST * keys.tolerance:
            break
    return PolarCam(values, keys.lobes, float(away[worst])), worst, scattered


def _samples(place: Floats, radius: Floats, keys: CamPoints) -> tuple[Floats, Floats]:
    """Angles (n + 1,) rad of the points of a lobe in order, and mean radii (n + 1,) mm; the first
    one comes again at the end."""
    lobe = 2.0 * np.pi / keys.lobes
    if keys.symmetric:
        place, radius = np.append(place, -place), np.append(radius, radius)
    place = np.mod(place, lobe)
    place[place > lobe - SAME] = 0.0
    order = np.argsort(place)
    place, radius = place[order], radius[order]
    group = np.cumsum(np.diff(place, prepend=place[0]) > SAME)
    count = np.bincount(group)
    place, radius = (np.bincount(group, values) / count for values in (place, radius))
    return np.append(place, place[0] + lobe), np.append(radius, radius[0])


def _values(spline: tuple[Floats, Floats, int], first: float, keys: CamPoints) -> Floats:
    """Radius and its derivatives (3, n) by a spline around a lobe whose first point is at `first`
    rad."""
    lobe = 2.0 * np.pi / keys.lobes
    theta = np.linspace(0.0, lobe, 2 * STEPS + 1)
    at = first + np.mod(theta - first, lobe)
    values = np.stack([scipy.interpolate.splev(at, spline, der=k) for k in range(3)])
    values[:, -1] = values[:, 0]
    if keys.symmetric:
        half, other = values[:, : STEPS + 1], values[:, STEPS:][:, ::-1]
        half = 0.5 * (half + other * [[1.0], [-1.0], [1.0]])
        half[1, [0, -1]] = 0.0
        values = mirrored_lobe(half)
    return values
