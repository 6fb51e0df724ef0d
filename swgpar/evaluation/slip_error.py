"""What the steps of a run with friction change: slip that begins, or turns, within one of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from swgpar.answers.answer import AnswerGroup, AnswerKind, answer, evaluation
from swgpar.design.drive_design import DriveDesign

SLIP_TOLERANCE = 0.01
"""Largest share of the input torque, or of the output's rotation in an increment, that half the
steps may change."""

MOST_PLACES = 3
"""Increments that a sentence names."""


@dataclass(frozen=True)
class SlipCheck:
    """An increment whose last step was taken again in halves.

    step, wg_angle_deg : as in the history
    doubtful : share of the flanks' force on points that stuck, or had no slip, in a whole step
    parts : steps in place of the one
    share : change by half the steps over the input torque, or where the wave generator stands over
    the rotation of the output in the step (`by_rotation`); None where the halves have no
    equilibrium
    torque_change_Nmm, rotation_change_arcmin : of the input torque and of the output
    """

    step: int
    wg_angle_deg: float
    doubtful: float
    parts: int = 1
    share: float | None = None
    by_rotation: bool = False
    torque_change_Nmm: float | None = None
    rotation_change_arcmin: float | None = None


@evaluation
class SlipError(AnswerGroup):
    """Largest changes by half the steps, of all increments that were compared.

    compared : increments;  places : with a change above `SLIP_TOLERANCE` or not known
    """

    share: float | None = answer(
        "slip.share",
        "change of input torque or rotation with half the steps, largest",
        exact=True,
        limit="tolerance",
    )
    torque_change_Nmm: float | None = answer(
        "slip.torque", "change of the input torque with half the steps, largest", "N·mm", exact=True
    )
    rotation_change_arcmin: float | None = answer(
        "slip.rotation",
        "change of the output's rotation with half the steps, largest",
        "arc minutes",
        exact=True,
    )
    compared: int
    places: Sequence[str]

    TITLE = "slip of the flanks within increments"
    ASKED_BY = "contact.friction"

    @property
    def tolerance(self) -> float:
        """Largest change that is good."""
        return SLIP_TOLERANCE

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        return super().kinds(design) if design.contact.friction else ()

    def reasons(self) -> Mapping[str, str]:
        if self.compared and self.share is None:
            return {"slip.share": "no equilibrium was found in half of the steps"}
        return {}

    def remarks(self) -> Iterator[str]:
        if not self.compared:
            yield "all points in contact slipped through their steps, which then change nothing"
        if self.places:
            yield (
                f"slip within increments is not resolved to {100.0 * SLIP_TOLERANCE:g} %: "
                f"{'; '.join(self.places)}; steps.subdivide = true or smaller increments may"
            )


def evaluate_slip(checks: Sequence[SlipCheck]) -> SlipError:
    """From the increments that were compared."""

    def largest(name: str) -> float | None:
        values = [getattr(check, name) for check in checks]
        return None if not values or None in values else max(values)

    places = []
    for check in checks:
        if check.share is None or check.share > SLIP_TOLERANCE:
            change = "it by an unknown share"
            if check.share is not None:
                what = "the rotation" if check.by_rotation else "the input torque"
                change = f"{what} by {100.0 * check.share:.2g} %"
            places.append(
                f"step {check.step} at {check.wg_angle_deg:.4g}°, where {100 * check.doubtful:.3g} "
                f"% of the flanks' force has no certain slip and half the steps change {change}"
            )
    return SlipError(
        share=largest("share"),
        torque_change_Nmm=largest("torque_change_Nmm"),
        rotation_change_arcmin=largest("rotation_change_arcmin"),
        compared=len(checks),
        places=tuple(places[:MOST_PLACES]),
    )
