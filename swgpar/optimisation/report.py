"""optimise.html: the problem, the best designs with their files, figures and all evaluations, in
one file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from swgpar.optimisation import figures
from swgpar.optimisation.problem import Problem
from swgpar.optimisation.result import OptimisationResult
from swgpar.optimisation.spec import Specification
from swgpar.results.figure_set import import_matplotlib
from swgpar.results.page import RANK, Picture, Row, Table, page
from swgpar.results.quantity import with_unit
from swgpar.version import __version__

STATUS = ("feasible", "infeasible", "failed")
"""Of evaluations, the best first."""


class Figures(NamedTuple):
    """pareto : empty with one objective;  importance : None where it cannot be told"""

    progress: Picture
    pareto: list[Picture]
    importance: Picture | None


def make_report(
    spec: Specification, problem: Problem, result: OptimisationResult, designs: Mapping[int, str]
) -> bytes:
    """The whole page; call it on one rank. designs : texts of the winning design files by number"""
    drawn = None
    failed_figures = ""
    if result.evaluations:
        try:
            import_matplotlib()
            drawn = _figures(problem, result)
        except Exception as error:  # a picture that fails must not cost the report
            failed_figures = str(error)
    ranked = _ranked(problem, result)
    left_out = ("status", "best", "wall_s", "reason")
    best = [{k: v for k, v in row.items() if k not in left_out} for row in ranked if row["best"]]
    every = result.evaluations.values()
    return page(
        "optimisation/optimise.html.j2",
        spec.title,
        scripts=(RANK,),
        version=__version__,
        section=spec.section,
        counts={status: sum(each.status == status for each in every) for status in STATUS},
        evaluated=len(every),
        seconds=sum(each.wall_s for each in every),
        variables=_variables(problem),
        quantities=_quantities(problem),
        best=_table(problem, best) if best else None,
        figures=drawn,
        failed_figures=failed_figures,
        designs=designs,
        evaluations=_table(problem, ranked, ranked=True) if ranked else None,
        text=spec.text,
    )


def _variables(problem: Problem) -> Table:
    rows = []
    for v in problem.section.variable:
        scale = ", ".join(map(str, v.choices)) or ("log" if v.log else "")
        rows.append(Row([", ".join(v.keys), v.low, v.high, problem.units[v.name], scale]))
    return Table(["variable", "low", "high", "unit", "scale or choices"], rows)


def _quantities(problem: Problem) -> Table:
    wanted: list[tuple[str, str]] = [(o.quantity, o.goal) for o in problem.section.objective]
    for c in problem.section.constraint:
        limits = (("at most", c.at_most), ("at least", c.at_least))
        wanted.append(
            (
                c.quantity,
                ", ".join(f"{word} {limit:g}" for word, limit in limits if limit is not None),
            )
        )
    rows = [
        Row([name, goal, problem.known[name].meaning, problem.known[name].unit])
        for name, goal in wanted
    ]
    return Table(["quantity", "goal or limit", "meaning", "unit"], rows)


def _ranked(problem: Problem, result: OptimisationResult) -> list[dict[str, Any]]:
    """Rows of optimise.csv: feasible designs with their rank by the first objective, infeasible
    ones, failed ones."""
    first = problem.section.objective[0]
    sign = 1.0 if first.goal == "minimise" else -1.0

    def order(row: dict[str, Any]) -> tuple[int, float]:
        violations = result.evaluations[row["evaluation"]].violations.values()
        amount = (
            sign * row[first.quantity]
            if row["status"] == "feasible"
            else max(violations, default=0.0)
        )
        return STATUS.index(row["status"]), amount

    rows = sorted(result.rows, key=order)
    return [
        {"rank": k if row["status"] == "feasible" else None, **row}
        for k, row in enumerate(rows, start=1)
    ]


def _table(problem: Problem, rows: list[dict[str, Any]], *, ranked: bool = False) -> Table:
    units = (
        problem.units | {name: problem.known[name].unit for name in problem.names} | {"wall_s": "s"}
    )
    heads = [
        with_unit("time" if name == "wall_s" else name, units.get(name, "")) for name in rows[0]
    ]
    return Table(
        heads, [Row(list(row.values()), row.get("status") == "failed") for row in rows], ranked
    )


def _figures(problem: Problem, result: OptimisationResult) -> Figures:
    pareto = [
        Picture(png, "objectives against each other") for png in figures.pareto(problem, result)
    ]
    importance = (
        Picture(figures.importance(result), "importance of the variables")
        if result.importance
        else None
    )
    return Figures(
        Picture(figures.progress(problem, result), "objectives by evaluation"), pareto, importance
    )
