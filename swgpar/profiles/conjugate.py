"""Conjugate flank: the envelope of the other gear's flank, or the boundary of the area it sweeps.

Where the envelope leads from the tip to the root without an undercut, and the teeth do not overlap
elsewhere, it is the flank. Else the boundary of the swept area is. `ends.py` makes what leads from
there to the circles.
"""

from __future__ import annotations

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.bracketed_root import root_between
from swgpar.profiles.ends import with_ends
from swgpar.profiles.envelope import STATIONS, Envelope
from swgpar.profiles.flank import FlankSegment, ToothProfile
from swgpar.profiles.keys import Conjugate
from swgpar.profiles.mesh_gap import NearestPlace, OutlinePair, outline
from swgpar.profiles.swept import SweptArea
from swgpar.profiles.teeth import Teeth
from swgpar.profiles.tooth_motion import ToothMotion

DEEPEST = 1e-6
"""Overlap of the flanks over the module that counts as interference."""


def conjugate(
    keys: Conjugate, teeth: Teeth, given: ToothProfile, motion: ToothMotion, name: str = "profile"
) -> ToothProfile:
    """Build the flank that lets `given`, the other gear's, pass in every position of `motion`.

    Its segments have the name ``conjugate`` where it is the envelope, ``swept`` where it is the
    boundary of the swept area.

    name : section of the design file, for messages. Raises InputError for teeth that pass each
    other elsewhere with an overlap, and for radii that do not fit.
    """
    envelope = Envelope(given, motion, 0.5 * keys.backlash / teeth.r_pitch)
    tip, root = teeth.r_tip_circle, teeth.r_root_circle

    def finished(segments: list[FlankSegment]) -> tuple[ToothProfile, NearestPlace]:
        curve = ToothProfile(tuple(segments), teeth.external, tip, root, teeth.n_teeth)
        flank = with_ends(curve, teeth.module, keys.r_tip, keys.r_root, name)
        external, internal = (flank, given) if teeth.external else (given, flank)
        pair = OutlinePair(outline(external), outline(internal), motion)
        return flank, pair.nearest_place(below=-DEEPEST * teeth.module)

    pieces = _whole_envelope(envelope, tip)
    if pieces:
        flank, deepest = finished(pieces)
        if deepest.distance >= -DEEPEST * teeth.module:
            return flank
    flank, deepest = finished(list(SweptArea(envelope, tip, teeth.module, name).boundary()))
    if deepest.distance < -DEEPEST * teeth.module:
        raise InputError(
            f"{name}: at {np.degrees(deepest.psi):.1f} degrees from the major axis the "
            f"{deepest.spline} of flexible_spline and the {deepest.ring} of the ring gear overlap "
            f"by {-deepest.distance:.3g} mm: allowed are lower teeth and other profiles of the "
            "other gear"
        )
    return flank


def _whole_envelope(envelope: Envelope, tip: float) -> list[FlankSegment]:
    """The envelope from the circle of radius `tip` (mm) to the tip edge of the other flank; empty
    where an undercut ends it before."""
    known, low = envelope.tipwards[0], envelope.given.tip_end
    # a rounded tip edge only touches at the major axis: the flank below it is what works
    if not known.size or known[-1] > low + envelope.given.length / (STATIONS - 1):
        return []
    low, high = max(low, float(known[-1])), float(envelope.branch[0][-1])

    def beyond(s: float) -> float:
        return abs(envelope.point(s)[0]) - tip

    if beyond(low) * beyond(high) > 0.0:
        return []
    return list(envelope.pieces(low, root_between(beyond, low, high, xtol=1e-13)))
