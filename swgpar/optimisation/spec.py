"""The optimisation file: variables with bounds, objectives, constraints, and how they are
searched."""

from __future__ import annotations

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

    def takes(self, value: Any) -> bool:
        """Whether a value is one of the choices, or within the bounds."""
        if self.choices:
            return any(value == one and type(value) is type(one) for one in self.choices)
        kinds = (int,) if self.integer else (int, float)
        if isinstance(value, bool) or not isinstance(value, kinds):
            return False
        return self.low is not None and self.high is not None and self.low <= value <= self.high

    @property
    def range_text(self) -> str:
        """The values that it takes, in words."""
        if self.choices:
            return ", ".join(map(show, self.choices))
        whole = " whole numbers" if self.integer else ""
        return f"{show(self.low)} to {show(self.high)}{whole}"


class Objective(Section):
    """One `[[optimise.objective]]`."""

    goal: Literal["minimise", "maximise"] = quantity("minimise", text="what is sought")
    quantity: str = quantity(text="quantity of a run, or of swgpar check")

    @property
    def sign(self) -> float:
        """Its product with a value is sought as small as possible."""
        return 1.0 if self.goal == "minimise" else -1.0


class Constraint(Section):
    """One `[[optimise.constraint]]`."""

    at_most: float | None = quantity(
        None, text="largest value allowed, in the unit of the quantity"
    )
    at_least: float | None = quantity(None, text="least value allowed")
    quantity: str = quantity(text="quantity of a run, or of swgpar check")

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
            f"{self.quantity} {words}": sign * (value - limit) / (abs(limit) or 1.0)
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
    variable: list[Variable] = quantity([], text="the variables")
    objective: list[Objective] = quantity([], text="the objectives")
    constraint: list[Constraint] = quantity([], text="the constraints")

    @property
    def quantities(self) -> list[str]:
        """Names of the quantities of objectives and constraints."""
        names = [objective.quantity for objective in self.objective]
        return list(dict.fromkeys(names + [constraint.quantity for constraint in self.constraint]))


class _File(Section):
    optimise: OptimiseSection


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
        if constraint.at_most is None and constraint.at_least is None:
            raise InputError(
                f"optimise.constraint {show(constraint.quantity)} has no limit: give at_most or "
                "at_least"
            )
    named = {variable.name: variable for variable in section.variable}
    for number, first in enumerate(section.first, start=1):
        for key, value in first.items():
            where = f"optimise.first {number}: {show_key(key)}"
            if key not in named:
                raise InputError(f"{where} is no variable: allowed {', '.join(named)}")
            require(named[key].takes(value), where, value, named[key].range_text)


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
