"""What a job of CalculiX consists of: numbered nodes, surfaces and constraints of the whole drive.

The plane model is one layer of C3D8I elements. Their incompatible modes are those of the project's
quadrilaterals; CPS4 of CalculiX has none. A material without transverse contraction along z, no
displacement along z and layers tied to each other give exact plane stress at any thickness.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import meshio
import numpy as np

from swgpar.constraints.distributing_coupling import node_weights
from swgpar.contact.flank_faces import flank_faces
from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.arrays import Floats, Ints
from swgpar.geometry.rotation import rotated
from swgpar.meshing import MeshRecipe, SectorMesh, build_sector_meshes
from swgpar.meshing.export import sector_numbers, whole_body, whole_drive
from swgpar.meshing.inp import element_faces
from swgpar.meshing.sweep import grid_quads
from swgpar.profiles import ToothProfile
from swgpar.profiles.flank import Segment
from swgpar.profiles.rigid_teeth import RigidTeeth

SIDES = {1: "clockwise", -1: "counter_clockwise"}
"""Of the flanks of a tooth."""

MEAN_NODES = 8
"""Least number of nodes of a mean motion; the mean of this many nodes at equal angles is free of
the waves of the bent flexible spline up to this order."""

Term = tuple[int, int, float]
"""Node from 0, degree of freedom from 1, coefficient."""


@dataclass(frozen=True)
class CoupledSurface:
    """Nodes of a surface that is coupled or loaded.

    nodes : (n,) from 0, and their weight (n,), tributary areas with the sum 1
    mean : nodes at equal angles, of which the mean motion is taken
    """

    nodes: Ints
    weight: Floats
    mean: Ints


class JobModel:
    """The whole drive of a design on the mesh of a recipe.

    meshes : one sector of the flexible spline and of the ring gear, as solids
    drive : both bodies as one mesh, the spline's nodes and elements first;  points : (n, 3) mm
    """

    def __init__(self, design: DriveDesign, recipe: MeshRecipe) -> None:
        self.design, self.plane = design, design.drive.model == "plane"
        self.flat = build_sector_meshes(design.geometry, recipe)
        self.meshes = {name: replace(mesh, lower_nodes=None) for name, mesh in self.flat.items()}
        self.spline, self.ring = self.meshes["flexible_spline"], self.meshes["ring_gear"]
        self.drive: meshio.Mesh = whole_drive(self.meshes)
        self.points: Floats = self.drive.points
        self.n_spline = len(whole_body(self.spline)[0])
        sizes = [len(mesh.elements) * mesh.n_sectors for mesh in self.meshes.values()]
        self.n_elements = sum(sizes)

    def numbers(self, mesh: SectorMesh, nodes: Ints) -> Ints:
        """Numbers (n_sectors, n), from 0, of nodes of a sector."""
        return sector_numbers(mesh)[:, nodes] + (0 if mesh is self.spline else self.n_spline)

    @cached_property
    def surfaces(self) -> dict[str, Ints]:
        """Element and face (n, 2), both from 0, of the surfaces in contact: each side of the flanks
        is one."""
        surfaces, first = {}, 0
        for mesh in self.meshes.values():
            quads = {
                f"{mesh.body}_{SIDES[grid.side]}": grid_quads(grid.nodes) for grid in mesh.flanks
            }
            if mesh is self.spline:
                quads[f"{mesh.body}_inner"] = mesh.faces["inner"]
            for name, corners in quads.items():
                copies = np.repeat(element_faces(mesh, corners)[None], mesh.n_sectors, axis=0)
                sectors = np.arange(mesh.n_sectors, dtype=np.int32)[:, None]
                copies[..., 0] += first + len(mesh.elements) * sectors
                surfaces[name] = copies.reshape(-1, 2)
            first += len(mesh.elements) * mesh.n_sectors
        return surfaces

    def displaced(self, nodes: Ints, u: Floats) -> list[str]:
        """Lines of a boundary with displacements (n, 3) mm of nodes (n,), from 0."""
        return [
            f"{node}, {axis}, {axis}, {value:.12e}"
            for node, values in zip(nodes + 1, u[:, : 2 if self.plane else 3], strict=True)
            for axis, value in enumerate(values, start=1)
        ]

    def surface(self, mesh: SectorMesh, name: str) -> CoupledSurface:
        """The nodes of a node set of a body."""
        nodes = mesh.node_sets[name]
        weight = node_weights(mesh.coords, nodes, mesh.ccw_nodes)
        nodes, weight = nodes[weight > 0.0], weight[weight > 0.0]
        x, _, z = mesh.coords[nodes].T
        middle = nodes[np.lexsort((np.abs(z - z.mean()).round(9), np.abs(x).round(9)))[0]]
        count = next(k for k in range(MEAN_NODES, mesh.n_sectors + 1) if mesh.n_sectors % k == 0)
        shares = np.tile(weight, mesh.n_sectors)
        return CoupledSurface(
            nodes=self.numbers(mesh, nodes).ravel(),
            weight=shares / shares.sum(),
            mean=self.numbers(mesh, np.array([middle]))[:: mesh.n_sectors // count, 0],
        )

    def inner_nodes(self) -> Ints:
        """Nodes (n,), from 0, of the inner surface that the cam can touch; of the plane model those
        of one layer."""
        nodes = np.unique(self.spline.faces["inner"])
        nodes = np.intersect1d(nodes, self.spline.node_sets["bore"]) if self.plane else nodes
        return np.unique(self.numbers(self.spline, nodes))

    def inner_gap(self) -> float:
        """Mean distance (mm) of the inner surface's facets from the exact cylinder."""
        corners = self.spline.coords[self.spline.faces["inner"]]
        length = np.hypot(*np.ptp(corners[..., :2], axis=1).T)
        height = self.design.inner_radius - np.hypot(*corners[..., :2].mean(axis=1).T)
        return float(2.0 / 3.0 * np.sum(length * height) / length.sum())

    def flank_gap(self) -> float:
        """Largest distance (mm) between a facet and the exact, crowned flank of a gear."""
        gears = self.design.geometry.gears
        faces = (
            flank_faces(mesh, mesh.flanks[0], gears[name].crowning)
            for name, mesh in self.meshes.items()
        )
        return max(float(np.abs(each.offset).max()) for each in faces)

    def faceted_teeth(self) -> RigidTeeth:
        """Rigid teeth whose flanks at mid-width are polygons."""
        spline, ring = _polygon(self.spline), _polygon(self.ring)
        return replace(self.design.rigid_teeth(), spline=spline, ring=ring)

    def ties(self) -> Iterator[list[Term]]:
        """Plane model: the upper layer of nodes moves with the lower one."""
        for name, mesh in self.flat.items():
            upper = np.flatnonzero(mesh.lower_nodes != np.arange(len(mesh.coords)))
            pairs = self.numbers(self.meshes[name], np.array([upper, mesh.lower_nodes[upper]]))
            pairs = np.moveaxis(pairs, 1, -1).reshape(-1, 2)
            for above, below in np.unique(pairs, axis=0).tolist():
                for axis in (1, 2):
                    yield [(above, axis, 1.0), (below, axis, -1.0)]

    @cached_property
    def closing_rotation(self) -> float:
        """Rotation (rad) of the output that brings the loaded flanks together, as rigid facets."""
        closing = abs(self.faceted_teeth().touching_rotation())
        if not np.isfinite(closing):  # the loaded state has to find the flanks
            closing = self.design.backlash_angle
        return self.design.kinematics.torque_direction * closing

    def housing(self, nodes: Ints, guide: int | None = None) -> Iterator[list[Term]]:
        """Nodes (n,) of the outer surface of the ring gear move along its circle and the axis.

        guide : node of the displacement of the circle along x and y, the next one of its slopes
        along z; without it the circle stands still

        The equations are linear: a node moves on the chord of the rotation that brings the flanks
        together.
        """
        normal, axes = self._chords(nodes)
        for node, n, pair in zip(nodes.tolist(), normal, axes.tolist(), strict=True):
            terms = [(node, axis + 1, float(n[axis])) for axis in pair]
            if guide is not None:
                terms += [(guide, axis + 1, -float(n[axis])) for axis in pair]
            if guide is not None and not self.plane:
                z = float(self.points[node, 2])
                terms += [(guide + 1, axis + 1, -z * float(n[axis])) for axis in pair]
            yield terms

    def _chords(self, nodes: Ints) -> tuple[Floats, Ints]:
        """Normals (n, 2) mm of the chords, and the axes (n, 2): of the displacement that follows,
        and of the other."""
        normal = rotated(self.points[nodes, :2], 0.5 * self.closing_rotation)
        first = np.abs(normal).argmax(axis=1)
        return normal, np.column_stack([first, 1 - first])

    def mean_motion(
        self,
        surface: CoupledSurface,
        reference: int,
        *,
        place: float | None = None,
        in_housing: bool = False,
        guide: int | None = None,
    ) -> Iterator[list[Term]]:
        """Mean displacements, tilts and rotation about z of a surface, linear: the degrees of
        freedom 1 to 3 of the node `reference`, and those of the next one.

        place : mm along z, of the point whose displacement the first node has; default the middle
        of the surface, as in the plane model
        in_housing : the nodes move in a housing, with `guide` as in `housing`; without a guide
        there is no mean displacement along x and y
        """
        x = self.points[surface.mean]
        arm, n = x - x.mean(axis=0), len(x)
        lever = 0.0 if place is None or self.plane else place - float(x[:, 2].mean())
        radius2 = float((arm[:, :2] ** 2).sum())
        (right, top), (left, bottom) = arm[:, :2].argmax(axis=0), arm[:, :2].argmin(axis=0)
        one, none = np.full(n, 1.0 / n), np.zeros(n)
        first, second = reference, reference + 1
        # factors of the displacements along x, y and z; the displacement that depends on the
        # others, by node and axis; factors of the references
        turn = -arm[:, 1] / radius2, arm[:, 0] / radius2, none
        rows = [(turn, (bottom, 0), {(second, 3): -1.0})]
        if not in_housing or guide is not None:
            rows += [
                ((one, none, none), (top, 0), {(first, 1): -1.0, (second, 2): lever}),
                ((none, one, none), (right, 1), {(first, 2): -1.0, (second, 1): -lever}),
            ]
        if not self.plane:
            rows += [
                ((none, none, one), (left, 2), {(first, 3): -1.0}),
                ((none, none, 2.0 / radius2 * arm[:, 1]), (top, 2), {(second, 1): -1.0}),
                ((none, none, -2.0 / radius2 * arm[:, 0]), (right, 2), {(second, 2): -1.0}),
            ]
        freedoms = [(int(node), axis) for node in surface.mean for axis in (1, 2, 3)]
        freedoms += [(node, axis) for node in (first, second) for axis in (1, 2, 3)]
        if guide is not None:
            freedoms += [(guide + k, axis) for k in (0, 1) for axis in (1, 2)]
        column = {freedom: k for k, freedom in enumerate(freedoms)}
        factors = np.zeros((len(rows), len(freedoms)))
        for row, (of_nodes, _, of_references) in zip(factors, rows, strict=True):
            row[: 3 * n] = np.stack(of_nodes, axis=-1).ravel()
            for freedom, factor in of_references.items():
                row[column[freedom]] = factor
        if in_housing:
            for (node, axis, factor), *others in self.housing(surface.mean, guide):
                inside = factors.T[column[node, axis]]
                by_inside = inside / factor
                inside[:] = 0.0
                for other, other_axis, share in others:
                    factors.T[column[other, other_axis]] -= share * by_inside
        dependent = [3 * int(k) + axis for _, (k, axis), _ in rows]
        # none of the dependent displacements is left in the equations of the others
        solved = np.linalg.inv(factors[:, dependent]) @ factors
        for row, first_column in zip(solved, dependent, strict=True):
            used = np.flatnonzero(np.abs(row) > 1e-12 * np.abs(row).max())
            columns = [first_column, *np.setdiff1d(used, dependent)]
            yield [(*freedoms[c], float(row[c])) for c in columns]


def _polygon(mesh: SectorMesh) -> ToothProfile:
    flank = mesh.flanks[0]
    points = mesh.coords[flank.nodes[:, int(np.abs(flank.z).argmin())], :2]
    x, y = np.diff(points, axis=0).T
    sides = zip(points, np.arctan2(y, x), np.hypot(x, y), strict=False)
    segments = tuple(Segment("facet", (p[0], p[1]), angle, 0.0, s) for p, angle, s in sides)
    return replace(mesh.profile, segments=segments)
