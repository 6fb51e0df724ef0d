"""Files of a user in a results folder: no run removes or replaces what no run has made there, and
none writes through a link."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import swgpar
from support.optimisation import OPTIMISATION
from support.paths import DESIGN, DRIVERS, RECIPE
from support.small_drive import PLANE
from support.small_trains import SMALL
from swgpar.errors import OutputError
from swgpar.results import lock, made_files
from swgpar.results.folder import CHECKPOINT
from swgpar.results.folder import RECIPE as RECIPE_NAME

SHORT = (*PLANE, "steps.rotation=2.0", "steps.increment=2.0", "output.figures=false")


def pair(out: Path, **options: bool) -> None:
    overrides = [*SMALL["gear_pair"], "output.figures=false"]
    design = swgpar.load_design(DRIVERS / "gear_pair.toml", overrides)
    swgpar.run(design, out=out, **options)


def drive(out: Path, recipe: Path = RECIPE, **options: bool | float) -> None:
    swgpar.run(swgpar.load_design(DESIGN, SHORT), recipe, out, **options)


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("finished") / "run"
    drive(out)
    return out


def test_a_recipe_in_the_folder_stays(finished: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    shutil.copytree(finished, out)
    shutil.copy(RECIPE, out / RECIPE_NAME)
    drive(out, out / RECIPE_NAME, overwrite=True)
    assert (out / RECIPE_NAME).read_bytes() == RECIPE.read_bytes()
    # a run that chooses its mesh would write this file
    with pytest.raises(OutputError, match=f"{RECIPE_NAME} is there, and was not made by a run"):
        drive(out, out / RECIPE_NAME, overwrite=True, accuracy=0.2)
    assert (out / RECIPE_NAME).read_bytes() == RECIPE.read_bytes()
    assert (out / "summary.json").exists()


def test_a_recipe_that_a_run_has_made_and_that_is_read_stays(
    finished: Path, tmp_path: Path
) -> None:
    out = tmp_path / "run"
    shutil.copytree(finished, out)
    made_files.note(out / RECIPE_NAME)
    shutil.copy(RECIPE, out / RECIPE_NAME)
    with pytest.raises(OutputError, match="is read by this run, which would replace it"):
        drive(out, out / RECIPE_NAME, overwrite=True, accuracy=0.2)
    drive(out, out / RECIPE_NAME, overwrite=True)
    assert (out / RECIPE_NAME).read_bytes() == RECIPE.read_bytes()
    drive(out, overwrite=True)
    assert (out / RECIPE_NAME).exists()


def test_tables_of_a_user_stay(tmp_path: Path) -> None:
    out = tmp_path / "run"
    pair(out)
    made = {path.name for path in (out / "tables").iterdir()}
    own = out / "tables" / "own.csv"
    own.write_text("a\n1\n", encoding="utf-8")
    with pytest.raises(OutputError, match=r"own\.csv is there, and was not made by a run"):
        pair(out, overwrite=True)
    assert (out / "summary.json").exists() and own.exists()
    own.unlink()
    pair(out, overwrite=True)
    assert {path.name for path in (out / "tables").iterdir()} == made


@pytest.mark.parametrize("name", ["published.csv", "figures/own.png", "start_up.h5"])
def test_other_files_of_a_user_stay(finished: Path, tmp_path: Path, name: str) -> None:
    out = tmp_path / "run"
    shutil.copytree(finished, out)
    (out / name).parent.mkdir(exist_ok=True)
    (out / name).write_text("own", encoding="utf-8")
    (out / "notes.tmp").touch()
    if name == "published.csv":  # no drive writes it
        drive(out, overwrite=True)
    else:
        with pytest.raises(OutputError, match="was not made by a run"):
            drive(out, overwrite=True)
    assert (out / name).read_text(encoding="utf-8") == "own" and (out / "notes.tmp").exists()


@pytest.mark.parametrize("name", ["history.csv", "run.log", "summary.json", "pairs.csv"])
def test_a_file_of_a_user_is_not_replaced(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("own", encoding="utf-8")
    for options in ({"overwrite": True}, {}):
        with pytest.raises(OutputError):
            drive(tmp_path, **options)
    assert (tmp_path / name).read_text(encoding="utf-8") == "own"


@pytest.mark.parametrize(
    "name", [lock.NAME, lock.OWNER, made_files.LIST, "run.log", "history.csv", "pairs.csv"]
)
@pytest.mark.parametrize("run", [drive, pair])
def test_links_are_not_followed(tmp_path: Path, name: str, run: Callable[..., None]) -> None:
    target, out = tmp_path / "target", tmp_path / "out"
    target.write_text("own", encoding="utf-8")
    out.mkdir()
    (out / name).symlink_to(target)
    if run is pair and name == "pairs.csv":  # no gear train writes it
        run(out)
    else:
        with pytest.raises(OutputError):
            run(out, overwrite=True)
    assert target.read_text(encoding="utf-8") == "own" and (out / name).is_symlink()


@pytest.mark.parametrize("name", ["fields", "figures", "tables"])
def test_folders_that_are_links_are_refused(finished: Path, tmp_path: Path, name: str) -> None:
    out, elsewhere = tmp_path / "run", tmp_path / "elsewhere"
    shutil.copytree(finished, out)
    elsewhere.mkdir()
    for own in ("mesh.h5", "own.png", "own.csv", "left.swgpar.tmp"):
        (elsewhere / own).touch()
    (out / name).symlink_to(elsewhere)
    with pytest.raises(OutputError, match=f"{name} is a link"):
        drive(out, overwrite=True)
    assert len(list(elsewhere.iterdir())) == 4


def test_temporary_files_are_not_written_through_links(tmp_path: Path) -> None:
    from swgpar.results.atomic import TEMPORARY, write_file

    target = tmp_path / "target"
    target.write_text("own", encoding="utf-8")
    (tmp_path / f"table.csv{TEMPORARY}").symlink_to(target)
    write_file(tmp_path / "table.csv", b"new")
    assert target.read_text(encoding="utf-8") == "own"
    assert (tmp_path / "table.csv").read_bytes() == b"new"


def test_a_run_without_a_list_is_continued(finished: Path, tmp_path: Path) -> None:
    """Of a version that kept none."""
    out = tmp_path / "run"
    shutil.copytree(finished, out)
    (out / made_files.LIST).unlink()
    with pytest.raises(OutputError, match="no list of the files that runs have made"):
        drive(out, overwrite=True)
    drive(out, restart=True)
    assert made_files.names(out) >= {CHECKPOINT, "history.csv", "summary.json", "run.log"}


def test_files_beside_a_study_stay(tmp_path: Path) -> None:
    section = {
        "design": str(DRIVERS / "gear_pair.toml"),
        "set": [*SMALL["gear_pair"]],
        "vary": {"mesh.half_backlash": [10.0]},
    }
    swgpar.study({"study": section}, tmp_path)
    own = tmp_path / "cases" / "own"
    own.mkdir()
    (own / "status.json").write_text("{}", encoding="utf-8")
    (own / "history.csv").write_text("own", encoding="utf-8")
    swgpar.study({"study": section}, tmp_path, overwrite=True)
    assert (own / "status.json").exists() and (own / "history.csv").exists()
    made_files.remove(tmp_path, ["published.csv"])
    (tmp_path / "published.csv").write_text("own", encoding="utf-8")
    with pytest.raises(OutputError, match=r"published\.csv is there"):
        swgpar.study({"study": section}, tmp_path, overwrite=True)
    assert (tmp_path / "study.csv").exists()


def test_designs_of_a_user_beside_a_search_stay(tmp_path: Path) -> None:
    pytest.importorskip("optuna")
    file, out = tmp_path / "search.toml", tmp_path / "out"
    file.write_text(OPTIMISATION.replace("evaluations = 12", "evaluations = 2"), encoding="utf-8")
    swgpar.optimise(file, out)
    own = out / "best" / "evaluation_own.toml"
    own.write_text("own", encoding="utf-8")
    with pytest.raises(OutputError, match="was not made by a run"):
        swgpar.optimise(file, out, overwrite=True)
    assert own.exists() and (out / "optimise.csv").exists()
    own.unlink()
    swgpar.optimise(file, out, overwrite=True)


def test_a_folder_of_an_earlier_version_is_named_as_such(tmp_path: Path) -> None:
    (tmp_path / "history.csv").write_text("", encoding="utf-8")
    with pytest.raises(OutputError, match=r"no list of the files .* \(swgpar.files\)"):
        made_files.require_own(tmp_path, ["history.csv"])
