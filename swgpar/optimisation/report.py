"""optimise.html: the problem, the best designs with their files, figures and all evaluations, in
one file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from swgpar.optimisation import figures
from swgpar.optimisation.comparison import (
    DesignComparison,
    bound_sentences,
    comparison,
    start_sentence,
)
from swgpar.optimisation.optimisation_data import OptimisationData
from swgpar.optimisation.problem import STATUS, Problem
from swgpar.optimisation.spec import Specification
from swgpar.results.page import Picture, Table
from swgpar.results.quantity import Quantity
from swgpar.studies.figures import as_png
from swgpar.studies.runs_page import FigureSection, runs_page, table_of_runs

IMPORTANCE = (
    "The importance of a variable is the share of it in what sets the best feasible designs apart "
    "from the others (PED-ANOVA)."
)

PARALLEL = (
    "Every design that has been computed is a line. An axis is a variable between its bounds, or a "
    "quantity. Marks on an axis are limits, and the side beyond them is not allowed."
)

SECTIONS = (
    (figures.PROGRESS, "Progress", "objectives by evaluation", ""),
    (figures.PARALLEL, "Parallel coordinates", "variables and quantities of all designs", PARALLEL),
    (figures.PARETO, "Pareto front", "objectives against each other", ""),
    (figures.IMPORTANCE, "Importance of the variables", "importance of the variables", IMPORTANCE),
)
"""Begin of the names of figures, heading above them, what they show, text below the heading."""

COLUMNS = 6
"""Designs beside each other in a table of the best ones."""


def make_report(
    spec: Specification, problem: Problem, result: OptimisationData, designs: Mapping[int, str]
) -> bytes:
    """The whole page; call it on one rank. designs : texts of the winning design files by number"""
    ranked = _ranked(problem, result)
    shown = comparison(result, result.compared) if result.compared else None
    return runs_page(
        "optimisation/optimise.html.j2",
        "Optimisation",
        spec,
        lambda: _figures(result) if ranked else [],
        [each.wall_s for each in result.evaluations.values()],
        counts=Counter(row["status"] for row in ranked),
        statuses=STATUS,
        load_cases=_load_cases(problem),
        variables=_variables(problem),
        quantities=_quantities(problem),
        compared=[_beside(part) for part in shown.parts(COLUMNS)] if shown else [],
        best=result.best,
        bounds=bound_sentences(result),
        without_start=start_sentence(result) if ranked else "",
        designs=designs,
        evaluations=table_of_runs(ranked, result.units) if ranked else None,
    )


def _beside(part: DesignComparison) -> Table:
    """The table of a part of the comparison."""
    rows = [[row.name, row.wanted, *row.cells] for row in part.rows]
    return Table(["evaluation", "sought", *part.heads], rows)


def _variables(problem: Problem) -> Table:
    rows = []
    for v in problem.section.variable:
        scale = ", ".join(map(str, v.choices)) or ("log" if v.log else "")
        rows.append([", ".join(v.keys), v.low, v.high, problem.units[v.name], scale])
    return Table(["variable", "low", "high", "unit", "scale or choices"], rows)


def _quantities(problem: Problem) -> Table:
    wanted: list[tuple[str, str]] = [(o.name, o.goal) for o in problem.section.objective]
    wanted += [(c.name, c.words) for c in problem.section.constraint]
    rows = []
    for name, goal in wanted:
        quantity = problem.known.get(name, Quantity("worst verdict of the rating sheet", ""))
        rows.append([name, goal, quantity.meaning, quantity.unit])
    return Table(["quantity", "goal or limit", "meaning", "unit"], rows)


def _load_cases(problem: Problem) -> Table | None:
    """The load cases; None where the file has none."""
    rows = [
        [
            one.name,
            "rating sheet" if one.rate else "run",
            ", ".join(one.set),
            ", ".join(one.without),
        ]
        for one in problem.section.load_case
    ]
    return Table(["load case", "computed", "keys", "without"], rows) if rows else None


def _ranked(problem: Problem, result: OptimisationData) -> list[dict[str, Any]]:
    """Rows of optimise.csv: feasible designs with their rank by the first objective, infeasible
    ones, failed ones."""
    first = problem.section.objective[0]

    def order(row: dict[str, Any]) -> tuple[int, float]:
        if row["status"] == "feasible":
            return 0, first.sign * row[first.name]
        violations = result.evaluations[row["evaluation"]].violations.values()
        return STATUS.index(row["status"]), max(violations, default=0.0)

    return [
        {"rank": k if row["status"] == "feasible" else None, **row}
        for k, row in enumerate(sorted(result.rows, key=order), start=1)
    ]


def _figures(result: OptimisationData) -> list[FigureSection]:
    found = figures.drawings(result)
    sections = []
    for begin, title, shows, text in SECTIONS:
        drawn = [draw() for name, draw in found.items() if name.startswith(begin)]
        pictures = [Picture(as_png(figure), shows) for figure in drawn]
        sections.append(FigureSection(title, pictures, text))
    return sections
