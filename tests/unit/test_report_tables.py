"""Tables of the reports of studies and optimisations: they scroll, headings have units, the best
comes first."""

from __future__ import annotations

import base64
import hashlib
import re
from pathlib import Path

import pytest

import swgpar
from support.html_text import Page, assert_needs_nothing_else
from support.optimisation import OPTIMISATION
from support.paths import DESIGN, RECIPE
from support.study_files import jobs_of
from swgpar.optimisation.problem import make_problem
from swgpar.optimisation.spec import load_specification
from swgpar.results.page import RANK, Table, page
from swgpar.studies.case import Outcome
from swgpar.studies.report import make_report
from swgpar.studies.spec import load_study
from swgpar.studies.table import compare_cases, shown_quantities

STUDY = f"""
[study]
design = "{DESIGN}"
meshes = ["{RECIPE}", "coarse"]
quantities = ["mean.fs_s1", "mean.wg_torque_Nmm", "sharing.pairs"]
[study.vary]
load.torque = [1.0, 2.0]
wave_generator.C = [0.9, 1.0]
[[study.case]]
name = "a"
published = {{ mean.fs_s1 = 300.0 }}
tolerance = {{ mean.fs_s1 = 5.0 }}
"""


def rows_of(text: str, number: int) -> list[list[str]]:
    """Cells of the rows of a table of a page."""
    body = re.findall(r"<table.*?</table>", text, flags=re.DOTALL)[number]
    return [
        re.findall(r"<td[^>]*>(.*?)</td>", row)
        for row in re.findall(r"<tr.*?</tr>", body, flags=re.DOTALL)[1:]
    ]


def test_tables_of_a_study(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(STUDY, encoding="utf-8")
    jobs = jobs_of(path)
    results = [
        (
            job,
            Outcome(
                "finished",
                values=dict.fromkeys(job.case.shown, 100.0 + k),
                elements=100 * 8**n,
                wall_s=1.0,
            ),
        )
        for k, job in enumerate(jobs)
        for n in [0 if job.finer else 1]
    ]
    text = make_report(load_study(path), results, compare_cases(results), tmp_path).decode()
    headings = [heads for heads, _ in assert_needs_nothing_else(text).tables]
    cases = next(heads for heads in headings if "case" in heads and "status" in heads)
    assert "load.torque (N·m)" in cases and "wave_generator.C" in cases and "time (s)" in cases
    for name, quantity in shown_quantities(results).items():
        assert (f"{name} ({quantity.unit})" if quantity.unit else name) in cases
    assert not any(
        "_percent" in head or head.endswith("_s") for heads in headings for head in heads
    )
    # which case is the smallest and which the largest, of the finer mesh
    found = rows_of(text, next(k for k, heads in enumerate(headings) if heads[1:2] == ["smallest"]))
    finest = [
        (outcome.values["mean.fs_s1"], job.case.name) for job, outcome in results if not job.finer
    ]
    row = next(cells for cells in found if cells[0] == "mean.fs_s1 (MPa)")
    assert (float(row[1]), row[2]) == min(finest) and (float(row[3]), row[4]) == max(finest)


def test_tables_of_an_optimisation(tmp_path: Path) -> None:
    pytest.importorskip("optuna")
    path = tmp_path / "search.toml"
    path.write_text(OPTIMISATION, encoding="utf-8")
    found = swgpar.optimise(path, tmp_path / "out")
    text = (tmp_path / "out" / "optimise.html").read_text(encoding="utf-8")
    tables = assert_needs_nothing_else(text).tables
    unit = make_problem(load_specification(path)).units["mesh.stiffness"]
    number, (heads, _) = next((k, entry) for k, entry in enumerate(tables) if "status" in entry[0])
    assert unit and f"mesh.stiffness ({unit})" in heads and "time (s)" in heads
    cells = [dict(zip(heads, row)) for row in rows_of(text, number)]
    feasible = [row for row in cells if row["status"] == "feasible"]
    assert [row["rank"] for row in feasible] == [str(k + 1) for k in range(len(feasible))]
    assert int(feasible[0]["evaluation"]) == found.best[0]
    name = "natural frequency 2 (rad/s)"
    frequencies = [float(row[name]) for row in feasible]
    assert frequencies == sorted(frequencies, reverse=True) and len(set(frequencies)) > 1


def report(heading: str, text: str) -> str:
    """A page with one table of answers, and a script."""
    empty = Table(["", "version or amount"], [])
    answers = Table([heading], [[text], [0.1 + 0.2]])
    values = {
        "figures": [],
        "inputs": text,
        "versions": empty,
        "answers": answers,
        "details": None,
        "compared": None,
    }
    return page("gear_trains/train_report.html.j2", text, scripts=(RANK,), **values).decode()


def test_a_table_that_does_not_scroll_is_found() -> None:
    text = report("load (N)", "text")
    assert Page(text).tables[0] == (["load (N)"], True)
    assert Page(text.replace("scroll", "still")).tables[0] == (["load (N)"], False)


def test_texts_are_escaped_and_only_scripts_of_the_package_run() -> None:
    text = report("load <b>", '</pre><script>alert("x")</script>')
    found = assert_needs_nothing_else(text)
    assert found.tags.count("script") == 1 and "b" not in found.tags
    assert 'data-value="0.30000000000000004">0.3<' in text
    source = re.search(r"<script>(.*?)</script>", text, flags=re.DOTALL)
    assert source is not None
    digest = base64.b64encode(hashlib.sha256(source[1].encode()).digest()).decode()
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)
    assert (
        policy is not None
        and policy[1].endswith(f"script-src 'sha256-{digest}'")
        and "'none'" in policy[1]
    )
