"""Choices of a drive on one mesh: increments, contact quadrature, linear solver. Errors are
differences.

Without friction the state does not depend on the path to it: the increment changes the seconds
only.
"""

from __future__ import annotations

from cases import Cases
from drive_cases import PERIOD, PLANE, PLANE_MESHES
from drive_runs import run

SMALL, TINY = "tests/data/small.toml", "tests/data/tiny.toml"

INCREMENTS = (4.0, 2.0, 1.0, 0.5, 0.25, 0.125)
"""Degrees, on a rotation by the first; the last one is the reference."""

STATE = ("last.fs_s1", "last.wg_torque_Nmm", "last.output_angle_deg")
MEANS = ("fs_s1", "fs_vm", "wg_torque_Nmm")


def increments(cases: Cases) -> None:
    """The state after 4 degrees, reached in increments, without friction and with it."""
    for friction in (0.0, 0.1):
        solved = []
        for increment in INCREMENTS:
            keys = [
                f"steps.rotation={INCREMENTS[0]}",
                f"steps.increment={increment}",
                f"contact.friction={friction}",
            ]
            folder = cases.out / f"increment_{increment:g}_friction_{friction:g}"
            solved.append(run(folder, PLANE, PLANE_MESHES[0], keys, cases.ranks))
        found = {q: (solved[-1]["values"][q], f"increment {INCREMENTS[-1]:g}") for q in STATE}
        levels = [f"{i:g} deg" for i in INCREMENTS[:-1]]
        cases.series(
            "increment", f"friction {friction:g}", solved[:-1], found, {}, levels, cases.ranks
        )


def quadrature(cases: Cases) -> None:
    """Lines of contact on a layer of the small cup drive; Gauss points of the cam in the plane. The
    reference has eight."""
    counts = (1, 2, 3, 4, 8)
    for key, design, mesh, overrides, problem in (
        ("quadrature", SMALL, TINY, [], "lines on a layer, small cup drive"),
        ("wg_quadrature", PLANE, PLANE_MESHES[0], PERIOD, "quadrature"),
    ):
        solved = [
            run(
                cases.out / f"{key}_{n}",
                design,
                mesh,
                [*overrides, f"contact.{key}={n}"],
                cases.ranks,
            )
            for n in counts
        ]
        found = {q: (solved[-1]["values"][q], "8 points") for q in MEANS}
        cases.series(
            problem,
            f"contact.{key}",
            solved[:-1],
            found,
            {},
            list(counts[:-1]),
            cases.ranks,
            False,
        )


def solvers(cases: Cases) -> None:
    """MUMPS and GAMG on the small cup drive of the tests."""
    solved = {
        linear: run(
            cases.out / f"linear_{linear}", SMALL, TINY, [f"solver.linear={linear}"], cases.ranks
        )
        for linear in ("direct", "iterative")
    }
    found = {q: (solved["direct"]["values"][q], "direct") for q in MEANS}
    for linear, one in solved.items():
        cases.series(
            "solver, small cup drive", linear, [one], found, {}, ["tiny"], cases.ranks, False
        )


def compute(cases: Cases) -> None:
    """All choices."""
    for group in (increments, quadrature, solvers):
        group(cases)
