"""Errors of the largest nodal stresses by the mesh of the drive (docs/theory/meshes.md)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.largest_stress.places import Place
from swgpar.largest_stress.root_stress import RootStress
from swgpar.largest_stress.wall_stress import CoarseWall
from swgpar.model.regions import TOOTH_ROOT

NODAL_ORDER = 1
"""Order of the largest nodal averages of stress (docs/verification/convergence.md)."""


MOST_LOST = 1.0
"""Share of the root's stress that nodal averages may lose where no windows say it. A stress of
which the root may have more has no estimate then."""


@dataclass(frozen=True)
class CoarseStresses:
    """Largest stresses on a coarser mesh under load, of which finer ones have their errors.

    places : by column of the history;  ratio : of the element sizes, coarse over fine
    wall : stresses of the wall on the coarser mesh; None where they are not known
    """

    places: Mapping[str, Place]
    ratio: float
    wall: CoarseWall | None = None

    def errors(self, fine: Mapping[str, Place]) -> dict[str, float]:
        """Errors of the stresses on the finer mesh as shares of them; none of those that depend on
        either mesh.

        A coarser mesh may have no node in a region, for example in a fillet of one element: no
        error there.
        """
        return {
            name: abs(place.value - self.places[name].value)
            / (self.ratio**NODAL_ORDER - 1.0)
            / place.value
            for name, place in fine.items()
            if name in self.places
            if not place.warning and not self.places[name].warning and place.value > 0.0
        }


def with_errors(
    places: Mapping[str, Place], shares: Mapping[str, float], root_stress: RootStress | None
) -> dict[str, Place]:
    """The places with the errors (MPa) of their stresses where they are known.

    shares : errors by a coarser mesh over the stresses, by column of the history
    root_stress : of the loaded state, where it is known. What nodal averages lose in the roots of
    the flexible spline is the same share of every stress there, in the ring gear in proportion to
    the element's length. The root may have the largest stress on a finer mesh.
    """
    lost: dict[str, float] = {}
    spacing = {place.body: place.root_spacing for place in places.values()}
    share = root_stress.lost_in_root if root_stress is not None else None
    if share is not None and places:
        of_spline = spacing[FLEXIBLE_SPLINE]
        lost = {
            body: share * (length / of_spline) ** NODAL_ORDER for body, length in spacing.items()
        }
    return {
        name: replace(place, error=_error(place, shares.get(name), lost.get(place.body)))
        for name, place in places.items()
    }


def _error(place: Place, share: float | None, lost: float | None) -> float | None:
    """Error (MPa) of a stress. share : by a coarser mesh;  lost : share that is lost in the
    roots"""
    may_overtake = (1.0 + MOST_LOST) * place.in_root > place.value
    if place.warning or (lost is None and may_overtake):  # what is not known is no zero
        return None
    in_root = lost is not None and place.region == TOOTH_ROOT
    if in_root and (share is None or place.body == FLEXIBLE_SPLINE):
        share = lost
    if share is None:
        return None
    error = share * place.value
    return error if lost is None else max(error, (1.0 + lost) * place.in_root - place.value)
