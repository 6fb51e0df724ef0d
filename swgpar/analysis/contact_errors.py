"""Errors by the mesh of the drive of what the contacts of its flanks give.

The loaded drive is solved on a coarser mesh for the error of the tension at the teeth. The contacts
there show their own errors (`swgpar.analysis.drive_mesh_error`). They are shares: at other angles
the same share of the value stands for the error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass

import numpy as np

from swgpar.analysis.drive_mesh_error import (
    SAFETY,
    CoarserMesh,
    least_error_of_force,
    shown_error,
)
from swgpar.evaluation.contact_error_shares import UNKNOWN, ContactErrorShares
from swgpar.flank_pressure.pair_contact import PairContact, touches_edges
from swgpar.meshing import MeshRecipe

LAW = 0.01
"""Error of the pressures of the contact law in the plane, as a share of them: of Hertz's, and those
beside joints of a profile (docs/theory/contact_pressure.md). No mesh of the drive shows it. What
the force brings with it is not in it."""

LEAST_PRESSURE = 0.02
"""Least error of a pressure in cup drives, as a share of it: finer meshes change most of them by up
to 1.7 %."""

LEAST_PRESSURE_WITH_EDGES = 0.05
"""The same where another contact lies on an edge."""

SHORT = 9.0
"""Length of a contact over its width below which it counts as short in both directions: the
displacement of its teeth along the face width decides as much as across. Of sixteen contacts off
edges of drawn cups three are shorter, with true errors of 2.4 to 4.7 %; of the others one has more
than 1.2 %."""

LEAST_PRESSURE_OF_SHORT = 0.05
"""Least error of the pressure of a short contact, as a share of it."""

HERTZ = 0.5
"""Error of a pressure that a force brings with it, as shares of both: a pressure goes with the root
of its line load. Forces of pairs move together from mesh to mesh, and where a pressure changes
little between two of them by chance that of the largest force tells more."""

SLIGHT = 0.3
"""Force over the largest one below which a pair off edges has what those on edges leave."""

ALONE = 0.99
"""Share in the force of a lobe from which a pair carries it alone. Its force follows from the
torque then, on every mesh, until another pair touches; how near that is the meshes do not show."""

Measure = Callable[[PairContact], float]
"""What is taken of a pair; nan where it has none."""


def contact_errors(
    coarser: CoarserMesh | None,
    recipe: MeshRecipe,
    contacts: Sequence[PairContact],
    lobes: int,
) -> ContactErrorShares:
    """Errors on the mesh of `recipe`, on which the loaded drive has these contacts; none of them is
    known without a coarser mesh."""
    if coarser is None or not contacts:
        return UNKNOWN
    model, on_edge = recipe.model, touches_edges(contacts)
    alone = any(lobes * pair.force_share > ALONE for pair in contacts)
    shown = _ErrorShare(coarser, recipe, contacts)
    least = least_error_of_force(model, contacts)
    least_pressure = LEAST_PRESSURE_WITH_EDGES if on_edge else LEAST_PRESSURE

    def of_force(share: float | None) -> float | None:
        return None if alone or share is None else max(share, least)

    shown_force = shown.of_largest(lambda pair: pair.force_N)
    force = of_force(shown_force)
    # the force of a pair that is alone changes where another one touches: that has no estimate
    by_force = HERTZ * (least if force is None else force)

    def of_pressure(measure: Measure) -> float | None:
        share = shown.of_largest(measure)
        if share is None:
            return None
        largest = max(contacts, key=lambda pair: np.nan_to_num(measure(pair)))
        if model != "plane":
            # the face width decides, which is coarser: no others are to be shown
            of_short = LEAST_PRESSURE_OF_SHORT if largest.is_short(SHORT) else 0.0
            return max(share / SAFETY, HERTZ * (shown_force or 0.0), least_pressure, of_short)
        # another mesh puts the cells elsewhere at a peak that is as narrow as they are
        return max(math.hypot(max(share, by_force), LAW), largest.unresolved)

    share = of_force(shown.of_largest(lambda pair: pair.force_share))
    if share is not None and force is not None and model == "plane":
        # the force of a pair and that of all may have changed together by chance
        share = max(share, math.hypot(force, shown.of_total()))
    off_edges = None if _is_slight(contacts) else of_pressure(_pressure_off_edges)
    return ContactErrorShares(
        pressure=of_pressure(lambda pair: pair.pressure_MPa),
        pressure_off_edges=off_edges,
        force=force,
        force_share=share,
        on_lines=model == "plane",
    )


def _pressure_off_edges(pair: PairContact) -> float:
    return np.nan if pair.edge else pair.pressure_MPa


def _is_slight(contacts: Sequence[PairContact]) -> bool:
    """Whether the pair with the largest pressure off edges carries little, and others, on edges,
    nearly all: what remains for it changes from mesh to mesh."""
    known = [pair for pair in contacts if np.isfinite(_pressure_off_edges(pair))]
    if not known:
        return False
    largest = max(pair.force_N for pair in contacts)
    return max(known, key=_pressure_off_edges).force_N < SLIGHT * largest


@dataclass(frozen=True)
class _ErrorShare:
    """Errors as shares of values of the pairs in contact, by the change from the coarser mesh.

    recipe, contacts : the mesh itself
    """

    coarser: CoarserMesh
    recipe: MeshRecipe
    contacts: Sequence[PairContact]

    def _shown(self, change: float) -> float:
        return shown_error(self.coarser.recipe, self.recipe, change, of_contact=True)

    def of_total(self) -> float:
        """Of the sum of the forces of all pairs. The torque tells it where all press one flank of
        their teeth; it changes where other pairs press against it."""
        coarse, fine = (
            sum(pair.force_N for pair in pairs) for pairs in (self.coarser.contacts, self.contacts)
        )
        return self._shown(fine - coarse) / fine

    def of_largest(self, measure: Measure) -> float | None:
        """Of the largest value of all pairs; None where a mesh has none.

        The larger one of what the largest values of all pairs show, and of what the pair that has
        it on the mesh shows: another pair may have nearly as much.
        """
        coarse, fine = (_known(pairs, measure) for pairs in (self.coarser.contacts, self.contacts))
        if not coarse or not fine:
            return None
        place = max(fine, key=lambda pair: fine[pair])
        shown = self._shown(fine[place] - max(coarse.values()))
        if place in coarse:
            shown = max(shown, self._shown(fine[place] - coarse[place]))
        return shown / fine[place] if fine[place] > 0.0 else None


def _known(pairs: Sequence[PairContact], measure: Measure) -> dict[Hashable, float]:
    """What is taken of the pairs that have it."""
    values = ((pair.key, measure(pair)) for pair in pairs)
    return {key: value for key, value in values if np.isfinite(value)}
