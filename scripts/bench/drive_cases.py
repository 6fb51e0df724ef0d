"""The plane drive and the cup drive on their recipes: means over a period of the largest stresses of the spline.

The limit of the plane drive is extrapolated, with the order that is observed, from its two finest recipes and a mesh
with twice as many elements in every direction as the finest. That of the cup drive is extrapolated from its two finest
recipes with second order (`swgpar.error_estimate`), and says little for the finest one.
"""

from __future__ import annotations

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


def compute(cases: Cases) -> None:
    """All recipes of both drives."""
    names = [mesh.split("/")[1].removesuffix(".toml") for mesh in PLANE_MESHES]
    solved = [run(cases.out / f"plane_drive_{n}", PLANE, m, PERIOD, cases.ranks) for n, m in zip(names, PLANE_MESHES)]
    finer = refined(PLANE_MESHES[-1], REFINED, cases.out / "plane_reference.toml")
    names.append("reference")
    solved.append(
        run(cases.out / "plane_drive_reference", PLANE, finer, [*PERIOD, "steps.start_levels=3"], cases.ranks)
    )
    found = {}
    for quantity in QUANTITIES:
        value, order = limit([s["values"][quantity] for s in solved], SIZES)
        print(f"plane drive, {quantity}: limit {value:.2f} MPa, observed order {order}")
        found[quantity] = (value, f"extrapolated, order {order:.2f}" if order else "finest mesh")
    cases.series("plane drive", "CPS4I", solved, found, {}, levels=names, ranks=cases.ranks, halved=False)

    levels = cases.levels(len(CUP_MESHES))
    names = [mesh.split("/")[1].removesuffix(".toml") for mesh in CUP_MESHES]
    solved = [run(cases.out / f"cup_drive_{names[k]}", CUP, CUP_MESHES[k], PERIOD, cases.ranks) for k in levels]
    found = {}
    for quantity in QUANTITIES:
        (a, b), (m, n) = ([s["values"][quantity] for s in solved[-2:]], [s["elements"] for s in solved[-2:]])
        found[quantity] = (estimate(a, b, m, n, 3).converged, "extrapolated, order 2")
    cases.series("cup drive", "C3D8I", solved, found, {}, levels=names, ranks=cases.ranks, halved=False)
