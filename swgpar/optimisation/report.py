"""optimise.html: the problem, the best designs with their files, figures and all evaluations, in
one file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from swgpar.optimisation import figures
from swgpar.optimisation.problem import STATUS, Problem
from swgpar.optimisation.result import OptimisationResult
from swgpar.optimisation.spec import Specification
from swgpar.results.page import Picture, Table, TableRow
from swgpar.studies.runs_page import FigureSection, runs_page, table_of_runs

IMPORTANCE = (
    "The importance of a variable is the share of it in what sets the best feasible designs apart "
    "from the others (PED-ANOVA)."
)


def make_report(
    spec: Specification, problem: Problem, result: OptimisationResult, designs: Mapping[int, str]
) -> bytes:
    """The whole page; call it on one rank. designs : texts of the winning design files by number"""
    ranked = _ranked(problem, result)
    left_out = ("status", "best", "wall_s", "reason")
    best = [{k: v for k, v in row.items() if k not in left_out} for row in ranked if row["best"]]
    units = problem.units | {name: quantity.unit for name, quantity in problem.known.items()}
    return runs_page(
        "optimisation/optimise.html.j2",
        "Optimisation",
        spec,
        lambda: _figures(problem, result) if ranked else [],
        [each.wall_s for each in result.evaluations.values()],
        counts=Counter(row["status"] for row in ranked),
        statuses=STATUS,
        variables=_variables(problem),
        quantities=_quantities(problem),
        best=table_of_runs(best, units) if best else None,
        designs=designs,
        evaluations=table_of_runs(ranked, units, ranked=True) if ranked else None,
    )


def _variables(problem: Problem) -> Table:
    rows = []
    for v in problem.section.variable:
        scale = ", ".join(map(str, v.choices)) or ("log" if v.log else "")
        rows.append(TableRow([", ".join(v.keys), v.low, v.high, problem.units[v.name], scale]))
    return Table(["variable", "low", "high", "unit", "scale or choices"], rows)


def _quantities(problem: Problem) -> Table:
    wanted: list[tuple[str, str]] = [(o.quantity, o.goal) for o in problem.section.objective]
    wanted += [(c.quantity, ", ".join(c.limits)) for c in problem.section.constraint]
    rows = []
    for name, goal in wanted:
        quantity = problem.known[name]
        rows.append(TableRow([name, goal, quantity.meaning, quantity.unit]))
    return Table(["quantity", "goal or limit", "meaning", "unit"], rows)


def _ranked(problem: Problem, result: OptimisationResult) -> list[dict[str, Any]]:
    """Rows of optimise.csv: feasible designs with their rank by the first objective, infeasible
    ones, failed ones."""
    first = problem.section.objective[0]

    def order(row: dict[str, Any]) -> tuple[int, float]:
        if row["status"] == "feasible":
            return 0, first.sign * row[first.quantity]
        violations = result.evaluations[row["evaluation"]].violations.values()
        return STATUS.index(row["status"]), max(violations, default=0.0)

    return [
        {"rank": k if row["status"] == "feasible" else None, **row}
        for k, row in enumerate(sorted(result.rows, key=order), start=1)
    ]


def _figures(problem: Problem, result: OptimisationResult) -> list[FigureSection]:
    progress = Picture(figures.progress(problem, result), "objectives by evaluation")
    fronts = figures.pareto(problem, result)
    pareto = [Picture(png, "objectives against each other") for png in fronts]
    importance = []
    if result.importance:
        importance = [Picture(figures.importance(result), "importance of the variables")]
    return [
        FigureSection("Progress", [progress]),
        FigureSection("Pareto front", pareto),
        FigureSection("Importance of the variables", importance, IMPORTANCE),
    ]
