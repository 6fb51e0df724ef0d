"""Transmission error and ripple of the input torque: curves, spectra by orders of the input's turn,
causes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from swgpar.answers.answer import AnswerGroup, AnswerKind, answer, evaluation, part_answers
from swgpar.design.deviations import Deviations, TiltedOffset
from swgpar.design.kinematics import Kinematics
from swgpar.design.sections import GearName
from swgpar.evaluation.period import of_period
from swgpar.evaluation.period_ranges import PeriodRanges
from swgpar.evaluation.result_frame import shown_output
from swgpar.load.load_sequence import LoadSequence
from swgpar.results.history import Row, column, transmission_error

COLUMNS = (
    "wg_angle_deg",
    "output_angle_deg",
    "transmission_error_arcsec",
    "wg_torque_Nmm",
    "newton_iterations",
    "by_linear_model",
    "linear_model_arcsec",
    "linear_model_Nmm",
)
"""Columns of transmission_error.csv. The last two: what a linear model differs by where Newton's
iteration has checked it, else no number."""

MODELLED = (
    ("transmission_error_arcsec", "linear_model_arcsec"),
    ("wg_torque_Nmm", "linear_model_Nmm"),
)
"""Columns of what a linear model gives, and of what it differs by."""

LARGEST = 12
"""Orders of a spectrum that are named."""

SHOWN = 5
"""Orders that the remarks name."""

NEGLIGIBLE = 1e-9
"""Amplitudes below this share of the largest one are round-off."""


@dataclass(frozen=True)
class TurnPoint:
    """State at an angle of the wave generator.

    index : of the angle;  wg_angle, output_angle : rad;  wg_torque : N mm
    iterations : of Newton, 0 where a state that is known repeats, and with a linear model
    by_linear_model : whether the state is that of the linear model
    difference : rad and N mm, by which the linear model differs from it, None where it is not known
    """

    index: int
    wg_angle: float
    output_angle: float
    wg_torque: float
    iterations: int
    by_linear_model: bool = False
    difference: tuple[float, float] | None = None


@dataclass(frozen=True)
class SpectrumLine:
    """An order of the input's turn, its amplitude and its cause."""

    order: float
    amplitude: float
    cause: str


@evaluation
class TorqueOverTurns:
    """Torque of the wave generator over the same angles.

    spectrum : its largest orders, N mm;  error_Nmm : of peak to peak, None where it is not known
    linear_model_Nmm : as `TransmissionError.linear_model_arcsec`
    """

    mean: float = answer(
        "transmission_error.torque_mean",
        "torque of the wave generator over the same angles, mean",
        "N·mm",
    )
    peak_to_peak: float = answer(
        "transmission_error.torque_peak_to_peak",
        "torque of the wave generator over the same angles, peak to peak",
        "N·mm",
        error="torque.error_Nmm",
    )
    spectrum: tuple[SpectrumLine, ...]
    error_Nmm: float | None = None
    linear_model_Nmm: float | None = None


PEAK_TO_PEAK = AnswerKind(
    "transmission_error.peak_to_peak",
    "transmission error, peak to peak",
    "arcsec",
    error="error_arcsec",
)


@evaluation
class TransmissionError(AnswerGroup):
    """Transmission error over whole turns with deviations, or over the sampled period of the ideal
    drive.

    turns, angles : turns of the wave generator, and angles that stand for them
    spectrum : its largest orders, arc seconds
    error_arcsec : of peak to peak, None where it is not known
    without_friction : whether friction that the run has is left out
    by_linear_model : angles by a linear model instead of Newton's iteration
    linear_model_arcsec : its largest difference where it was compared; None without one
    """

    turns: float
    angles: int
    peak_to_peak: float = part_answers(PEAK_TO_PEAK)
    amplitude: float = answer(
        "transmission_error.amplitude",
        "transmission error, half of peak to peak",
        "arcsec",
        detail=True,
    )
    mean: float = answer(
        "transmission_error.mean", "transmission error, mean", "arcsec", detail=True
    )
    spectrum: tuple[SpectrumLine, ...]
    torque: TorqueOverTurns
    error_arcsec: float | None = None
    without_friction: bool = False
    by_linear_model: int = 0
    linear_model_arcsec: float | None = None

    TITLE = "transmission error over a period, or with deviations over whole turns"
    ASKED_BY = "steps.samples or [deviations]"
    IN_PROGRAMS = False

    @property
    def covered(self) -> str:
        """What the error is of, in words."""
        if self.turns >= 1.0:
            return f"{self.turns:.0f} turns with deviations"
        return "one period of the ideal drive"

    def remarks(self) -> Iterator[str]:
        yield self.covered
        if self.without_friction:
            yield "without contact.friction: over whole turns flanks have none"
        if self.by_linear_model:
            yield (
                f"{self.by_linear_model} of {self.angles} angles by a linear model. At others it "
                f"differs by up to {self.linear_model_arcsec or 0.0:.2g} arc seconds and "
                f"{self.torque.linear_model_Nmm or 0.0:.2g} N·mm from Newton's iteration, which "
                "gives all that may be the largest and the smallest"
            )
        for line in self.spectrum[:SHOWN]:
            yield f"order {line.order:.3f}: {line.amplitude:.3g} arc seconds, {line.cause}"


