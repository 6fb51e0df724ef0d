"""Result folders of the first format, without a number, open and have the same quantities."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import swgpar
from support.paths import DATA
from swgpar.api import save_report
from swgpar.systems.drive import DRIVE

FOLDERS = DATA / "first_format"


@pytest.mark.parametrize("name", ["plane", "bearing", "stiffness"])
def test_the_quantities_are_those_of_the_version_that_wrote_it(name: str, tmp_path: Path) -> None:
    shutil.copytree(FOLDERS / name, tmp_path / name)
    result = swgpar.open_result(tmp_path / name)
    expected = json.loads((FOLDERS / name / "quantities.json").read_text(encoding="utf-8"))
    values = DRIVE.measure(result).values
    assert {quantity: values[quantity] for quantity in expected} == expected
    save_report(result, tmp_path / name)
    assert (tmp_path / name / "report.html").stat().st_size > 10_000


@pytest.mark.parametrize(
    "content", [{"format": 99}, {"format": 2, "rotation": None}, {"bodies": {}}]
)
def test_another_content_is_refused_with_both_versions(
    content: dict[str, object], tmp_path: Path
) -> None:
    folder = tmp_path / "plane"
    shutil.copytree(FOLDERS / "plane", folder)
    table = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    del table["wall_s"]
    (folder / "summary.json").write_text(json.dumps(table | content), encoding="utf-8")
    version = swgpar.__version__
    other = rf"in the format 99: allowed are formats 1 to 2 with swgpar {version}"
    changed = rf"and swgpar {version} does not read its content"
    words = other if content.get("format") == 99 else changed
    with pytest.raises(
        swgpar.OutputError, match=rf"summary.json was written by swgpar 0.1.0,? {words}"
    ):
        swgpar.open_result(folder)


@pytest.mark.parametrize("text", ["", "[]", '{"design": 1}', "{}"])
def test_a_summary_without_a_design_is_refused(text: str, tmp_path: Path) -> None:
    folder = tmp_path / "plane"
    shutil.copytree(FOLDERS / "plane", folder)
    (folder / "summary.json").write_text(text, encoding="utf-8")
    with pytest.raises(swgpar.OutputError, match="cannot read .*summary.json: ") as refusal:
        swgpar.open_result(folder)
    assert len(str(refusal.value).splitlines()) == 1
