"""The start design and the bounds of a search, its tables and figures: on a gear train of
milliseconds."""

from __future__ import annotations

import io
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
from rich.console import Console

import swgpar
from support.optimisation import FREQUENCY, FROM_START, OPTIMISATION
from support.paths import DRIVERS
from swgpar.optimisation import terminal
from swgpar.optimisation.bounds import at_bounds, position
from swgpar.optimisation.comparison import comparison
from swgpar.optimisation.spec import Variable

pytest.importorskip("optuna")

MASS = "gear_1.mass"
STIFFNESS = "mesh.stiffness"


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> swgpar.OptimisationResult:
    folder = tmp_path_factory.mktemp("search")
    (folder / "search.toml").write_text(FROM_START, encoding="utf-8")
    return swgpar.optimise(folder / "search.toml", folder / "out", progress=False)


def searched(folder: Path, text: str) -> swgpar.OptimisationResult:
    folder.mkdir()
    (folder / "search.toml").write_text(text, encoding="utf-8")
    return swgpar.optimise(folder / "search.toml", folder / "out", progress=False)


def test_evaluation_0_is_the_design_file(found: swgpar.OptimisationResult) -> None:
    design = swgpar.load_design(DRIVERS / "gear_pair.toml")
    assert found.start == 0 and found.without_start == ""
    start = found.evaluations[0]
    assert start.values == {STIFFNESS: design.mesh.stiffness, MASS: design.gear_1.mass}
    assert start.quantities[FREQUENCY] == pytest.approx(swgpar.check(design)[FREQUENCY], rel=1e-12)
    assert found.evaluations[1].values[STIFFNESS] == 2e9  # the first of those that are given
    assert found.compared == [0, *found.best] and found.best != [0]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            FROM_START.replace("high = 200.0", "high = 150.0"),
            "gear_1.mass = 181.6 is out of range: allowed 20 to 150",
        ),
        (OPTIMISATION, "gear_1.mass = 181.6 and gear_2.mass = 104 are one variable"),
    ],
)
def test_a_start_design_that_is_no_point_of_the_search(
    tmp_path: Path, text: str, words: str
) -> None:
    search = searched(tmp_path / "search", text.replace("evaluations = 12", "evaluations = 2"))
    assert search.start is None and search.without_start == words
    assert search.compared == search.best
    page = (search.folder / "optimise.html").read_text(encoding="utf-8")
    assert f"The start design is no point of the search: {words}." in page


@pytest.mark.parametrize(
    ("where", "evaluations"),
    [
        ("swgpar.optimisation.problem.Problem.evaluate", 1),
        ("swgpar.optimisation.problem.Problem.evaluate", 2),
        ("in ask", 2),
    ],
)
def test_a_start_design_that_was_interrupted_is_tried_after_a_restart(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, where: str, evaluations: int
) -> None:
    """Also where it has no parameters yet, and where more designs are given than are evaluated."""
    path, out = tmp_path / "search.toml", tmp_path / "out"
    text = FROM_START.replace("evaluations = 12", f"evaluations = {evaluations}")
    path.write_text(text, encoding="utf-8")

    def killed(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as context:
        context.setattr("optuna.Trial._suggest" if where == "in ask" else where, killed)
        with pytest.raises(KeyboardInterrupt):
            swgpar.optimise(path, out)
    again = swgpar.optimise(path, out, restart=True)
    assert again.start is not None and len(again.evaluations) == evaluations
    assert again.evaluations[again.start].values[MASS] == 181.6


def test_variables_at_their_bounds() -> None:
    linear = Variable(keys=["a.x"], low=10.0, high=20.0)
    log = Variable(keys=["a.y"], low=1.0, high=1e4, log=True)
    choice = Variable(keys=["a.z"], choices=[1, 2])
    inside = {"a.x": 10.2, "a.y": 1.2, "a.z": 1}
    assert at_bounds([linear, log, choice], inside) == ()
    near = at_bounds([linear, log, choice], {"a.x": 10.09, "a.y": 9.2e3, "a.z": 1})
    assert [(one.variable, one.side, one.bound) for one in near] == [
        ("a.x", "lower", 10.0),
        ("a.y", "upper", 1e4),
    ]
    assert near[0].text == "a.x = 10.09 is at its lower bound 10"
    assert position(log, 100.0) == pytest.approx(0.5) and position(choice, 2) == 1.0


def test_variables_at_bounds_are_named_everywhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a mass that cannot become small enough."""
    text = FROM_START.replace("low = 20.0", "low = 180.0").replace("= 12", "= 30")
    search = searched(tmp_path / "search", text.replace("high = 200.0", "high = 1e4"))
    (best,) = search.best
    words = [one.text for one in search.at_bounds[best] if one.variable == MASS]
    assert len(words) == 1 and "is at its lower bound 180" in words[0]
    assert words[0] in (search.folder / "optimise.html").read_text(encoding="utf-8")
    assert words[0] in " ".join(printed(search, 80, monkeypatch).split())


def printed(search: swgpar.OptimisationResult, width: int, monkeypatch: pytest.MonkeyPatch) -> str:
    file = io.StringIO()
    monkeypatch.setattr(terminal, "console", Console(file=file, width=width))
    terminal.print_result(search)
    return file.getvalue()


def test_the_table_of_the_best_is_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also with a front of many designs: every number stands on one line, in the order of the
    columns."""
    second = '\n[[optimise.objective]]\nquantity = "damping ratio 2"\n'
    search = searched(tmp_path / "search", FROM_START + second)
    assert len(search.best) > 5
    for width in (60, 80):
        text = printed(search, width, monkeypatch)
        assert max(map(len, text.splitlines())) <= width and "…" not in text
        for number in search.compared[: terminal.SHOWN]:
            each = search.evaluations[number]
            for value in (*each.values.values(), *each.quantities.values()):
                assert f"{value:.5g}" in text.split()


def test_parts_of_a_comparison_have_the_start_design(found: swgpar.OptimisationResult) -> None:
    numbers = [0, 3, 4, 5, *found.best]
    parts = list(comparison(found, numbers).parts(3))
    assert [part.heads[0] for part in parts] == ["0 (start)"] * len(parts) and len(parts) == 2
    assert parts[1].rows[0].cells[1] == found.evaluations[5].values[STIFFNESS]


def test_figures_of_a_search(found: swgpar.OptimisationResult, tmp_path: Path) -> None:
    """Parallel coordinates show limits, the start design and the best one."""
    assert found.plot.names[:2] == ("progress", "parallel_coordinates")
    figure = found.plot.parallel_coordinates()
    (panel,) = figure.axes
    labels = {line.get_label(): line for line in panel.lines}
    start, best = labels["start design"], labels["best"]
    variables = found.section.variable
    for line, number in ((start, 0), (best, found.best[0])):
        values = found.evaluations[number].values
        expected = [position(one, values[one.name]) for one in variables]
        assert np.asarray(line.get_ydata())[: len(variables)] == pytest.approx(expected)
    names = [text.get_text().replace("\n", " ") for text in panel.get_xticklabels()]
    assert "mesh. stiffness (N/m)" in names[0] or "mesh.stiffness" in names[0]
    assert len(names) == 4 and names[2].endswith("maximise")
    (path,) = [one for one in found.plot.save(tmp_path) if one.stem == "parallel_coordinates"]
    assert np.std(matplotlib.image.imread(path)) > 0.05
