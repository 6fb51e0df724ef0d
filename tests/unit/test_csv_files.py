"""CSV files of a user: what is not read as it stands there is refused with its line."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN
from swgpar.design.deviations import read_column
from swgpar.errors import InputError
from swgpar.input.curve_file import read_curve, read_rows
from swgpar.input.toml_file import read_toml


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("pitch\n1,5\n2,5\n", "row 2 has 2 values and the header has 1"),
        ("tooth,pitch\n1,1.5\n2,2,5\n", "row 3 has 3 values and the header has 2"),
        ("pitch,pitch\n1,2\n", 'two columns "pitch"'),
        ("pitch\n" + 140_000 * "1" + "\n", "it is no CSV file with a header"),
        ("tooth;pitch\n1;1\n", "is not a column of"),
    ],
    ids=["decimal comma", "longer row", "doubled name", "long field", "semicolons"],
)
def test_columns_are_refused(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "pitch.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        read_column(str(path), "pitch")


def test_a_byte_order_mark_is_no_part_of_the_first_name(tmp_path: Path) -> None:
    path = tmp_path / "pitch.csv"
    path.write_bytes("pitch,tooth\n1.5,1\n2.5,2\n".encode("utf-8-sig"))
    assert read_column(str(path), "pitch") == [1.5, 2.5]


def test_points_with_decimal_commas(tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    path.write_text("x;y\n1,5;2,25\n 2,5 ; 3\n", encoding="utf-8")
    assert np.array_equal(read_curve(path), [[1.5, 2.25], [2.5, 3.0]])
    path.write_text("1.5, 2.25\n2.5,\t3\n", encoding="utf-8")
    assert np.array_equal(read_curve(path), [[1.5, 2.25], [2.5, 3.0]])
    # two kinds of separators: 1.5 and 2, or 1, 5 and 2
    for line in ("1,5 2\n", "1,5\t2,5\n", "1 2;3\n"):
        path.write_text(line, encoding="utf-8")
        with pytest.raises(InputError, match="no point"):
            read_rows(path, None, {2, 3})


def test_pipes_and_devices_are_refused(tmp_path: Path) -> None:
    for name in ("design.toml", "points.csv", "drawing.dxf"):
        os.mkfifo(tmp_path / name)
    words = "it is a pipe or a device"
    for path in (tmp_path / "design.toml", Path("/dev/zero"), Path("/dev/null")):
        with pytest.raises(InputError, match=words):
            read_toml(path)
    for name in ("points.csv", "drawing.dxf"):
        with pytest.raises(InputError, match=words):
            read_curve(tmp_path / name)
    with pytest.raises(InputError, match=words):
        read_column(str(tmp_path / "points.csv"), "")
    with pytest.raises(InputError, match=words):
        swgpar.check(DESIGN, mesh=tmp_path / "design.toml")
