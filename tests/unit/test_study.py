"""Study files: expansion into cases, refusals in one sentence, error estimates, comparison with
published values."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

import swgpar
from support.html_text import assert_needs_nothing_else
from support.paths import DATA, DESIGN, RECIPE, ROOT
from support.stepping import small
from support.study_files import assert_refused, jobs_of
from swgpar.analysis.error_estimate import estimate
from swgpar.errors import InputError
from swgpar.evaluation.step_values import step_values
from swgpar.presentation.drive_result import DriveResult
from swgpar.results.table import format_csv
from swgpar.run_options import RunOptions
from swgpar.studies.case import Outcome
from swgpar.studies.figures import over_angle, over_key
from swgpar.studies.job import read_status, run_one
from swgpar.studies.report import make_report
from swgpar.studies.spec import load_study
from swgpar.studies.study import queue
from swgpar.studies.table import compare_cases, study_rows
from swgpar.systems.drive import DRIVE, Drives

MESHES = f'meshes = ["{RECIPE}"]'
Write = Callable[..., Path]


@pytest.fixture
def study_file(tmp_path: Path) -> Write:
    """Function that writes a study of the small drive: further lines of [study], then the rest of
    the file."""

    def write(rest: str = "", *, meshes: str = MESHES, more: str = "") -> Path:
        path = tmp_path / "study.toml"
        path.write_text(f'[study]\ndesign = "{DESIGN}"\n{meshes}\n{more}\n{rest}', encoding="utf-8")
        return path

    return write


def test_grid_and_sweep(study_file: Write) -> None:
    vary = '[study.vary]\n"load.torque" = [1.0, 2.0]\nwave_generator.C = [0.9, 1.0]\n'
    grid = jobs_of(study_file(vary))
    assert [j.case.name for j in grid] == [f"torque={t}_C={c}" for t in (1, 2) for c in (0.9, 1)]
    assert [(j.case.design.load.torque, j.case.design.wave_generator.C) for j in grid] == [
        (1.0, 0.9),
        (1.0, 1.0),
        (2.0, 0.9),
        (2.0, 1.0),
    ]
    sweep = jobs_of(study_file(vary, more='mode = "sweep"'))
    assert [j.case.name for j in sweep] == ["torque=1_C=0.9", "torque=2_C=1"]


def test_one_design_on_two_meshes(study_file: Write, tmp_path: Path) -> None:
    finer = tmp_path / "finer.toml"
    finer.write_text((RECIPE).read_text(encoding="utf-8"), encoding="utf-8")
    jobs = jobs_of(study_file(meshes=f'meshes = ["{RECIPE}", "finer.toml"]'))
    assert [(j.case.name, j.mesh.stem, j.finer) for j in jobs] == [
        ("small", "tiny", 1),
        ("small", "finer", 0),
    ]
    assert queue(jobs, [None, None]) == [1, 0]
    assert queue(jobs, [None, "failed"]) == [0, 1]
    assert jobs[0].folder(Path("out")) == Path("out/cases/small/tiny")


def test_cases_with_sections_and_own_overrides(study_file: Write) -> None:
    jobs = jobs_of(
        study_file(
            "[[study.case]]\nname = 'plain'\n"
            "[[study.case]]\nname = 'simplified'\nset = ['load.torque=3.0']\nnote = 'x'\n"
            "section.wave_generator = { type = 'simplified', C = 0.97, face_width = 4.0 }\n"
            "[study.vary]\nwave_generator.C = [0.95]\n",
            more='set = ["load.torque=1.0", "output.figures=true"]',
        )
    )
    plain, simplified = (job.case.design for job in jobs)
    assert (plain.load.torque, plain.wave_generator.type) == (1.0, "elliptical")
    assert (simplified.load.torque, simplified.wave_generator.type) == (3.0, "simplified")
    assert simplified.wave_generator.C == 0.95
    assert not plain.output.fields and plain.output.figures
    assert [job.case.name for job in jobs] == ["plain_C=0.95", "simplified_C=0.95"]


def test_whole_sections_are_varied(study_file: Write) -> None:
    jobs = jobs_of(
        study_file(
            "[study.vary]\nwave_generator = [{ face_width = 4.0 }, { type = 'simplified', "
            "face_width = 4.0 },"
            " { type = 'simplified', C = 0.9, face_width = 4.0 }]\n"
        )
    )
    names = [job.case.name for job in jobs]
    assert names == [
        "wave_generator=1",
        "wave_generator=simplified-2",
        "wave_generator=simplified-3",
    ]
    row = study_rows([(jobs[2], Outcome("failed", "no"))])[0]
    assert row["wave_generator"] == '{ type = "simplified", C = 0.9, face_width = 4.0 }'


def test_a_refused_design_is_a_case(study_file: Write) -> None:
    jobs = jobs_of(study_file("[study.vary]\nload.torque = [-1.0, 2.0]\n"))
    assert [job.case.design is None for job in jobs] == [True, False]
    assert jobs[0].case.refusal == "load.torque = -1 is out of range: allowed 0 to 1000000000 N·m"
    with pytest.raises(
        InputError, match="every case is refused: load.torqe.*did you mean load.torque"
    ):
        jobs_of(study_file("[study.vary]\nload.torqe = [1.0, 2.0]\n"))


@pytest.mark.parametrize(
    ("rest", "more", "words"),
    [
        ("", "titel = 'x'", "did you mean study.title?"),
        ("", "title = 3", "study.title = 3 is not a text: allowed title of the report"),
        ("", "set = 3", "study.set = 3 is not a list of texts"),
        ("", "set = [3]", "study.set = 3 is not a list of texts"),
        ("", "set = ['torque=3']", "write section.key=value"),
        ("", "mode = 'random'", 'allowed "grid" or "sweep"'),
        ("", "parallel = 'all'", 'allowed "cases" or "ranks"'),
        ("[stdy]\n", "", "stdy = an empty table is not a section of a study file: allowed [study]"),
        (
            "[study.vary]\nload.torque = 3.0\n",
            "",
            'study.vary."load.torque" = 3 is not a list of values',
        ),
        ("[study.vary]\nload.torque = []\n", "", "allowed one value or more"),
        ("[study.vary]\ntorque = [1.0]\n", "", 'allowed "section.key"'),
        ("[study.vary]\nload.torque = [1.0]\nload = [1.0, 2.0]\n", "", "TOML"),
        ("[study.vary]\nload.torque = [1.0]\n'load' = [{}]\n", "", "TOML"),
        (
            "[study.vary]\n'load.torque' = [1.0]\n'load' = [{ torque = 1.0 }]\n",
            "",
            "allowed is one of both",
        ),
        (
            "[study.vary]\nload.torque = [1.0]\nmaterial.nu = [0.3, 0.2]\n",
            "mode = 'sweep'",
            "material.nu has 2",
        ),
        ("[study.vary]\nload.torque = [1.0, 1.0]\n", "", '"torque=1" is the name of two cases'),
        ("[study]\n", "", "TOML"),
        ("[study.case]\nname = 'a'\n", "", "write [[study.case]]"),
        ("[[study.case]]\n", "", "[[study.case]] 1: case.name is missing: give a text"),
        ("[[study.case]]\nname = 'a'\nsett = 1\n", "", "did you mean case.set?"),
        ("[[study.case]]\nname = 'a/b'\n", "", "names no folder"),
        ("[[study.case]]\nname = 'a'\nset = ['x']\n", "", "write section.key=value"),
        ("[[study.case]]\nname = 'a'\nsection.load = 3\n", "", "section.load = 3 is not a section"),
        ("[[study.case]]\nname = 'a'\npublished.mean.fs_s9 = 3\n", "", "did you mean mean.fs_s"),
        (
            "[[study.case]]\nname = 'a'\npublished = 3\n",
            "",
            "case.published = 3 is not a table of numbers",
        ),
        (
            "[[study.case]]\nname = 'a'\npublished.mean.fs_s1 = 'x'\n",
            "",
            "is not a table of numbers",
        ),
        ("[[study.case]]\nname = 'a'\ntolerance.mean.fs_s1 = 3\n", "", "has no published value"),
        (
            "[[study.case]]\nname = 'a'\npublished.mean.fs_s1 = 1\ntolerance.mean.fs_s1 = 0\n",
            "",
            "out of range: allowed above 0",
        ),
        (
            "[[study.case]]\nname = 'a'\n[[study.case]]\nname = 'a'\n",
            "",
            '"a" is the name of two cases',
        ),
        (
            "[[study.case]]\nname = 'a'\nset = ['load.torque=1.0']\n[study.vary]\nload.torque = "
            "[1.0]\n",
            "",
            "allowed in one of both",
        ),
    ],
)
def test_a_wrong_study_file_is_refused_in_one_sentence(
    study_file: Write, rest: str, more: str, words: str
) -> None:
    assert_refused(study_file(rest, more=more), words)


@pytest.mark.parametrize(
    ("meshes", "words"),
    [
        ("meshes = []", "study.meshes = [] is empty"),
        ("", "study.meshes is missing: give a list of texts"),
        ("meshes = ['none.toml']", "none.toml cannot be read"),
        (f"meshes = ['{DATA / 'small.toml'}']", "is not a section of a mesh recipe"),
        (f"meshes = ['{DATA / 'tiny.toml'}', '{DATA / 'tiny.toml'}']", "have a name twice"),
    ],
)
def test_wrong_meshes_are_refused(study_file: Write, meshes: str, words: str) -> None:
    with pytest.raises(InputError, match="study.toml") as caught:
        jobs_of(study_file(meshes=meshes))
    assert words in str(caught.value)


def test_the_example_of_the_documentation(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "howto" / "studies.md").read_text(encoding="utf-8")
    example = text.partition("```toml\n")[2].partition("```")[0]
    path = tmp_path / "study.toml"
    path.write_text(
        example.replace("../..", str(ROOT)).replace("../", f"{ROOT / 'drivers'}/"), encoding="utf-8"
    )
    jobs = jobs_of(path)
    assert len(jobs) == 8 and all(job.case.design is not None for job in jobs)
    assert (jobs[0].case.name, jobs[-1].case.name) == (
        "elliptical_torque=10",
        "simplified_torque=20",
    )


class Broken(Drives):
    """Drives whose runs end in an error that is no error of swgpar."""

    def run(self, *_: object, **__: object) -> DriveResult:
        raise ZeroDivisionError("by nothing")


def test_an_unforeseen_error_is_the_case_s_own(study_file: Write, tmp_path: Path) -> None:
    (job,) = jobs_of(study_file())
    job = replace(job, case=replace(job.case, system=Broken()))
    options = RunOptions(tmp_path / "a" / "b", recipe=job.recipe, comm=MPI.COMM_SELF)
    found = run_one(job.case.system, job.case.design, options)
    assert (found.status, found.reason) == ("failed", "ZeroDivisionError: by nothing")
    assert read_status(tmp_path / "a" / "b")["reason"] == found.reason


def test_a_run_begins_anew_where_more_is_asked_of_its_loaded_state(tmp_path: Path) -> None:
    """Windows belong to the loaded state, from which a checkpoint has gone on."""
    design = small("plane", "steps.rotation=0")
    options = RunOptions(tmp_path, recipe=swgpar.load_mesh(RECIPE), comm=MPI.COMM_SELF)
    first = run_one(DRIVE, design, options)
    again = run_one(
        DRIVE,
        design.with_values({"output.root_stress": True}),
        replace(options, restart=True),
    )
    assert first.status == again.status == "finished"
    assert "root.s1" not in first.values and again.values["root.s1"] > 0.0


@pytest.mark.parametrize("dimensions", [2, 3])
def test_error_estimate_of_a_linear_sequence(dimensions: int) -> None:
    """Values f + c h give f, whatever the ratio of the meshes."""
    exact, slope = 300.0, -7.0
    numbers = [(n, exact + slope * n ** (-1.0 / dimensions)) for n in (1000, 3375, 20000)]
    for (n1, f1), (n2, f2) in zip(numbers, numbers[1:]):
        found = estimate(f1, f2, n1, n2, dimensions)
        assert found.converged == pytest.approx(exact, abs=1e-10)
        assert found.error == pytest.approx(abs(f2 - exact), abs=1e-10)
    assert estimate(1.0, 2.0, 1000, 1000, dimensions) is None


def outcome(fs_s1: float, elements: int) -> Outcome:
    stresses = {
        "fs_s1": np.array([2.0, 3.0, 2.0, 2.0]) * fs_s1,
        "fs_s3": np.ones(4),
        "fs_vm": np.ones(4),
    }
    columns = {
        "step": np.array([1, 1, 3, 4]),
        "wg_angle_deg": np.array([0.0, 0.0, 0.0, 2.0]),
        **stresses,
    }
    means = dict.fromkeys(
        ("fs_s1", "fs_s3", "fs_vm", "rg_s1", "rg_s3", "rg_vm", "wg_torque_Nmm"), fs_s1
    )
    rows = [
        dict(zip(columns, row)) for row in zip(*(values.tolist() for values in columns.values()))
    ]
    found = {f"mean.{name}": value for name, value in means.items()} | dict(
        step_values(rows).values
    )
    return Outcome(
        "finished", values=found, elements=elements, newton_mean=5.0, wall_s=1.0, history=columns
    )


def test_published_values(study_file: Write) -> None:
    published = (
        "published = { mean.fs_s1 = 200.0, step1.fs_s1 = 500.0, step2.fs_s1 = 1.0, mean.fs_vm = "
        "210.0 }"
    )
    (job,) = jobs_of(
        study_file(
            f"[[study.case]]\nname = 'a'\n{published}\n"
            "tolerance = { mean.fs_s1 = 5.5, step1.fs_s1 = 5.0, step2.fs_s1 = 5.0 }\n"
        )
    )
    (failed, *_) = compare_cases([(job, Outcome("failed", "no"))])
    assert (failed.computed, failed.error_estimate, failed.verdict) == (None, None, "MISS")
    job = replace(job, case=replace(job.case, meshes=(job.mesh, Path("fine.toml")), compared=1))
    coarse = replace(job, finer=1)
    rows = {
        c.quantity: c
        for c in compare_cases([(coarse, outcome(180.0, 1000)), (job, outcome(210.0, 8000))])
    }
    inside, without, miss, never = (
        rows[n] for n in ("mean.fs_s1", "mean.fs_vm", "step1.fs_s1", "step2.fs_s1")
    )
    assert (inside.quantity, inside.unit, inside.computed, inside.difference_percent) == (
        "mean.fs_s1",
        "MPa",
        210.0,
        5.0,
    )
    assert inside.verdict == "inside"
    assert inside.converged == pytest.approx(240.0)
    assert inside.error_estimate == pytest.approx(30.0)
    assert (miss.computed, miss.difference_percent, miss.verdict) == (630.0, 26.0, "MISS")
    assert (never.computed, never.difference_percent, never.verdict) == (None, None, "MISS")
    assert (without.difference_percent, without.verdict) == (0.0, "")
    job, coarse = (replace(j, case=replace(j.case, compared=0)) for j in (job, coarse))
    first, *_ = compare_cases([(coarse, outcome(180.0, 1000)), (job, outcome(210.0, 8000))])
    assert (first.mesh, first.computed) == (job.mesh.stem, 180.0)
    assert first.error_estimate == pytest.approx(60.0)


def test_tables_and_report(study_file: Write, tmp_path: Path) -> None:
    path = study_file("[study.vary]\nload.torque = [1.0, 2.0, 3.0]\n", more="title = 'T < 4'")
    jobs = jobs_of(path)
    failed = Outcome("failed", "the <sun>, and the moon")
    results = list(zip(jobs, [outcome(100.0, 10), outcome(1.0 / 3.0, 10), failed]))
    rows = list(csv.DictReader(io.StringIO(format_csv(study_rows(results)).decode())))
    assert [row["status"] for row in rows] == ["finished", "finished", "failed"]
    assert float(rows[1]["mean.fs_s1"]) == 1.0 / 3.0 and rows[2]["mean.fs_s1"] == ""
    assert [float(row["load.torque"]) for row in rows] == [1.0, 2.0, 3.0]
    assert rows[2]["reason"] == "the <sun>, and the moon"
    page = make_report(load_study(path), results, [], tmp_path).decode()
    assert "T &lt; 4" in page and "the &lt;sun&gt;" in page and "<sun>" not in page
    assert page.count("data:image/png;base64,") == 2
    assert_needs_nothing_else(page)


def test_many_lines_take_several_figures(study_file: Write) -> None:
    jobs = jobs_of(
        study_file("[study.vary]\nload.torque = [1.0, 2.0]\nmaterial.nu = [" + list_of(15) + "]\n")
    )
    results = [(job, outcome(100.0, 10)) for job in jobs]
    assert len(list(over_angle(results))) == 3
    assert len(list(over_key(results, "load.torque", in_step=False))) == 2
    assert len(list(over_key(results, "material.nu", in_step=False))) == 1


def list_of(count: int) -> str:
    return ", ".join(f"{0.2 + 0.01 * k:.2f}" for k in range(count))
