"""What the coupling at the input is at the output."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from swgpar.answers.answer import AnswerGroup, answer, evaluation
from swgpar.design.input_coupling import InputCoupling


@evaluation
class CouplingAtOutput(AnswerGroup):
    """Play and stiffness of the coupling between shaft and cam, seen from the output with the shaft
    locked.

    stiffness : None where the coupling is rigid
    """

    play: float = answer(
        "input_coupling.play",
        "play of the input's coupling at the output",
        "arc minutes",
        exact=True,
    )
    stiffness: float | None = answer(
        "input_coupling.stiffness",
        "stiffness of the input's coupling at the output",
        "N·m/rad",
        exact=True,
    )

    TITLE = "coupling at the input"
    ASKED_BY = "[input_coupling]"
    SECTION = "input_coupling"

    def remarks(self) -> Iterator[str]:
        yield "stiffness, backlash and lost motion are those with the shaft locked, not the cam"


def coupling_at_output(coupling: InputCoupling, ratio: float) -> CouplingAtOutput:
    """ratio : wave generator over output"""
    return CouplingAtOutput(
        play=60.0 * float(np.degrees(coupling.output_play(ratio))),
        stiffness=coupling.output_stiffness(ratio),
    )
