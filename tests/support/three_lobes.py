"""The small drive with three lobes."""

from __future__ import annotations

from support.small_drive import PLANE

THREE_LOBES = (
    "drive.teeth_fs=60",
    "drive.teeth_rg=63",
    "drive.pressure_angle=12.0",
    "drive.addendum_coef=0.8",
    "drive.dedendum_coef=1.0",
    "flexible_spline.rim=0.4",
    "wave_generator.type=harmonic",
    "wave_generator.lobes=3",
    "wave_generator.C=0.986",
    "cup.length=24.0",
)
"""Overrides of the small drive: 60 and 63 teeth."""

MODELS = {"cup": THREE_LOBES, "plane": (*PLANE, *THREE_LOBES)}
