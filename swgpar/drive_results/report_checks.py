"""Verdicts on a finished run: balance, energy, penetration, edge contact, resolution, and what else
may mislead; and on the strength of the drive."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from swgpar.checks.clearance import Clearance, clearances
from swgpar.drive_results.check import Check
from swgpar.drive_results.strength_checks import strength_checks
from swgpar.drive_results.summary import BodySizes, DriveSummary
from swgpar.evaluation.jamming import ENERGY
from swgpar.evaluation.largest_contact import LargestContact
from swgpar.evaluation.losses import DriveLosses
from swgpar.evaluation.numerics import BALANCE, Numerics
from swgpar.evaluation.rotation import Rotation
from swgpar.evaluation.strains import LargestStrains
from swgpar.flank_pressure.pair_contact import FACE_END
from swgpar.largest_stress.accuracy import Accuracy
from swgpar.largest_stress.places import APART, BODIES, LargestStresses
from swgpar.largest_stress.root_stress import RootStress
from swgpar.results.history import loaded_increments

RESOLUTION = 0.05
"""Largest error of the stress at the teeth, relative."""

HELPS = {
    FACE_END: "crowning of flanks in [micro_geometry] takes the load from the ends",
    "tip of": "tip_relief of the gears takes the load from their tips",
}
"""What helps where the place of an edge contact has these words."""

QUALITY = 0.2
"""Least scaled Jacobian of the elements."""


def checks(summary: DriveSummary, history: Mapping[str, np.ndarray]) -> list[Check]:
    """All checks of a run, from its summary and history."""
    design = summary.design
    loaded = 1000.0 * design.load.torque > design.negligible_torque
    period = 0.999999 * np.degrees(design.kinematics.period_angle)
    covered = design.steps.samples > 0 or design.steps.rotation >= period
    judged = loaded and covered and design.repeats
    return [
        _balance(summary.numerics),
        _energy(summary.rotation, judged, design.contact.friction > 0.0, summary.losses),
        _penetration(design.contact.penetration_tolerance * design.drive.module, history),
        _clearance(clearances(design.rigid_pairs)),
        _edge(summary.contact),
        _resolution(summary.root_stress, summary.accuracy),
        _meshed(summary.stresses),
        _elements(summary.bodies),
        *([_strains(summary.strains)] if summary.strains else []),
        *strength_checks(summary),
    ]


def _balance(found: Numerics) -> Check:
    left, largest = found.balance_error_Nmm, found.largest_tooth_torque_Nmm
    if largest == 0.0:
        return Check("balance of torques", None, "the teeth carry no torque")
    text = (
        f"{left:.2g} N·mm are left over of {largest:.4g} N·mm at the teeth; good up to {BALANCE:g} "
        f"of it"
    )
    return Check("balance of torques", left <= found.largest_balance_Nmm, text)


def _energy(rotation: Rotation, judged: bool, friction: bool, losses: DriveLosses | None) -> Check:
    """judged : whether there is a load, and the rotation covers a period, after which the drive is
    in the same state

    What friction takes is known by forces and sliding where the losses are.
    """
    name, expected = "energy", rotation.wg_torque_expected_Nmm
    if departure := rotation.jammed or rotation.energy:
        return Check(name, False, departure)
    mean = rotation.means.get("wg_torque_Nmm")
    if mean is None or not judged:
        return Check(
            name,
            None,
            "needs a torque that is not small beside the spline's bending, a rotation over a "
            "period of the motion or more, and no load from one side, with which a drive does not "
            "repeat",
        )
    torque = "mean torque on the standing wave generator" if rotation.input else "mean input torque"
    text = f"{torque} {mean:.5g} N·mm, by the energy balance {expected:.5g} N·mm"
    if friction and losses is not None and rotation.input is None:
        taken, half = losses.parts_Nmm.flank_friction, rotation.sampling_error or {}
        within = ENERGY * expected + half.get("wg_torque_Nmm", 0.0)
        return Check(
            name,
            abs(mean - expected - taken) <= within,
            f"{text}, and {taken:.3g} N·mm by friction of the flanks; good within {within:.2g} "
            "N·mm",
        )
    if friction:
        good = mean >= expected * (1.0 - ENERGY)
        return Check(name, good, f"{text}; friction takes {mean - expected:.3g} N·mm")
    good = abs(mean / expected - 1.0) <= ENERGY
    return Check(name, good, f"{text}; good within {100 * ENERGY:g} %")


def _penetration(allowed: float, history: Mapping[str, np.ndarray]) -> Check:
    loaded = loaded_increments(history)
    if "max_penetration_mm" not in history:  # a result of another version
        return Check("penetration", None, "the history does not have it")
    most = float(history["max_penetration_mm"][loaded].max(initial=0.0))
    text = (
        f"cam and pins penetrate the spline by up to {1000 * most:.2g} µm; good up to "
        f"{1000 * allowed:.2g} µm"
    )
    return Check("penetration", most <= allowed, text)


def _clearance(every: Sequence[Clearance]) -> Check:
    least = min(every, key=lambda clearance: clearance.nearest.distance)
    text = (
        f"smallest distance of the undeformed teeth {1000 * least.nearest.distance:.3g} µm, "
        f"{least.place}; good from {1000 * least.allowed:.2g} µm: teeth take up an overlap of "
        "that size"
    )
    return Check("clearance of the flanks", not least.overlaps, text)


def _edge(contact: LargestContact | None) -> Check:
    if contact is None:
        return Check("edge contact", None, "no contact under load is known")
    if contact.largest is None:
        return Check("edge contact", None, "no pressure of the flanks could be computed")
    at = contact.largest
    text = (
        f"lies on an edge, with {at.force_N:.4g} N: stress and pressure there grow with every "
        "finer mesh"
        if at.edge
        else "lies off edges"
    )
    others = f"; edges carry up to {contact.edge_force_N:.4g} N" if contact.edge_force_N else ""
    text = f"the largest pressure of the flanks {text}{others}"
    helps = [keys for place, keys in HELPS.items() if at.edge and place in at.edge_place]
    text = "; ".join([text, *helps])
    if contact.unknown_force_N and not at.edge:
        unknown = f"that of a pair with {contact.unknown_force_N:.4g} N could not be computed"
        return Check("edge contact", None, f"{text}; {unknown}")
    return Check("edge contact", not at.edge, text)


def _resolution(root: RootStress | None, accuracy: Accuracy | None) -> Check:
    if root is None:
        text = (
            "the stress at the teeth is not resolved by windows: nodal averages have no error "
            "(output.root_stress)"
        )
        return Check("resolution", None, text)
    if root.total_error is None:
        text = "the error of the largest tension at the teeth has no estimate"
        return Check("resolution", None, text)
    share = root.total_error / abs(root.s1) if root.s1 else np.inf
    limit = accuracy.asked if accuracy else RESOLUTION
    text = (
        f"error of the largest tension at the teeth {100 * share:.2g} %; good up to "
        f"{100 * limit:.3g} %"
    )
    return Check("resolution", share <= limit and (accuracy is None or accuracy.reached), text)


def _meshed(stresses: LargestStresses) -> Check:
    doubtful = [
        name
        for name, place in stresses.places.items()
        if place.warning and not name.endswith(APART)
    ]
    if not stresses.places:
        return Check("places of the stresses", None, "there is no increment under load")
    if not doubtful:
        return Check(
            "places of the stresses", True, "no largest stress lies where the mesh determines it"
        )
    text = (
        f"{', '.join(doubtful)}: the largest value lies where it depends on the mesh; see the "
        f"table of stresses"
    )
    return Check("places of the stresses", None, text)


def _strains(strains: LargestStrains) -> Check:
    found = {BODIES[body]: strain for body, strain in strains.of_bodies.items()}
    if not found:
        return Check("strains", None, "there is no increment under load")
    text = ", ".join(f"{body} {strain:.2g} %" for body, strain in found.items())
    return Check(
        "strains",
        max(found.values()) <= strains.limit,
        f"largest strain apart from the contact: {text}; the linear law holds up to "
        f"{strains.limit:g} %",
    )


def _elements(bodies: Mapping[str, BodySizes]) -> Check:
    worst = {body: sizes.quality["min_scaled_jacobian"] for body, sizes in bodies.items()}
    text = ", ".join(f"{body.replace('_', ' ')} {value:.2g}" for body, value in worst.items())
    return Check(
        "elements",
        min(worst.values()) >= QUALITY,
        f"least scaled Jacobian: {text}; good from {QUALITY:g}",
    )
