"""Error of the largest tension at the teeth by the mesh of the drive (docs/theory/windows.md).

The drive is loaded on a coarser mesh and on its own. The change of the stress in a window between
them shows the error. Few elements along the flanks stay: fewer would not find the contacts.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from swgpar.analysis.shortcuts import FEWEST, finds_contacts
from swgpar.evaluation.bearing_loads import BallLoads
from swgpar.evaluation.contact_error_shares import UNKNOWN, ContactErrorShares
from swgpar.evaluation.loaded_bearing import loaded_bearing
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.flank_pressure.pair_contact import (
    FACE_END,
    PairContact,
    pair_contacts,
    touches_edges,
)
from swgpar.largest_stress.places import OF_REGION, Place
from swgpar.largest_stress.region_stress import RegionStress
from swgpar.largest_stress.root_stress import ENDS, RootStress, resolve_root_stress
from swgpar.load.load_states import LoadState
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe_counts import (
    body_ratio,
    coarsened,
    contact_ratio,
    with_flanks_of,
)
from swgpar.model.drive_model import DriveModel
from swgpar.model.regions import INSIDE, TIP, TOOTH_ROOT, UNDER_CONTACT

ORDER = 2
"""Order of the displacements of a mesh."""

SAFETY = 2.0
"""Factor on the errors that two meshes show. Layers below the flank and counts of the ring gear are
too small to be coarsened, and the orders that are seen are 1.3 to 2
(docs/verification/error_sources_plane.md)."""

COMPARED_LEVELS = 2
"""Windows of which the last one shows what the mesh of the drive changes."""

LEAST = {"plane": 0.004, "cup": 0.015}
"""Least error by the mesh of the drive that meshes can show, as a share of the stress: contact
points move between nodes, and the recipe of cup drives has the fewest layers below the root
already. Twice the elements in root and below it change the reference cup by 1 %."""

OF_LEAST = {"root": 4, "under": 1, "rim": 1}
"""Counts of the flexible spline of that recipe, `forces`: with more of all of them the least error
falls in second order, as far as the one in the plane."""

LEAST_WITH_EDGES = 0.02
"""The same where a contact lies on an edge. The forces of the teeth move with the mesh: on
plane_coarse by 0.7 to 2.7 % of the stress."""

LEAST_AT_LOADED_ENDS = 0.05
"""The same of the stress at the ends of teeth where a contact lies on an end of the face width. How
much of the load is there follows from the layers along the face width and from those below the
root, which change such a stress by 2.5 and 1.8 % (docs/verification/error_sources_cup.md)."""

LEAST_IN_RING = {"plane": 0.1, "cup": 0.3}
"""Least error in the ring gear, as a share of its largest stress; in the plane not in the tooth
root. Its meshes have one element in the rim and below the root, which no coarser one has fewer of:
more of them change these stresses by up to a tenth, the largest one in a root by 0.9 %. In a cup
drive there are two windows, of which the finer one misses 3 to 30 %
(docs/verification/effectivity.md)."""

LEAST_FORCE = {"plane": 0.02, "cup": 0.07}
"""Least error of a force, as a share of it: elements along the flank, below it and in the ring
gear, of which no coarser mesh has fewer, change it by up to 2 % in the plane. In a cup drive the
forces of some ten pairs move with the layers along the face width, by 1 to 6.5 %
(docs/verification/error_sources_cup.md)."""

LEAST_FORCE_WITH_EDGES = 0.03
"""The same in the plane where a contact lies on an edge, whose compliance no mesh resolves."""


@dataclass(frozen=True)
class CoarserMesh:
    """The coarser mesh with which a mesh of the drive is compared.

    stresses : s1 (MPa) on windows, coarse to fine, by part of the teeth
    contacts : of all touching pairs
    regions : largest stresses of the regions by windows, by name
    bearing : what it gives; None without one
    """

    recipe: MeshRecipe
    stresses: Mapping[str, Sequence[float]]
    contacts: Sequence[PairContact] = ()
    regions: Mapping[str, RegionStress] = field(default_factory=dict)
    bearing: BallLoads | None = None


@dataclass(frozen=True)
class MeshComparison:
    """A mesh of the drive and the coarser one with which it is compared.

    coarser : None where it could not be loaded;  contacts : of all touching pairs on the mesh
    ring_teeth : modelled teeth of the ring gear;  before : see `drive_error`
    contact_errors, bearing_errors : of the contacts of flanks, and see `bearing_errors`
    """

    recipe: MeshRecipe
    coarser: CoarserMesh | None
    contacts: Sequence[PairContact]
    ring_teeth: int
    before: RootStress | None = None
    contact_errors: ContactErrorShares = UNKNOWN
    bearing_errors: dict[str, float] = field(default_factory=dict)

    def with_errors(self, found: RootStress) -> RootStress:
        """Stresses by windows on the mesh, with their errors by the mesh of the drive. More windows
        may find the largest stress in another part of the teeth, of another error."""
        least = least_error(self.recipe, self.contacts, found.part)
        error = drive_error(self.coarser, self.recipe, found, least, self.before)
        regions = region_errors(
            self.coarser, self.recipe, found, least, self.contacts, self.ring_teeth
        )
        return replace(found, drive_error=error, regions=regions)


def coarser_recipe(recipe: MeshRecipe) -> MeshRecipe | None:
    """Recipe with which a mesh is compared; None where it would not find the contacts."""
    coarse = coarsened(recipe)
    if min(coarse.flexible_spline.flank, coarse.ring_gear.flank) < FEWEST:
        coarse = with_flanks_of(coarse, recipe)
    return coarse if finds_contacts(coarse) else None


def coarser_mesh(model: DriveModel, state: LoadState, *, windows: bool) -> CoarserMesh:
    """What the loaded model on a coarser mesh gives in contacts and bearing, and in windows;
    collective.

    windows : whether they are computed

    Raises ConvergenceError or InputError where a window cannot be computed.
    """
    contacts, bearing = pair_contacts(model, state), loaded_bearing(model, state)
    if not windows:
        return CoarserMesh(model.recipe, {}, contacts, {}, bearing)
    found = resolve_root_stress(model, state, COMPARED_LEVELS, COMPARED_LEVELS - 1)
    return CoarserMesh(model.recipe, found.by_part, contacts, found.regions, bearing)


def drive_error(
    coarser: CoarserMesh | None,
    recipe: MeshRecipe,
    fine: RootStress,
    least: float,
    before: RootStress | None = None,
) -> float | None:
    """Error (MPa) by the mesh of the drive; None where no coarser mesh shows it.

    coarser : of the same windows;  recipe, fine : the mesh itself
    least : share of the stress, see `least_error`
    before : on the coarser mesh, with its error, if it is known; of no account where another part
        of the teeth has the largest stress

    A change that is small by chance is no convergence: the error is at least what remains of that
    before, and `least` of the stress.
    """
    if coarser is None:
        return None
    ratio = body_ratio(coarser.recipe, recipe)
    if ratio is None:
        return None
    of_part = coarser.stresses[fine.part]
    shared = min(len(fine.levels), len(of_part)) - 1
    found, coarse = fine.levels[shared], of_part[shared]
    if math.isnan(found) or math.isnan(coarse):  # a part that was followed on no shared window
        return None
    error = shown_error(coarser.recipe, recipe, found - coarse) * abs(fine.s1 / found)
    known = before.drive_error if before is not None and before.part == fine.part else None
    remains = 0.0 if known is None else known / ratio**ORDER
    return max(error, remains, least * abs(fine.s1))


def region_errors(
    coarser: CoarserMesh | None,
    recipe: MeshRecipe,
    fine: RootStress,
    least: float,
    contacts: Sequence[PairContact],
    ring_teeth: int,
) -> dict[str, RegionStress]:
    """The stresses of the regions with their errors by the mesh of the drive, where the coarser
    mesh shows them. Tips have none where a contact lies on an edge: the stress has no limit there.

    contacts : of all touching pairs;  ring_teeth : modelled teeth of the ring gear
    others : see `drive_error`

    The ring gear's stresses follow the forces of the flanks. That of a pair which carries a lobe
    alone follows from the torque, but its place moves with the mesh as others do.
    """
    of_force = least_error_of_force(recipe.model, contacts)
    found, model, on_edge = {}, recipe.model, touches_edges(contacts)
    for name, stress in fine.regions.items():
        kind, _, region = name.partition(OF_REGION)
        if on_edge and region == TIP:
            found[name] = replace(stress, drive_error=None)
            continue
        share = least
        if stress.place.body != FLEXIBLE_SPLINE:
            if model == "cup" or region != TOOTH_ROOT:
                share = LEAST_IN_RING[model]
            by_pairs = _force_error(coarser, recipe, contacts, stress.place, ring_teeth)
            share = max(share, of_force, by_pairs)
        floor = share * _largest_apart(fine.regions, kind)
        error = _region_error(coarser, recipe, name, stress, floor)
        found[name] = replace(stress, drive_error=error)
    return found


def _force_error(
    coarser: CoarserMesh | None,
    recipe: MeshRecipe,
    contacts: Sequence[PairContact],
    place: Place,
    ring_teeth: int,
) -> float:
    """Error of the forces beside a place of the ring gear, of the pairs on its tooth and on those
    beside it, as a share of their sum. Each of them adds to the stress in proportion to its force,
    and their errors are independent."""
    if coarser is None:
        return 0.0
    coarse = {pair.key: pair.force_N for pair in coarser.contacts}
    near = [
        pair
        for pair in contacts
        if pair.ring in ("", place.body) and (pair.ring_tooth - place.tooth + 1) % ring_teeth <= 2
    ]
    errors = [
        shown_error(
            coarser.recipe, recipe, pair.force_N - coarse.get(pair.key, 0.0), of_contact=True
        )
        for pair in near
    ]
    total = sum(pair.force_N for pair in near)
    return math.hypot(*errors) / total if total > 0.0 else 0.0


def _largest_apart(regions: Mapping[str, RegionStress], kind: str) -> float:
    """The largest stress (MPa) of a kind and body in regions that no contact presses."""
    return max(
        stress.place.value
        for name, stress in regions.items()
        if name.startswith(kind + OF_REGION) and stress.place.region not in (UNDER_CONTACT, INSIDE)
    )


def _region_error(
    coarser: CoarserMesh | None,
    recipe: MeshRecipe,
    name: str,
    fine: RegionStress,
    least: float,
) -> float | None:
    """Error (MPa) of the stress of a region; None where the coarser mesh has none there.

    least : MPa
    """
    if fine.nodal:  # its error is far larger
        return least
    coarse = None if coarser is None else coarser.regions.get(name)
    if coarser is None or coarse is None:
        return None
    shared = min(len(coarse.tops), len(fine.tops)) - 1
    before, value = coarse.tops[shared], fine.tops[shared]
    if not (before > 0.0 and value > 0.0):
        return None
    # the flexible spline's root and rim are no part of the ring gear: forces change its stresses
    of_forces = fine.place.body != FLEXIBLE_SPLINE
    shown = shown_error(coarser.recipe, recipe, value - before, of_contact=of_forces)
    return max(shown * fine.place.value / value, least)


def shown_error(
    coarse: MeshRecipe, fine: MeshRecipe, change: float, *, of_contact: bool = False
) -> float:
    """Error of a value on a mesh by its change from a coarser one, which has other counts.

    of_contact : of a force or pressure of the flanks, for which the counts of `CONTACT` decide
        where they differ
    """
    ratio = contact_ratio(coarse, fine) if of_contact else None
    return SAFETY * abs(change) / ((ratio or smallest_ratio(coarse, fine)) ** ORDER - 1.0)


def smallest_ratio(coarse: MeshRecipe, fine: MeshRecipe) -> float:
    """The smallest ratio of counts that differ, one of which does."""
    ratios = body_ratio(coarse, fine), contact_ratio(coarse, fine)
    return min(ratio for ratio in ratios if ratio is not None)


def least_error_of_force(model: str, contacts: Sequence[PairContact]) -> float:
    """Least error of a force that two meshes of the drive can show, as a share of it."""
    on_edge = model == "plane" and touches_edges(contacts)
    return LEAST_FORCE_WITH_EDGES if on_edge else LEAST_FORCE[model]


def least_error(recipe: MeshRecipe, contacts: Sequence[PairContact], part: str) -> float:
    """Least error that two meshes of the drive can show, as a share of the largest stress in this
    part of the teeth. recipe : of the finer one"""
    if part == ENDS and any(FACE_END in contact.edge_place for contact in contacts):
        return LEAST_AT_LOADED_ENDS
    if touches_edges(contacts):
        return LEAST_WITH_EDGES
    if recipe.model == "plane":
        return LEAST["plane"]
    spline = recipe.flexible_spline
    ratio = min(getattr(spline, name) / count for name, count in OF_LEAST.items())
    return max(LEAST["cup"] / max(ratio, 1.0) ** ORDER, LEAST["plane"])
