"""From the values of the variables to a design, its run, and what objectives and constraints make
of it."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.errors import InputError
from swgpar.input.quantities import unit_of_key
from swgpar.input.toml_file import apply_overrides, read_toml, with_value
from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.optimisation.spec import OptimiseSection, Screen, Specification, Variable
from swgpar.results.quantity import Quantity
from swgpar.run_options import RunOptions
from swgpar.studies.case import not_known
from swgpar.studies.job import run_one
from swgpar.studies.run_file import refusals_of, refuse_mesh
from swgpar.systems import System, system_of_table

FAILED = 100.0
"""Violation of a design that is refused or whose run fails: those of limits are about 1 where a
value is twice one."""


SOUGHT = {"set", "screen", "variable", "objective", "constraint"}
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
    violations : of the constraints, by their description; 0 and less is allowed
    wall_s : seconds
    """

    values: dict[str, Any]
    status: str
    reason: str
    quantities: dict[str, float]
    violations: dict[str, float]
    wall_s: float = 0.0


@dataclass(frozen=True)
class Problem:
    """A checked problem.

    table, run_table : content of the design file with `set`, and the same as it is run, without
    output
    mesh, recipe : of a drive
    units : of the variables, by name
    known : quantities by name, derived ones included;  derived : names of those that follow without
    a run
    """

    section: OptimiseSection
    system: System[Any, Any]
    table: dict[str, Any]
    run_table: dict[str, Any]
    mesh: Path | None
    recipe: MeshRecipe | None
    units: dict[str, str]
    known: dict[str, Quantity]
    derived: frozenset[str]

    @property
    def identity(self) -> str:
        """A number that stands for what is computed: a search is only continued with the same."""
        content = (
            self.section.model_dump(include=SOUGHT),
            self.run_table,
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
        """Run a design; collective. A design that is refused or fails is an outcome."""
        quantities: dict[str, float] = {}
        try:
            design = self.system.load(self.applied(self.run_table, values))
            if self.derived:
                derived = self.system.check(design)
                quantities = {name: float(derived[name]) for name in self.derived}
        except InputError as error:
            return self._ended(values, str(error), quantities)
        if any(amount > 0.0 for amount in self._violations(quantities).values()):
            return self._ended(values, "", quantities)
        mesh = str(self.mesh or "")
        options = RunOptions(recipe=self.recipe, recipe_name=mesh, plain=True, comm=comm)
        outcome = run_one(self.system, design, options)
        names = self.section.quantities
        quantities |= {
            name: float(outcome.values[name]) for name in names if name in outcome.values
        }
        missing = [name for name in names if not np.isfinite(quantities.get(name, np.nan))]
        growing = [name for name in names if name in outcome.unbounded]
        failure = outcome.reason
        if missing:
            failure = failure or f"the run has no value of {missing[0]}"
        elif growing:  # a smaller number there is no better design
            failure = f"{growing[0]} has no limit: it grows with every finer mesh"
        return self._ended(values, failure, quantities, outcome.wall_s or 0.0)

    def _violations(self, quantities: dict[str, float]) -> dict[str, float]:
        violations: dict[str, float] = {}
        for constraint in self.section.constraint:
            value = quantities.get(constraint.quantity, np.nan)
            if np.isfinite(value):
                violations |= constraint.violations(value)
        return violations

    def _ended(
        self,
        values: dict[str, Any],
        failure: str,
        quantities: dict[str, float],
        wall_s: float = 0.0,
    ) -> Evaluation:
        violations, status, reason = self._violations(quantities), "feasible", ""
        broken = [text for text, amount in violations.items() if amount > 0.0]
        if failure:
            status, reason = "failed", failure
            violations["failed"] = FAILED
        elif broken:
            status, reason = "infeasible", f"{', '.join(broken)} is not kept"
        return Evaluation(values, status, reason, quantities, violations, wall_s)


def make_problem(spec: Specification, screen: bool = False) -> Problem:
    """The checked problem of a file, or that of its screen; every problem of the file is an
    InputError."""
    with refusals_of(spec.name):
        return _make(spec, spec.section, spec.section.screen if screen else None)


def _make(spec: Specification, section: OptimiseSection, screen: Screen | None) -> Problem:
    table = apply_overrides(read_toml(spec.folder / section.design), section.set)
    cheaper = screen.set if screen else []
    system = system_of_table(table)
    # what the file does not ask for itself is left out, as in studies
    quiet = system.without_output(apply_overrides(table, cheaper))
    quiet = apply_overrides(quiet, [*section.set, *cheaper])
    mesh, recipe = (screen.mesh if screen else "") or section.mesh, None
    if "mesh" not in system.options:
        refuse_mesh("optimise.mesh", mesh, system)
    elif not mesh:
        raise InputError("optimise.mesh is missing: give a mesh recipe")
    else:
        recipe = load_recipe(spec.mesh(mesh))
    design = system.load(quiet)
    known, derived = dict(system.quantities(design)), set()
    for name in section.quantities:
        if name not in known:
            if name not in system.check(design):
                raise not_known("optimise: ", known, system, name)
            known[name] = Quantity("by swgpar check", "")
            derived.add(name)
    problem = Problem(
        section=section,
        system=system,
        table=table,
        run_table=quiet,
        mesh=spec.mesh(mesh) if mesh else None,
        recipe=recipe,
        units={variable.name: unit_of_key(design, variable.name) for variable in section.variable},
        known=known,
        derived=frozenset(derived),
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
        try:
            problem.system.load(problem.applied(problem.run_table, {variable.name: tried}))
        except InputError as error:
            if any(words in str(error) for words in NO_KEY):
                raise
