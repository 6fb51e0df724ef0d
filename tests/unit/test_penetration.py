"""Penetration of cam and pins: a run says it once, where augmentations leave more than is asked."""

from __future__ import annotations

import pytest

import swgpar
from support.messages import Messages
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE, SHORT


@pytest.mark.parametrize(("tolerance", "lines"), [("1e-9", 1), ("1e-1", 0)])
def test_remaining_penetration_is_one_line(tolerance: str, lines: int) -> None:
    soft = "contact.wg_penalty_coef=0.5", f"contact.penetration_tolerance={tolerance}"
    design = swgpar.load_design(DESIGN, [*PLANE, *SHORT, *soft, "output.root_stress=false"])
    with Messages() as said:
        result = swgpar.run(design, RECIPE, progress=False)
    assert sum("penetrate" in text for text in said.texts) == lines
    assert len(result.history["step"]) > 1
