"""Whole turns of the wave generator with deviations, as a part of a run: what is computed, kept and reported."""

from __future__ import annotations

import numpy as np

from swgpar.analysis.deviating_drive import DeviatingDrive
from swgpar.analysis.recorder import Recorder
from swgpar.analysis.transmission_error import turn_row
from swgpar.design.drive_design import DriveDesign
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.results.history import Row

SAVED = 50
"""Angles after which the rows so far are saved."""

REPORTS = 10
"""Lines of the log in all."""


def follow_turns(design: DriveDesign, recipe: MeshRecipe, recorder: Recorder) -> None:
    """Compute the angles of the turns that the recorder does not know, and let it keep them; collective.

    recipe : of the run's mesh. Raises ConvergenceError; the rows up to then are kept.
    """
    step = design.period_angle / design.deviations.angles_per_pitch
    known = {_index(row, step): row for row in recorder.known_turns()}
    with recorder.model.phases("turns"):
        drive = DeviatingDrive(design, recipe, recorder.comm)
        total = drive.pitches * design.deviations.angles_per_pitch
        logger.info(
            "transmission error at %d angles of %d turns: %d unknowns%s",
            total,
            design.deviations.turns,
            sum(body["dofs"] for body in drive.model.counts().values()),
            " (half of the drive, by symmetry)" if drive.model.copies == 2 else "",
        )
        try:
            report, iterations = -(-total // REPORTS), 0
            for point in drive.points(set(known)):
                known[point.index] = turn_row(point, design.ratio)
                iterations += point.iterations
                if len(known) % SAVED == 0:
                    recorder.keep_turns(_sorted(known))
                if len(known) % report == 0:
                    logger.info("%6d of %d angles, %d Newton iterations", len(known), total, iterations)
        finally:
            recorder.keep_turns(_sorted(known))
            drive.destroy()


def _index(row: Row, step: float) -> int:
    return round(np.radians(row["wg_angle_deg"]) / step)


def _sorted(known: dict[int, Row]) -> list[Row]:
    return [known[index] for index in sorted(known)]
