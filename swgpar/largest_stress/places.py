"""Where the largest stresses are: body, region, tooth, radius, z, angle, and whether the number
means anything."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from swgpar.answers.answer import (
    Answer,
    AnswerGroup,
    AnswerKind,
    declared_answers,
    evaluation,
    part_answers,
    place_text,
    with_error,
    with_no_limit,
)
from swgpar.design.drive_design import DriveDesign
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.body_layout import BodyLayout
from swgpar.load.load_states import LoadState
from swgpar.meshing.drive_geometry import DriveGeometry
from swgpar.meshing.sector import SectorMesh
from swgpar.model.drive_model import DriveModel
from swgpar.model.nodal_pressure import nodal_pressure
from swgpar.model.regions import END, NEAR, UNDER_CONTACT, WITHOUT_LIMIT, warning_of

TOUCHED = 0.02
"""Share of the largest nodal pressure from which a flank's node counts as touched."""

OFF_CORNERS = "_off_corners"
"""Ending of the names of stresses apart from the contact of flanks and off all places where there
is no limit."""

APART, APART_DISTANCE = "_apart", 0.25
"""Ending of the names of stresses apart from the contact of flanks; distance (modules) from a
touched node."""

OF_REGION = " in "
"""Between a stress and a region in the names of the largest stresses of regions: "fs_vm in cup
wall"."""

ROLLER = "below a roller: an average over elements, larger on a finer mesh"
CORNER = "a contact lies on the edge of a tooth: larger on a finer mesh"


@dataclass(frozen=True)
class Place:
    """Place of a largest stress.

    value : MPa;  body : name
    region : "tooth root", "tooth end", "flank under contact", "flank", "tip", "rim inside", "rim",
    "notch", "corner", "rim at the edge of the cam", "cup wall", "fillet at the back", "fillet",
    "closed end", "bore", "attachment", "flange", "rim of the flange", "outer surface" or "inside
    the tooth"
    tooth : number, counter-clockwise from +y in the undeformed drive
    radius, z : mm;  angle_deg : from +y, counter-clockwise
    warning : why the value depends on the mesh; empty where it converges
    error : MPa, estimated; None where it is not known
    on_mesh : MPa, nodal average on the drive's mesh where the value is by windows; else None
    """

    value: float
    body: str
    region: str
    tooth: int
    radius: float
    z: float
    angle_deg: float
    warning: str
    error: float | None = None
    on_mesh: float | None = None

    @classmethod
    def at(
        cls,
        layout: BodyLayout,
        region: str,
        point: np.ndarray,
        tooth: int,
        value: float,
        error: float = math.inf,
    ) -> Place:
        """The place of a stress without a warning.

        point : (3,) mm, undeformed, with the tooth at +y;  tooth : number, of any turn
        value, error : MPa, the error infinite if unknown
        """
        x, y, z = point
        angle = float(layout.sector_angle(np.array(tooth)) - np.arctan2(x, y))
        return cls(
            value=value,
            body=layout.name,
            region=region,
            tooth=tooth % layout.mesh.n_sectors,
            radius=float(np.hypot(x, y)),
            z=0.0 if layout.mesh.plane else float(z),
            angle_deg=float(np.degrees(angle)) % 360.0,
            warning="",
            error=error if math.isfinite(error) else None,
        )

    @property
    def text(self) -> str:
        """Words for the place."""
        return place_text(self.region, self.tooth, self.radius, self.z, self.angle_deg)


STRESSES = {"s1": "tension s1", "s3": "compression |s3|", "vm": "von Mises stress"}
BODIES = {"fs": "flexible spline", "rg": "ring gear", "ds": "dynamic spline"}


def stress_kind(body: str, stress: str, ending: str = "", words: str = "") -> AnswerKind:
    """The largest stress of a body. ending, words : `APART` or `OFF_CORNERS`, and what it says"""
    text = f"{BODIES[body]}, {STRESSES[stress]}{words}"
    return AnswerKind(f"largest.{body}_{stress}{ending}", text, "MPa")


def region_kind(body: str, stress: str, region: str) -> AnswerKind:
    """The largest stress of a body in a region of it."""
    one = stress_kind(body, stress, f"{OF_REGION}{region}", f" in {region}")
    return replace(one, detail=True)


def of_its_bodies(kinds: tuple[AnswerKind, ...], design: DriveDesign) -> tuple[AnswerKind, ...]:
    """Of these kinds those that a drive of the design has: only a pancake has a dynamic spline."""
    if design.dynamic_spline is not None:
        return kinds
    return tuple(kind for kind in kinds if not kind.name.partition(".")[2].startswith("ds"))


