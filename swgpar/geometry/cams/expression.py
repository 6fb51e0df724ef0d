"""Polar expressions of cams: a small language for the radius as a function of the angle.

A text has assignments, separated by semicolons or line ends, and one expression at its end:

    s = theta / (pi / 2); a - (a - b) * (10 * s**3 - 15 * s**4 + 6 * s**5)

It has numbers, names, + - * / **, parentheses, `A if CONDITION else B` with < <= > >=, `and` and
`or`, and the functions of `FUNCTIONS`. Exponents do not depend on the angle. Nothing else is
evaluated: the text is parsed, and each node of its tree is one of these or refused. First and
second derivatives by the angle are exact.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.arrays import Floats
from swgpar.input.quantities import show

LONGEST, MOST_NODES = 2000, 300
"""Characters of a text, and nodes of its tree, at most."""

LARGEST = 1e100
"""Largest number in a text."""


class Jet(NamedTuple):
    """A function of the angle at points: value (n,) and first two derivatives (n,)."""

    value: Floats
    first: Floats
    second: Floats

    def of(self, value: Floats, first: Floats, second: Floats) -> Jet:
        """A function f of this one by the chain rule, from f, f' and f'' at its values."""
        return Jet(value, first * self.first, second * self.first**2 + first * self.second)


def _constant(value: float | Floats, like: Floats) -> Jet:
    zero = np.zeros_like(like)
    return Jet(np.broadcast_to(np.asarray(value, dtype=float), like.shape), zero, zero)


def _power(x: Jet, n: float) -> Jet:
    return x.of(
        x.value**n,
        n * x.value ** (n - 1.0) if n else 0.0 * x.value,
        n * (n - 1.0) * x.value ** (n - 2.0) if n not in (0.0, 1.0) else 0.0 * x.value,
    )


def _tangent(x: Jet) -> Jet:
    t = np.tan(x.value)
    return x.of(t, 1.0 + t * t, 2.0 * t * (1.0 + t * t))


def _exponential(x: Jet) -> Jet:
    e = np.exp(x.value)
    return x.of(e, e, e)


FUNCTIONS: dict[str, Callable[[Jet], Jet]] = {
    "sin": lambda x: x.of(np.sin(x.value), np.cos(x.value), -np.sin(x.value)),
    "cos": lambda x: x.of(np.cos(x.value), -np.sin(x.value), -np.cos(x.value)),
    "tan": _tangent,
    "sqrt": lambda x: _power(x, 0.5),
    "exp": _exponential,
    "log": lambda x: x.of(np.log(x.value), 1.0 / x.value, -1.0 / x.value**2),
    "abs": lambda x: x.of(np.abs(x.value), np.sign(x.value), 0.0 * x.value),
}
"""Functions of one argument."""

COMPARISONS: dict[type[ast.cmpop], Callable[[Floats, Floats], np.ndarray]] = {
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
}


