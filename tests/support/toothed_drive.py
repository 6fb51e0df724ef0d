"""A plane drive with the teeth of a profile, and designs whose profile gives no flank."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN
from support.small_drive import PLANE
from swgpar.errors import InputError

GEAR = {"tip": 2, "layers": 1, "flank": 4, "root": 3, "under": 1, "rim": 1}


def run_with_teeth(keys: str, tooth_width: float) -> None:
    """Run a plane drive with a profile on both gears, one of them with rounded tips.

    keys : of the profile, as in a design file;  tooth_width : `ring_gear.c_P`
    """
    design = swgpar.load_design(
        DESIGN,
        [
            *PLANE,
            f"flexible_spline.profile={{{keys}}}",
            f"ring_gear.profile={{{keys}, r_tip = 0.05}}",
            f"ring_gear.c_P={tooth_width}",
            "steps.rotation=0",
            "output.figures=false",
        ],
    )
    assert design.rigid_teeth().clearance() > 0.0
    recipe = {"flexible_spline": GEAR, "ring_gear": GEAR}
    result = swgpar.run(design, mesh=recipe, progress=False)
    assert np.isfinite(result.history["fs_s1"]).all()


def refuse_profile(
    design_file: Callable, section: dict[str, Any], values: Sequence[str], words: str
) -> None:
    """A profile of the ring gear is refused in one line with these words."""
    with pytest.raises(InputError, match=words) as caught:
        swgpar.load_design(design_file({"ring_gear.profile": section}), values)
    assert "\n" not in str(caught.value)
