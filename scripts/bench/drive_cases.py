"""The plane drive and the cup drive on their recipes: means over a period of the largest stresses of the spline.

The limit of the plane drive is extrapolated, with the order that is observed, from its two finest recipes and a mesh
with twice as many elements in every direction as the finest. That of the cup drive is extrapolated from its two finest
recipes with second order (`swgpar.error_estimate`), and says little for the finest one.
"""

from __future__ import annotations

from pathlib import Path

from cases import Cases
from convergence import limit
from drive_runs import refined, run

from swgpar.error_estimate import estimate

PLANE, CUP = "drivers/plane_half_turn.toml", "drivers/cup_45deg.toml"
PLANE_MESHES = ("mesh/plane_coarse.toml", "mesh/plane.toml", "mesh/plane_fine.toml")
CUP_MESHES = ("mesh/coarse.toml", "mesh/medium.toml", "mesh/full.toml")
PERIOD = ["steps.samples=4", "steps.start_levels=1"]
QUANTITIES = ("fs_s1", "fs_s3", "fs_vm")
REFINED = 2
SIZES = [1.5 * REFINED, REFINED, 1.0]
"""Of the spline's elements on plane, plane_fine and the refined mesh, over those of the last."""


def named(meshes: tuple[str, ...]) -> list[str]:
    """Recipes by the names of their files."""
    return [Path(mesh).stem for mesh in meshes]


def plane(cases: Cases) -> None:
    """The plane drive on its recipes and on a finer mesh."""
    names = named(PLANE_MESHES)
    solved = [run(cases.out / f"plane_drive_{n}", PLANE, m, PERIOD, cases.ranks) for n, m in zip(names, PLANE_MESHES)]
    finer = refined(PLANE_MESHES[-1], REFINED, cases.out / "plane_reference.toml")
    names.append("reference")
    solved.append(
        run(cases.out / "plane_drive_reference", PLANE, finer, [*PERIOD, "steps.start_levels=3"], cases.ranks)
    )
    found = {}
    for quantity in QUANTITIES:
        value, order = limit([s["values"][quantity] for s in solved], SIZES)
        found[quantity] = (value, f"extrapolated, order {order:.2f}" if order else "finest mesh")
    cases.series("plane drive", "CPS4I", solved, found, {}, levels=names, ranks=cases.ranks, halved=False)


def cup(cases: Cases) -> None:
    """The cup drive on its recipes."""
    levels = cases.levels(len(CUP_MESHES))
    names = named(CUP_MESHES)
    solved = [run(cases.out / f"cup_drive_{names[k]}", CUP, CUP_MESHES[k], PERIOD, cases.ranks) for k in levels]
    found = {}
    for quantity in QUANTITIES:
        (a, b), (m, n) = ([s[k] for s in solved[-2:]] for k in ("values", "elements"))
        found[quantity] = (estimate(a[quantity], b[quantity], m, n, 3).converged, "extrapolated, order 2")
    cases.series("cup drive", "C3D8I", solved, found, {}, levels=names, ranks=cases.ranks, halved=False)


def compute(cases: Cases) -> None:
    """Both drives."""
    plane(cases)
    cup(cases)
