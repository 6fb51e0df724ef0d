"""A flexible bearing for the small plane drive."""

from __future__ import annotations

BEARING = (
    "wave_generator.bearing.balls=20",
    "wave_generator.bearing.ball_diameter=2.0",
    "wave_generator.bearing.race_thickness=0.5",
)
"""Overrides that put a bearing between cam and flexible spline of the small drive."""
