"""The largest tensile stress at the teeth of the loaded flexible spline, resolved by windows, with its error.

The mesh of a drive is too coarse for the gradient in the tooth root. Windows (`local_problem`) on three meshes, each
finer than the one before, give the stress, the order at which it converges, and from both the error that the last mesh
leaves. The error of the drive's displacements on the cuts is not in it (docs/theory/windows.md).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from swgpar.analysis.drive_model import DriveModel
from swgpar.analysis.local_problem import SECTORS, LocalProblem, WindowStress
from swgpar.design.drive_design import DriveDesign
from swgpar.design.load_states import LoadState
from swgpar.fem.body_layout import FLEXIBLE_SPLINE
from swgpar.fem.stress import principal
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe import make_recipe

RATIO = {"plane": 2.0, "cup": 1.5}
"""Ratio of element sizes of successive windows."""

COUNTS: dict[str, dict[str, dict[str, int]]] = {
    "plane": {"flexible_spline": {"root": 4, "under": 3, "rim": 4, "layers": 1, "tip": 2, "flank": 8}},
    "cup": {
        "flexible_spline": {"root": 4, "under": 2, "rim": 2, "layers": 1},
        "face_width": {"elements": 6},
        "cup": {"cylinder": 6},  # along the whole cylinder
    },
}
"""Counts of the first window; the others are those of the drive's recipe."""

LEVELS = {"plane": 4, "cup": 3}
"""Windows in the loaded state."""

PERIOD_LEVEL = {"plane": 1, "cup": 0}
"""Index of the window with which the further angles of a period are computed."""

FLANK, END_RATIO = 8, 3.0
"""Least count along the flank; middle elements along the face width over those at both ends."""

LOWEST_ORDER, HIGHEST_ORDER = 1.0, 2.0
"""Bounds of the observed order: a higher one, which is seen in the plane, would rest on two differences only."""

CLOSE = 0.85
"""Share of the largest stress on the drive's own mesh from which a tooth outside of the first window is looked at."""


@dataclass(frozen=True)
class RootStress:
    """Largest tensile stress at the teeth.

    s1 : MPa;  error : MPa, estimated, of the window's mesh
    on_mesh : MPa, of the nodal averages on the drive's mesh
    region : as of a `Place`;  warning : why there is no limit to converge to; empty where there is one
    tooth : number, counter-clockwise from +y in the undeformed drive
    radius, z : mm;  angle_deg : from +y, counter-clockwise
    levels : s1 (MPa) on the windows, coarse to fine;  elements : of the finest window
    period : angles of the wave generator (degrees) and s1 (MPa) there, of one sampled period
    """

    s1: float
    error: float
    on_mesh: float
    region: str
    warning: str
    tooth: int
    radius: float
    z: float
    angle_deg: float
    levels: tuple[float, ...]
    elements: int
    period: tuple[tuple[float, float], ...] = ()


def window_recipe(design: DriveDesign, recipe: MeshRecipe, level: int) -> MeshRecipe:
    """Recipe of the window `level`, from 0 on; what windows do not refine is that of the drive's `recipe`.

    Raises InputError where a count is out of range.
    """
    finer = RATIO[design.drive.model] ** level
    content: dict[str, Any] = recipe.model_dump(exclude_none=True)
    content["flexible_spline"]["flank"] = max(FLANK, recipe.flexible_spline.flank)
    for section, counts in COUNTS[design.drive.model].items():
        content[section] |= {name: int(count * finer) for name, count in counts.items()}
    if design.drive.model == "cup":
        content["face_width"]["end_ratio"], content["cup"]["end_ratio"] = END_RATIO, 1.0
    return make_recipe(content)


