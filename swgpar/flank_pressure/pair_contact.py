"""Contact of every touching pair of flanks: force, line load, and the pressure.

In the plane model the pressure is that of the contact law, which joins the mesh to the half plane
(`swgpar.contact.contact_lines`), on cells that are finer than those of the solution. In space the
largest pressure may lie between the law's lines, which are few where the load is short: the
mesh gives the force of a pair and its place along the face width, the exact flanks are moved with
their teeth, and the gap between them goes into the contact of two half spaces over a patch
(`swgpar.flank_pressure.patch_contact`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np

from swgpar.contact.flanks import FlankContact
from swgpar.contact.pressed_lines import PressedLine
from swgpar.contact.search import FlankPair
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.flank_pressure.contact_station import ContactStation, line_station, patch_stations
from swgpar.flank_pressure.flank_loads import (
    LineLoad,
    flank_forces,
    forces_on_teeth,
    line_loads,
    nodal_flank_forces,
    tributary,
)
from swgpar.flank_pressure.moved_pairs import FlankGap, Neighbours, moved_teeth
from swgpar.flank_pressure.patch_contact import CELLS_ACROSS, PatchContact, patch_contact
from swgpar.flank_pressure.shear import largest_shear
from swgpar.geometry.rotation import rotated
from swgpar.load.load_states import LoadState
from swgpar.log import logger
from swgpar.materials import contact_modulus
from swgpar.model.drive_model import DriveModel

SMALLEST = 1e-3
"""Line load, over the largest one, below which the pressure of a pair is not computed. On an edge
a small force has a pressure as large as others."""

WIDTH = 0.05
"""Width over the module within which the contact is looked for at first."""

STRIPS = 48
"""Strips of a line on which its pressure is reported in the plane."""


NEARLY = 0.85
"""Pressure over the largest one off edges from which a narrow peak is resolved."""

FACE_END = "end of the face width"
"""Edge on which the load of a pair may lie, in words."""


@dataclass(frozen=True)
class PairContact:
    """Contact of two flanks.

    tooth, ring_tooth : numbers of the teeth, counter-clockwise from +y;  flank : of the flexible
    spline's tooth
    angle_deg : of the force on the deformed flank, from the major axis, counter-clockwise, -180 to
    180
    force_N : force between the flanks;  force_share : over the sum of the forces of all pairs of
    that ring gear
    torque_Nmm : about the axis, on the flexible spline
    width_mm : length along the face width that carries the force
    line_load_Nmm : largest line load, N/mm, at `z_mm`;  radius_mm : of the contact, on the
    undeformed flexible spline
    pressure_MPa, half_width_mm, shear_MPa : largest pressure, half width of the contact and largest
    shear below it
    sliding_mm_s : sliding of the flexible spline's flank on the other in the section, at the speed
    of the input
    edge : 1 where the contact ends at the tip of a profile, or the load at an end of the face
    width; the pressure is then no property of the drive;  edge_place : which of them, in words
    ring : body whose tooth is meant, in a drive with two ring gears; else empty
    stations : along the face width, those that carry a load
    unresolved : what strips and cells of about the same width differ by, over the largest pressure;
    0 where the law's cells did not tell it

    From `width_mm` to `sliding_mm_s` all are nan where the pressure is not computed.
    """

    tooth: int
    flank: str
    ring_tooth: int
    angle_deg: float
    force_N: float
    force_share: float
    torque_Nmm: float
    width_mm: float = np.nan
    line_load_Nmm: float = np.nan
    z_mm: float = np.nan
    radius_mm: float = np.nan
    pressure_MPa: float = np.nan
    half_width_mm: float = np.nan
    shear_MPa: float = np.nan
    sliding_mm_s: float = np.nan
    edge: int = 0
    edge_place: str = ""
    ring: str = ""
    stations: tuple[ContactStation, ...] = ()
    unresolved: float = 0.0

    @property
    def key(self) -> tuple[str, int, str]:
        """What tells the pair from others."""
        return self.ring, self.tooth, self.flank

    def is_short(self, ratio: float) -> bool:
        """Whether the contact is shorter along the face width than `ratio` times its width."""
        return self.width_mm < ratio * 2.0 * self.half_width_mm

    def row(self) -> dict[str, Any]:
        """The row of pairs.csv."""
        left_out = ("stations", "unresolved") if self.ring else ("stations", "unresolved", "ring")
        return {name: value for name, value in vars(self).items() if name not in left_out}

    def station_rows(self) -> list[dict[str, Any]]:
        """The rows of contact_lines.csv."""
        pair = {"tooth": self.tooth, "flank": self.flank, "ring_tooth": self.ring_tooth}
        pair |= {"ring": self.ring} if self.ring else {}
        return [{**pair, **station.row()} for station in self.stations]


def touches_edges(contacts: Iterable[PairContact]) -> bool:
    """Whether one of the contacts lies on an edge."""
    return any(contact.edge for contact in contacts)


def pair_contacts(model: DriveModel, state: LoadState) -> list[PairContact]:
    """Contacts of all touching pairs, by ring gear and tooth, the same on all ranks; collective."""
    return [
        contact for flanks in model.problem.flanks for contact in _contacts(model, state, flanks)
    ]


def _contacts(model: DriveModel, state: LoadState, flanks: FlankContact) -> list[PairContact]:
    """Contacts of all touching pairs with one ring gear."""
    spline = model.partition.layouts[FLEXIBLE_SPLINE]
    first, end = model.partition.owned_sectors(FLEXIBLE_SPLINE)
    teeth = spline.first_tooth + np.arange(first, end)
    forces = flank_forces(model, state, teeth, flanks)
    loads = line_loads(spline.mesh, forces)
    pairs = [pair for pair in flanks.pairs if (pair.sector - first, pair.side) in loads]
    carried = _carried(model, state, flanks, pairs, forces, loads)
    plane = model.design.drive.model == "plane"
    # friction presses nothing
    vector = nodal_flank_forces(model, state, flanks, friction=False)
    pressing = line_loads(spline.mesh, forces_on_teeth(model, teeth, vector))
    peaks = {k: _peak(load) for k, load in pressing.items()}
    top = max(model.comm.allgather(max(peaks.values(), default=0.0)))
    resolved = [
        k
        for k, pair in enumerate(pairs)
        if peaks.get((pair.sector - first, pair.side), 0.0) > SMALLEST * top
    ]
    moved, facing = moved_teeth(
        model, [pairs[k] for k in resolved], flanks, None if plane else vector
    )
    vector.destroy()
    materials = (model.design.materials[layout.name] for layout in (spline, flanks.ring.layout))
    modulus = contact_modulus(*materials, plane_stress=plane)
    u = model.problem.displacement()

    @cache
    def lines() -> dict[tuple[int, int], list[PressedLine]]:
        """Of the contact law: in space few pairs ask for them, or none."""
        return _by_flank(flanks.pressed_lines(u, state))

    def of_pair(pair: FlankPair) -> list[PressedLine]:
        return lines().get((pair.sector, pair.side), [])

    teeth_of, failed = dict(zip(resolved, zip(moved, facing))), []

    def press(k: int, lines_of_law: Callable[[], list[PressedLine]]) -> None:
        load = pressing[pairs[k].sector - first, pairs[k].side]
        try:
            carried[k] = _with_pressure(
                carried[k], model, load, lines_of_law, *teeth_of[k], modulus
            )
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            failed.append(f"tooth {pairs[k].sector}: {error}")

    for k in resolved:
        press(k, partial(of_pair, pairs[k]))
    if plane:
        large = _large_off_edges(model, [carried[k] for k in resolved])
        narrow = [
            k
            for k, is_large in zip(resolved, large)
            if is_large and any(line.has_narrow_peak for line in of_pair(pairs[k]))
        ]
        if narrow:
            lines().update(_by_flank(flanks.pressed_lines(u, state, {pairs[k] for k in narrow})))
            for k in narrow:
                press(k, partial(of_pair, pairs[k]))
    contacts = [contact for part in model.comm.allgather(carried) for contact in part]
    reasons = [reason for part in model.comm.allgather(failed) for reason in part]
    if reasons:
        pairs_left = f"a pair is left out of pairs.csv: {reasons[0]}"
        if len(reasons) > 1:
            pairs_left = f"{len(reasons)} pairs is left out of pairs.csv, the first is {reasons[0]}"
        logger.warning("the pressure of %s", pairs_left)
    total = model.copies * sum(contact.force_N for contact in contacts)
    contacts = [replace(contact, force_share=contact.force_N / total) for contact in contacts]
    return sorted(contacts, key=lambda one: (one.tooth, one.flank))


def _by_flank(lines: Iterable[PressedLine]) -> dict[tuple[int, int], list[PressedLine]]:
    """Lines by sector and side of the flexible spline's flank."""
    found: dict[tuple[int, int], list[PressedLine]] = {}
    for line in lines:
        found.setdefault((line.pair.sector, line.pair.side), []).append(line)
    return found


