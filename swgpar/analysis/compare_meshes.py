"""The loaded drive on its mesh beside a coarser one: errors of contacts, bearing and stresses."""

from __future__ import annotations

from collections.abc import Sequence

from swgpar.analysis.bearing_errors import bearing_errors
from swgpar.analysis.contact_errors import contact_errors
from swgpar.analysis.drive_mesh_error import CoarserMesh, MeshComparison
from swgpar.evaluation.loaded_bearing import loaded_bearing
from swgpar.fem.body import RING_GEAR
from swgpar.flank_pressure.pair_contact import PairContact
from swgpar.largest_stress.root_stress import RootStress
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel


def compare_meshes(
    model: DriveModel,
    state: LoadState,
    contacts: Sequence[PairContact],
    coarser: CoarserMesh | None,
    before: RootStress | None = None,
) -> MeshComparison:
    """The loaded model, with these contacts of flanks, beside a coarser mesh; collective.
    before : see `drive_error`"""
    bearing, lobes = loaded_bearing(model, state), model.design.wave_generator.lobes
    return MeshComparison(
        model.recipe,
        coarser,
        contacts,
        model.partition.layouts[RING_GEAR].count,
        before,
        contact_errors(coarser, model.recipe, contacts, lobes),
        {} if bearing is None else bearing_errors(coarser, model.recipe, bearing),
    )
