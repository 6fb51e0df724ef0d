"""optimise.html: the problem, the best designs with their files, figures and all evaluations, in one file."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any

from swgpar.optimisation import figures
from swgpar.optimisation.problem import Problem
from swgpar.optimisation.result import OptimisationResult
from swgpar.optimisation.spec import Specification
from swgpar.results.figure_set import import_matplotlib
from swgpar.results.html_page import RANK, RANKING, image, page, table, with_unit
from swgpar.version import __version__

IMPORTANCE = (
    "The importance of a variable is the share of it in what sets the best feasible designs apart from the others "
    "(PED-ANOVA)."
)

STATUS = ("feasible", "infeasible", "failed")
"""Of evaluations, the best first."""


def make_report(spec: Specification, problem: Problem, result: OptimisationResult, designs: Mapping[int, str]) -> bytes:
    """The whole page; call it on one rank. designs : texts of the winning design files by number"""
    title = escape(spec.title)
    parts = [f"<h1>{title}</h1>", _introduction(spec, result), "<h2>Problem</h2>", _problem(problem)]
    parts += ["<h2>Best</h2>", _best(problem, result)]
    if result.evaluations:
        try:
            import_matplotlib()
            parts += _figures(problem, result)
        except Exception as error:  # a picture that fails must not cost the report
            parts.append(f"<p class=bad>Figures could not be drawn: {escape(str(error))}</p>")
    for number, text in designs.items():
        parts += [
            f"<details{' open' if len(designs) == 1 else ''}><summary>Design file of evaluation {number}</summary>",
            f"<pre>{escape(text)}</pre></details>",
        ]
    parts += ["<h2>Evaluations</h2>", RANKING, _evaluations(problem, result)]
    if spec.section.remarks:
        parts.append("<h2>Remarks</h2>")
        parts += [f"<p>{escape(text)}</p>" for text in spec.section.remarks.strip().split("\n\n")]
    parts += ["<h2>Optimisation file</h2>", f"<pre>{escape(spec.text)}</pre>", RANK]
    return page(spec.title, parts)


def _introduction(spec: Specification, result: OptimisationResult) -> str:
    every = result.evaluations.values()
    counts = ", ".join(f"{sum(each.status == status for each in every)} {status}" for status in STATUS)
    seconds = sum(each.wall_s for each in every)
    return (
        f"<p>swgpar {__version__}: {len(result.evaluations)} evaluations ({counts}), {seconds:.0f} s of computing. "
        f"Design: {escape(spec.section.design)}. Sampler: {spec.section.sampler}.</p>"
    )


def _problem(problem: Problem) -> str:
    section = problem.section
    variables = [
        (
            [
                ", ".join(v.keys),
                v.low,
                v.high,
                problem.units[v.name],
                ", ".join(map(str, v.choices)) or ("log" if v.log else ""),
            ],
            False,
        )
        for v in section.variable
    ]
    quantities = [
        ([o.quantity, o.goal, problem.known[o.quantity].meaning, problem.known[o.quantity].unit], False)
        for o in section.objective
    ]
    for c in section.constraint:
        limits = [
            f"{word} {limit:g}"
            for word, limit in (("at most", c.at_most), ("at least", c.at_least))
            if limit is not None
        ]
        known = problem.known[c.quantity]
        quantities.append(([c.quantity, ", ".join(limits), known.meaning, known.unit], False))
    return table(["variable", "low", "high", "unit", "scale or choices"], variables) + table(
        ["quantity", "goal or limit", "meaning", "unit"], quantities
    )


def _best(problem: Problem, result: OptimisationResult) -> str:
    if not result.best:
        return "<p class=bad>No design keeps all constraints.</p>"
    left_out = ("status", "best", "wall_s", "reason")
    rows = [{k: v for k, v in row.items() if k not in left_out} for row in _ranked(problem, result) if row["best"]]
    return _table(problem, rows)


def _evaluations(problem: Problem, result: OptimisationResult) -> str:
    rows = _ranked(problem, result)
    return _table(problem, rows, ranked=True) if rows else "<p>none</p>"


def _ranked(problem: Problem, result: OptimisationResult) -> list[dict[str, Any]]:
    """Rows of optimise.csv: feasible designs with their rank by the first objective, infeasible ones, failed ones."""
    first = problem.section.objective[0]
    sign = 1.0 if first.goal == "minimise" else -1.0

    def order(row: dict[str, Any]) -> tuple[int, float]:
        violations = result.evaluations[row["evaluation"]].violations.values()
        amount = sign * row[first.quantity] if row["status"] == "feasible" else max(violations, default=0.0)
        return STATUS.index(row["status"]), amount

    rows = sorted(result.rows, key=order)
    return [{"rank": k if row["status"] == "feasible" else None, **row} for k, row in enumerate(rows, start=1)]


def _table(problem: Problem, rows: list[dict[str, Any]], *, ranked: bool = False) -> str:
    units = problem.units | {name: problem.known[name].unit for name in problem.names} | {"wall_s": "s"}
    heads = [with_unit("time" if name == "wall_s" else name, units.get(name, "")) for name in rows[0]]
    return table(heads, ((list(row.values()), row.get("status") == "failed") for row in rows), ranked=ranked)


def _figures(problem: Problem, result: OptimisationResult) -> list[str]:
    parts = ["<h2>Progress</h2>", image(figures.progress(problem, result), "objectives by evaluation")]
    pictures = figures.pareto(problem, result)
    if pictures:
        parts += ["<h2>Pareto front</h2>", *(image(png, "objectives against each other") for png in pictures)]
    if result.importance:
        parts += ["<h2>Importance of the variables</h2>", f"<p>{IMPORTANCE}</p>"]
        parts.append(image(figures.importance(result), "importance of the variables"))
    return parts