def _large_off_edges(model: DriveModel, contacts: list[PairContact]) -> list[bool]:
    """Whether contacts of this rank are off edges and have nearly the largest pressure of those;
    collective."""
    pressures = [0.0 if one.edge else float(np.nan_to_num(one.pressure_MPa)) for one in contacts]
    top = max(model.comm.allgather(max(pressures, default=0.0)))
    return [pressure > NEARLY * top for pressure in pressures]


def _carried(
    model: DriveModel,
    state: LoadState,
    flanks: FlankContact,
    pairs: list[FlankPair],
    forces: np.ndarray,
    loads: Mapping[tuple[int, int], LineLoad],
) -> list[PairContact]:
    """Force, torque and place of owned pairs, without pressure and share. forces : (n_owned,
    n_node, 3) N"""
    body, ring = model.elements.bodies[FLEXIBLE_SPLINE], flanks.ring.layout
    name = ring.name if len(model.problem.flanks) > 1 else ""
    spline, (first, _) = body.layout, model.partition.owned_sectors(FLEXIBLE_SPLINE)
    positions = (body.positions() + body.displacement(model.problem.displacement()))[body.owned]
    grids = {grid.side: grid for grid in spline.mesh.flanks}
    found = []
    for pair in pairs:
        k, nodes = pair.sector - first, grids[pair.side].nodes.ravel()
        force, (x, y, _) = forces[k, nodes], positions[k, nodes].T
        load, size = loads[k, pair.side], np.linalg.norm(force, axis=1)
        place = np.arctan2(-(size @ x), size @ y) - state.angle
        found.append(
            PairContact(
                tooth=(spline.first_tooth + pair.sector) % spline.mesh.n_sectors,
                flank="clockwise" if pair.side > 0 else "counter-clockwise",
                ring_tooth=pair.ring_tooth % ring.mesh.n_sectors,
                angle_deg=float(np.degrees(np.arctan2(np.sin(place), np.cos(place)))),
                force_N=float(load.load @ load.direction @ tributary(load.z)),
                force_share=np.nan,
                torque_Nmm=float(x @ force[:, 1] - y @ force[:, 0]),
                ring=name,
            )
        )
    return found


