"""JSON files have no Infinity and no NaN, whatever a run gives; what is round-off has no value."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

import swgpar
from support.paths import DATA, DESIGN, RECIPE, ROOT
from support.small_drive import PLANE
from support.small_trains import result_with
from swgpar.drive_results.summary_file import summary_to_json
from swgpar.evaluation.transmission_error import SpectrumLine
from swgpar.gear_trains import result as trains
from swgpar.results import history
from swgpar.results.atomic import to_json
from swgpar.results.checkpoint import read_checkpoint, write_checkpoint
from swgpar.results.folder import CHECKPOINT, SUMMARY
from swgpar.studies import job
from swgpar.systems.gear_train import GEAR_TRAIN

PACKAGE = ROOT / "swgpar"
NOT_FINITE = (math.nan, math.inf, -math.inf)

WRITERS = {
    "results/atomic.py": "every JSON file",
    "results/checkpoint.py": "a data set of the checkpoint, which swgpar alone reads",
    "input/refusals.py": "sentences",
    "input/quantities.py": "sentences",
    "studies/spec.py": "the text of a study given in Python",
    "optimisation/problem.py": "a sum of the problem",
}
"""Modules that make JSON, and what of."""


def strict(text: bytes | str) -> object:
    """The content of JSON text; constants that JSON does not have are an error."""

    def refused(name: str) -> None:
        raise AssertionError(f"{name} is no JSON")

    return json.loads(text, parse_constant=refused)


def test_one_function_makes_all_json_files() -> None:
    makers = {
        str(path.relative_to(PACKAGE))
        for path in PACKAGE.rglob("*.py")
        if any(call in path.read_text(encoding="utf-8") for call in ("json.dump", ".dump_json"))
    }
    assert makers == set(WRITERS)


@pytest.mark.parametrize("value", NOT_FINITE)
def test_numbers_that_are_not_finite_are_null(value: float) -> None:
    content = {
        "number": value,
        "of NumPy": np.float64(value),
        "array": np.array([1.0, value]),
        "nested": [{"deep": (value, 2)}],
        "dataclass": SpectrumLine(2.0, value, "pitch"),
    }
    found = strict(to_json(content))
    assert isinstance(found, dict)
    assert found["number"] is None and found["of NumPy"] is None
    assert found["array"] == [1.0, None] and found["nested"] == [{"deep": [None, 2]}]
    assert found["dataclass"] == {"order": 2.0, "amplitude": None, "cause": "pitch"}


@pytest.mark.parametrize("value", NOT_FINITE)
def test_every_writer_leaves_valid_files(value: float, tmp_path: Path) -> None:
    summary = swgpar.open_result(DATA / "first_format" / "bearing").summary
    broken = replace(
        summary,
        wall_s=value,
        rotation=replace(summary.rotation, means=dict.fromkeys(summary.rotation.means, value)),
        stiffness=None,
    )
    strict(summary_to_json(broken))
    strict(history.format_description())
    strict(to_json({"status": job.STATUS, "seconds": value}))
    table = {"time": np.array([0.0, value])}
    quantities = {"one": value, "several": [1.0, value]}
    result = result_with(quantities, table)
    trains.write(result, tmp_path, MPI.COMM_SELF)
    stored = trains.StoredTrainSummary.model_validate(strict((tmp_path / SUMMARY).read_bytes()))
    read = trains.summary_from(stored, result.summary.design, result.summary.known)
    assert read["several[1]"].value == 1.0 and read["one"].value is None
    values = GEAR_TRAIN.measure(trains.read(tmp_path, stored, read)).values
    assert values == GEAR_TRAIN.measure(result).values and len(values) == 1


def test_a_checkpoint_keeps_them(tmp_path: Path) -> None:
    path = tmp_path / CHECKPOINT
    write_checkpoint(path, MPI.COMM_SELF, {}, {"pairs": [1.0, math.nan, math.inf]})
    found = read_checkpoint(path, MPI.COMM_SELF, dict)
    assert np.array_equal(found["pairs"], [1.0, math.nan, math.inf], equal_nan=True)


def run(folder: Path, *values: str) -> swgpar.DriveResult:
    design = swgpar.load_design(DESIGN, [*PLANE, "output.root_stress=false", *values])
    result = swgpar.run(design, RECIPE, out=folder, progress=False)
    strict((folder / SUMMARY).read_bytes())
    return result


@pytest.mark.parametrize("samples", [2, 6])
def test_without_a_torque_there_is_no_ripple(tmp_path: Path, samples: int) -> None:
    steps = "steps.rotation=9", f"steps.samples={samples}"
    summary = run(tmp_path, "load.torque=0", *steps).summary
    assert summary["rotation.torque_ripple"].value is None
    assert summary["rotation.torque_ripple"].remark.startswith("the mean input torque")


def test_a_torque_that_is_no_load_has_no_stiffness(tmp_path: Path) -> None:
    """The chords are quotients of round-off; with a torque that bends the teeth they are known.

    The drive floats in its backlash under the small torque: its cam holds more than that.
    """
    values = ("stiffness.positions=1", "stiffness.mesh_error=false")
    none = run(tmp_path / "none", *values, "stiffness.torque=1e-6").summary
    for name in ("stiffness.K1", "stiffness.K2", "stiffness.K3"):
        assert none[name].value is None and "too small" in none[name].remark
    some = run(tmp_path / "some", *values, "stiffness.torque=1.0").summary
    assert some["stiffness.K1"].value > 0.0 and some["stiffness.K3"].value > 0.0
