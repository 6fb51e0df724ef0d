"""Displacement and tilt of the output, and reactions of its bearing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from swgpar.answers.answer import AnswerGroup, answer, evaluation
from swgpar.checks.output_bearing_checks import LARGEST_SHIFT, LARGEST_TILT
from swgpar.design.output_bearing import OutputBearing
from swgpar.results.history import OUTPUT_COLUMNS, Row, column

MICROMETRES, MILLIRADIANS = 1000.0, 1000.0


@evaluation
class OutputBearingLoads(AnswerGroup):
    """Largest values over the increments under load, each by its magnitude.

    radial_force_N, axial_force_N, tilting_moment_Nm : of the bearing on the output
    module : mm, of the drive
    """

    radial_um: float = answer(
        "output_bearing.radial_displacement",
        "largest radial displacement of the output in the middle of its bearing",
        "µm",
    )
    axial_um: float = answer(
        "output_bearing.axial_displacement", "largest axial displacement of the output", "µm"
    )
    tilt_mrad: float = answer("output_bearing.tilt", "largest tilt of the output", "mrad")
    radial_force_N: float = answer(
        "output_bearing.radial_force", "largest radial force of the output's bearing", "N"
    )
    axial_force_N: float = answer(
        "output_bearing.axial_force", "largest axial force of the output's bearing", "N"
    )
    tilting_moment_Nm: float = answer(
        "output_bearing.tilting_moment", "largest tilting moment of the output's bearing", "N·m"
    )
    module: float

    TITLE = "bearing of the output, under load"
    ASKED_BY = "[output_bearing]"
    SECTION = "output_bearing"

    def remarks(self) -> Iterator[str]:
        shift = max(self.radial_um, self.axial_um) / MICROMETRES
        if shift > LARGEST_SHIFT * self.module:
            yield (
                f"the output is displaced by {shift:.2g} mm, more than {LARGEST_SHIFT:g} modules: "
                "its bearing is too soft for what teeth and cam press on it"
            )
        if self.tilt_mrad > MILLIRADIANS * LARGEST_TILT:
            yield (
                f"the output tilts by {self.tilt_mrad:.2g} mrad, and only tilts up to "
                f"{MILLIRADIANS * LARGEST_TILT:g} mrad are small ones, as the model has them"
            )


def output_bearing_loads(
    bearing: OutputBearing, module: float, rows: Sequence[Row]
) -> OutputBearingLoads | None:
    """From rows of the history under load; None where there are none. module : mm"""
    if not rows:
        return None
    moved = np.column_stack([column(rows, name) for name in OUTPUT_COLUMNS])
    radial, axial = float(np.hypot(*moved[:, :2].T).max()), float(np.abs(moved[:, 2]).max())
    tilt = float(np.hypot(*moved[:, 3:].T).max())
    return OutputBearingLoads(
        radial_um=MICROMETRES * radial,
        axial_um=MICROMETRES * axial,
        tilt_mrad=MILLIRADIANS * tilt,
        radial_force_N=bearing.radial_stiffness * radial,
        axial_force_N=bearing.axial_stiffness * axial,
        tilting_moment_Nm=bearing.tilting_stiffness * tilt,
        module=module,
    )