@evaluation
class LargestStresses(AnswerGroup):
    """Largest stresses of all increments under load, by windows where they resolve them, else nodal
    averages.

    places : by column of the history, and with `APART`;  regions : by names with `OF_REGION`
    """

    places: Mapping[str, Place] = part_answers(
        *(
            stress_kind(body, stress, ending, words)
            for body in BODIES
            for stress in STRESSES
            for ending, words in (
                ("", ""),
                (APART, ", apart from the contact"),
                (OFF_CORNERS, ", apart from the contact, and off corners without a radius"),
            )
            if not (ending == APART and stress == "s1")
        )
    )
    regions: Mapping[str, Place]

    TITLE = "largest stresses of all increments under load"
    OF_REGIONS = tuple(region_kind(body, stress, "") for body in BODIES for stress in STRESSES)

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        return of_its_bodies(super().kinds(design), design)

    @classmethod
    def of(cls, places: Mapping[str, Place]) -> LargestStresses:
        """From places by the names of `find_places`; without those for which there is no node."""
        known = {name: place for name, place in places.items() if np.isfinite(place.value)}
        return cls(
            places={name: place for name, place in known.items() if OF_REGION not in name},
            regions={name: place for name, place in known.items() if OF_REGION in name},
        )

    def answers(self) -> Iterator[Answer]:
        declared = (*declared_answers(LargestStresses), *self.OF_REGIONS)
        kinds = {kind.name.partition(".")[2]: kind for kind in declared}
        for name, place in (*self.places.items(), *self.regions.items()):
            stress, within, region = name.partition(OF_REGION)
            hidden = stress.endswith(OFF_CORNERS) and not self._lies_at_a_corner(stress)
            kind = kinds[stress + within]
            one = Answer(
                name=f"largest.{name}",
                value=place.value,
                unit=kind.unit,
                text=f"{kind.text}{region}",
                place=place.text,
                remark=place.warning,
                detail=kind.detail or hidden,
            )
            yield with_no_limit(one) if place.warning else with_error(one, place.error)

    def _lies_at_a_corner(self, name: str) -> bool:
        """Whether the largest stress apart from the contact has no limit, where another one off
        corners has this name."""
        stress = name.removesuffix(OFF_CORNERS)
        largest = self.places.get(stress + APART, self.places.get(stress))
        return largest is not None and largest.region in WITHOUT_LIMIT


def find_places(
    model: DriveModel,
    state: LoadState,
    fields: Mapping[str, Mapping[str, np.ndarray]],
    *,
    on_edge: bool = False,
) -> dict[str, Place]:
    """Places of the largest s1, |s3| and von Mises stress of all gears, by column of the history;
    collective.

    |s3| and von Mises are looked for apart from the contact of flanks as well, with names that end
    with `APART`: on surfaces and in the rim. Inside of a tooth they decrease with the distance from
    the contact, wherever it is cut off. All are looked for in every region as well, with names that
    have `OF_REGION`; only values above 0. Names that end with `OFF_CORNERS` are of those apart from
    the contact that have a limit.

    fields : nodal fields of the gears as `DriveModel.stresses` gives them
    on_edge : whether a contact of flanks lies on the edge of a tooth
    """
    pressed = pressed_nodes(
        model, state
    )  # those of the spline; any flank of a ring gear may be touched
    found, geometry = {}, model.geometry
    distance, on_rollers = (
        APART_DISTANCE * geometry.module,
        model.design.wave_generator.type in ("two_roller", "four_roller"),
    )
    for name in geometry.gears:
        body = model.elements.bodies[name]
        prefix = body.layout.body.stress_prefixes[0]
        ring = name != FLEXIBLE_SPLINE
        mesh, free = body.layout.mesh, np.zeros(fields[name]["s3"].shape, dtype=bool)
        # every sector of a ring gear is alike: one stands for all
        near = near_contact(mesh, working_flanks(mesh)[None] if ring else pressed, distance)
        near |= inside_teeth(geometry, mesh)
        apart = np.broadcast_to(~near, free.shape)
        regions = model.regions[name]
        beyond = np.ones(free.shape[1], dtype=bool)  # nodes of the housing
        beyond[mesh.nodes_of(0)] = False
        for stress in ("s1", "s3", "vm"):
            values = -fields[name][stress] if stress == "s3" else fields[name][stress]
            values = np.where(beyond, -np.inf, values)
            # s1 below a contact is compressive or small; of a ring gear any flank may be touched
            below = near if stress != "s1" else free if ring else pressed
            below = np.broadcast_to(below, free.shape)
            names = {f"{prefix}_{stress}": (values, below)}
            if stress != "s1":
                names[f"{prefix}_{stress}{APART}"] = (
                    np.where(apart, values, -np.inf),
                    free,
                )
            limited = np.where(below, regions[True], regions[False])
            limited = ~np.isin(limited, (*WITHOUT_LIMIT, UNDER_CONTACT)) & (
                apart | (stress == "s1")
            )
            names[f"{prefix}_{stress}{OFF_CORNERS}"] = np.where(limited, values, -np.inf), below
            names |= _by_region(f"{prefix}_{stress}", regions, values, below)
            for column, of in names.items():
                place = _largest(model, name, *of)
                if OF_REGION in column and place.value <= 0.0:
                    continue
                if on_rollers and stress != "s1" and place.region == "rim inside":
                    place = replace(place, warning=ROLLER)
                if on_edge and ring and not place.warning:
                    place = replace(place, warning=CORNER)
                found[column] = place
    return found


