"""Files of a results folder that were cut off or changed: a sentence that names the file, or the
result as it was."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

import swgpar
from support.paths import DESIGN, DRIVERS, RECIPE
from support.small_drive import PLANE
from support.small_trains import SMALL
from swgpar.api.runs import save_report
from swgpar.errors import SwgparError
from swgpar.presentation.drive_result import DriveResult

LOOP = (
    *PLANE,
    "steps.rotation=0",
    "stiffness.torque=0.2",
    "stiffness.positions=1",
    "stiffness.mesh_error=false",
    "output.figures=false",
    "output.fields=true",
)


@pytest.fixture(scope="module")
def loop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("loop") / "run"
    swgpar.run(swgpar.load_design(DESIGN, LOOP), RECIPE, out)
    return out


@pytest.fixture(scope="module")
def train(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("train") / "run"
    overrides = [*SMALL["gear_pair"], "output.figures=false"]
    swgpar.run(swgpar.load_design(DRIVERS / "gear_pair.toml", overrides), out=out)
    return out


def damages(content: bytes) -> Iterator[bytes]:
    """The content cut off and changed in many ways."""
    lines = content.splitlines(keepends=True)
    yield b""
    for share in (0.01, 0.3, 0.7, 0.99):
        yield content[: int(share * len(content))]
    yield b"".join(lines[:-1])
    yield b"".join(lines[:1])
    yield b"".join([*lines, lines[-1]])
    yield content.replace(b",", b";")
    yield content.replace(b"1", b"x")
    yield content[:40] + 140_000 * b"7" + content[40:]
    yield content[:60] + b"\xff\x00" + content[60:]


def use(folder: Path, out: Path) -> None:
    """All that reads a result."""
    result = swgpar.open_result(folder)
    for answer in result.summary.values():
        assert answer.value is None or answer.value == answer.value
    result.plot.save(folder)
    save_report(result, folder)
    if isinstance(result, DriveResult):
        swgpar.export(result, out, ["lookup", "parquet"], overwrite=True)


@pytest.mark.parametrize("kind", ["loop", "train"])
def test_every_damage_has_a_sentence(
    request: pytest.FixtureRequest, kind: str, tmp_path: Path
) -> None:
    whole, folder = request.getfixturevalue(kind), tmp_path / "run"
    refused = {}
    names = ["history.csv", "program.csv", "pairs.csv", "history.json", "summary.json"]
    names += [str(path.relative_to(whole)) for path in whole.glob("tables/*.csv")]
    for name in [name for name in names if (whole / name).exists()]:
        for content in damages((whole / name).read_bytes()):
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(whole, folder)
            (folder / name).write_bytes(content)
            try:
                use(folder, tmp_path / "export")
            except SwgparError as error:
                assert str(error).isprintable() and str(folder) in str(error)
                refused[name] = refused.get(name, 0) + 1
    assert set(refused) >= {"history.csv", "summary.json"} and min(refused.values()) >= 5


@pytest.mark.parametrize("name", ["history.csv", "program.csv"])
def test_a_table_that_lacks_rows_is_named(loop: Path, tmp_path: Path, name: str) -> None:
    shutil.copytree(loop, tmp_path / "run")
    file = tmp_path / "run" / name
    file.write_bytes(b"".join(file.read_bytes().splitlines(keepends=True)[:-1]))
    with pytest.raises(SwgparError, match=rf"{name} has \d+ rows, and the run wrote \d+"):
        swgpar.open_result(tmp_path / "run")


def test_damaged_fields_have_a_sentence(loop: Path, tmp_path: Path) -> None:
    for name in ("fields.h5", "fields/mesh.h5", "fields/increment_0001.h5"):
        folder = tmp_path / name.replace("/", "_")
        shutil.copytree(loop, folder)
        content = (folder / name).read_bytes()
        (folder / name).write_bytes(content[: len(content) // 2])
        with pytest.raises(SwgparError, match=f"cannot read {folder}") as caught:
            swgpar.open_result(folder).grid(0)
        assert "h5py" not in str(caught.value) and "errno" not in str(caught.value)


def test_results_of_another_version_say_what_to_do(loop: Path, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    shutil.copytree(loop, folder)
    content = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    content["versions"]["swgpar"] = "99.0"
    for change, words in (
        ({"format": 9}, "written by swgpar 99.0 in the format 9: allowed are formats 1 to 2"),
        ({"rotation": "x"}, "written by swgpar 99.0, and swgpar .* does not read its content"),
    ):
        (folder / "summary.json").write_text(json.dumps({**content, **change}), encoding="utf-8")
        with pytest.raises(SwgparError, match=words):
            swgpar.open_result(folder)
