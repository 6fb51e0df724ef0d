"""The section [deviations]: how real gears deviate from the ideal ones, and over how many turns
that is followed."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import model_validator

from swgpar.errors import InputError
from swgpar.geometry.pitch_deviations import pitch_tolerances, random_pitch_errors
from swgpar.input.quantities import Section, not_negative, quantity, show
from swgpar.input.regular_file import read_regular
from swgpar.profiles import Teeth
from swgpar.profiles.flank_deviations import GearDeviations, direction

MICRO = 1e-3
"""mm in a micrometre."""


class Offset(Section):
    """Eccentricity of an axis."""

    eccentricity: float = not_negative("distance of the axis from that of the drive", "mm", 0.0)
    direction: float = quantity(
        0.0, unit="deg", text="of the eccentricity, counter-clockwise from +y"
    )

    @property
    def shift(self) -> np.ndarray:
        """Eccentricity as a vector (2,) mm."""
        return self.eccentricity * direction(float(np.radians(self.direction)))


class TiltedOffset(Offset):
    """Eccentricity and tilt of an axis."""

    tilt: float = not_negative(
        "of the axis, about the middle of the face width", "deg", 0.0, le=1.0
    )
    tilt_direction: float = quantity(
        0.0, unit="deg", text="to which the axis leans at positive z, counter-clockwise from +y"
    )

    @property
    def lean(self) -> np.ndarray:
        """Displacement (2,) of the axis per mm along z."""
        return float(np.tan(np.radians(self.tilt))) * direction(
            float(np.radians(self.tilt_direction))
        )


class ToothDeviations(Section):
    """Deviations of the teeth of a gear."""

    pitch_errors: list[float] = quantity(
        [],
        unit="µm",
        text="position of each tooth on the pitch circle less the theoretical one, "
        "counter-clockwise",
    )
    pitch_file: str = quantity("", text="CSV file with the pitch errors, instead of the list")
    pitch_column: str = quantity("", text="its column, in micrometres; without one the only column")
    pitch_grade: int = quantity(
        0,
        text="ISO 1328-1 tolerance class of random pitch errors, instead of the list; 0: none",
        ge=0,
        le=11,
    )
    profile_slope: float = quantity(
        0.0, unit="µm", text="slope deviation of the profile; above 0: full at the tip"
    )
    profile_form: float = not_negative("form deviation of the profile: height of a wave", "µm", 0.0)

    @model_validator(mode="before")
    @classmethod
    def _read_file(cls, values: Any) -> Any:
        """Replace the file by its values: the design is then complete without it."""
        if (
            not isinstance(values, dict)
            or not isinstance(values.get("pitch_file"), str)
            or not values["pitch_file"]
        ):
            return values
        if values.get("pitch_errors") or values.get("pitch_grade"):
            raise InputError(
                f"pitch_file = {show(values['pitch_file'])} stands beside pitch_errors or "
                "pitch_grade: allowed is one of the three"
            )
        others = {k: v for k, v in values.items() if k not in ("pitch_file", "pitch_column")}
        return {
            **others,
            "pitch_errors": read_column(values["pitch_file"], values.get("pitch_column", "")),
        }


class SplineDeviations(ToothDeviations, Offset):
    """Deviations of the flexible spline's teeth; the eccentricity is that of its toothing in its
    inner surface."""


class RingDeviations(ToothDeviations, TiltedOffset):
    """Deviations of the ring gear."""

    ovality: float = not_negative("of its bore: largest less smallest diameter", "mm", 0.0)
    ovality_direction: float = quantity(
        0.0, unit="deg", text="of the largest diameter, counter-clockwise from +y"
    )


class Deviations(Section):
    """Section [deviations]: the transmission error is followed over whole turns with these
    deviations."""

    turns: int = quantity(1, text="turns of the wave generator", ge=1, le=1000)
    angles_per_pitch: int = quantity(
        1, text="angles per pitch of the fixed gear; orders of the mesh need 3 or more", ge=1, le=64
    )
    mesh: Literal["coarse", "same"] = quantity(
        "coarse",
        text="the coarsest mesh that finds the contacts, with fewer points on the cam, or that of "
        "the run",
    )
    linear_model: bool = quantity(
        False,
        text="most angles of a plane drive by a linear model, where it pays. Newton's iteration "
        "checks it at others; by default without --plain only",
    )
    seed: int = quantity(
        1, text="of random pitch errors; another one is another drive of the same grade", ge=0
    )
    flexible_spline: SplineDeviations = SplineDeviations()
    ring_gear: RingDeviations = RingDeviations()
    wave_generator: TiltedOffset = TiltedOffset()
    cup: TiltedOffset = TiltedOffset()


def read_column(path: str, column: str) -> list[float]:
    """Numbers of a column of a CSV file with a header; raises InputError of one sentence."""
    try:
        text = read_regular(Path(path)).decode("utf-8-sig")
        header, *rows = [row for row in csv.reader(text.splitlines()) if row]
    except (OSError, ValueError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or "it is no CSV file with a header"
        raise InputError(f"pitch_file = {show(path)} cannot be read: {reason}") from None
    names = [name.strip() for name in header]
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                f"pitch_file = {show(path)} has two columns {show(name)}: allowed is one of a name"
            )
    for number, row in enumerate(rows, start=2):
        if len(row) > len(names):
            raise InputError(
                f"pitch_file = {show(path)}: row {number} has {len(row)} values and the header has "
                f"{len(names)}: allowed is one for each column, with a point as decimal sign"
            )
    if not column and len(names) == 1:
        column = names[0]
    if column not in names:
        raise InputError(
            f"pitch_column = {show(column)} is not a column of {path}: allowed {', '.join(names)}"
        )
    if not rows:
        raise InputError(
            f"pitch_column = {show(column)} of {path} has no values: allowed is one for each tooth"
        )
    values = [row[names.index(column)] if names.index(column) < len(row) else "" for row in rows]
    try:
        return [float(value) for value in values]
    except ValueError as error:
        raise InputError(
            f"pitch_column = {show(column)} of {path} has a value that is no number: {error}"
        ) from None


def gear_deviations(deviations: Deviations, gear: str, teeth: Teeth) -> GearDeviations:
    """Deviations of "flexible_spline" or "ring_gear" in mm and rad."""
    section: SplineDeviations | RingDeviations = getattr(deviations, gear)
    micrometres = np.array(section.pitch_errors)
    if section.pitch_grade:
        tolerances = pitch_tolerances(2.0 * teeth.r_pitch, teeth.module, section.pitch_grade)
        micrometres = random_pitch_errors(
            teeth.n_teeth, tolerances, (deviations.seed, int(teeth.external))
        )
    elif not len(micrometres):
        micrometres = np.zeros(teeth.n_teeth)
    deviating = GearDeviations(
        r_pitch=teeth.r_pitch,
        pitch=MICRO * micrometres,
        shift=section.shift,
        profile_slope=MICRO * section.profile_slope,
        profile_form=MICRO * section.profile_form,
    )
    if not isinstance(section, RingDeviations):
        return deviating
    angle = float(np.radians(section.ovality_direction))
    return replace(deviating, tilt=section.lean, ovality=section.ovality, oval_angle=angle)
