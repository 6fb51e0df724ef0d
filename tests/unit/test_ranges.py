"""Magnitudes of numbers: extremes of any key are refused with the range, in drives and gear
trains."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import swgpar
from support.paths import ROOT
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.gear_trains.train import MODELS
from swgpar.input.quantities import Section, unit_of
from swgpar.input.ranges import SMALLEST_AND_LARGEST
from swgpar.systems import system_of_section

DRIVERS = ROOT / "drivers"
FILES = [
    DRIVERS / f"{name}.toml"
    for name in (
        "cup_45deg",
        "plane_half_turn",
        "cascade",
        "gear_pair",
        "planetary",
        "planetary_stage",
        "ring_moving_load",
    )
]
EXTREMES = (1e300, -1e300, 1e-300, 1e16, 1e-16)


def numbers(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Keys with a number, or a list of them, and the value."""
    for name, value in table.items():
        if isinstance(value, dict):
            yield from numbers(value, f"{above}{name}.")
        elif (
            isinstance(value, float) or (isinstance(value, list) and value)
        ) and not above.startswith(("published", "measured")):
            yield f"{above}{name}", value


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_extremes_are_refused_with_the_range(file: Path) -> None:
    design = swgpar.load_design(file)
    found = list(numbers(design.model_dump()))
    assert len(found) > 10
    for key, value in found:
        for extreme in EXTREMES:
            wrong = [extreme] * len(value) if isinstance(value, list) else extreme
            with pytest.raises(InputError) as caught:
                design.with_values({key: wrong})
            message = str(caught.value)
            assert message.startswith(key) and "allowed" in message and message.isprintable(), (
                key,
                extreme,
                message,
            )


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_what_is_accepted_can_be_checked(file: Path) -> None:
    """Large and small values of a key that its range allows: finite numbers, or one sentence."""
    design = swgpar.load_design(file)
    for key, value in numbers(design.model_dump()):
        for other in (1e-6, 1e4):
            wanted = [other] * len(value) if isinstance(value, list) else other
            try:
                changed = design.with_values({key: wanted})
                derived = system_of_section(changed.system).check(changed)
            except InputError as error:
                assert str(error).isprintable()
            else:
                assert np.isfinite(list(derived.values())).all(), (key, other)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        (
            "flexible_spline.rim",
            1e-7,
            "flexible_spline.rim = 1e-07 is out of range: allowed 0.01 to 100 mm (0.01 to 100 "
            "modules)",
        ),
        (
            "load.torque",
            1e-300,
            "load.torque = 1e-300 is out of range: allowed 0 and 1e-15 to 1000000000 N·m",
        ),
        (
            "load.torque",
            1e300,
            "load.torque = 1e+300 is out of range: allowed 0 and 1e-15 to 1000000000 N·m",
        ),
        ("material.E", 1e-9, "material.E = 1e-09 is out of range: allowed 1e-06 to 1e+14 MPa"),
        (
            "micro_geometry.wg_slope",
            1e7,
            "micro_geometry.wg_slope = 10000000 is out of range: allowed -1000000 to -1e-09, 0 and "
            "1e-09 to 1000000 mm",
        ),
    ],
)
def test_the_sentence_has_the_range(key: str, value: float, words: str) -> None:
    with pytest.raises(InputError) as caught:
        swgpar.load_design(FILES[0], {key: value})
    assert str(caught.value) == words


def sections(model: type[Section]) -> Iterator[type[Section]]:
    for field in model.model_fields.values():
        for choice in getattr(field.annotation, "__args__", (field.annotation,)):
            if isinstance(choice, type) and issubclass(choice, Section):
                yield choice
                yield from sections(choice)


def test_every_unit_has_its_magnitudes() -> None:
    for design in (DriveDesign, *(model.Design for model in MODELS.values())):
        for section in sections(design):
            for name, field in section.model_fields.items():
                assert unit_of(field) in SMALLEST_AND_LARGEST, (section, name)


def test_too_many_time_steps_are_refused() -> None:
    with pytest.raises(
        InputError, match="time.step = .* is out of range: allowed .*at most 10000000 steps"
    ):
        swgpar.load_design(DRIVERS / "gear_pair.toml", {"time.end": 1e6})


def test_values_too_far_apart_for_the_arithmetic() -> None:
    with pytest.raises(InputError, match="the gear train cannot be computed with these values: "):
        swgpar.check(DRIVERS / "planetary.toml", {"wind.length": 1e-3})


def test_the_number_of_runs_is_limited() -> None:
    vary = {
        "load.torque": [float(k) for k in range(1000)],
        "material.E": [1e5 + k for k in range(1000)],
    }
    study = {"design": str(FILES[1]), "meshes": ["plane_coarse"], "vary": vary}
    with pytest.raises(
        InputError, match="has 1000000 runs: allowed up to study.max_cases = 100000"
    ):
        swgpar.study({"study": study})
