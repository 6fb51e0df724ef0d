"""The numbers of a study: a row per job, published values, error estimates from two meshes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from swgpar.analysis.error_estimate import Estimate, estimate
from swgpar.input.quantities import unit_of_key
from swgpar.input.toml_file import toml_value
from swgpar.results.quantity import Quantity
from swgpar.studies.case import Case, Job, Outcome

Result = tuple[Job, Outcome]

OF_MESHES = ("mesh", "converged", "error_estimate")
"""Columns of published.csv."""


@dataclass(frozen=True)
class Comparison:
    """A published value beside the computed one.

    mesh : the one it was computed on, or empty
    estimate : from the two finest meshes, its error that of the computed value
    difference : percent of the published value;  verdict : "inside", "MISS", or empty without a
    tolerance
    """

    case: str
    mesh: str
    quantity: str
    unit: str
    published: float
    computed: float | None
    difference: float | None
    tolerance: float | None
    verdict: str
    estimate: Estimate | None


def by_case(results: Sequence[Result]) -> list[tuple[Case, list[Outcome]]]:
    """Cases with the outcomes on their meshes, coarse to fine."""
    groups: dict[str, tuple[Case, list[Outcome]]] = {}
    for job, outcome in results:
        groups.setdefault(job.case.name, (job.case, []))[1].append(outcome)
    return list(groups.values())


def complete(results: Sequence[Result]) -> list[Result]:
    """Results of the cases that have ended on all of their meshes."""
    ended = {
        case.name
        for case, outcomes in by_case(results)
        if len(outcomes) == max(len(case.meshes), 1)
    }
    return [(job, outcome) for job, outcome in results if job.case.name in ended]


def shown_quantities(results: Sequence[Result]) -> dict[str, Quantity]:
    """The quantities in tables and figures, of all cases."""
    return {
        name: job.case.known[name]
        for job, _ in results
        for name in job.case.shown
        if name in job.case.known
    }


def units_of_keys(results: Sequence[Result]) -> dict[str, str]:
    """Units of the varied keys, by the first case whose design has them."""
    units: dict[str, str] = {}
    for job, _ in results:
        for key in job.case.varied:
            if job.case.design is not None and not units.get(key):
                units[key] = unit_of_key(job.case.design, key)
    return units


def estimate_of(case: Case, outcomes: Sequence[Outcome], name: str) -> Estimate | None:
    """Error estimate of a quantity from the last two meshes; None without two values."""
    pair = [
        (outcome.values[name], outcome.elements)
        for outcome in outcomes[-2:]
        if name in outcome.values and outcome.elements is not None
    ]
    if len(pair) < 2:
        return None
    (coarse, n_coarse), (fine, n_fine) = pair
    return estimate(coarse, fine, n_coarse, n_fine, case.system.dimensions(case.design))


def compare(results: Sequence[Result]) -> list[Comparison]:
    """All published values."""
    rows = []
    for case, outcomes in by_case(results):
        for name, published in case.section.published.items():
            outcome = outcomes[case.compared]
            computed = outcome.values.get(name)
            difference = None
            if computed is not None and published != 0.0:
                difference = 100.0 * (computed - published) / abs(published)
            tolerance, verdict = case.section.tolerance.get(name), ""
            if tolerance is not None:
                verdict = (
                    "inside" if difference is not None and abs(difference) <= tolerance else "MISS"
                )
            found = estimate_of(case, outcomes, name)
            if found is not None and computed is not None:
                found = Estimate(found.converged, abs(found.converged - computed))
            mesh = case.meshes[case.compared].stem if case.meshes else ""
            unit = case.known[name].unit if name in case.known else ""
            rows.append(
                Comparison(
                    case.name,
                    mesh,
                    name,
                    unit,
                    published,
                    computed,
                    difference,
                    tolerance,
                    verdict,
                    found,
                )
            )
    return rows


def study_rows(results: Sequence[Result]) -> list[dict[str, Any]]:
    """Rows of study.csv."""
    keys = list(dict.fromkeys(key for job, _ in results for key in job.case.varied))
    names = list(dict.fromkeys(name for job, _ in results for name in job.case.shown))
    rows = []
    for job, outcome in results:
        details = {
            "mesh": job.mesh_name,
            "elements": outcome.elements,
            "newton_mean": outcome.newton_mean,
        }
        row: dict[str, Any] = {"case": job.case.name}
        if "mesh" in job.case.system.options:
            row.update(details)
        row.update({key: shown(job.case.varied.get(key)) for key in keys})
        row["status"] = outcome.status
        row.update({name: outcome.values.get(name) for name in names})
        row.update(wall_s=outcome.wall_s, reason=outcome.reason)
        rows.append(row)
    return rows


def shown(value: Any) -> Any:
    """A varied value in a table: numbers and texts as they are, all else as in TOML."""
    if value is None:
        return None
    return (
        value
        if isinstance(value, (float, int, str)) and not isinstance(value, bool)
        else toml_value(value)
    )


def published_rows(comparisons: Iterable[Comparison]) -> list[dict[str, Any]]:
    """Rows of published.csv; without what follows from meshes where there are none."""
    rows = [
        {
            "case": c.case,
            "mesh": c.mesh,
            "quantity": c.quantity,
            "unit": c.unit,
            "published": c.published,
            "computed": c.computed,
            "difference_percent": c.difference,
            "tolerance_percent": c.tolerance,
            "verdict": c.verdict,
            "converged": c.estimate.converged if c.estimate else None,
            "error_estimate": c.estimate.error if c.estimate else None,
        }
        for c in comparisons
    ]
    if any(row["mesh"] for row in rows):
        return rows
    return [{name: value for name, value in row.items() if name not in OF_MESHES} for row in rows]