def _by_region(
    stress: str, regions: Mapping[bool, np.ndarray], values: np.ndarray, below: np.ndarray
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Values (n_sectors, n_node) of every region, -inf elsewhere, by name; the same names on all
    ranks."""
    return {
        f"{stress}{OF_REGION}{region}": (
            np.where(
                np.where(below, regions[True] == region, regions[False] == region), values, -np.inf
            ),
            below,
        )
        for region in np.unique(np.concatenate(list(regions.values())))
    }


def inside_teeth(geometry: DriveGeometry, mesh: SectorMesh) -> np.ndarray:
    """Whether a node (n_node,) of a sector lies inside of its tooth: neither on a surface nor in
    the rim."""
    radius, z = np.hypot(mesh.coords[:, 0], mesh.coords[:, 1]), mesh.coords[:, 2]
    low, high = sorted((mesh.profile.r_root_circle, mesh.profile.r_tip_circle))
    near = NEAR * geometry.module
    inside = (radius > low + near) & (radius < high - near)
    if not mesh.plane:
        front, back = geometry.gears[mesh.body].ends
        inside &= (z > front + near) & (z < back - near)
    for grid in mesh.flanks:
        inside[grid.nodes.ravel()] = False
    return inside


def root_nodes(geometry: DriveGeometry, mesh: SectorMesh) -> np.ndarray:
    """Nodes (n,) on the roots of a sector's tooth, between its ends."""
    nodes = [grid.nodes[grid.s >= mesh.profile.root_start].ravel() for grid in mesh.flanks]
    found = np.unique(np.concatenate(nodes))
    return (
        found if mesh.plane else found[np.abs(mesh.coords[found, 2]) <= END * geometry.face_width]
    )


def pressed_nodes(model: DriveModel, state: LoadState) -> np.ndarray:
    """Nodes (n_owned, n_node) bool of the flexible spline that a contact presses on; collective."""
    pressure = nodal_pressure(model.problem, state, model.elements.bodies[FLEXIBLE_SPLINE])
    top = max(model.comm.allgather(float(pressure.max(initial=0.0))))
    return pressure > TOUCHED * top if top > 0.0 else np.zeros(pressure.shape, dtype=bool)


def working_flanks(mesh: SectorMesh) -> np.ndarray:
    """Nodes (n_node,) bool on the working parts of the flanks of a sector: not on its roots."""
    working = np.zeros(len(mesh.coords), dtype=bool)
    for grid in mesh.flanks:
        working[grid.nodes[grid.s < mesh.profile.root_start]] = True
    return working


def near_contact(mesh: SectorMesh, touched: np.ndarray, distance: float) -> np.ndarray:
    """Nodes (n_sectors, n_node) within a distance (mm) of touched ones on flanks and roots: a tip
    may reach the root of the other gear."""
    flanks = np.zeros(len(mesh.coords), dtype=bool)
    for grid in mesh.flanks:
        flanks[grid.nodes] = True
    tree, near = cKDTree(mesh.coords), np.zeros(touched.shape, dtype=bool)
    for sector in np.flatnonzero((touched & flanks).any(axis=1)):
        nodes = np.flatnonzero(touched[sector] & flanks)
        within = tree.query_ball_point(mesh.coords[nodes], distance)
        near[sector, np.unique(np.concatenate(within).astype(int))] = True
    return near


def _largest(model: DriveModel, name: str, values: np.ndarray, touched: np.ndarray) -> Place:
    """Place of the largest of values (n_sectors, n_node) MPa of a body; collective. touched : nodes
    under contact"""
    body = model.elements.bodies[name]
    best: tuple[float, int, int, bool] = (-np.inf, 0, 0, False)
    if values.size:
        sector, node = np.unravel_index(values.argmax(), values.shape)
        first, _ = model.partition.owned_sectors(name)
        best = (
            float(values[sector, node]),
            first + int(sector),
            int(node),
            bool(touched[sector, node]),
        )
    value, sector, node, pressed = max(model.comm.allgather(best), key=lambda one: one[0])
    layout, point = body.layout, body.layout.mesh.coords[node]
    region = str(model.regions[name][pressed][node])
    place = Place.at(layout, region, point, layout.first_tooth + sector, value)
    return replace(place, warning=warning_of(model.geometry, region, point))
