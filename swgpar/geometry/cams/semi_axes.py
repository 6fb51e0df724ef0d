"""Deflection and semi-axes of a cam, from its keys and the bore of the flexible spline."""

from __future__ import annotations

from swgpar.geometry.cams.from_points import points_cam
from swgpar.geometry.cams.keys import CamPoints, FourRoller, Reduced, TwoRoller, WaveGenerator


def roller_radius(keys: FourRoller | TwoRoller) -> float:
    """Radius of the rollers, mm."""
    return keys.r_4 if isinstance(keys, FourRoller) else keys.r_2


def radial_deflection(keys: WaveGenerator, inner_radius: float, standard: float) -> float:
    """Radial deflection w0, mm: how far the tip of a lobe, or of a roller, lies outside of the
    bore.

    inner_radius : mm, of the undeformed flexible spline
    standard : mm, deflection of a cam without a key for it
    """
    if isinstance(keys, CamPoints):
        return float(points_cam(keys).values[0, 0]) + keys.offset - inner_radius
    if keys.deflection is not None:
        return keys.deflection
    if isinstance(keys, Reduced) and keys.major_axis is not None:
        return 0.5 * keys.major_axis + keys.offset - inner_radius
    if isinstance(keys, FourRoller | TwoRoller) and keys.centre_radius is not None:
        return keys.centre_radius + roller_radius(keys) - inner_radius
    return standard


def minor_semi_axis(keys: WaveGenerator, inner_radius: float, deflection: float) -> float | None:
    """Minor semi-axis b, mm (eqs 3.2, 3.4), of the surface on the spline; rollers have none.

    inner_radius : mm, of the undeformed flexible spline;  deflection : mm, w0
    """
    if not isinstance(keys, Reduced):
        return None
    if keys.minor_axis is not None:
        return 0.5 * keys.minor_axis + keys.offset
    return keys.C * (inner_radius - deflection)
