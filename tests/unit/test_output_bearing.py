"""The section [output_bearing]: what it means, what it refuses, what it makes of the model."""

from __future__ import annotations

import numpy as np
import pytest

from support.paths import DATA, DESIGN
from support.small_drive import PLANE
from swgpar import load_design
from swgpar.analysis.accuracy import require_refinable
from swgpar.analysis.shortcuts import with_shortcuts
from swgpar.checks.output_bearing_checks import check_output_bearing
from swgpar.design.drive_design import DriveDesign
from swgpar.drive_results.summary import known_answers
from swgpar.errors import InputError
from swgpar.evaluation.output_bearing_loads import output_bearing_loads
from swgpar.meshing import load_recipe
from swgpar.results.history import OUTPUT_COLUMNS

BEARING = (
    "output_bearing.radial_stiffness=1e5",
    "output_bearing.axial_stiffness=2e5",
    "output_bearing.tilting_stiffness=1e4",
)
MOMENT = "output_bearing.tilting_moment=2"


def design(*overrides: str) -> DriveDesign:
    return load_design(DESIGN, [*BEARING, *overrides])


def test_directions_of_the_load() -> None:
    bearing = design(
        "output_bearing.radial_force=10",
        "output_bearing.radial_direction=90",
        "output_bearing.axial_force=-4",
        MOMENT,
        "output_bearing.tilting_direction=0",
    ).output_bearing
    # counter-clockwise from +y is -x; an axis that leans to +y at +z has turned about -x
    assert bearing.load == pytest.approx([-10.0, 0.0, -4.0, -2000.0, 0.0], abs=1e-12)
    tilt = (bearing.load / bearing.stiffness)[3:]
    leaning = np.cross([*tilt, 0.0], [0.0, 0.0, 1.0])
    assert leaning == pytest.approx([0.0, 2e-4, 0.0], abs=1e-12)


def test_a_load_from_one_side_takes_the_whole_drive_and_all_angles() -> None:
    recipe = load_recipe("forces")
    for overrides, repeats in ((("output_bearing.axial_force=5",), True), ((MOMENT,), False)):
        one = design(*overrides, "steps.rotation=45")
        assert one.repeats == repeats and one.copies == (2 if repeats else 1)
        assert bool(with_shortcuts(one, recipe).design.steps.samples) == repeats


@pytest.mark.parametrize(
    ("overrides", "start", "end"),
    [
        (
            (MOMENT, "steps.rotation=45", "steps.samples=4"),
            "steps.samples = 4",
            "does not repeat after a pitch",
        ),
        ((MOMENT, "fatigue.surface_factor=0.9"), "[fatigue]", "allowed without them"),
        ((MOMENT, "losses.loss_factor=1e-4"), "[losses]", "allowed without them"),
        ((MOMENT, "stiffness.torque=1"), "stiffness.positions", "does not repeat after a pitch"),
        (("deviations.ring_gear.eccentricity=0.01",), "[output_bearing]", "without them"),
        (("drive.layout=wave_generator_fixed",), "[output_bearing]", '"spline_fixed"'),
        (("output_bearing.radial_stiffness=0",), "output_bearing.radial_stiffness", "above 0"),
        (("output_bearing.radial_force=-1",), "output_bearing.radial_force", "0"),
        (("output_bearing.radial_force=10001",), "output_bearing.radial_force", "by 0.1 mm"),
        (
            ("output_bearing.axial_force=-20001",),
            "output_bearing.axial_force = -20001 is out of range: allowed -2e+04 to 2e+04 N,",
            "by 0.1 mm on the bearing alone",
        ),
        (
            ("output_bearing.position=-401",),
            "output_bearing.position = -401",
            "allowed -400 to 400 mm (10 pitch diameters)",
        ),
        (
            ("output_bearing.tilting_moment=101",),
            "output_bearing.tilting_moment = 101 is out of range: allowed 0 to 100 N·m,",
            "tilts it by 0.01 rad",
        ),
        ((*PLANE, MOMENT), "output_bearing.tilting_moment", 'drive.model = "plane"'),
        ((*PLANE, "output_bearing.axial_force=1"), "output_bearing.axial_force", "only 0"),
    ],
)
def test_refusals(overrides: tuple[str, ...], start: str, end: str) -> None:
    with pytest.raises(InputError) as caught:
        design(*overrides)
    message = str(caught.value)
    assert message.startswith(start) and end in message and "\n" not in message


def test_stiffnesses_are_required() -> None:
    with pytest.raises(InputError, match=r"output_bearing.axial_stiffness.*missing|required"):
        load_design(DESIGN, [BEARING[0], BEARING[2]])


def test_a_pancake_has_none() -> None:
    with pytest.raises(InputError, match="no end of its flexible spline is held"):
        load_design(DATA / "pancake.toml", BEARING)


def test_an_accuracy_needs_a_period() -> None:
    require_refinable(design(), 0.05)
    with pytest.raises(InputError, match="a tilting moment in .output_bearing.: allowed without"):
        require_refinable(design(MOMENT), 0.05)


def test_answers_are_the_largest_values_under_load() -> None:
    bearing = design(MOMENT).output_bearing
    check_output_bearing(design(MOMENT), bearing)
    moved = ([3e-4, 4e-4, 1e-4, 0.0, 0.0], [0.0, 1e-4, -6e-4, 3e-4, -4e-4])
    rows = [dict(zip(OUTPUT_COLUMNS, values, strict=True)) for values in moved]
    found = output_bearing_loads(bearing, 1.0, rows)
    values = {answer.name: answer.value for answer in found.answers()}
    assert values == pytest.approx(
        {
            "output_bearing.radial_displacement": 0.5,
            "output_bearing.axial_displacement": 0.6,
            "output_bearing.tilt": 0.5,
            "output_bearing.radial_force": 50.0,
            "output_bearing.axial_force": 120.0,
            "output_bearing.tilting_moment": 5.0,
        }
    )
    assert values.keys() <= known_answers(design()).keys()
    assert not values.keys() & known_answers(load_design(DESIGN)).keys()
    assert output_bearing_loads(bearing, 1.0, []) is None


@pytest.mark.parametrize(
    ("moved", "sentence"),
    [
        ([0.0, 0.099, -0.099, 0.0, 0.0099], None),
        ([0.0, 0.0, -0.5, 0.0, 0.0], "displaced by 0.5 mm, more than 0.1 modules: its bearing is"),
        ([0.08, 0.08, 0.0, 0.0, 0.0], "displaced by 0.11 mm"),
        ([0.0, 0.0, 0.0, 0.009, 0.009], "tilts by 13 mrad, and only tilts up to 10 mrad are small"),
    ],
)
def test_a_bearing_that_gives_way_is_named(moved: list[float], sentence: str | None) -> None:
    rows = [dict(zip(OUTPUT_COLUMNS, moved, strict=True))]
    remarks = list(output_bearing_loads(design().output_bearing, 1.0, rows).remarks())
    assert len(remarks) == (sentence is not None) and all(sentence in one for one in remarks)
