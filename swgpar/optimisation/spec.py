"""The optimisation file: variables with bounds, objectives, constraints, and how they are
searched."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from typing import Any, Literal

from swgpar.errors import InputError
from swgpar.input.arguments import given_path
from swgpar.input.quantities import Section, quantity, show, show_key
from swgpar.input.regular_file import read_regular
from swgpar.input.require import require
from swgpar.input.toml_file import read_toml, split_override, validate
from swgpar.studies.run_file import RunFile, RunsSection, flat, refusals_of, require_only


class Variable(Section):
    """One `[[optimise.variable]]`: keys of the design file that get one value."""

    keys: list[str] = quantity(text="keys of the design file that take the value", min_length=1)
    low: float | None = quantity(None, text="lower bound, in the unit of the keys")
    high: float | None = quantity(None, text="upper bound")
    log: bool = quantity(False, text="search on a logarithmic scale")
    integer: bool = quantity(False, text="whole numbers only")
    choices: list[Any] = quantity([], text="values to choose from, in place of bounds")

    @property
    def name(self) -> str:
        """Name in tables: the first key."""
        return self.keys[0]

    def taken(self, value: Any) -> Any:
        """The value as the variable has it, 2 for 2.0 where whole numbers are meant; None where it
        is no choice, or beyond a bound."""
        kinds = (int, float) if self.choices or self.integer else ()
        others = [kind(value) for kind in kinds if type(value) in kinds and kind(value) == value]
        return next((one for one in (value, *others) if self.takes(one)), None)

    def takes(self, value: Any) -> bool:
        """Whether a value is one of the choices, or within the bounds."""
        if self.choices:
            return any(value == one and type(value) is type(one) for one in self.choices)
        kinds = (int,) if self.integer else (int, float)
        if isinstance(value, bool) or not isinstance(value, kinds):
            return False
        return self.low is not None and self.high is not None and self.low <= value <= self.high

    @property
    def is_whole(self) -> bool:
        """Whether it has whole numbers only."""
        return self.integer or (bool(self.choices) and all(type(x) is int for x in self.choices))

    @property
    def range_text(self) -> str:
        """The values that it takes, in words."""
        if self.choices:
            return ", ".join(map(show, self.choices))
        whole = " whole numbers" if self.integer else ""
        return f"{show(self.low)} to {show(self.high)}{whole}"


class LoadCaseSection(Section):
    """One `[[optimise.load_case]]`: what is computed of every design."""

    name: str = quantity(text="name: letters, digits, _ and -")
    rate: bool = quantity(
        False, text="the rating sheet of the design, which has [rating], in place of one run"
    )
    without: list[str] = quantity(
        [], text="sections of the design file that the case does not have"
    )
    set: list[str] = quantity([], text='"section.key=value" of this case')


class Wanted(Section):
    """What objectives and constraints have in common."""

    case: str = quantity("", text="name of the load case, where there are load cases")
    quantity: str = quantity(text="quantity of a run, of swgpar check, or of a rating sheet")

    @property
    def name(self) -> str:
        """Name in tables: the quantity, after its load case if there is one."""
        return f"{self.case}: {self.quantity}" if self.case else self.quantity

    @property
    def is_verdict(self) -> bool:
        """Whether a verdict is meant, and no number."""
        return False


class Objective(Wanted):
    """One `[[optimise.objective]]`."""

    goal: Literal["minimise", "maximise"] = quantity("minimise", text="what is sought")

    @property
    def sign(self) -> float:
        """Its product with a value is sought as small as possible."""
        return 1.0 if self.goal == "minimise" else -1.0


HEADLINE = "headline"
"""Name of the worst verdict of a rating sheet."""


class Constraint(Wanted):
    """One `[[optimise.constraint]]`."""

    at_most: float | None = quantity(
        None, text="largest value allowed, in the unit of the quantity"
    )
    at_least: float | None = quantity(None, text="least value allowed")
    verdict: Literal["", "passes", "not judged", "within its error"] = quantity(
        "", text=f'worst verdict allowed of a row of a rating sheet, or of its "{HEADLINE}"'
    )

    @property
    def is_verdict(self) -> bool:
        return bool(self.verdict)

    @property
    def words(self) -> str:
        """What it asks for."""
        return self.verdict or ", ".join(self.limits)

    @property
    def limits(self) -> dict[str, tuple[float, float]]:
        """Limit by its description, and the sign of a violation."""
        limits = {"at most": (self.at_most, 1.0), "at least": (self.at_least, -1.0)}
        return {
            f"{words} {limit:g}": (limit, sign)
            for words, (limit, sign) in limits.items()
            if limit is not None
        }

    def violations(self, value: float) -> dict[str, float]:
        """How far a value is beyond the limits, over their sizes; 0 and less is allowed."""
        return {
            f"{self.name} {words}": sign * (value - limit) / (abs(limit) or 1.0)
            for words, (limit, sign) in self.limits.items()
        }


class Screen(Section):
    """`[optimise.screen]`: a search on a cheaper model, whose best designs begin the search
    proper."""

    set: list[str] = quantity([], text='"section.key=value" that make the model cheaper')
    mesh: str = quantity(
        "", text="mesh recipe of the cheaper model; else that of the search proper"
    )
    evaluations: int = quantity(text="runs of the cheaper model", ge=1, le=100_000)
    best: int = quantity(
        5, text="its best designs that are tried first in the search proper", ge=1, le=1000
    )


class OptimiseSection(RunsSection):
    """The `[optimise]` without its lists of tables."""

    mesh: str = quantity("", text="mesh recipe of a drive, relative to this file")
    evaluations: int = quantity(
        text="designs that are tried, refused and failed ones included", ge=1, le=100_000
    )
    sampler: Literal["tpe", "nsga2", "random"] = quantity(
        "tpe", text="tree-structured Parzen estimator, NSGA-II, or random designs"
    )
    seed: int = quantity(1, text="of the random numbers", ge=0, le=2**31)
    storage: str = quantity("", text="URL of a database; else a file in the folder of the results")
    first: list[dict[str, Any]] = quantity([], text="designs that are tried first: values by key")
    screen: Screen | None = None
    load_case: list[LoadCaseSection] = quantity([], text="the load cases; without any it is one")
    variable: list[Variable] = quantity([], text="the variables")
    objective: list[Objective] = quantity([], text="the objectives")
    constraint: list[Constraint] = quantity([], text="the constraints")

    @property
    def quantities(self) -> list[str]:
        """Names of the quantities of objectives and constraints."""
        return list(dict.fromkeys(one.name for one in self.wanted if not one.is_verdict))

    @property
    def wanted(self) -> list[Wanted]:
        """Objectives and constraints."""
        return [*self.objective, *self.constraint]


class _File(Section):
    optimise: OptimiseSection


NAME = r"[A-Za-z0-9_-]+"
"""Names of load cases."""

Specification = RunFile[OptimiseSection]
"""The checked content of an optimisation file."""


def load_specification(path: str | Path) -> Specification:
    """Read and check an optimisation file; every problem is an `InputError` of one sentence that
    names the file."""
    path = given_path("optimisation", path)
    table = read_toml(path)
    with refusals_of(str(path)):
        require_only("optimise", table, "an optimisation file")
        section = validate(_File, table).optimise
        section = section.model_copy(update={"first": [flat(entry) for entry in section.first]})
        _check(section)
    return Specification(str(path), path.parent, read_regular(path).decode("utf-8-sig"), section)


def _check(section: OptimiseSection) -> None:
    for kind in ("variable", "objective"):
        if not getattr(section, kind):
            raise InputError(f"optimise.{kind} is missing: allowed one [[optimise.{kind}]] or more")
    for override in section.set:
        split_override(override)
    seen: set[str] = set()
    for variable in section.variable:
        _check_variable(variable, seen)
    for constraint in section.constraint:
        if not constraint.words:
            raise InputError(
                f"optimise.constraint {show(constraint.quantity)} has no limit: give at_most or "
                "at_least, or the verdict of a row of a rating sheet"
            )
    _check_load_cases(section)
    named = {variable.name: variable for variable in section.variable}
    for number, first in enumerate(section.first, start=1):
        for key, value in first.items():
            where = f"optimise.first {number}: {show_key(key)}"
            if key not in named:
                raise InputError(f"{where} is no variable: allowed {', '.join(named)}")
            require(named[key].takes(value), where, value, named[key].range_text)


def _check_load_cases(section: OptimiseSection) -> None:
    varied = {key for variable in section.variable for key in variable.keys}
    cases = {case.name: case for case in section.load_case}
    for name, count in Counter(case.name for case in section.load_case).items():
        where = f"optimise.load_case: name = {show(name)}"
        if not re.fullmatch(NAME, name):
            raise InputError(f"{where} is no name: allowed letters, digits, _ and -")
        if count > 1:
            raise InputError(f"{where} is given twice: allowed are different names")
        for override in cases[name].set:
            key, _ = split_override(override)
            if key in varied:
                raise InputError(
                    f"optimise.load_case {show(name)}: {show_key(key)} is a variable, and has one "
                    "value in all load cases"
                )
    for one in section.wanted:
        kind = "objective" if isinstance(one, Objective) else "constraint"
        where = f"optimise.{kind} {show(one.quantity)}"
        if one.case not in (cases or {"": None}):
            given = f"case = {show(one.case)} is no load case" if one.case else "case is missing"
            names = ", ".join(cases) or "none without [[optimise.load_case]]"
            raise InputError(f"{where}: {given}: allowed {names}")
        rated = bool(cases) and cases[one.case].rate
        if one.is_verdict and not rated:
            raise InputError(
                f"{where}: verdict has no meaning for a run: allowed of load cases with rate = true"
            )
        if isinstance(one, Constraint) and one.verdict and one.limits:
            raise InputError(f"{where} has a verdict and a limit: allowed is one of both")
        if rated and one.quantity == HEADLINE and not one.is_verdict:
            raise InputError(f"{where} is a verdict and no number: give verdict in a constraint")


def _check_variable(variable: Variable, seen: set[str]) -> None:
    where = f"optimise.variable {show(variable.name)}"
    for key in variable.keys:
        if "." not in key:
            raise InputError(f"{where}: {show_key(key)} is no key: allowed section.key")
        if key in seen:
            raise InputError(f"{where}: {show_key(key)} is varied twice: allowed once")
        seen.add(key)
    missing = [variable.low, variable.high].count(None)
    if missing != (2 if variable.choices else 0):
        raise InputError(f"{where} needs low and high, or choices: allowed is one of both")
    if variable.choices:
        if not all(isinstance(choice, (bool, int, float, str)) for choice in variable.choices):
            raise InputError(
                f"{where}: choices = {show(variable.choices)}: allowed are numbers and texts"
            )
        return
    low, high = float(variable.low), float(variable.high)
    require(low < high, f"{where}: high", high, f"above {low:g} (low)")
    require(low > 0.0 or not variable.log, f"{where}: low", low, "above 0 with log = true")
    if variable.integer and not (low.is_integer() and high.is_integer()):
        raise InputError(
            f"{where}: low = {low:g}, high = {high:g}: allowed whole numbers with integer = true"
        )
