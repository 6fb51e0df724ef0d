"""Elements with and without incompatible modes, MUMPS and GAMG, on the problems of
element_problems.py."""

from __future__ import annotations

from cases import Cases, references

from support.element_problems import ELEMENTS, ITERATIVE, PROBLEMS


def compute(cases: Cases) -> None:
    """All problems, elements and levels. The limits of those without a closed form are those of the
    modes' elements."""
    limits = {}
    for name, problem in PROBLEMS.items():
        for element, (plane, incompatible) in ELEMENTS.items():
            levels = cases.levels(problem.plane if plane else problem.solid)
            if not levels:
                continue
            linear = {"": "direct"} | (
                {", GAMG": "iterative"} if (name, element) in ITERATIVE else {}
            )
            for text, kind in linear.items():
                case = {"kind": "element", "problem": name, "element": element, "linear": kind}
                count = (
                    len(levels) if kind == "direct" else min(len(levels), ITERATIVE[name, element])
                )
                solved = [cases.solved({**case, "level": level}) for level in levels[:count]]
                if problem.like is None and incompatible and kind == "direct":
                    limits[name, plane] = references(solved)
                found = limits[problem.like or name, plane]
                theory = problem.rates if incompatible else {}
                cases.series(name, element + text, solved, found, theory)
