"""Means, maxima and ripple over the rotation, with their errors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from swgpar.answers.answer import (
    Answer,
    AnswerGroup,
    AnswerKind,
    answer,
    evaluation,
    known_quotient,
    part_answers,
)
from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.jamming import energy_remark, jamming_remark
from swgpar.evaluation.numerics import torque_left
from swgpar.evaluation.period import of_period, sampling_error
from swgpar.evaluation.period_ranges import (
    INPUT_TORQUE,
    CoarsePeriod,
    PeriodRanges,
    period_curves,
    range_errors,
)
from swgpar.evaluation.result_frame import InputTorque, input_torque
from swgpar.largest_stress.places import STRESSES, Place
from swgpar.load.load_sequence import LoadSequence
from swgpar.load.load_states import Stage
from swgpar.results.history import DECLARED, Row, column

GEAR_STRESSES = tuple(f"{body}_{stress}" for body in ("fs", "rg") for stress in STRESSES)
"""Columns of the history with the largest stresses of both bodies."""

BALANCE_SAFETY = 2.0
"""Factor on the distance of the mean input torque from that of the energy balance."""

MEAN_COLUMNS = tuple(
    sorted(
        (declared for declared in DECLARED if declared.averaged),
        key=lambda declared: declared.unit != "MPa",
    )
)
"""Columns of the history whose means and maxima over the rotation are taken, stresses first."""


def _by_column(group: str, field: str, words: str, *, detail: bool) -> Iterator[AnswerKind]:
    """Answers in a field by column of the history."""
    for mean in MEAN_COLUMNS:
        text = f"{mean.label or mean.name}, {words} over the rotation"
        yield AnswerKind(
            f"{group}.{mean.name}",
            text,
            mean.unit,
            f"{field}.{mean.name}",
            detail,
            error="" if detail else f"mesh_error.{mean.name}",
        )


MAIN_MEANS = tuple(
    kind
    for kind in _by_column("mean", "means", "mean", detail=False)
    if kind.name.partition(".")[2] in ("fs_s1", "fs_s3", "fs_vm", "rg_vm", "wg_torque_Nmm")
)
"""What tables and figures show of a drive whose output rotates."""


@evaluation
class Rotation(AnswerGroup):
    """What the increments of the rotation give; without a rotation there are no means.

    means, maxima : by column of the history: stresses in MPa, torque in N mm
    input : with the wave generator fixed
    range_errors : of the ranges of transmission error and input torque;  ripple_error : of the
    ripple; None where they are not known
    mesh_error : errors of the means where they are known: of nodal averages (MPa) by the mesh, of
    the input torque (N mm) by the energy balance
    sampling_error : change of the means with half as many angles, with `steps.samples`
    newton_iterations_mean : of an increment
    jammed : a sentence where the mean input torque is far from that of the energy balance
    energy : the same where it departs by more than its error
    """

    means: Mapping[str, float] = part_answers(*_by_column("mean", "means", "mean", detail=False))
    input: InputTorque | None
    torque_ripple: float | None = answer(
        "rotation.torque_ripple",
        "input torque, largest less smallest over mean",
        error="ripple_error",
    )
    transmission_error_arcsec: float | None = answer(
        "rotation.transmission_error",
        "transmission error of the ideal drive, peak to peak",
        "arcsec",
        error="range_errors.transmission_error",
    )
    wg_torque_expected_Nmm: float = answer(
        "rotation.expected_wg_torque",
        "mean torque of the wave generator by the energy balance",
        "N·mm",
        exact=True,
    )
    maxima: Mapping[str, float] = part_answers(
        *_by_column("maximum", "maxima", "largest", detail=True)
    )
    mesh_error: Mapping[str, float]
    sampling_error: Mapping[str, float] | None
    newton_iterations_mean: float | None
    jammed: str | None
    energy: str | None = None
    ripple_error: float | None = None
    range_errors: PeriodRanges | None = None

    TITLE = "over the rotation"
    IN_PROGRAMS = False

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        has = {
            "all": True,
            "pancake": design.dynamic_spline is not None,
            "wave generator fixed": design.kinematics.wave_generator_is_fixed,
        }
        missing = [mean.name for mean in MEAN_COLUMNS if not has[mean.drives]]
        return tuple(
            kind
            for kind in super().kinds(design)
            for group, _, name in [kind.name.partition(".")]
            if name not in missing
            and (group != "input" or design.kinematics.wave_generator_is_fixed)
        )

    def answers(self) -> Iterator[Answer]:
        return super().answers() if self.means else iter(())

    def reasons(self) -> Mapping[str, str]:
        if not self.means or self.torque_ripple is not None:
            return {}
        return {
            "rotation.torque_ripple": "the mean input torque is not larger than its error: what "
            "increments leave over and angles change; without torque and friction it is zero"
        }

    def remarks(self) -> Iterator[str]:
        yield from filter(None, (self.jammed, self.energy))
        if self.sampling_error:
            changes = ", ".join(
                f"{name} {self.sampling_error[name]:.2f}" for name in GEAR_STRESSES[:3]
            )
            yield f"half as many angles change the means by (MPa): {changes}"


def evaluate_rotation(
    sequence: LoadSequence,
    rows: Sequence[Row],
    pairs: Sequence[Row],
    places: Mapping[str, Place],
    *,
    friction: bool,
    coarse: CoarsePeriod | None = None,
) -> Rotation:
    """From the history `rows` of the computed increments.

    pairs : rows of pairs.csv;  friction : whether flanks have friction
    places : by which the errors of the means are known
    coarse : the period on a coarser mesh, where it is known
    """
    kinematics, rotation = sequence.kinematics, rotation_rows(sequence, rows)
    sampled = sampled_rows(sequence, rows)
    driven = input_torque(kinematics, sequence.torque, sampled)
    left = torque_left(rows)
    means: dict[str, float] = {}
    maxima: dict[str, float] = {}
    ripple = deviation = half = ranges = None
    if sampled:
        declared = [mean.name for mean in MEAN_COLUMNS]
        names = [name for name in declared if all(name in row for row in sampled)]
        means = {name: float(np.mean([row[name] for row in sampled])) for name in names}
        maxima = {name: float(column(sampled, name).max()) for name in names}
        name = "tooth_torque_Nmm" if driven else INPUT_TORQUE
        over = period_curves(kinematics, sampled, name).ranges
        deviation, torque = over.transmission_error, column(sampled, name)
        if sequence.samples:
            half = sampling_error(sequence, list(rows), tuple(names))
            ranges = range_errors(kinematics, sampled, name, coarse)
        change = half[INPUT_TORQUE] if half else 0.0
        mean = abs(float(torque.mean()))
        # without a torque and without friction it is zero, and all of it an error
        error = left + change if sequence.torque or friction else mean
        ripple = known_quotient(over.torque, mean, error)
    jammed, energy = jamming_remark(sequence, sampled, means, left, pairs), None
    if not jammed:
        left += half[INPUT_TORQUE] if half else 0.0
        energy = energy_remark(sequence, sampled, means, left, pairs, friction=friction)
    return Rotation(
        means=means,
        maxima=maxima,
        torque_ripple=ripple,
        transmission_error_arcsec=deviation,
        mesh_error=mesh_error(means, places) | _torque_error(sequence, means, rows, friction),
        ripple_error=ranges.torque / mean if ranges and ripple is not None else None,
        range_errors=ranges,
        sampling_error=half,
        newton_iterations_mean=float(np.mean([row["newton_iterations"] for row in rotation]))
        if rotation
        else None,
        input=driven,
        wg_torque_expected_Nmm=kinematics.wave_generator_torque(sequence.torque),
        jammed=jammed,
        energy=energy,
    )


def rotation_rows(sequence: LoadSequence, rows: Sequence[Row]) -> list[Row]:
    """Rows of the history that belong to the rotation; none in a load program."""
    return [] if sequence.points else [row for row in rows if int(row["step"]) >= Stage.ROTATE]


def sampled_rows(sequence: LoadSequence, rows: Sequence[Row]) -> list[Row]:
    """Rows of the history that stand for the rotation: those of the sampled period, or all; none in
    a load program."""
    if sequence.samples:
        return of_period(sequence, list(rows))
    return rotation_rows(sequence, rows)


def _torque_error(
    sequence: LoadSequence, means: Mapping[str, float], rows: Sequence[Row], friction: bool
) -> dict[str, float]:
    """Error (N mm) of the mean input torque over a sampled period; empty where it is not known.

    Without friction the work of the input over a period is that of the output. So the mean torque
    is known, and the distance from it is the error.
    """
    known = INPUT_TORQUE in means and sequence.samples and sequence.repeats
    if friction or not known or not sequence.torque:
        return {}
    expected = sequence.kinematics.wave_generator_torque(sequence.torque)
    return {INPUT_TORQUE: BALANCE_SAFETY * abs(means[INPUT_TORQUE] - expected) + torque_left(rows)}


def mesh_error(means: Mapping[str, float], places: Mapping[str, Place]) -> dict[str, float]:
    """Errors (MPa) of the means of nodal averages, by column of the history, where they are known.

    They are in proportion to those of the largest stresses under load: of what windows resolve, how
    far nodal averages are from it, and its own error.
    """
    found = {}
    for name, place in places.items():
        if name in means and place.error:
            nodal = place.value if place.on_mesh is None else place.on_mesh
            found[name] = means[name] * (abs(place.value - nodal) + place.error) / nodal
    return found
