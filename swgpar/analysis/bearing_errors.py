"""Errors by the mesh of the drive of what a bearing gives.

The loaded drive is solved on coarser meshes for the error of the tension at the teeth. The bearing
there shows the errors by the same groups of counts (`swgpar.analysis.drive_mesh_error`). They are
shares: at other angles the same share of the value stands for the error.
"""

from __future__ import annotations

from collections.abc import Sequence

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
    coarser: Sequence[CoarserMesh], recipe: MeshRecipe, fine: BallLoads
) -> dict[str, float]:
    """Errors as shares of the values, by the names of answers that all meshes have.

    recipe, fine : the mesh itself
    """
    meshes = [(one.recipe, _estimated(one.bearing)) for one in coarser]
    meshes.append((recipe, _estimated(fine)))
    hidden = {kind.name for kind in NOT_SHOWN}
    return {
        name: max(shown_error([(one, known[name]) for one, known in meshes]) / abs(value), LEAST)
        for name, value in meshes[-1][1].items()
        if value and name not in hidden and all(name in known for _, known in meshes)
    }


def _estimated(bearing: BallLoads | None) -> dict[str, float]:
    """Values of the answers that are not exact."""
    answers = () if bearing is None else bearing.answers()
    return {one.name: one.value for one in answers if one.no_error and one.value is not None}