def _peak(load: LineLoad) -> float:
    return float(np.linalg.norm(load.load, axis=1).max())


def _with_pressure(
    contact: PairContact,
    model: DriveModel,
    load: LineLoad,
    lines_of_law: Callable[[], list[PressedLine]],
    teeth: Neighbours,
    ring_teeth: Neighbours,
    modulus: float,
) -> PairContact:
    """The contact of a pair with its local pressure.

    lines_of_law : those of the contact law, which tells the pressure in the plane, and in space
    where half spaces find no contact: at the end of the face width;  modulus : E*, MPa
    """
    tooth, facing = teeth[1], ring_teeth[1]
    gap, plane = FlankGap(tooth, facing), model.design.drive.model == "plane"
    patch, lines, on_ring_tip, unresolved = None, [], False, 0.0
    try:
        if plane:
            lines = lines_of_law()
        else:
            patch = _patch(model, gap, load, modulus)
    except (ArithmeticError, np.linalg.LinAlgError):
        lines = lines_of_law()
        if not lines:
            raise
    if patch is not None:
        at_end, reaches, shear = patch.at_end, patch.reaches, patch.largest_shear
        stations, ring_cell = patch_stations(patch), patch.cell_width
        width = len(patch.z) * patch.cell_length
    elif lines:
        strips = STRIPS if plane else CELLS_ACROSS
        stations = tuple(line_station(line, strips) for line in lines)
        line, station = max(zip(lines, stations), key=lambda one: one[0].largest)
        on_tip, on_ring_tip = line.ends_on_tips
        (first, last), (first_cell, ring_cell) = line.ends, line.outermost_cells
        own_tip, own_root = first < first_cell, last > tooth.profile.length - ring_cell
        at_end = on_tip or own_tip or own_root
        low, high = facing.ends
        reaches = not plane and any(
            one.z - one.length < low or one.z + one.length > high for one in lines
        )
        width = sum(one.length for one in lines)
        unresolved = max(line.largest / station.pressure_MPa - 1.0, 0.0)
        shear = largest_shear(line.low, line.high, line.pressure, station.half_width_mm)
    else:
        return contact
    top = max(stations, key=lambda station: station.pressure_MPa)
    ends = line.ends if lines else top.s_mm + top.half_width_mm * np.array([-1.0, 1.0])
    foot = gap.foot(np.reshape(ends, (2, 1)), np.array([top.z_mm]))
    on_ring_tip = bool(on_ring_tip or foot.min() < ring_cell)
    places = {
        FACE_END: reaches,
        f"tip of the {tooth.body.replace('_', ' ')}": at_end,
        f"tip of the {facing.body.replace('_', ' ')}": on_ring_tip,
    }
    edges = [place for place, reached in places.items() if reached]
    middle = tooth.profile.point(np.clip(top.s_mm, 0.0, tooth.profile.length))[0]
    return replace(
        contact,
        width_mm=width,
        line_load_Nmm=top.line_load_Nmm,
        z_mm=top.z_mm,
        radius_mm=float(np.hypot(*middle)),
        pressure_MPa=top.pressure_MPa,
        half_width_mm=top.half_width_mm,
        shear_MPa=shear,
        sliding_mm_s=_sliding(model, gap, teeth, ring_teeth, top) * model.design.load.input_rate,
        edge=int(bool(edges)),
        edge_place=" and the ".join(edges),
        stations=stations,
        unresolved=unresolved,
    )