class PolarExpression:
    """A parsed text.

    text : in the language above;  names : with their values
    key : of the design file, for messages

    Raises InputError where the text is not in the language.
    """

    def __init__(self, text: str, names: Mapping[str, float], key: str) -> None:
        self.key, self.names = key, dict(names)
        if len(text) > LONGEST:
            raise InputError(
                f"{key} has {len(text)} characters: allowed up to {LONGEST} in an expression"
            )
        lines = "\n".join(line.strip() for line in text.strip().splitlines())
        try:
            self.statements = ast.parse(lines).body
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            line = error.text if isinstance(error, SyntaxError) else None
            place = f" at {show(line.strip())}" if line else ""
            raise InputError(
                f"{key} cannot be read{place}: allowed are assignments, separated by semicolons, "
                "and an expression at the end"
            ) from None
        nodes = sum(1 for statement in self.statements for _ in ast.walk(statement))
        if nodes > MOST_NODES:
            raise InputError(f"{key} has {nodes} parts: allowed up to {MOST_NODES}")
        if not self.statements or not isinstance(self.statements[-1], ast.Expr):
            raise InputError(f"{key} has no expression at its end: allowed is one, the radius")

    def __call__(self, theta: Floats) -> Jet:
        """The radius at angles (n,) rad."""
        one, zero = np.ones_like(theta), np.zeros_like(theta)
        known = {name: _constant(value, theta) for name, value in self.names.items()}
        known |= {"theta": Jet(theta, one, zero), "pi": _constant(np.pi, theta)}
        with np.errstate(all="ignore"):  # what is not finite is refused by the caller
            for statement in self.statements[:-1]:
                if not isinstance(statement, ast.Assign) or len(statement.targets) != 1:
                    raise self._refused(statement, "an assignment")
                target = statement.targets[0]
                if not isinstance(target, ast.Name):
                    raise self._refused(target, "a name")
                if target.id in FUNCTIONS or target.id in ("theta", "pi", *self.names):
                    raise self._refused(target, "another name")
                known[target.id] = self._value(statement.value, known)
            last = self.statements[-1]
            assert isinstance(last, ast.Expr)
            return self._value(last.value, known)

    def _refused(self, node: ast.AST, allowed: str) -> InputError:
        return InputError(f"{self.key}: {show(ast.unparse(node))} is refused: allowed {allowed}")

    def _value(self, node: ast.expr, known: Mapping[str, Jet]) -> Jet:
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            if isinstance(node.value, bool) or abs(node.value) > LARGEST:
                raise self._refused(node, f"numbers up to {LARGEST:g}")
            return _constant(float(node.value), known["theta"].value)
        if isinstance(node, ast.Name):
            if node.id not in known:
                functions = [f"{name}()" for name in FUNCTIONS]
                raise self._refused(node, ", ".join([*known, *functions]))
            return known[node.id]
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
            x = self._value(node.operand, known)
            return x if isinstance(node.op, ast.UAdd) else Jet(*map(np.negative, x))
        if isinstance(node, ast.BinOp):
            return self._binary(node, known)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            function = FUNCTIONS.get(node.func.id)
            if function is None or len(node.args) != 1 or node.keywords:
                raise self._refused(node, f"{', '.join(FUNCTIONS)} of one argument")
            return function(self._value(node.args[0], known))
        if isinstance(node, ast.IfExp):
            where = self._condition(node.test, known)
            here, there = self._value(node.body, known), self._value(node.orelse, known)
            return Jet(*(np.where(where, *each) for each in zip(here, there, strict=True)))
        raise self._refused(
            node, "numbers, names, + - * / **, if with else, and functions of one argument"
        )

    def _binary(self, node: ast.BinOp, known: Mapping[str, Jet]) -> Jet:
        x, y = self._value(node.left, known), self._value(node.right, known)
        if isinstance(node.op, ast.Add):
            return Jet(*map(np.add, x, y))
        if isinstance(node.op, ast.Sub):
            return Jet(*map(np.subtract, x, y))
        if isinstance(node.op, ast.Pow):
            if not np.isfinite(y.value).all():
                raise self._refused(node, "finite exponents")
            if y.first.any() or y.second.any() or np.ptp(y.value):
                raise self._refused(node, "exponents that do not depend on theta")
            return _power(x, float(y.value[0]))
        if isinstance(node.op, ast.Div):
            y = _power(y, -1.0)
        elif not isinstance(node.op, ast.Mult):
            raise self._refused(node, "+ - * / **")
        return Jet(
            x.value * y.value,
            x.first * y.value + x.value * y.first,
            x.second * y.value + 2.0 * x.first * y.first + x.value * y.second,
        )

    def _condition(self, node: ast.expr, known: Mapping[str, Jet]) -> np.ndarray:
        if isinstance(node, ast.BoolOp):
            join = np.logical_and if isinstance(node.op, ast.And) else np.logical_or
            return np.asarray(join.reduce([self._condition(one, known) for one in node.values]))
        if isinstance(node, ast.Compare) and all(type(op) in COMPARISONS for op in node.ops):
            values = [self._value(one, known).value for one in (node.left, *node.comparators)]
            holds = [
                COMPARISONS[type(op)](left, right)
                for op, left, right in zip(node.ops, values[:-1], values[1:], strict=True)
            ]
            return np.asarray(np.logical_and.reduce(holds))
        raise self._refused(node, "comparisons by < <= > >=, and, or")
