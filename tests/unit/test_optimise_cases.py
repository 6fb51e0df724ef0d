"""Load cases of an optimisation: gear trains under two loads, refusals, numbers of a rating
sheet."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import swgpar
from support.optimisation import FREQUENCY
from support.paths import DESIGN, DRIVERS, RECIPE
from swgpar.answers.answer import NO_LIMIT, Answer
from swgpar.answers.verdict import Judgement, Limit, Sense, Verdict
from swgpar.errors import InputError
from swgpar.input.toml_file import to_toml
from swgpar.optimisation.problem import make_problem
from swgpar.optimisation.rated_quantities import (
    LEAST_MARGIN,
    distance,
    growing,
    rated_values,
    row_of_least_margin,
)
from swgpar.optimisation.spec import load_specification
from swgpar.rating.sheet import RatedVerdict, RatingSheet

pytest.importorskip("optuna")

Change = Callable[[dict[str, Any]], Any]

SEARCH: dict[str, Any] = {
    "design": str(DRIVERS / "gear_pair.toml"),
    "set": ["monte_carlo.samples=20", "time.end=1e-4", "time.rows=2"],
    "evaluations": 3,
    "load_case": [
        {"name": "light", "set": ["gear_1.mass=100.0"]},
        {"name": "heavy", "set": ["gear_1.mass=400.0"]},
    ],
    "variable": [{"keys": ["mesh.stiffness"], "low": 1e9, "high": 1e11}],
    "objective": [{"case": "light", "quantity": FREQUENCY}],
    "constraint": [{"case": "heavy", "quantity": FREQUENCY, "at_least": 100.0}],
}


def written(folder: Path, table: dict[str, Any]) -> Path:
    path = folder / "search.toml"
    path.write_text(to_toml({"optimise": table}), encoding="utf-8")
    return path


def test_quantities_of_two_load_cases(tmp_path: Path) -> None:
    found = swgpar.optimise(written(tmp_path, SEARCH), tmp_path / "out")
    assert found.start == 0
    for each in found.evaluations.values():
        for case, mass in (("light", 100.0), ("heavy", 400.0)):
            values = {"mesh.stiffness": each.values["mesh.stiffness"], "gear_1.mass": mass}
            design = swgpar.load_design(DRIVERS / "gear_pair.toml", values)
            value = swgpar.check(design)[FREQUENCY]
            assert each.quantities[f"{case}: {FREQUENCY}"] == pytest.approx(value, rel=1e-12)
    page = (found.folder / "optimise.html").read_text(encoding="utf-8")
    assert "gear_1.mass=400.0" in page and f"heavy: {FREQUENCY}" in page
    # the design file has the variables, and not the keys of a case
    (best,) = found.best
    assert found.designs[best]["gear_1"]["mass"] == 181.6


def test_a_limit_of_one_case_that_follows_at_once_costs_no_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = copy.deepcopy(SEARCH)
    table["constraint"][0]["at_least"] = 1e12
    monkeypatch.setattr("swgpar.optimisation.load_cases.run_one", lambda *_: pytest.fail("a run"))
    found = swgpar.optimise(written(tmp_path, table), tmp_path / "out")
    assert {one.status for one in found.evaluations.values()} == {"infeasible"}
    reason = found.evaluations[0].reason
    assert reason == f"heavy: {FREQUENCY} at least 1e+12 is not kept"


def _set(section: str, **values: Any) -> Change:
    return lambda table: table[section][0].update(values)


def _without_case(table: dict[str, Any]) -> None:
    del table["objective"][0]["case"]


REFUSALS: list[tuple[Change, str]] = [
    (_without_case, "optimise.objective .*case is missing: allowed light, heavy"),
    (_set("objective", case="dark"), 'case = "dark" is no load case: allowed light, heavy'),
    (lambda table: table.pop("load_case"), "allowed none without"),
    (_set("load_case", name="heavy"), 'name = "heavy" is given twice'),
    (_set("load_case", name="a b"), 'name = "a b" is no name: allowed letters, digits'),
    (_set("load_case", set=["mesh.stiffness=1e9"]), "mesh.stiffness is a variable"),
    (_set("load_case", set=["mesh.stifness=1e9"]), "stifness"),
    (_set("load_case", without=["mash"]), 'without = "mash" is no section that the design file'),
    (_set("load_case", rate=True), "rate = true has no meaning for a gear train"),
    (
        lambda table: table["constraint"].append(
            {"case": "light", "quantity": FREQUENCY, "verdict": "passes"}
        ),
        "verdict has no meaning for a run: allowed of load cases with rate = true",
    ),
    (_set("constraint", verdict="fails"), "verdict"),
    (_set("objective", quantity="no such thing"), 'load_case "light": no such thing is not'),
]


@pytest.mark.parametrize(("change", "words"), REFUSALS)
def test_load_cases_are_refused_in_one_sentence(tmp_path: Path, change: Change, words: str) -> None:
    table = copy.deepcopy(SEARCH)
    change(table)
    with pytest.raises(InputError, match=words) as refusal:
        make_problem(load_specification(written(tmp_path, table)))
    assert "\n" not in str(refusal.value)


RATED: dict[str, Any] = {
    "design": "drive.toml",
    "mesh": str(RECIPE),
    "evaluations": 1,
    "load_case": [{"name": "sheet", "rate": True}],
    "variable": [{"keys": ["flexible_spline.rim"], "low": 0.5, "high": 0.7}],
    "objective": [{"case": "sheet", "quantity": "stiffness K1", "goal": "maximise"}],
    "constraint": [{"case": "sheet", "quantity": "headline", "verdict": "within its error"}],
}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            _set("constraint", verdict="passes"),
            "yield of teeth and rim has no limit: no strengths are given",
        ),
        (
            _set("constraint", quantity="stiffness K2", verdict="passes"),
            '"stiffness K2" never passes: stiffness K2 has no limit: no requirement',
        ),
        (_set("objective", quantity="margin of stiffness K2"), "margin of stiffness K1"),
        (_set("objective", quantity="headline"), "is a verdict and no number"),
        (_set("constraint", at_most=1.0), "has a verdict and a limit: allowed is one of both"),
    ],
)
def test_rating_sheets_are_refused_in_one_sentence(
    tmp_path: Path, change: Change, words: str
) -> None:
    design = swgpar.load_design(DESIGN).model_dump(exclude_unset=True)
    design |= {"rating": {"rated_torque": 1.0, "K1": 1.0}}
    (tmp_path / "drive.toml").write_text(to_toml(design), encoding="utf-8")
    problem = make_problem(load_specification(written(tmp_path, RATED)))
    assert problem.units["sheet: stiffness K1"] == "N·m/rad"
    table = copy.deepcopy(RATED)
    change(table)
    with pytest.raises(InputError, match=words) as refusal:
        make_problem(load_specification(written(tmp_path, table)))
    assert "\n" not in str(refusal.value)


# -- numbers of a sheet ----------------------------------------------------------------------------

AT_MOST, AT_LEAST = Limit(10.0, Sense.AT_MOST, ""), Limit(10.0, Sense.AT_LEAST, "")


def verdict(name: str, value: float, limit: Limit | None, **more: Any) -> Verdict:
    return Verdict(name, Answer(name, value, "", name, **more), limit)


def sheet(*verdicts: Verdict) -> RatingSheet:
    return RatingSheet("", tuple(RatedVerdict(one, "") for one in verdicts), (), {}, None)


@pytest.mark.parametrize(
    ("value", "limit", "margin"),
    [
        (8.0, AT_MOST, 0.2),
        (12.0, AT_MOST, -0.2),
        (12.0, AT_LEAST, 0.2),
        (0.5, Limit(-2.0, Sense.AT_LEAST, ""), 1.25),
        (-3.0, Limit(0.0, Sense.AT_LEAST, ""), -3.0),
    ],
)
def test_a_margin_is_positive_on_the_good_side(value: float, limit: Limit, margin: float) -> None:
    assert rated_values(sheet(verdict("a", value, limit))) == pytest.approx(
        {"a": value, "margin of a": margin, LEAST_MARGIN: margin}
    )


def test_the_least_margin_is_of_rows_that_are_judged() -> None:
    rows = sheet(
        verdict("a", 8.0, AT_MOST),
        verdict("b", 9.0, None),
        verdict("c", 30.0, AT_MOST, no_error=NO_LIMIT),
        verdict("d", math.inf, AT_LEAST),
    )
    found = rated_values(rows)
    assert row_of_least_margin(rows) == "a"
    assert found[LEAST_MARGIN] == pytest.approx(0.2) and found["margin of d"] == math.inf
    assert growing(rows) == {"c", "margin of c"}


@pytest.mark.parametrize("limit", [AT_MOST, AT_LEAST])
@pytest.mark.parametrize("value", [7.9, 8.0, 9.0, 9.99, 10.0, 10.01, 11.0, 12.0, 12.1, math.inf])
@pytest.mark.parametrize("error", [None, 2.0])
def test_a_distance_says_what_the_verdict_says(
    value: float, limit: Limit, error: float | None
) -> None:
    """0 and less where the verdict is allowed, more where it is not; the farther the worse."""
    one, order = verdict("a", value, limit, error=error), list(Judgement)
    for allowed in (Judgement.PASSES, Judgement.NOT_JUDGED, Judgement.WITHIN_ERROR):
        kept = order.index(one.judgement) <= order.index(allowed)
        for name in ("a", "headline"):
            assert (distance(sheet(one), name, allowed) <= 0.0) == kept
        further = verdict("a", value + (3.0 if limit is AT_MOST else -3.0), limit, error=error)
        if math.isfinite(value):
            worse = distance(sheet(further), "a", allowed)
            assert worse > distance(sheet(one), "a", allowed) or worse <= 0.0


def test_the_headline_is_as_far_as_its_worst_row() -> None:
    good, bad = verdict("a", 8.0, AT_MOST), verdict("b", 15.0, AT_MOST)
    unlimited = verdict("c", 99.0, None)
    rows = sheet(good, bad, unlimited)
    assert distance(rows, "headline", Judgement.PASSES) == pytest.approx(0.5)
    assert distance(sheet(good, unlimited), "headline", Judgement.PASSES) <= 0.0
    missing = Verdict("d", None, AT_MOST, "the run waits")
    assert distance(sheet(good, missing), "headline", Judgement.PASSES) == 1.0
    assert distance(sheet(good, missing), "headline", Judgement.NOT_JUDGED) <= 0.0
