"""The sequence of a run, and its intermediate load states."""

from __future__ import annotations

import pytest

from support.paths import DESIGN
from swgpar import load_design
from swgpar.load.load_sequence import load_sequence, start_state


@pytest.mark.parametrize("torque", ["0", "2"])
def test_every_increment_can_be_cut(torque: str) -> None:
    """Half of an increment is another load state than its end, and one that nears it."""
    design = load_design(DESIGN, [f"load.torque={torque}", "steps.rotation=4", "steps.increment=2"])
    module, travel = design.drive.module, design.deflection
    before = start_state(design)
    keys = ("angle", "cam_clearance", "flank_clearance", "pin_inset", "output_rotation", "torque")
    for target in load_sequence(design).states:
        # without a torque step 3 is the end of step 2
        if any(getattr(before, k) != getattr(target, k) for k in keys):
            half, end = (before.interpolate(target, share, module, travel) for share in (0.5, 1.0))
            assert end == target
            assert any(getattr(half, k) != getattr(target, k) for k in keys), target
        before = target


def test_engagement_grows_from_a_clearance() -> None:
    design = load_design(DESIGN, [])
    deflected, engaged = load_sequence(design).states[:2]
    half = deflected.interpolate(engaged, 0.5, design.drive.module, design.deflection)
    assert half.cam_clearance > 0.0 and half.flank_clearance > 0.0
    assert half.pin_inset == pytest.approx(0.125 * design.deflection)