def turn_row(point: TurnPoint, kinematics: Kinematics) -> Row:
    """Row of transmission_error.csv; the output's angle lies between -180 and 180 degrees."""
    angles = float(np.degrees(point.wg_angle)), float(np.degrees(point.output_angle))
    row = _row(kinematics, *angles, point.wg_torque, point.iterations)
    if point.difference is not None:
        by = float(np.degrees(point.difference[0])) * 3600.0, point.difference[1]
        row.update(zip((name for _, name in MODELLED), by))
    return {**row, "by_linear_model": int(point.by_linear_model)}


def doubtful_extremes(rows: Sequence[Row]) -> list[int]:
    """Numbers of the rows by a linear model that may be the largest or the smallest of all, by how
    much the model differs from Newton's iteration elsewhere."""
    modelled = column(rows, "by_linear_model") > 0.0
    doubtful = np.zeros(len(rows), dtype=bool)
    for name, by in MODELLED:
        values, difference = column(rows, name), column(rows, by)
        known = difference[np.isfinite(difference)]
        if not len(known):
            doubtful |= modelled
            continue
        sure = values[~modelled]
        doubtful |= modelled & (values - known.min() > sure.max(initial=-np.inf))
        doubtful |= modelled & (values - known.max() < sure.min(initial=np.inf))
    return [int(k) for k in np.flatnonzero(doubtful)]


def period_rows(sequence: LoadSequence, rows: Sequence[Row]) -> list[Row]:
    """Rows of transmission_error.csv of the ideal drive from the history of its sampled period;
    none without one."""
    if not sequence.samples or len(rows) < sequence.samples or not sequence.torque:
        return []
    names = ("wg_angle_deg", "output_angle_deg", "wg_torque_Nmm", "newton_iterations")
    return [
        _row(sequence.kinematics, *(row[name] for name in names))
        for row in of_period(sequence, list(rows))
    ]


def _row(
    kinematics: Kinematics, wg_angle: float, output_angle: float, wg_torque: float, iterations: int
) -> Row:
    """Angles in degrees, in the frame in which the drive is computed; torque in N mm."""
    error = transmission_error(np.array(wg_angle), np.array(output_angle), kinematics.ratio)
    shown = shown_output(kinematics, wg_angle, output_angle)
    by_model = (0, np.nan, np.nan)
    values = (wg_angle, shown, float(error), wg_torque, iterations, *by_model)
    return dict(zip(COLUMNS, values, strict=True))


def _largest(rows: Sequence[Row], name: str) -> float | None:
    """Largest number of a column, by its size; None without one, as in rows of earlier versions."""
    values = np.array([row.get(name, np.nan) for row in rows], dtype=float)
    known = np.abs(values[np.isfinite(values)])
    return float(known.max()) if len(known) else None


def spectrum(values: np.ndarray, turns: float) -> tuple[np.ndarray, np.ndarray]:
    """Orders (m,) of the input's turn above 0, and amplitudes (m,) of values (n,) at even angles
    over `turns` turns."""
    amplitude = np.abs(np.fft.rfft(values)) / len(values)
    both = 2.0 * np.ones(len(amplitude))
    if len(values) % 2 == 0:
        both[-1] = 1.0  # the highest order stands alone
    order = np.arange(len(amplitude)) / turns
    return order[1:], (both * amplitude)[1:]


