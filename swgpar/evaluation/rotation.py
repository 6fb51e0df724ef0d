"""Means, maxima and ripple over the rotation, with their errors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.answers import Answer, AnswerGroup, AnswerKind
from swgpar.evaluation.jamming import jamming_remark
from swgpar.evaluation.period import of_period, sampling_error
from swgpar.evaluation.places import STRESSES, Place
from swgpar.evaluation.result_frame import InputTorque, input_torque
from swgpar.evaluation.windows.root_stress import RootStress
from swgpar.load.load_states import Stage
from swgpar.results.history import COLUMNS, Row, column, transmission_error

GEAR_STRESSES = tuple(f"{body}_{stress}" for body in ("fs", "rg") for stress in STRESSES)
"""Columns of the history with the largest stresses of both bodies."""

INPUT_TORQUE = "wg_torque_Nmm"

MEAN_COLUMNS = (*GEAR_STRESSES, *(f"ds_{stress}" for stress in STRESSES), INPUT_TORQUE)
"""Columns of the history whose means and maxima over the rotation are taken."""


@dataclass(frozen=True)
class Rotation(AnswerGroup):
    """What the increments of the rotation give; without a rotation there are no means.

    means, maxima : by column of the history: stresses in MPa, torque in N mm
    torque_ripple : largest less smallest input torque, over the mean
    transmission_error_arcsec : largest less smallest transmission error
    mesh_error : errors (MPa) of the means of nodal averages by the mesh, where they are known
    sampling_error : change of the means with half as many angles, with `steps.samples`
    newton_iterations_mean : of an increment
    input : torque that drives the ring gear, with the wave generator fixed
    wg_torque_expected_Nmm : mean torque of the wave generator by the energy balance
    jammed : a sentence where the mean input torque is far from that
    """

    means: Mapping[str, float]
    maxima: Mapping[str, float]
    torque_ripple: float | None
    transmission_error_arcsec: float | None
    mesh_error: Mapping[str, float]
    sampling_error: Mapping[str, float] | None
    newton_iterations_mean: float | None
    input: InputTorque | None
    wg_torque_expected_Nmm: float
    jammed: str | None

    TITLE = "over the rotation"
    OVERALL = (
        AnswerKind(
            "rotation.torque_ripple",
            "input torque, largest less smallest over mean",
            path="torque_ripple",
        ),
        AnswerKind(
            "rotation.transmission_error",
            "transmission error of the ideal drive, peak to peak",
            "arcsec",
            "transmission_error_arcsec",
        ),
        AnswerKind(
            "rotation.expected_wg_torque",
            "mean torque of the wave generator by the energy balance",
            "N·mm",
            "wg_torque_expected_Nmm",
        ),
    )
    INPUT = (
        AnswerKind(
            "input.torque", "torque of the driven ring gear, mean", "N·mm", "input.torque_Nmm"
        ),
        AnswerKind(
            "input.expected_torque",
            "the same by the energy balance",
            "N·mm",
            "input.torque_expected_Nmm",
        ),
    )
    MEANS = tuple(
        AnswerKind(
            f"mean.{name}",
            f"{COLUMNS[name].label}, mean over the rotation",
            COLUMNS[name].unit,
            f"means.{name}",
        )
        for name in MEAN_COLUMNS
    )
    MAXIMA = tuple(
        replace(
            mean,
            name=mean.name.replace("mean.", "maximum."),
            text=mean.text.replace("mean", "largest"),
            path=mean.path.replace("means", "maxima"),
            detail=True,
        )
        for mean in MEANS
    )
    KINDS = (*MEANS, *INPUT, *OVERALL, *MAXIMA)

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        if design.has_program:
            return ()
        left_out = () if design.dynamic_spline is not None else ("mean.ds_", "maximum.ds_")
        left_out += () if design.wave_generator_is_fixed else ("input.",)
        return tuple(kind for kind in cls.KINDS if not kind.name.startswith(left_out))

    def answers(self) -> Iterator[Answer]:
        for answer in super().answers() if self.means else ():
            group, _, name = answer.name.partition(".")
            yield replace(answer, error=self.mesh_error.get(name) if group == "mean" else None)

    def remarks(self) -> Iterator[str]:
        if self.jammed:
            yield self.jammed
        if self.sampling_error:
            changes = ", ".join(
                f"{name} {self.sampling_error[name]:.2f}" for name in GEAR_STRESSES[:3]
            )
            yield f"half as many angles change the means by (MPa): {changes}"


def evaluate_rotation(
    design: DriveDesign,
    rows: Sequence[Row],
    root_stress: RootStress | None,
    places: Mapping[str, Place],
) -> Rotation:
    """From the history `rows` of the computed increments.

    root_stress, places : by which the errors of the means are known
    """
    rotation = (
        [] if design.has_program else [row for row in rows if int(row["step"]) >= Stage.ROTATE]
    )
    sampled = sampled_rows(design, rows)
    driven = input_torque(design, sampled)
    means: dict[str, float] = {}
    maxima: dict[str, float] = {}
    ripple = deviation = half = None
    if sampled:
        names = [name for name in MEAN_COLUMNS if name in sampled[0]]
        means = {name: float(np.mean([row[name] for row in sampled])) for name in names}
        maxima = {name: float(column(sampled, name).max()) for name in names}
        torque, mean = column(sampled, INPUT_TORQUE), means[INPUT_TORQUE]
        ripple = float(np.ptp(torque)) / abs(mean) if mean else None
        angles = column(sampled, "wg_angle_deg"), column(sampled, "output_angle_deg")
        deviation = float(np.ptp(transmission_error(*angles, design.ratio)))
        if design.steps.samples:
            half = sampling_error(design, list(rows), tuple(names))
    return Rotation(
        means=means,
        maxima=maxima,
        torque_ripple=driven.torque_ripple if driven else ripple,
        transmission_error_arcsec=deviation,
        mesh_error=mesh_error(root_stress, means, places),
        sampling_error=half,
        newton_iterations_mean=float(np.mean([row["newton_iterations"] for row in rotation]))
        if rotation
        else None,
        input=driven,
        wg_torque_expected_Nmm=1000.0 * design.load.torque / abs(design.ratio),
        jammed=jamming_remark(design, sampled, means),
    )


def sampled_rows(design: DriveDesign, rows: Sequence[Row]) -> list[Row]:
    """Rows of the history that stand for the rotation: those of the sampled period, or all; none in
    a load program."""
    if design.steps.samples:
        return of_period(design, list(rows))
    return [] if design.has_program else [row for row in rows if int(row["step"]) >= Stage.ROTATE]


def mesh_error(
    root_stress: RootStress | None, means: Mapping[str, float], places: Mapping[str, Place]
) -> dict[str, float]:
    """Errors (MPa) of the means of nodal stresses by the drive's mesh, by column of the history,
    where they are known.

    That of s1 is how far windows are from it, and their own error. Others are in proportion to
    those of the largest stresses under load, which a coarser mesh gives.
    """
    found = {
        name: means[name] * place.error / place.value
        for name, place in places.items()
        if name in means and place.error
    }
    if root_stress is not None:
        found["fs_s1"] = abs(root_stress.on_mesh - root_stress.s1) + root_stress.total_error
    return found
