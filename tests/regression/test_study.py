"""A study of the small drive through the command: ranks, failures, kill and restart."""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import pytest

from support.commands import execute, kill_after, on_ranks, succeed, swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE

GOOD, FAILING = ("a_torque=0.1", "a_torque=0.2"), ("b_torque=0.1", "b_torque=0.2")
SET = [*PLANE, "steps.rotation=2.0", "steps.increment=2.0"]


def study_file(folder: Path, more: str = "", torques: str = "[0.1, 0.2]", bad: bool = True) -> Path:
    path = folder / "study.toml"
    text = f'[study]\ndesign = "{DESIGN}"\nmeshes = ["{RECIPE}"]\nset = {SET}\n'
    text += f"{more}\n[study.vary]\nload.torque = {torques}\n[[study.case]]\nname = 'a'\n"
    text += "published.mean.fs_s1 = 1897.0\ntolerance.mean.fs_s1 = 2.0\n"
    if bad:
        text += (
            "[[study.case]]\nname = 'b'\nset = ['solver.max_iterations=1', "
            "'solver.max_cutbacks=0']\n"
        )
    path.write_text(text, encoding="utf-8")
    return path


def study_command(path: Path, out: Path, *more: str, ranks: int = 1) -> list[str]:
    return on_ranks(ranks) + swgpar("study", path, "--out", out, *more)


def table(out: Path, name: str = "study.csv") -> list[dict[str, str]]:
    with open(out / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def assert_same_table(out: Path, other: Path) -> None:
    left, right = table(out), table(other)
    assert [row["case"] for row in left] == [row["case"] for row in right]
    for a, b in zip(left, right):
        for name, value in a.items():
            if name.startswith("mean.") and value:
                assert float(value) == pytest.approx(float(b[name]), rel=1e-8), (a["case"], name)
            elif name not in (
                "wall_s",
                "newton_mean",
            ):  # round-off on other ranks may cost an iteration
                assert value == b[name], (a["case"], name)


def status(out: Path, case: str) -> dict:
    return json.loads((out / "cases" / case / "tiny" / "status.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An uninterrupted study on one rank, two of whose four cases fail."""
    folder = tmp_path_factory.mktemp("study")
    done = execute(study_command(study_file(folder), folder / "out"))
    assert (
        done.returncode == 5
        and "2 of 4 runs failed" in done.stderr
        and "Traceback" not in done.stderr
    )
    lines = [line for line in done.stdout.splitlines() if line[1:3] == "/4"]
    assert len(lines) == 4 and sum("Newton iterations  finished" in line for line in lines) == 2
    assert "deflect" not in "".join(
        line for line in done.stdout.splitlines() if "failed" not in line
    )
    return folder / "out"


def test_a_failing_case_does_not_stop_the_others(whole: Path) -> None:
    rows = {row["case"]: row for row in table(whole)}
    assert list(rows) == [*GOOD, *FAILING]
    assert all(
        rows[name]["status"] == "finished" and float(rows[name]["mean.fs_s1"]) > 0.0
        for name in GOOD
    )
    for name in FAILING:
        assert rows[name]["status"] == "failed" and "did not converge" in rows[name]["reason"]
        assert status(whole, name)["reason"] == rows[name]["reason"]
    assert [row["verdict"] for row in table(whole, "published.csv")] == ["inside", "inside"]
    page = (whole / "study.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 2 and "did not converge" in page


def test_two_ranks_give_the_same(whole: Path, tmp_path: Path) -> None:
    done = execute(study_command(study_file(tmp_path), tmp_path / "out", ranks=2))
    assert done.returncode == 5
    assert_same_table(tmp_path / "out", whole)
    log = (tmp_path / "out/cases" / GOOD[0] / "tiny/run.log").read_text(encoding="utf-8")
    assert log.count("; 1 rank\n") == 1


def test_kill_and_restart(whole: Path, tmp_path: Path) -> None:
    path, out = study_file(tmp_path), tmp_path / "out"
    kill_after(study_command(path, out), out / "cases" / GOOD[1] / "tiny", rows=2)
    assert (
        status(out, GOOD[0])["status"] == "finished" and status(out, GOOD[1])["status"] == "started"
    )
    page = (out / "study.html").read_text(encoding="utf-8")  # of what is there
    assert "3 more runs have not ended" in page and [row["case"] for row in table(out)] == [GOOD[0]]
    assert [row["verdict"] for row in table(out, "published.csv")] == ["inside"]
    refused = execute(study_command(path, out))
    assert refused.returncode == 4 and "--restart" in refused.stderr
    done = execute(study_command(path, out, "--restart", ranks=2))
    assert done.returncode == 5
    assert done.stdout.count("finished before") == 1
    assert "restarted after increment" in (out / "cases" / GOOD[1] / "tiny/run.log").read_text(
        encoding="utf-8"
    )
    assert_same_table(out, whole)


def test_all_ranks_on_one_case(whole: Path, tmp_path: Path) -> None:
    path, out = study_file(tmp_path, "parallel = 'ranks'", "[0.2]"), tmp_path / "out"
    done = execute(study_command(path, out, ranks=2))
    assert done.returncode == 5
    log = (out / "cases" / GOOD[1] / "tiny/run.log").read_text(encoding="utf-8")
    assert "2 ranks" in log
    (row, failed), (expected,) = table(out), [row for row in table(whole) if row["case"] == GOOD[1]]
    assert float(row["mean.fs_s1"]) == pytest.approx(float(expected["mean.fs_s1"]), rel=1e-8)
    assert failed["status"] == "failed"
    # only what changed is computed: a repaired case begins anew, a finished one is kept
    path.write_text(
        path.read_text(encoding="utf-8").replace("max_iterations=1'", "max_iterations=25'")
    )
    done = succeed(study_command(path, out, "--restart"))
    assert done.stdout.count("finished before") == 1
    assert [row["status"] for row in table(out)] == ["finished", "finished"]


def test_a_finished_case_is_not_replaced_by_another_design(whole: Path, tmp_path: Path) -> None:
    path, out = study_file(tmp_path, torques="[0.2]", bad=False), tmp_path / "out"
    shutil.copytree(whole, out)
    path.write_text(
        path.read_text(encoding="utf-8").replace("steps.increment=2.0", "steps.increment=1.0")
    )
    before = (out / "cases" / GOOD[1] / "tiny/history.csv").read_bytes()
    done = execute(study_command(path, out, "--restart"))
    assert done.returncode == 5 and "results of another design" in table(out)[0]["reason"]
    assert (out / "cases" / GOOD[1] / "tiny/history.csv").read_bytes() == before
    assert status(out, GOOD[1])["status"] == "finished"


def test_a_wrong_study_file_is_refused_on_all_ranks(tmp_path: Path) -> None:
    path = study_file(tmp_path, "titel = 'x'")
    done = execute(study_command(path, tmp_path / "out", ranks=2), timeout=120.0)
    assert done.returncode == 2 and not (tmp_path / "out").exists()
    (sentence,) = done.stderr.splitlines()
    assert sentence.endswith("did you mean study.title?")
