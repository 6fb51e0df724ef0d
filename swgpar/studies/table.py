"""The numbers of a study: a row per job, published values, error estimates from two meshes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from swgpar.analysis.error_estimate import Estimate, estimate
from swgpar.input.quantities import unit_of_key
from swgpar.input.toml_file import toml_value
from swgpar.results.quantity import Quantity
from swgpar.studies.case import Case, Job, Outcome

JobResult = tuple[Job, Outcome]

OF_MESHES = ("mesh", "converged", "error_estimate")
"""Columns of published.csv."""


@dataclass(frozen=True)
class CaseComparison:
    """A published value beside the computed one: a row of published.csv.

    mesh : the one it was computed on, or empty
    difference_percent : of the published value
    verdict : "inside", "MISS", or empty without a tolerance
    converged : from the two finest meshes;  error_estimate : that of the computed value
    """

    case: str
    mesh: str
    quantity: str
    unit: str
    published: float
    computed: float | None
    difference_percent: float | None
    tolerance_percent: float | None
    verdict: str
    converged: float | None
    error_estimate: float | None


def by_case(results: Sequence[JobResult]) -> list[tuple[Case, list[Outcome]]]:
    """Cases with the outcomes on their meshes, coarse to fine."""
    groups: dict[str, tuple[Case, list[Outcome]]] = {}
    for job, outcome in results:
        groups.setdefault(job.case.name, (job.case, []))[1].append(outcome)
    return list(groups.values())


def complete(results: Sequence[JobResult]) -> list[JobResult]:
    """Results of the cases that have ended on all of their meshes."""
    ended = {
        case.name
        for case, outcomes in by_case(results)
        if len(outcomes) == max(len(case.meshes), 1)
    }
    return [(job, outcome) for job, outcome in results if job.case.name in ended]


def shown_quantities(results: Sequence[JobResult]) -> dict[str, Quantity]:
    """The quantities in tables and figures, of all cases."""
    return {
        name: job.case.known[name]
        for job, _ in results
        for name in job.case.shown
        if name in job.case.known
    }


def units_of_keys(results: Sequence[JobResult]) -> dict[str, str]:
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


def compare_cases(results: Sequence[JobResult]) -> list[CaseComparison]:
    """All published values."""
    rows = []
    for case, outcomes in by_case(results):
        mesh = case.meshes[case.compared].stem if case.meshes else ""
        for name, published in case.section.published.items():
            computed = outcomes[case.compared].values.get(name)
            difference = converged = error = None
            if computed is not None and published != 0.0:
                difference = 100.0 * (computed - published) / abs(published)
            tolerance, verdict = case.section.tolerance.get(name), ""
            if tolerance is not None:
                inside = difference is not None and abs(difference) <= tolerance
                verdict = "inside" if inside else "MISS"
            of_meshes = estimate_of(case, outcomes, name)
            if of_meshes is not None:
                converged = of_meshes.converged
                error = of_meshes.error if computed is None else abs(converged - computed)
            rows.append(
                CaseComparison(
                    case=case.name,
                    mesh=mesh,
                    quantity=name,
                    unit=case.known[name].unit if name in case.known else "",
                    published=published,
                    computed=computed,
                    difference_percent=difference,
                    tolerance_percent=tolerance,
                    verdict=verdict,
                    converged=converged,
                    error_estimate=error,
                )
            )
    return rows


def study_rows(results: Sequence[JobResult]) -> list[dict[str, Any]]:
    """Rows of study.csv."""
    keys = list(dict.fromkeys(key for job, _ in results for key in job.case.varied))
    names = list(dict.fromkeys(name for job, _ in results for name in job.case.shown))
    rows = []
    for job, outcome in results:
        row: dict[str, Any] = {"case": job.case.name}
        if "mesh" in job.case.system.options:
            row |= {"mesh": job.mesh_name, "elements": outcome.elements}
            row["newton_mean"] = outcome.newton_mean
        row |= {key: shown(job.case.varied.get(key)) for key in keys} | {"status": outcome.status}
        row |= {name: outcome.values.get(name) for name in names}
        rows.append(row | {"wall_s": outcome.wall_s, "reason": outcome.reason})
    return rows


def shown(value: Any) -> Any:
    """A varied value in a table: numbers and texts as they are, all else as in TOML."""
    if value is None or (isinstance(value, (float, int, str)) and not isinstance(value, bool)):
        return value
    return toml_value(value)


def published_rows(comparisons: Iterable[CaseComparison]) -> list[dict[str, Any]]:
    """Rows of published.csv; without what follows from meshes where there are none."""
    rows = [asdict(comparison) for comparison in comparisons]
    if any(row["mesh"] for row in rows):
        return rows
    return [{name: value for name, value in row.items() if name not in OF_MESHES} for row in rows]
