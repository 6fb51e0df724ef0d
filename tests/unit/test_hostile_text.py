"""Texts of a user in messages and tables: no control characters, no formulas, no folders
elsewhere."""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import pytest

from support.commands import execute, swgpar
from support.messages import Messages
from support.paths import DESIGN
from swgpar.errors import LONGEST, InputError, printable
from swgpar.input.toml_file import apply_overrides
from swgpar.log import logger
from swgpar.meshing import load_recipe
from swgpar.results.table import format_csv, read_columns
from swgpar.studies.spec import LONGEST_NAME, folder_name

ESCAPE = "\x1b]0;title\x07\x1b[31m"


def test_errors_are_printable_and_short() -> None:
    message = str(InputError(f"key {ESCAPE} = \u202e\x9b\udcff\nis bad: " + 5000 * "x"))
    assert message.isprintable() and len(message) == LONGEST
    assert r"key \x1b]0;title\x07\x1b[31m = \u202e\x9b\udcff is bad: xxx" in message
    assert printable("5 N·mm, größer, 齿轮\n") == "5 N·mm, größer, 齿轮\n"


def test_the_log_is_printable() -> None:
    with Messages() as messages:
        logger.info("figure %s", ESCAPE)
        logger.warning("50 %% of %d", 3)
    assert messages.texts == [f"figure {printable(ESCAPE)}", "50 % of 3"]


@pytest.mark.parametrize(
    "arguments",
    [
        ("check", DESIGN, "--set", f"drive.{ESCAPE}=1"),
        ("check", DESIGN, "--set", f"drive.layout={ESCAPE}"),
        ("check", f"{ESCAPE}.toml"),
        ("check", DESIGN, f"--{ESCAPE}"),
        ("check", DESIGN, "--mesh", ESCAPE),
        (ESCAPE,),
    ],
)
def test_commands_print_no_control_characters(arguments: tuple[object, ...]) -> None:
    done = execute(swgpar(*arguments), timeout=120.0)
    assert done.returncode == 2 and done.stderr.removesuffix("\n").isprintable() and not done.stdout


def test_names_longer_than_a_file_system_takes_are_no_recipes() -> None:
    with pytest.raises(InputError, match="mesh = .* is not available"):
        load_recipe(5000 * "x")
    with pytest.raises(InputError, match="cannot be read"):
        load_recipe(5000 * "x" + ".toml")


def test_long_keys_are_shortened() -> None:
    key = "drive." + 5000 * "k"
    with pytest.raises(InputError) as caught:
        apply_overrides({"drive": {5000 * "k": 1}}, {f"{key}.x": 1})
    assert len(str(caught.value)) < 300
    done = execute(swgpar("check", DESIGN, "--set", f"{key}=1"), timeout=120.0)
    assert (
        done.returncode == 2
        and "drive.kkk" in done.stderr
        and "..." in done.stderr
        and len(done.stderr) < 500
    )


def test_tables_hold_no_formulas(tmp_path: Path) -> None:
    texts = ["=1+1", "+A1", "-A1", "@SUM(A1)", "-1.5", "+2e3", "-inf", "plain", "a=b", "\tx"]
    path = tmp_path / "table.csv"
    path.write_bytes(format_csv([{"=key": text, "value": -1.5} for text in texts]))
    with open(path, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header == ["'=key", "value"]
    shown = [
        "'=1+1",
        "'+A1",
        "'-A1",
        "'@SUM(A1)",
        "-1.5",
        "+2e3",
        "-inf",
        "plain",
        "a=b",
        r"\t" + "x",
    ]
    assert [row[0] for row in rows] == shown
    assert (read_columns(path)["value"] == -1.5).all()


@pytest.mark.parametrize(
    "text", ["..", ".", "...", "/tmp/evil=1", "a/../../b", "-x", "a\nb", "~", "=1", 300 * "long"]
)
def test_names_of_folders_stay_inside(tmp_path: Path, text: str) -> None:
    name = folder_name(text)
    assert (
        (tmp_path / name).resolve().parent == tmp_path
        and len(name) <= LONGEST_NAME
        and name.isprintable()
    )
    (tmp_path / name).mkdir()


def test_folder_names_are_kept_where_they_fit() -> None:
    for name in ("torque=5.0_teeth=120", "c_P=0.9,1.1", "Größe_1", 100 * "x"):
        assert folder_name(name) == name
    assert folder_name(101 * "x") != folder_name(102 * "x")


def test_a_recipe_of_the_package_is_not_taken_from_the_working_directory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = load_recipe("plane_coarse")
    (tmp_path / "plane_coarse").write_text("nonsense", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert load_recipe("plane_coarse") == expected


def test_matplotlib_takes_no_settings_of_the_working_directory(tmp_path: Path) -> None:
    (tmp_path / "matplotlibrc").write_text("lines.linewidth: 77\n", encoding="utf-8")
    code = (
        "from swgpar.results.figure_set import import_matplotlib; import_matplotlib(); "
        "import matplotlib, os; print(matplotlib.rcParams['lines.linewidth'], os.getcwd())"
    )
    command = [sys.executable, "-P", "-c", code]
    assert execute(command, cwd=tmp_path, timeout=120.0).stdout.split() == ["1.5", str(tmp_path)]
