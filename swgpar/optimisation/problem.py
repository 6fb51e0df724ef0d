"""From the values of the variables to a design, its run, and what objectives and constraints make
of it."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mpi4py import MPI

from swgpar.errors import InputError
from swgpar.input.quantities import unit_of_key
from swgpar.input.toml_file import apply_overrides, read_toml, with_value
from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.optimisation.load_cases import CaseOutcome, ProblemCase, make_case
from swgpar.optimisation.spec import (
    LoadCaseSection,
    Objective,
    OptimiseSection,
    Screen,
    Specification,
    Variable,
)
from swgpar.optimisation.start_design import StartDesign, start_design
from swgpar.results.quantity import Quantity
from swgpar.run_options import RunOptions
from swgpar.studies.run_file import refusals_of, refuse_mesh
from swgpar.systems import System, system_of_table

FAILED = 100.0
"""Violation of a design that is refused or whose run fails: those of limits are about 1 where a
value is twice one."""


SOUGHT = {"set", "screen", "load_case", "variable", "objective", "constraint"}
"""Keys that say what is sought; a search is continued with others of the rest."""


STATUS = ("feasible", "infeasible", "failed")
"""Of evaluations, the best first: a constraint is violated, the design is refused or its run ended
in an error."""


@dataclass(frozen=True)
class Evaluation:
    """What became of a design.

    values : of the variables, by name
    status : one of `STATUS`;  reason : one sentence, empty when feasible
    quantities : those of objectives and constraints by name, as far as they are known
    verdicts : those that constraints ask for, by name
    violations : of the constraints, by their description; 0 and less is allowed
    wall_s : seconds
    """

    values: dict[str, Any]
    status: str
    reason: str
    quantities: dict[str, float]
    violations: dict[str, float]
    verdicts: dict[str, str] = field(default_factory=dict)
    wall_s: float = 0.0


@dataclass(frozen=True)
class Problem:
    """A checked problem.

    table : content of the design file with `set`
    cases : load cases, in the order of the file; one without a name where it has none
    start : the design of the file as a point of the search
    mesh, recipe : of a drive
    units : of the variables and quantities, by name
    known : quantities by name, derived ones included
    """

    section: OptimiseSection
    system: System[Any, Any]
    table: dict[str, Any]
    cases: tuple[ProblemCase, ...]
    start: StartDesign
    mesh: Path | None
    recipe: MeshRecipe | None
    units: dict[str, str]
    known: dict[str, Quantity]

    @property
    def identity(self) -> str:
        """A number that stands for what is computed: a search is only continued with the same."""
        content = (
            self.section.model_dump(include=SOUGHT),
            [case.table for case in self.cases],
            self.recipe and self.recipe.model_dump(),
        )
        text = json.dumps(content, sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def applied(self, table: dict[str, Any], values: dict[str, Any]) -> dict[str, Any]:
        """The content of a design file with the values of the variables, by name."""
        for variable in self.section.variable:
            if variable.name in values:
                for key in variable.keys:
                    table = with_value(table, key, values[variable.name])
        return table

    def evaluate(self, values: dict[str, Any], comm: MPI.Comm) -> Evaluation:
        """Compute the load cases of a design; collective. A design that is refused or fails is an
        outcome."""
        found = _Found(self, values)
        designs = []
        try:
            for case in self.cases:
                design = case.load(self.applied(case.table, values))
                designs.append(design)
                found.note(case, CaseOutcome(case.derive(design)))
        except InputError as error:
            return found.ended(str(error))
        if found.violated:
            return found.ended("")
        mesh = str(self.mesh or "")
        options = RunOptions(recipe=self.recipe, recipe_name=mesh, plain=True, comm=comm)
        with self.system.shared() as system:
            for case, design in zip(self.cases, designs):
                outcome = case.compute(design, system, options)
                found.note(case, outcome)
                if failure := found.failure(case, outcome):
                    return found.ended(failure)
        return found.ended("")


class _Found:
    """What is known of a design, load case by load case."""

    def __init__(self, problem: Problem, values: dict[str, Any]) -> None:
        self._problem, self._values = problem, values
        self._quantities: dict[str, float] = {}
        self._verdicts: dict[str, str] = {}
        self._distances: dict[str, float] = {}
        self._seconds = 0.0

    def note(self, case: ProblemCase, outcome: CaseOutcome) -> None:
        """A load case has been computed."""
        self._quantities |= {
            one.name: float(outcome.values[one.quantity])
            for one in case.wanted
            if one.quantity in outcome.values and not one.is_verdict
        }
        self._verdicts |= outcome.verdicts
        self._distances |= outcome.distances
        self._seconds += outcome.wall_s

    def failure(self, case: ProblemCase, outcome: CaseOutcome) -> str:
        """Why the case does not give what is asked of it; empty where it does."""
        where = f"load case {case.section.name}: " if case.section.name else ""
        if outcome.reason:
            return f"{where}{outcome.reason}"
        for one in case.wanted:
            value = self._quantities.get(one.name, math.nan)
            if one.is_verdict:
                continue
            if math.isnan(value):
                return f"{where}the run has no value of {one.quantity}"
            if math.isinf(value) and isinstance(one, Objective):
                return f"{where}{one.quantity} is without end"
            if one.quantity in outcome.unbounded:  # a smaller number there is no better design
                return f"{where}{one.quantity} has no limit: it grows with every finer mesh"
        return ""

    @property
    def _violations(self) -> dict[str, float]:
        violations: dict[str, float] = {}
        for constraint in self._problem.section.constraint:
            value = self._quantities.get(constraint.name, math.nan)
            if not constraint.is_verdict and not math.isnan(value):
                violations |= constraint.violations(value)
        return violations | self._distances

    @property
    def violated(self) -> list[str]:
        """Descriptions of the constraints that are known to be violated."""
        return [text for text, amount in self._violations.items() if amount > 0.0]

    def ended(self, failure: str) -> Evaluation:
        """The evaluation. failure : empty where all cases have given what is asked of them"""
        violations, status, reason = self._violations, "feasible", ""
        if failure:
            status, reason = "failed", failure
            violations["failed"] = FAILED
        elif self.violated:
            status, reason = "infeasible", f"{', '.join(self.violated)} is not kept"
        return Evaluation(
            self._values,
            status,
            reason,
            self._quantities,
            violations,
            self._verdicts,
            self._seconds,
        )


def make_problem(spec: Specification, screen: bool = False) -> Problem:
    """The checked problem of a file, or that of its screen; every problem of the file is an
    InputError."""
    with refusals_of(spec.name):
        return _make(spec, spec.section, spec.section.screen if screen else None)


def _make(spec: Specification, section: OptimiseSection, screen: Screen | None) -> Problem:
    table = apply_overrides(read_toml(spec.folder / section.design), section.set)
    cheaper = screen.set if screen else []
    system = system_of_table(table)
    rated = apply_overrides(table, cheaper)
    # what the file does not ask for itself is left out of runs, as in studies
    quiet = apply_overrides(system.without_output(rated), [*section.set, *cheaper])
    mesh, recipe = (screen.mesh if screen else "") or section.mesh, None
    if "mesh" not in system.options:
        refuse_mesh("optimise.mesh", mesh, system)
    elif not mesh:
        raise InputError("optimise.mesh is missing: give a mesh recipe")
    else:
        recipe = load_recipe(spec.mesh(mesh))
    cases = []
    for case in section.load_case or [LoadCaseSection.model_construct(name="")]:
        wanted = [one for one in section.wanted if one.case == case.name]
        cases.append(make_case(case, system, (quiet, rated), wanted))
    known = {
        one.name: case.known[one.quantity]
        for case in cases
        for one in case.wanted
        if one.quantity in case.known
    }
    designs = [case.design for case in cases]
    units = {name: quantity.unit for name, quantity in known.items()}
    for variable in section.variable:
        found = (unit_of_key(design, variable.name) for design in designs)
        units[variable.name] = next(filter(None, found), "")
    problem = Problem(
        section=section,
        system=system,
        table=table,
        cases=tuple(cases),
        start=start_design(section.variable, designs),
        mesh=spec.mesh(mesh) if mesh else None,
        recipe=recipe,
        units=units,
        known=known,
    )
    for variable in section.variable:
        _require_keys(problem, variable)
    return problem


NO_KEY = ("is not a key of", "cannot be applied", "is not a section")
"""Words of refusals of a key, and not of its value."""


def _require_keys(problem: Problem, variable: Variable) -> None:
    """Refuse a variable whose keys the design does not have, whatever their value; a value that
    does not fit the others is no matter here."""
    for value in variable.choices or (variable.low, variable.high):
        tried = int(value) if variable.integer else value
        for case in problem.cases:
            try:
                case.load(problem.applied(case.table, {variable.name: tried}))
            except InputError as error:
                if any(words in str(error) for words in NO_KEY):
                    raise
