"""Heights and tip relief of each gear, and remarks on teeth that touch roots and on thin rims."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN
from support.small_drive import PLANE
from swgpar.checks.remarks import remarks
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError

INVOLUTE = {"type": "involute", "cutter_radius": 0.2}


def design(**values: Any) -> DriveDesign:
    keys = [f"{key.replace('__', '.')}={value}" for key, value in values.items()]
    return swgpar.load_design(DESIGN, [*PLANE, *keys])


def test_each_gear_has_its_heights() -> None:
    """Circles of both gears and the bore follow from a gear's own coefficients."""
    plain = design()
    own = design(flexible_spline__dedendum_coef=0.9, ring_gear__addendum_coef=0.5)
    m, spline, ring = plain.drive.module, *map(own.profile, ("flexible_spline", "ring_gear"))
    assert spline.r_root_circle == pytest.approx(20.0 * m - 0.9 * m)
    assert spline.r_tip_circle == pytest.approx(20.0 * m + 0.6 * m)
    assert ring.r_tip_circle == pytest.approx(21.0 * m - 0.5 * m)
    assert ring.r_root_circle == pytest.approx(21.0 * m + 0.8 * m)
    assert own.inner_radius == pytest.approx(plain.inner_radius - 0.1 * m)


def test_tips_on_the_pitch_circle() -> None:
    arcs = "{type = 'double_arc', r_addendum = 1.0, r_dedendum = 0.5}"
    for gear in ("flexible_spline", "ring_gear"):
        values = {f"{gear}__profile": arcs, f"{gear}__addendum_coef": 0.0}
        flat = design(**values)
        flank = flat.profile(gear)
        assert [segment.name for segment in flank.segments] == ["straight", "dedendum"]
        assert flank.r_tip_circle == pytest.approx(flat.teeth(gear).r_pitch)
        assert flat.backlash == pytest.approx(design().backlash, abs=1e-9)
        # with an addendum that the straight segment reaches, its end is on that line too
        low = design(**values | {f"{gear}__addendum_coef": 0.1}).profile(gear)
        end = low.point(low.breaks[1]) - low.point(0.0)
        assert end[0] / np.hypot(*end[0]) == pytest.approx(flank.tangent(0.0)[0], abs=1e-12)


def test_equal_heights_touch_and_say_so() -> None:
    equal = design(drive__dedendum_coef=0.6)
    sentences = [sentence for sentence in remarks(equal) if "touch the root circle" in sentence]
    assert len(sentences) == 2 and "ring_gear" in sentences[0]
    assert not any("touch the root" in sentence for sentence in remarks(design()))


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"drive__dedendum_coef": 0.5}, "drive.dedendum_coef = 0.5 .* 0.6 to 2 modules"),
        ({"ring_gear__dedendum_coef": 0.5}, "ring_gear.dedendum_coef = 0.5 .* flexible_spline"),
        ({"ring_gear__addendum_coef": 0.9}, "drive.dedendum_coef = 0.8 .* ring_gear"),
        ({"ring_gear__addendum_coef": -0.1}, "ring_gear.addendum_coef = -0.1"),
        ({"ring_gear__tip_relief": -0.1}, "ring_gear.tip_relief = -0.1"),
        ({"ring_gear__tip_relief": 0.6}, "ring_gear.tip_relief = 0.6"),
        (
            {"ring_gear__tip_relief": 0.01, "ring_gear__tip_relief_height": 1.3},
            "ring_gear.tip_relief_height = 1.3 .* root",
        ),
    ],
)
def test_what_does_not_fit_is_refused(values: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        design(**values)


def test_the_largest_tip_relief_is_named() -> None:
    with pytest.raises(InputError, match="allowed 0 to about") as caught:
        design(ring_gear__tip_relief=0.6)
    found = re.search(r"about ([0-9.]+) mm", str(caught.value))
    assert found is not None
    largest = float(found[1])
    assert design(ring_gear__tip_relief=0.98 * largest).ring_gear.tip_relief > 0.05
    with pytest.raises(InputError, match="is out of range"):
        design(ring_gear__tip_relief=1.02 * largest)


def test_thin_rims_are_named() -> None:
    """A rim of 0.2 modules under teeth of 1.8 (a public shop drive)."""
    involutes = {
        f"{gear}__profile": "{type = 'involute', cutter_radius = 0.2" + more + "}"
        for gear, more in (("flexible_spline", ""), ("ring_gear", ", cutter_teeth = 28"))
    }
    heights = {"drive__addendum_coef": 0.8, "drive__dedendum_coef": 1.0}
    thin = design(**involutes, **heights, flexible_spline__rim=0.2)
    (sentence,) = (text for text in remarks(thin) if "rim" in text)
    assert "0.11 of the height" in sentence
    assert not any("flexible_spline.rim" in text for text in remarks(design()))


@pytest.mark.parametrize("gear", ["flexible_spline", "ring_gear"])
@pytest.mark.parametrize("kind", ["arcs", "involute"])
def test_tip_relief(gear: str, kind: str) -> None:
    """Turned by the stated angles, with exact tangents and curvatures, smooth where it begins."""
    values: dict[str, Any] = {}
    if kind == "involute":
        shaper = ", cutter_teeth = 28" if gear == "ring_gear" else ""
        values[f"{gear}__profile"] = "{type = 'involute', cutter_radius = 0.2" + shaper + "}"
    values |= {f"{gear}__c_l": 0.5}
    plain = design(**values).profile(gear)
    values |= {f"{gear}__tip_relief": 0.02, f"{gear}__tip_relief_height": 0.4}
    changed = design(**values).profile(gear)
    assert plain.top_land - changed.top_land == pytest.approx(0.04, rel=1e-9)
    side = 1.0 if plain.external else -1.0
    for depth, share in ((0.1, (0.3 / 0.4) ** 2), (0.3, (0.1 / 0.4) ** 2), (0.45, 0.0)):
        radius = plain.r_tip_circle - side * depth
        angle = 0.5 * (plain.thickness(radius) - changed.thickness(radius)) / radius
        assert angle == pytest.approx(share * 0.02 / plain.r_tip_circle, abs=1e-12)
    for begin, end in zip(changed.breaks[:-1], changed.breaks[1:], strict=True):
        h = 1e-6
        s = begin + (end - begin) * np.linspace(0.05, 0.95, 9)
        along = (changed.point(s + h) - changed.point(s - h)) / (2.0 * h)
        assert along == pytest.approx(changed.tangent(s), abs=1e-8)
        bend = (changed.tangent(s + h) - changed.tangent(s - h)) / (2.0 * h)
        bend = np.einsum("ij,ij->i", bend, changed.normal(s))
        assert bend == pytest.approx(changed.curvature(s), abs=1e-6)