class Causes:
    """Names of the orders of the input's turn.

    A gear that stands is passed by both waves in every turn: its deviations have whole orders. The
    other gear turns with the output, against which the wave generator turns 1 - 1 / ratio times.
    The teeth mesh once per pitch of the standing gear, with odd numbers of teeth twice. Bolts turn
    with the flexible spline.

    Parameters
    ----------
    kinematics : of the drive;  deviations : None of the ideal drive
    turns : of the wave generator over which the spectrum was taken
    """

    def __init__(self, kinematics: Kinematics, deviations: Deviations | None, turns: float) -> None:
        self.kinematics, self.turns = kinematics, turns
        self.mesh = math.lcm(kinematics.teeth(kinematics.standing_gear), kinematics.lobes)
        self.of_wave_generator = _kinds(deviations, "wave_generator")
        gears: tuple[GearName, ...] = ("ring_gear", "flexible_spline")
        self.gears = [
            (gear.replace("_", " "), kinds, self._passes(gear))
            for gear in gears
            if (kinds := _kinds(deviations, gear))
        ]
        self.bolts = 0.0
        if kinematics.bolts:
            per_turn = math.lcm(kinematics.bolts, kinematics.lobes)
            self.bolts = per_turn * self._passes("flexible_spline")

    def _passes(self, gear: GearName) -> float:
        """Turns of the wave generator against a gear in one of its turns."""
        turns_too = gear == self.kinematics.output_gear
        return 1.0 - 1.0 / self.kinematics.ratio if turns_too else 1.0

    def of(self, order: float) -> str:
        """Cause of an order, or several that the spectrum cannot tell apart."""
        half = 0.5 / self.turns * (1.0 + 1e-9)
        times = round(order / self.mesh)
        if times and abs(order - times * self.mesh) < half:
            return "mesh of the teeth" if times == 1 else f"mesh of the teeth, {times} times"
        times = round(order / self.bolts) if self.bolts else 0
        if times and abs(order - times * self.bolts) < half:
            return "bolts" if times == 1 else f"bolts, {times} times"
        found = []
        for name, kinds, passes in self.gears:
            times = round(order / passes)
            if times and abs(order - times * passes) < half:
                found.append(f"{name} ({', '.join(kinds)}), {times} per turn against it")
        output = 1.0 / abs(self.kinematics.ratio)
        times = round(order / output)
        if (
            not found
            and times
            and abs(order - times * output) < half
            and self.turns >= abs(self.kinematics.ratio)
        ):
            against = " against the ring gear" if self.kinematics.wave_generator_is_fixed else ""
            found.append(f"output, {times} per turn{against}")
        if round(order) == 1 and self.of_wave_generator:
            found.append(f"wave generator ({', '.join(self.of_wave_generator)})")
        return " or ".join(found) or "combined"


def _kinds(deviations: Deviations | None, part: str) -> list[str]:
    """Kinds of deviations of a part that are not zero."""
    if deviations is None:
        return []
    section = getattr(deviations, part)
    kinds = []
    if not isinstance(section, TiltedOffset) or part == "ring_gear":
        kinds += ["pitch"] if section.pitch_errors or section.pitch_grade else []
    kinds += ["eccentricity"] if section.eccentricity else []
    kinds += ["tilt"] if getattr(section, "tilt", 0.0) else []
    kinds += ["ovality"] if getattr(section, "ovality", 0.0) else []
    if part == "flexible_spline":
        cup = deviations.cup
        kinds += [
            name
            for name, value in (("cup eccentricity", cup.eccentricity), ("cup tilt", cup.tilt))
            if value
        ]
    return kinds


def evaluate_turns(
    kinematics: Kinematics,
    deviations: Deviations | None,
    samples: int,
    rows: Sequence[Row],
    errors: PeriodRanges | None = None,
    *,
    friction: bool = False,
) -> TransmissionError | None:
    """The transmission error from the rows of transmission_error.csv; None without rows.

    samples : rows of a period without deviations
    errors : of the ranges of the ideal drive, where they are known
    friction : whether the flanks of the run have it
    """
    if not rows:
        return None
    step = (
        kinematics.period_angle / samples
        if deviations is None
        else kinematics.pitch_angle / deviations.angles_per_pitch
    )
    turns = len(rows) * step / (2.0 * np.pi)
    error, torque = column(rows, "transmission_error_arcsec"), column(rows, "wg_torque_Nmm")
    causes = Causes(kinematics, deviations, turns)
    known = errors if deviations is None else None
    return TransmissionError(
        turns=turns,
        angles=len(rows),
        peak_to_peak=float(np.ptp(error)),
        amplitude=0.5 * float(np.ptp(error)),
        mean=float(error.mean()),
        spectrum=_named(error, turns, causes),
        torque=TorqueOverTurns(
            mean=float(torque.mean()),
            peak_to_peak=float(np.ptp(torque)),
            spectrum=_named(torque, turns, causes),
            error_Nmm=known.torque if known else None,
            linear_model_Nmm=_largest(rows, "linear_model_Nmm"),
        ),
        error_arcsec=known.transmission_error if known else None,
        without_friction=friction and deviations is not None,
        by_linear_model=int(sum(row.get("by_linear_model", 0) for row in rows)),
        linear_model_arcsec=_largest(rows, "linear_model_arcsec"),
    )


def _named(values: np.ndarray, turns: float, causes: Causes) -> tuple[SpectrumLine, ...]:
    """The largest orders of a spectrum with their causes."""
    order, amplitude = spectrum(values, turns)
    largest = np.argsort(-amplitude, kind="stable")[:LARGEST]
    floor = NEGLIGIBLE * max(float(np.abs(values).max(initial=0.0)), 1e-300)
    return tuple(
        SpectrumLine(float(order[k]), float(amplitude[k]), causes.of(float(order[k])))
        for k in largest
        if amplitude[k] > floor
    )


def orders(
    turns: float, rows: Mapping[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Orders (m,) and amplitudes (m,) of the transmission error (arc seconds) and of the input
    torque (N mm).

    turns : of the wave generator, of `TransmissionError`;  rows : columns of transmission_error.csv
    """
    order, error = spectrum(rows["transmission_error_arcsec"], turns)
    return order, error, spectrum(rows["wg_torque_Nmm"], turns)[1]
