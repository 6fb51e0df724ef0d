"""Files of the history: of other versions, with a column more or less."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import swgpar
from support.paths import RECIPE
from support.stepping import small
from swgpar.results import history

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
        rows[1] | {"step": 4, "pairs_in_contact": 8, "fs_s1": 102.5, "strain_energy": 3.5, "remark": "second"}
        == rows[1]
    )
    assert [type(rows[0][name]) for name in ("step", "wg_angle_deg")] == [int, float]
    found = history.curves(history.columns(rows), 0, 2, 8.57, -20.0)
    assert found.values["fs_s1"].tolist() == [101.5, 102.5] and "rg_vm" not in found.values


def test_a_newer_version_is_refused(tmp_path: Path) -> None:
    path = tmp_path / history.NAME
    path.write_bytes(OLD)
    description = json.loads(history.format_description())
    (tmp_path / history.DESCRIPTION).write_text(json.dumps(description | {"version": 7}), encoding="utf-8")
    with pytest.raises(ValueError, match=f"columns are of version 7, and swgpar .* reads up to {history.VERSION}"):
        history.read_history(path)


def test_without_steps_there_is_no_history(tmp_path: Path) -> None:
    (tmp_path / history.NAME).write_bytes(OLD.replace(b"step", b"number"))
    with pytest.raises(ValueError, match=r"history\.csv has no column step"):
        history.read_history(tmp_path / history.NAME)


def test_a_value_needs_a_declared_column() -> None:
    with pytest.raises(ValueError, match="strain_energy is not declared"):
        history.plain_row({"step": 3, "strain_energy": 2.5})


@pytest.mark.parametrize("missing", ["fs_s3", "wg_torque_Nmm", "output_angle_deg", "rg_vm"])
def test_a_result_without_a_column_has_figures(tmp_path_factory: pytest.TempPathFactory, missing: str) -> None:
    run = tmp_path_factory.getbasetemp() / "history_run"
    if not run.exists():
        swgpar.run(small("plane"), RECIPE, run, progress=False)
    folder = tmp_path_factory.mktemp(missing)
    shutil.copytree(run, folder, dirs_exist_ok=True)
    (folder / history.DESCRIPTION).unlink()
    header, *lines = (folder / history.NAME).read_text(encoding="utf-8").splitlines()
    index = header.split(",").index(missing)
    kept = [",".join(cell for k, cell in enumerate(line.split(",")) if k != index) for line in (header, *lines)]
    (folder / history.NAME).write_text("\n".join(kept) + "\n", encoding="utf-8")
    result = swgpar.open_result(folder)
    assert missing not in result.history
    assert len(result.plot.stress().axes[0].lines) >= 6
    result.plot.torque_and_transmission_error()
