"""Files of the history: of other versions, with a column more or less."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import swgpar
from support.paths import RECIPE
from support.stepping import small
from swgpar.api import save_report
from swgpar.drive_results.report_checks import checks
from swgpar.results import history

OF_ALL = [column.name for column in history.columns_of("all")]

OLD = b"""step,wg_angle_deg,output_angle_deg,fs_s1,pairs_in_contact,wall_s,strain_energy,remark
3,0.0,0.25,101.5,8,0.5,2.5,first
4,1.5,0.125,102.5,8,0.25,3.5,second
"""
"""Without a description: of version 1. Some columns are missing, two are not known."""


def test_columns_are_read_by_their_names(tmp_path: Path) -> None:
    path = tmp_path / history.NAME
    path.write_bytes(OLD)
    rows = history.read_history(path)
    assert list(rows[0]) == OLD.decode().splitlines()[0].split(",")
    assert (
        rows[1]
        | {
            "step": 4,
            "pairs_in_contact": 8,
            "fs_s1": 102.5,
            "strain_energy": 3.5,
            "remark": "second",
        }
        == rows[1]
    )
    assert [type(rows[0][name]) for name in ("step", "wg_angle_deg")] == [int, float]
    found = history.curves(history.columns(rows), 0, 2, 8.57, -20.0)
    assert found.values["fs_s1"].tolist() == [101.5, 102.5] and "rg_vm" not in found.values


def test_a_newer_version_is_refused(tmp_path: Path) -> None:
    path = tmp_path / history.NAME
    path.write_bytes(OLD)
    description = json.loads(history.format_description())
    (tmp_path / history.DESCRIPTION).write_text(
        json.dumps(description | {"version": 7}), encoding="utf-8"
    )
    with pytest.raises(
        ValueError, match=f"columns are of version 7, and swgpar .* reads up to {history.VERSION}"
    ):
        history.read_history(path)


def test_without_steps_there_is_no_history(tmp_path: Path) -> None:
    (tmp_path / history.NAME).write_bytes(OLD.replace(b"step", b"number"))
    with pytest.raises(ValueError, match=r"history\.csv has no column step"):
        history.read_history(tmp_path / history.NAME)


def test_a_value_needs_a_declared_column() -> None:
    with pytest.raises(ValueError, match="strain_energy is not declared"):
        history.plain_row({"step": 3, "strain_energy": 2.5})


def test_rows_before_a_restart_may_lack_a_column(tmp_path: Path) -> None:
    """The file has the columns of all rows, with empty cells that read as NaN."""
    later = {
        "step": 4,
        "wg_angle_deg": 1.5,
        "output_angle_deg": 0.1,
        "fs_s1": 2.5,
        "pairs_in_contact": 8,
    }
    rows = [
        {"step": 3, "wg_angle_deg": 0.0, "output_angle_deg": 0.0},
        later,
        {**later, "wg_angle_deg": 3.0},
    ]
    path = tmp_path / history.NAME
    path.write_bytes(history.format_rows(rows))
    assert path.read_text(encoding="utf-8").splitlines()[1] == "3,0.0,0.0,,"
    read = history.read_history(path)
    assert read == rows
    found = history.columns(read)
    assert list(found) == list(later) and found["step"].dtype == np.int64
    for name, value in (("fs_s1", 2.5), ("pairs_in_contact", 8.0)):
        np.testing.assert_array_equal(found[name], [np.nan, value, value])
    curves = history.curves(found, 3, 3, 8.57, -20.0)
    assert np.isnan(curves.fine["fs_s1"]).all()
    assert np.isfinite(curves.fine[history.TRANSMISSION_ERROR]).all()


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    swgpar.run(small("plane"), RECIPE, folder, progress=False)
    return folder


@pytest.mark.parametrize("missing", [name for name in OF_ALL if name not in history.REQUIRED])
def test_a_result_without_a_column_has_figures_and_a_report(
    run: Path, tmp_path: Path, missing: str
) -> None:
    shutil.copytree(run, tmp_path, dirs_exist_ok=True)
    (tmp_path / history.DESCRIPTION).unlink()
    header, *lines = (tmp_path / history.NAME).read_text(encoding="utf-8").splitlines()
    index = header.split(",").index(missing)
    kept = [
        ",".join(cell for k, cell in enumerate(line.split(",")) if k != index)
        for line in (header, *lines)
    ]
    (tmp_path / history.NAME).write_text("\n".join(kept) + "\n", encoding="utf-8")
    result = swgpar.open_result(tmp_path)
    assert missing not in result.history
    curves = 2 * len({"fs_s1", "fs_s3", "fs_vm", "rg_vm"} - {missing})
    assert len(result.plot.stress().axes[0].lines) == curves
    result.plot.torque_and_transmission_error()
    result.plot.load_sharing()
    checks(result.summary, result.history)


def test_a_report_without_a_column(run: Path, tmp_path: Path) -> None:
    """`swgpar report` on a folder of the first version: no description, and a column less."""
    shutil.copytree(run, tmp_path, dirs_exist_ok=True)
    (tmp_path / history.DESCRIPTION).unlink()
    text = (tmp_path / history.NAME).read_text(encoding="utf-8")
    (tmp_path / history.NAME).write_text(
        text.replace("max_penetration_mm", "other"), encoding="utf-8"
    )
    save_report(swgpar.open_result(tmp_path), tmp_path)
    assert "the history does not have it" in (tmp_path / "report.html").read_text(encoding="utf-8")
