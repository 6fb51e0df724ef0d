"""Drives over meshes: means over a period of the largest stresses of the spline.

The plane drive and the plane section of the cup drive are refined in all directions beyond their
finest recipe. Their limit is extrapolated from the last three meshes with the order that these
show. The cup drive is too large. Its limit is extrapolated from its two finest recipes with the
order of `analysis.error_estimate`. It says little about the finest recipe; the errors of the same
recipes in the plane section say more.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from cases import Cases
from drive_runs import run

from support.convergence import limit
from support.recipes import refined
from swgpar.analysis.error_estimate import estimate

PLANE, CUP = "drivers/plane_half_turn.toml", "drivers/cup_45deg.toml"
PLANE_MESHES = ("plane_coarse", "plane", "plane_fine")
CUP_MESHES = ("coarse", "medium", "full")
PERIOD = ["steps.samples=4", "steps.start_levels=1"]
FINER = ["steps.samples=4", "steps.start_levels=3"]
CUP_PERIOD = ["steps.samples=8", "steps.start_levels=2", "steps.pins=false", "solver.rtol=1e-5"]
QUANTITIES = ("fs_s1", "fs_s3", "fs_vm")

SECTION = [
    "drive.model=plane",
    "load.torque=2",
    *(f"micro_geometry.{key}=0" for key in ("wg_crowning", "wg_slope", "fs_crowning")),
]
"""Overrides that make the plane drive of the cup drive's section, under a tenth of the torque."""

PLANE_FACTORS, SECTION_FACTORS = (1, 1.5, 2), (1, 2, 3)
"""Of the finest recipe's counts: the meshes from which limits are extrapolated."""

COUNTS = {
    "root x 2": ("flexible_spline.root",),
    "under, rim x 2": ("flexible_spline.under", "flexible_spline.rim"),
    "root, under, rim x 2": (
        "flexible_spline.root",
        "flexible_spline.under",
        "flexible_spline.rim",
    ),
    "flank, layers x 2": (
        "flexible_spline.flank",
        "flexible_spline.layers",
        "ring_gear.flank",
        "ring_gear.layers",
    ),
}
"""Keys of the middle plane recipe that are doubled, to see which are worth it."""


def refinements(
    cases: Cases,
    problem: str,
    choice: str,
    design: str,
    meshes: Sequence[str],
    factors: tuple[float, ...],
    keys: list[str],
) -> dict[str, tuple[float, str]]:
    """Rows of a plane drive on its recipes and on refinements of the last one; returns the
    limits."""
    name = problem.replace(" ", "_")
    runs = [(Path(mesh).stem, Path(mesh), [*PERIOD, *keys]) for mesh in meshes]
    for factor in factors[1:]:
        label = f"{Path(meshes[-1]).stem} x {factor:g}"
        path = cases.out / f"{name}_x{factor:g}.toml"
        runs.append((label, refined(meshes[-1], path, factor), [*FINER, *keys]))
    solved = [
        run(cases.out / f"{name}_{label.replace(' ', '')}", design, m, k, cases.ranks)
        for label, m, k in runs
    ]
    found = {}
    for quantity in QUANTITIES:
        value, order = limit(
            [s["values"][quantity] for s in solved], [1.0 / factor for factor in factors]
        )
        found[quantity] = (value, f"extrapolated, order {order:.2f}" if order else "finest mesh")
    labels = [label for label, *_ in runs]
    if not any(source.startswith("extrapolated") for _, source in found.values()):
        solved, labels = solved[:-1], labels[:-1]  # the last one is the reference
    cases.series(problem, choice, solved, found, {}, levels=labels, ranks=cases.ranks, halved=False)
    return found


def counts(cases: Cases, found: dict[str, tuple[float, str]]) -> None:
    """Rows of the plane drive on its middle recipe with some counts doubled."""
    for text, keys in COUNTS.items():
        path = refined(
            PLANE_MESHES[1],
            cases.out / f"plane_{text.replace(' ', '').replace(',', '_')}.toml",
            2,
            keys,
        )
        one = run(cases.out / path.stem, PLANE, path, PERIOD, cases.ranks)
        cases.series(
            "plane drive", f"plane, {text}", [one], found, {}, [""], cases.ranks, halved=False
        )


def cup(cases: Cases) -> None:
    """Rows of the cup drive on its recipes."""
    levels = cases.levels(len(CUP_MESHES))
    names = [Path(mesh).stem for mesh in CUP_MESHES]
    solved = [
        run(cases.out / f"cup_drive_{names[k]}", CUP, CUP_MESHES[k], CUP_PERIOD, cases.ranks)
        for k in levels
    ]
    found = {}
    for quantity in QUANTITIES:
        (a, b), (m, n) = ([s[k] for s in solved[-2:]] for k in ("values", "elements"))
        found[quantity] = (
            estimate(a[quantity], b[quantity], m, n, 3).converged,
            "extrapolated, assumed order",
        )
    cases.series(
        "cup drive", "C3D8I", solved, found, {}, levels=names, ranks=cases.ranks, halved=False
    )


def plane(cases: Cases) -> None:
    """Both plane drives."""
    found = refinements(cases, "plane drive", "CPS4I", PLANE, PLANE_MESHES, PLANE_FACTORS, [])
    counts(cases, found)
    refinements(
        cases, "section of the cup drive", "CPS4I", CUP, CUP_MESHES, SECTION_FACTORS, SECTION
    )


def compute(cases: Cases) -> None:
    """All drives."""
    plane(cases)
    cup(cases)
