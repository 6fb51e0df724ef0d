"""Errors by the mesh of the drive of what a bearing gives.

The loaded drive is solved on a coarser mesh for the error of the tension at the teeth. The bearing
there shows its own errors (`swgpar.analysis.drive_mesh_error`). They are shares: at other angles
the same share of the value stands for the error.
"""

from __future__ import annotations

from swgpar.analysis.drive_mesh_error import CoarserMesh, shown_error
from swgpar.evaluation.bearing_loads import (
    RACE_MISES,
    RADIAL_SHARE,
    RADIAL_SHARE_OF_BALLS,
    TORSIONAL_SHARE_OF_BALLS,
    BallLoads,
)
from swgpar.meshing import MeshRecipe

LEAST = 0.02
"""Least error of what a bearing gives, as a share of it: a ball has another place between the nodes
of the race on every mesh."""

NOT_SHOWN = (RACE_MISES, RADIAL_SHARE, TORSIONAL_SHARE_OF_BALLS, RADIAL_SHARE_OF_BALLS)
"""Answers whose error two meshes do not show. All meshes have one element through the thickness of
the race. The tangent of balls with little load decides about the others. They change by up to 16,
6, 41 and 44 % on meshes with 2.25 times the elements (docs/verification/effectivity.md)."""


def bearing_errors(
    coarser: CoarserMesh | None, recipe: MeshRecipe, fine: BallLoads
) -> dict[str, float]:
    """Errors as shares of the values, by the names of answers that both meshes have; none without
    a coarser mesh.

    recipe, fine : the mesh itself
    """
    if coarser is None:
        return {}
    coarse, hidden = _estimated(coarser.bearing), {kind.name for kind in NOT_SHOWN}
    return {
        name: max(shown_error(coarser.recipe, recipe, value - coarse[name]) / abs(value), LEAST)
        for name, value in _estimated(fine).items()
        if value and name not in hidden and name in coarse
    }


def _estimated(bearing: BallLoads | None) -> dict[str, float]:
    """Values of the answers that are not exact."""
    answers = () if bearing is None else bearing.answers()
    return {one.name: one.value for one in answers if one.no_error and one.value is not None}