def resolve_root_stress(
    model: DriveModel, state: LoadState, recipe: MeshRecipe, levels: int | None = None
) -> RootStress:
    """Resolve the largest tensile stress at the teeth in the model's equilibrium under `state`; collective.

    recipe : of the model's mesh;  levels : windows, each finer than the one before; None for those of `LEVELS`

    Raises ConvergenceError or InputError where a window cannot be computed.
    """
    design, by_tooth = model.design, _largest_by_tooth(model)
    coarsest = window_recipe(design, recipe, 0)
    first = int(by_tooth.argmax())
    found = _solve(model, state, first, coarsest)
    far = by_tooth.copy()
    far[_near(first, len(by_tooth))] = -np.inf
    other = int(far.argmax())
    tooth = first
    if far[other] > CLOSE * by_tooth[first]:
        there = _solve(model, state, other, coarsest)
        if there.value > found.value:
            tooth, found = other, there
    values = [found.value]
    for level in range(1, levels or LEVELS[design.drive.model]):
        found = _solve(model, state, tooth, window_recipe(design, recipe, level))
        values.append(found.value)
    logger.info("windows around tooth %d: s1 %s MPa", tooth, ", ".join(f"{value:.1f}" for value in values))
    error = error_of(values, RATIO[design.drive.model])
    return _place(model, found, tuple(values), error, float(by_tooth[first]))


def with_angle(known: RootStress, model: DriveModel, state: LoadState, recipe: MeshRecipe) -> RootStress:
    """`known`, of the loaded state, with s1 at a further angle of the period; collective.

    One window, not the finest, is computed there. Its error is taken to be that of the same window in the loaded
    state. Raises like `resolve_root_stress`.
    """
    level = PERIOD_LEVEL[model.design.drive.model]
    tooth = int(_largest_by_tooth(model).argmax())
    found = _solve(model, state, tooth, window_recipe(model.design, recipe, level))
    value = found.value * known.s1 / known.levels[level]
    period = known.period or ((0.0, known.s1),)
    return replace(known, period=(*period, (float(np.degrees(state.angle)), value)))


def error_of(levels: list[float], ratio: float) -> float:
    """Error of the last of three values on meshes whose element sizes have this ratio, by the observed order."""
    before, last = levels[-2] - levels[-3], levels[-1] - levels[-2]
    order = LOWEST_ORDER
    if before * last > 0.0:
        order = float(np.clip(np.log(before / last) / np.log(ratio), LOWEST_ORDER, HIGHEST_ORDER))
    # a last change that is small by chance is no convergence
    change = max(abs(last), abs(before) / ratio**HIGHEST_ORDER)
    return change / (ratio**order - 1.0)


def _near(tooth: int, count: int) -> np.ndarray:
    """Modelled teeth (n,) whose stresses the window of a tooth resolves."""
    inside = SECTORS // 2 - 1
    return (tooth + np.arange(-inside, inside + 1)) % count


def _largest_by_tooth(model: DriveModel) -> np.ndarray:
    """Largest s1 (n_modelled,) MPa of the toothed part of every modelled sector; collective."""
    body = model.elements.bodies[FLEXIBLE_SPLINE]
    half = 0.5 * model.design.drive.face_width
    toothed = np.abs(body.layout.mesh.coords[:, 2]) <= half * (1.0 + 1e-9)
    stress = body.nodal_stress(model.problem.displacement())
    mine = principal(stress[:, toothed])[0].max(axis=1) if len(stress) else np.zeros(0)
    return np.concatenate(model.comm.allgather(mine))


def _solve(model: DriveModel, state: LoadState, tooth: int, recipe: MeshRecipe) -> WindowStress:
    first = model.partition.layouts[FLEXIBLE_SPLINE].first_tooth
    window = LocalProblem(model, state, first + tooth, recipe)
    try:
        window.solve()
        return window.largest()
    finally:
        window.destroy()


def _place(
    model: DriveModel, found: WindowStress, levels: tuple[float, ...], error: float, on_mesh: float
) -> RootStress:
    x, y, z = found.position
    layout = model.partition.layouts[FLEXIBLE_SPLINE]
    angle = float(layout.sector_angle(np.array(found.tooth)) - np.arctan2(x, y))
    return RootStress(
        s1=found.value,
        error=error,
        on_mesh=on_mesh,
        region=found.region,
        warning=found.warning,
        tooth=found.tooth % layout.mesh.n_sectors,
        radius=float(np.hypot(x, y)),
        z=0.0 if layout.mesh.plane else float(z),
        angle_deg=float(np.degrees(angle)) % 360.0,
        levels=levels,
        elements=found.elements,
    )
