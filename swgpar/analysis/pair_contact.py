"""Contact of every touching pair of flanks: force, line load, and the local pressure that no mesh of a drive resolves.

The mesh gives the forces and the places of the teeth. At the station along the face width with the largest line load,
the exact profiles are moved with their teeth, and the gap between them goes into the line contact of two half planes
(`contact.line_contact`), which is Hertz's where the profiles are arcs.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from scipy.integrate import trapezoid

from swgpar.analysis.drive_model import DriveModel
from swgpar.analysis.flank_loads import LineLoad, line_loads
from swgpar.contact.line_contact import effective_modulus, line_contact
from swgpar.contact.search import FlankPair
from swgpar.contact.segments import MIRROR
from swgpar.design.load_states import LoadState
from swgpar.fem.body_layout import FLEXIBLE_SPLINE, RING_GEAR, BodyLayout
from swgpar.fem.vectors import read_field
from swgpar.geometry.profiles import ToothProfile
from swgpar.geometry.rotation import HALF_TURN, rotated
from swgpar.log import logger
from swgpar.meshing.sector import FlankGrid

SMALLEST = 0.02
"""Line load, over the largest one, below which a pair is left out."""

WIDTH = 0.05
"""Width over the module within which the contact is looked for at first."""

END = 1e-6
"""Distance over the module from the end of a profile within which a contact lies on an edge."""


@dataclass(frozen=True)
class PairContact:
    """Contact of two flanks.

    tooth, ring_tooth : numbers of the teeth, counter-clockwise from +y;  flank : of the flexible spline's tooth
    force_N : normal force;  width_mm : length along the face width that carries it
    line_load_Nmm : largest line load, N/mm, at `z_mm`;  radius_mm : of the contact, on the undeformed flexible spline
    pressure_MPa, half_width_mm, shear_MPa : largest pressure, half width of the contact and largest shear below it
    edge : 1 where the contact ends at the tip of a profile, or the load at an end of the face width; the pressure is
    then no property of the drive
    """

    tooth: int
    flank: str
    ring_tooth: int
    force_N: float
    width_mm: float
    line_load_Nmm: float
    z_mm: float
    radius_mm: float
    pressure_MPa: float
    half_width_mm: float
    shear_MPa: float
    edge: int


def pair_contacts(model: DriveModel, state: LoadState) -> list[PairContact]:
    """Contacts of all pairs that carry a load, by tooth, the same on all ranks; collective."""
    spline = model.partition.layouts[FLEXIBLE_SPLINE]
    first, end = model.partition.owned_sectors(FLEXIBLE_SPLINE)
    loads = line_loads(model, state, spline.first_tooth + np.arange(first, end))
    pairs = [pair for pair in model.problem.flanks.pairs if (pair.sector - first, pair.side) in loads]
    top = max(model.comm.allgather(max((_peak(load) for load in loads.values()), default=0.0)))
    pairs = [pair for pair in pairs if _peak(loads[pair.sector - first, pair.side]) > SMALLEST * top]
    x = model.problem.x
    moved = read_field(model.partition, FLEXIBLE_SPLINE, np.array([p.sector for p in pairs], dtype=np.int64), x)
    facing = read_field(model.partition, RING_GEAR, np.array([p.ring for p in pairs], dtype=np.int64), x)
    found, failed = [], []
    for pair, u, ring_u in zip(pairs, moved, facing):
        try:
            contact = _contact(model, pair, loads[pair.sector - first, pair.side], u, ring_u)
            found.append(tuple(asdict(contact).values()))
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            failed.append(f"tooth {pair.sector}: {error}")
    rows = [row for part in model.comm.allgather(found) for row in part]
    for reason in (reason for part in model.comm.allgather(failed) for reason in part):
        logger.warning("the contact of a pair is left out of pairs.csv: %s", reason)
    return sorted((PairContact(*row) for row in rows), key=lambda one: (one.tooth, one.flank))


def _peak(load: LineLoad) -> float:
    return float(np.linalg.norm(load.load, axis=1).max())


def _contact(model: DriveModel, pair: FlankPair, load: LineLoad, u: np.ndarray, ring_u: np.ndarray) -> PairContact:
    """Contact of one pair. u, ring_u : displacements (n_node, 3) mm of both sectors"""
    design = model.design
    spline, ring = model.partition.layouts
    module, plane = design.drive.module, spline.mesh.plane
    size = np.linalg.norm(load.load, axis=1)
    station = int(size.argmax())
    if pair.ring_flip:
        ring_u = HALF_TURN * ring_u
    tooth = _Tooth(spline, spline.first_tooth + pair.sector, pair.side, u, station)
    facing = _Tooth(ring, pair.ring_tooth, -pair.side, ring_u, station)

    def gap(s: np.ndarray) -> np.ndarray:
        inside = (s >= 0.0) & (s <= tooth.profile.length)
        distance, _ = facing.profile.distance(facing.to_profile(tooth.from_profile(np.where(inside, s, 0.0))))
        return np.where(inside, distance, np.inf)

    s = np.linspace(0.0, tooth.profile.length, 2001)
    start = float(s[gap(s).argmin()])
    direction = load.load.sum(axis=0) / np.linalg.norm(load.load.sum(axis=0))
    along = load.load @ direction
    modulus = effective_modulus(design.material.E, design.material.nu, plane_stress=plane)
    found = line_contact(gap, start, WIDTH * module, float(size[station]), modulus)
    _, foot = facing.profile.distance(
        facing.to_profile(tooth.from_profile(found.middle + found.half_width * np.array([-1.0, 1.0])))
    )
    at_end = not plane and station in (0, len(size) - 1)
    middle = tooth.profile.point(np.clip(found.middle, 0.0, tooth.profile.length))[0]
    return PairContact(
        tooth=(spline.first_tooth + pair.sector) % spline.mesh.n_sectors,
        flank="clockwise" if pair.side > 0 else "counter-clockwise",
        ring_tooth=pair.ring_tooth % ring.mesh.n_sectors,
        force_N=float(trapezoid(along, load.z)),
        width_mm=_length_above(load.z, size, SMALLEST * float(size.max())),
        line_load_Nmm=float(size[station]),
        z_mm=0.0 if plane else float(load.z[station]),
        radius_mm=float(np.hypot(*middle)),
        pressure_MPa=found.peak,
        half_width_mm=found.half_width,
        shear_MPa=found.largest_shear(),
        edge=int(found.at_end or foot.min() < END * module or at_end),
    )


def _length_above(z: np.ndarray, values: np.ndarray, level: float) -> float:
    """Length (mm) on which values (n,), linear between z (n,) mm, are above a level."""
    low, high = np.minimum(values[:-1], values[1:]), np.maximum(values[:-1], values[1:])
    share = np.where(high > low, (high - level) / np.where(high > low, high - low, 1.0), high > level)
    return float((np.clip(share, 0.0, 1.0) * np.diff(z)).sum())


class _Tooth:
    """A tooth that has moved rigidly, in the section of one station along the face width.

    Parameters
    ----------
    layout, tooth, side : body, number and flank;  u : (n_node, 3) mm, displacement of its sector in the drive's frame
    station : number of the section, among those of the flank's grid
    """

    def __init__(self, layout: BodyLayout, tooth: int, side: int, u: np.ndarray, station: int) -> None:
        self.profile: ToothProfile = layout.mesh.profile
        self.mirror = MIRROR if side < 0 else np.ones(2)
        angle = float(layout.sector_angle(np.array(tooth)))
        nodes = np.concatenate([_active(grid, self.profile, station) for grid in layout.mesh.flanks])
        before = layout.mesh.coords[nodes, :2]
        after = before + rotated(u[nodes, :2], -angle)
        # the rotation that fits best is that of the polar decomposition
        middle, moved = before.mean(axis=0), after.mean(axis=0)
        a, b = (before - middle).T @ (after - moved)
        turn = float(np.arctan2(a[1] - b[0], a[0] + b[1]))
        self._middle, self._moved, self._turn, self._angle = middle, moved, turn, angle

    def from_profile(self, s: np.ndarray) -> np.ndarray:
        """Points (n, 2) of the drive's frame, of the flank at arc lengths s (n,) mm."""
        point = self.profile.point(s) * self.mirror
        return rotated(self._moved + rotated(point - self._middle, self._turn), self._angle)

    def to_profile(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 2) of the drive's frame in the frame of the undeformed flank."""
        local = rotated(points, -self._angle)
        return (self._middle + rotated(local - self._moved, -self._turn)) * self.mirror


def _active(grid: FlankGrid, profile: ToothProfile, station: int) -> np.ndarray:
    """Nodes (n,) of the active part of a flank, above its root, at a station."""
    above = grid.s <= profile.breaks[-2] * (1.0 + 1e-9)
    return grid.nodes[above if above.sum() > 2 else slice(None), station]
