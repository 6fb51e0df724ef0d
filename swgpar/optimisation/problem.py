"""From the values of the variables to a design, its run, and what objectives and constraints make
of it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.errors import InputError
from swgpar.input.quantities import unit_of_key
from swgpar.input.toml_file import apply_overrides, read_toml, with_value
from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.meshing.recipe import is_recipe_name
from swgpar.optimisation.spec import OptimiseSection, Specification
from swgpar.results.quantity import Quantity
from swgpar.run_options import RunOptions
from swgpar.studies.case import PlannedRun, not_known
from swgpar.studies.job import run_planned
from swgpar.systems import System, system_of_table

FAILED = 100.0
"""Violation of a design that is refused or whose run fails: those of limits are about 1 where a
value is twice one."""


@dataclass(frozen=True)
class Evaluation:
    """What became of a design.

    values : of the variables, by name
    status : "feasible", "infeasible" (a constraint is violated) or "failed" (refused, or the run
    ended in an error)
    reason : one sentence, empty when feasible
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
    def names(self) -> list[str]:
        """Quantities of objectives and constraints."""
        return self.section.quantities

    @property
    def identity(self) -> str:
        """A number that stands for what is computed: a search is only continued with the same."""
        kept = {
            "evaluations",
            "storage",
            "parallel",
            "title",
            "remarks",
            "first",
            "sampler",
            "seed",
            "design",
            "mesh",
        }
        content = (
            self.section.model_dump(exclude=kept),
            self.run_table,
            self.recipe and self.recipe.model_dump(),
        )
        return hashlib.sha256(
            json.dumps(content, sort_keys=True, default=str).encode()
        ).hexdigest()[:16]

    def applied(self, table: dict[str, Any], values: dict[str, Any]) -> dict[str, Any]:
        """The content of a design file with the values of the variables, by name."""
        for variable in self.section.variable:
            if variable.name in values:
                for key in variable.keys:
                    table = with_value(table, key, values[variable.name])
        return table

    def evaluate(
        self,
        values: dict[str, Any],
        comm: MPI.Comm,
        on_increment: Callable[[], None] = lambda: None,
    ) -> Evaluation:
        """Run a design; collective. A design that is refused or fails is an outcome."""
        design, refusal, quantities = None, "", {}
        try:
            design = self.system.load(self.applied(self.run_table, values))
            if self.derived:
                derived = self.system.check(design)
                quantities = {name: float(derived[name]) for name in self.derived}
        except InputError as error:
            refusal = str(error)
        violations = self._violations(quantities)
        if refusal or any(amount > 0.0 for amount in violations.values()):
            return self._ended(values, refusal, quantities, 0.0)
        planned = PlannedRun(self.system, design, self.recipe, str(self.mesh or ""))
        outcome = run_planned(planned, RunOptions(comm=comm, on_increment=on_increment))
        quantities |= {
            name: float(outcome.values[name]) for name in self.names if name in outcome.values
        }
        reason = outcome.reason
        missing = [name for name in self.names if not np.isfinite(quantities.get(name, np.nan))]
        if not reason and missing:
            reason = f"the run has no value of {missing[0]}"
        return self._ended(values, reason, quantities, outcome.wall_s or 0.0)

    def _violations(self, quantities: dict[str, float]) -> dict[str, float]:
        found: dict[str, float] = {}
        for constraint in self.section.constraint:
            if np.isfinite(quantities.get(constraint.quantity, np.nan)):
                found |= constraint.violations(quantities[constraint.quantity])
        return found

    def _ended(
        self, values: dict[str, Any], failure: str, quantities: dict[str, float], wall_s: float
    ) -> Evaluation:
        violations = self._violations(quantities)
        broken = [text for text, amount in violations.items() if amount > 0.0]
        if failure:
            return Evaluation(
                values, "failed", failure, quantities, violations | {"failed": FAILED}, wall_s
            )
        reason = f"{', '.join(broken)} is not kept" if broken else ""
        return Evaluation(
            values, "infeasible" if broken else "feasible", reason, quantities, violations, wall_s
        )


def make_problem(spec: Specification, screen: bool = False) -> Problem:
    """The checked problem of a file, or that of its screen; every problem of the file is an
    InputError."""
    section = spec.section
    try:
        return _make(section, spec.folder, screen)
    except InputError as error:
        raise InputError(f"{spec.name}: {error}") from None


def _make(section: OptimiseSection, folder: Path, screen: bool) -> Problem:
    table = apply_overrides(read_toml(folder / section.design), section.set)
    cheaper = section.screen if screen else None
    run_table = apply_overrides(table, cheaper.set) if cheaper else table
    system = system_of_table(table)
    # what the file does not ask for itself is left out, as in studies
    quiet = apply_overrides(
        system.without_output(run_table), [*section.set, *(cheaper.set if cheaper else ())]
    )
    mesh, recipe = None, None
    named = (cheaper.mesh if cheaper else "") or section.mesh
    if "mesh" in system.options:
        if not named:
            raise InputError("optimise.mesh is missing: give a mesh recipe")
        mesh = Path(named) if is_recipe_name(named) else folder / named
        recipe = load_recipe(mesh)
    elif named:
        raise InputError(f"optimise.mesh has no meaning for {system.noun}: leave it out")
    design = system.load(quiet)
    known, derived = dict(system.quantities(design)), set()
    for name in section.quantities:
        if name not in known:
            if name not in system.check(design):
                raise not_known("optimise: ", known, system, name)
            known[name] = Quantity("by swgpar check", "")
            derived.add(name)
    units = {variable.name: unit_of_key(design, variable.name) for variable in section.variable}
    problem = Problem(section, system, table, quiet, mesh, recipe, units, known, frozenset(derived))
    for variable in section.variable:
        value = variable.choices[0] if variable.choices else variable.low
        _require_key(problem, variable.name, int(value) if variable.integer else value)
    return problem


def _require_key(problem: Problem, name: str, value: Any) -> None:
    """Refuse a variable that is no key of the design; a value that does not fit the others is no
    matter here."""
    try:
        problem.system.load(problem.applied(problem.run_table, {name: value}))
    except InputError as error:
        if "is not a key of" in str(error):
            raise