def _sliding(
    model: DriveModel, gap: FlankGap, teeth: Neighbours, ring_teeth: Neighbours, at: ContactStation
) -> float:
    """Sliding (mm per rad of the wave generator) of both flanks at a station, towards the root of
    the spline's tooth.

    After one pitch of the fixed gear a tooth is where its neighbour was, turned by that pitch. So
    the neighbours give the velocity of a tooth.
    """
    pitch = model.design.kinematics.pitch_angle
    z, s = np.array([at.z_mm]), np.array([[at.s_mm]])

    def velocity(trio: Neighbours, arc_length: np.ndarray) -> np.ndarray:
        before, after = (
            rotated(trio[k].sections(z).from_profile(arc_length)[0, 0], turn)
            for k, turn in ((2, -pitch), (0, pitch))
        )
        return (after - before) / (2.0 * pitch)

    step = 1e-3 * gap.tooth.profile.length * np.array([[-1.0], [1.0]])
    low, high = gap.tooth.sections(z).from_profile(s + step)[:, 0]
    tangent = (high - low) / np.linalg.norm(high - low)
    return float((velocity(teeth, s) - velocity(ring_teeth, gap.foot(s, z))) @ tangent)


def _patch(model: DriveModel, gap: FlankGap, load: LineLoad, modulus: float) -> PatchContact:
    """Contact of a pair in space. load : of the pressures on the mesh"""
    along, share = load.load @ load.direction, tributary(load.z)
    force = float(along @ share)
    # the ring gears of a pancake drive are narrower than the flexible spline
    low, high = gap.facing.ends
    ends = max(float(load.z[0]), low), min(float(load.z[-1]), high)
    place = float(along * load.z @ share) / force
    width = WIDTH * model.design.drive.module
    return patch_contact(gap, gap.least_at, ends, width, force=force, place=place, modulus=modulus)
