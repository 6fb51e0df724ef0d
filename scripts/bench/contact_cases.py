"""Hertz's line contact and the ring on an elliptical cam: elements, quadrature of the cam, solver
and ranks."""

from __future__ import annotations

from cases import Case, Cases, references

HERTZ: dict[str, Case] = {"C3D8I": {"incompatible": True}, "C3D8": {"incompatible": False}}
HERTZ_LEVELS = 4

PLAIN = {"plane": True, "incompatible": True, "quadrature": 3, "linear": "direct"}
RING: dict[str, tuple[int, int, Case]] = {
    "CPS4I, quadrature 3": (6, 1, {}),
    "CPS4I, quadrature 1": (6, 1, {"quadrature": 1}),
    "CPS4I, quadrature 2": (6, 1, {"quadrature": 2}),
    "CPS4I, quadrature 7": (6, 1, {"quadrature": 7}),
    "CPS4, quadrature 3": (6, 1, {"incompatible": False}),
    "C3D8I, quadrature 3": (5, 1, {"plane": False}),
    "C3D8, quadrature 3": (5, 1, {"plane": False, "incompatible": False}),
    "CPS4I, quadrature 3, 2 ranks": (6, 2, {}),
    "CPS4I, quadrature 3, GAMG": (4, 1, {"linear": "iterative"}),
}
"""Levels, ranks and what differs from `PLAIN`, which is what `swgpar run` does; the limit is that
of the first."""


def compute(cases: Cases) -> None:
    """All choices and levels of both problems."""
    for choice, case in HERTZ.items():
        levels = cases.levels(HERTZ_LEVELS)
        solved = [cases.solved({"kind": "hertz", **case, "level": level}) for level in levels]
        cases.series("Hertz line contact", choice, solved, references(solved), {})
    limits = None
    for choice, (count, ranks, case) in RING.items():
        levels = cases.levels(count)
        solved = [
            cases.solved({"kind": "ring on cam", **PLAIN, **case, "level": k}, ranks)
            for k in levels
        ]
        limits = limits or references(solved)
        # facets lie on the cam up to terms of the square of their length
        theory = {"s1": 2.0, "contact force": 2.0} if choice == next(iter(RING)) else {}
        cases.series("ring on elliptical cam", choice, solved, limits, theory, ranks=ranks)
