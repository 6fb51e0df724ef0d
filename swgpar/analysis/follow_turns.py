"""Whole turns of the wave generator with deviations: what a run computes, keeps and reports."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np
from mpi4py import MPI

from swgpar.analysis.deviating_drive import DeviatingDrive
from swgpar.analysis.recorder import Recorder
from swgpar.errors import ConvergenceError
from swgpar.evaluation.transmission_error import TurnPoint, doubtful_extremes, turn_row
from swgpar.log import logger
from swgpar.results.history import Row

ROUND, SHARED_ROUND = 10, 100
"""States that a rank computes before the ranks exchange theirs: of a drive that they share, and of
one of its own, so that it seldom waits for others."""

SAVED = 50
"""Angles after which the rows so far are saved."""

REPORTS = 10
"""Lines of the log in all."""


def follow_turns(recorder: Recorder) -> None:
    """Let the recorder keep the angles of the turns that it does not know; collective.

    The states do not depend on each other. In the plane, where every rank has room for the whole
    drive, the ranks share the states; they share the cup. Where a linear model gives most angles,
    Newton's iteration then gives those that may be the largest or the smallest.

    Raises ConvergenceError; the rows up to then are kept.
    """
    design = recorder.model.design
    step = design.kinematics.pitch_angle / design.deviations.angles_per_pitch
    known = {_index(row, step): row for row in recorder.known_turns()}
    comm, shared = recorder.comm, design.drive.model == "plane"
    with recorder.model.phases("turns"):
        drive = DeviatingDrive(design, recorder.model.recipe, MPI.COMM_SELF if shared else comm)
        total = drive.angles
        logger.info(
            "transmission error at %d angles of %d turns: %d unknowns%s",
            total,
            design.deviations.turns,
            sum(body["dofs"] for body in drive.model.counts().values()),
            drive.model.part_remark,
        )
        share = (comm.rank, comm.size) if shared else (0, 1)
        most = SHARED_ROUND if shared else ROUND
        try:
            saved, reported, iterations = len(known), 0, 0
            first = drive.points(set(known), share, linear_model=design.deviations.linear_model)
            for found in _rounds(first, comm, most):
                known |= {point.index: turn_row(point, design.kinematics) for point in found}
                iterations += sum(point.iterations for point in found)
                if len(known) >= saved + SAVED:
                    saved = len(known)
                    recorder.keep_turns(_sorted(known))
                if len(known) * REPORTS >= (reported + 1) * total:
                    reported = len(known) * REPORTS // total
                    logger.info(
                        "%6d of %d angles, %d Newton iterations", len(known), total, iterations
                    )
            # all angles are known: the number of a row is the index of its angle
            while doubtful := set(doubtful_extremes(_sorted(known))):
                logger.info("%d angles by Newton's iteration that may be extreme", len(doubtful))
                for found in _rounds(drive.points(set(known) - doubtful, share), comm, most):
                    known |= {point.index: turn_row(point, design.kinematics) for point in found}
            modelled = sum(row["by_linear_model"] for row in known.values())
            if modelled:
                logger.info(
                    "%d angles by a linear model; --plain computes all by Newton's iteration",
                    modelled,
                )
        finally:
            recorder.keep_turns(_sorted(known))
            drive.destroy()


def _rounds(points: Iterator[TurnPoint], comm: MPI.Comm, most: int) -> Iterator[list[TurnPoint]]:
    """Points of all ranks, on all ranks, as they come; collective.

    most : of a rank at once

    Raises the ConvergenceError of any rank on all of them, after the points up to then.
    """
    while True:
        mine, failure = _next(points, most)
        parts = comm.allgather((mine, failure))
        found = list({point.index: point for part, _ in parts for point in part}.values())
        if found:
            yield found
        for _, message in parts:
            if message:
                raise ConvergenceError(message)
        if not found:
            return


def _next(points: Iterator[TurnPoint], most: int) -> tuple[list[TurnPoint], str]:
    """The next points of this rank, and why there are no more."""
    found: list[TurnPoint] = []
    try:
        for point in islice(points, most):
            found.append(point)  # noqa: PERF402, one by one: those before an error count
    except ConvergenceError as error:
        return found, str(error)
    return found, ""


def _index(row: Row, step: float) -> int:
    return round(np.radians(row["wg_angle_deg"]) / step)


def _sorted(known: dict[int, Row]) -> list[Row]:
    return [known[index] for index in sorted(known)]
