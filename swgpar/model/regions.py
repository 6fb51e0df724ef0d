"""Regions of a tooth sector: tooth root, flank, rim, cup wall, ..., and where a stress has no limit
to converge to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.meshing.drive_geometry import CupGeometry, DriveGeometry
from swgpar.meshing.sector import SectorMesh
from swgpar.model.sharp_corners import REACH, sharp_corners

BACK = "fillet at the back"
"""Region of the fillet between the back of the teeth and the wall of the cup."""

ATTACHED = "attachment"
"""Region of the clamped ring of closed end or flange, or of the ring in which its bolts lie; of the
edges of a ring gear whose outer surface is held."""

TOOTH_ROOT, TOOTH_END, UNDER_CONTACT = "tooth root", "tooth end", "flank under contact"
"""Regions of the roots and of the ends of the teeth; of the flanks that touch and of what is close
below them."""

FLANK, TIP, INSIDE = "flank", "tip", "inside the tooth"
"""Regions of the flanks that do not touch, of the tips, and of what lies on no surface."""

RIM_INSIDE, RIM, NOTCH_REGION = "rim inside", "rim", "notch"
"""Regions of the inner half of the flexible spline's rim, of the outer half of the ring gear's rim,
and of the corner without a fillet behind the teeth."""

OUTER = "outer surface"
"""Region of the outer surface of the ring gear."""

CAM_EDGE, CORNER = "rim at the edge of the cam", "corner"
"""Regions where the stress has no limit: inside of the rim at the edge of the wave generator, and
beside corners without a radius."""

CUP_WALL = "cup wall"
"""Region of the wall between the back of the teeth and its fillet."""

FILLET = "fillet"
"""Region of the fillet before the closed end or flange, and of the wall beside it."""

WALL = (CUP_WALL, FILLET, "closed end", "bore", "flange", "rim of the flange")
"""Regions of the wall behind the teeth."""

END = 0.45
"""Share of the face width from its middle beyond which a place belongs to the end of a tooth."""

WITHOUT_LIMIT = (NOTCH_REGION, ATTACHED, CAM_EDGE, CORNER)
"""Regions where the stress grows with every finer mesh."""

AT_ENDS = (TOOTH_END, BACK, NOTCH_REGION)
"""Regions of the ends of the teeth."""

NEAR = 0.02
"""Distance over the module within which a place lies on an edge."""

BESIDE = 0.5
"""Distance over the thickness of the wall within which a place belongs to the fillet beside it, or
to the edge of an attachment or of the wave generator: as far as the stress there reaches."""

AT_CORNER = 0.1
"""Distance over the thickness of the wall within which a place on the back of the teeth belongs to
the corner there."""

AVERAGE = "below the contact of teeth: an average over elements, larger on a finer mesh"
NOTCH = "in the notch behind the teeth, a corner without fillet: no limit to converge to"
EDGE = "at the edge of the wave generator: edge contact, no limit to converge to"
NO_RADIUS = "which has no radius: no limit to converge to"
CLAMPED = "at the edge of a rigid attachment: no limit to converge to"


def sector_regions(geometry: DriveGeometry, mesh: SectorMesh) -> dict[bool, np.ndarray]:
    """Regions (n_node,) of the nodes of a sector, by whether a contact of flanks presses on
    them."""
    nodes = range(len(mesh.coords))
    return {touched: regions_of(geometry, mesh, nodes, touched) for touched in (False, True)}


def regions_of(
    geometry: DriveGeometry, mesh: SectorMesh, nodes: Sequence[int] | np.ndarray, touched: bool
) -> np.ndarray:
    """Regions (n,) of nodes (n,) of a sector. touched : whether a contact of flanks presses on
    them, or close to them"""
    nodes = np.asarray(nodes, dtype=int)
    points = mesh.coords[nodes]
    # both layers of the plane are alike
    lower = nodes if mesh.lower_nodes is None else mesh.lower_nodes[nodes]
    once, index = np.unique(lower, return_inverse=True)
    of_each = [_smooth_region(geometry, mesh, int(node), touched) for node in once]
    found = np.array(of_each, dtype=object)[index]
    found[at_the_cam_edge(geometry, points) & (found == RIM_INSIDE)] = CAM_EDGE
    found[_beside_the_wall(geometry, mesh)[nodes]] = NOTCH_REGION
    at_held_edge = _at_a_held_edge(geometry, mesh, points)
    found[at_held_edge & np.isin(found, (RIM, OUTER))] = ATTACHED
    of_wall = np.isin(found, (*WALL, RIM_INSIDE))
    for corner in sharp_corners(geometry, mesh.body):
        found[corner.near(points) & (of_wall | corner.of_tooth)] = CORNER
    return found.astype(str)


def at_the_cam_edge(geometry: DriveGeometry, points: np.ndarray) -> np.ndarray:
    """Whether points (n, 3) mm are as close to an edge of the wave generator along the axis as the
    stress there reaches, (n,) bool."""
    if geometry.model == "plane":
        return np.zeros(len(points), dtype=bool)
    beyond = np.abs(points[:, 2]) - 0.5 * geometry.cam_width
    return np.abs(beyond) < BESIDE * geometry.gears[FLEXIBLE_SPLINE].rim


def _beside_the_wall(geometry: DriveGeometry, mesh: SectorMesh) -> np.ndarray:
    """Nodes (n_node,) bool on the back of the teeth within the reach of the corner behind them,
    where the wall continues the layers below the root.

    There the corner of the mesh goes up the root arc as far as the elements of the wall do.
    """
    found, cup = np.zeros(len(mesh.coords), dtype=bool), geometry.cup
    if mesh.plane or mesh.body != FLEXIBLE_SPLINE or cup is None:
        return found
    if cup.back_fillet > 0.0 or not cup.continues_root:
        return found
    z, near = mesh.coords[:, 2], NEAR * geometry.module
    radius = np.hypot(mesh.coords[:, 0], mesh.coords[:, 1])
    surface = geometry.inner_radius + geometry.cup_thickness
    above = np.flatnonzero((np.abs(z - cup.wall.back) < near) & (radius > surface - near))
    of_wall = mesh.hexes[z[mesh.hexes].max(axis=1) > cup.wall.back + near]
    corner = np.intersect1d(above, of_wall)
    if len(corner):
        distance, _ = cKDTree(mesh.coords[corner]).query(mesh.coords[above])
        found[above[distance <= REACH * geometry.cup_thickness]] = True
    return found


def _at_a_held_edge(geometry: DriveGeometry, mesh: SectorMesh, points: np.ndarray) -> np.ndarray:
    """Whether points (n, 3) mm of a ring gear are close to an edge of its outer surface, which is
    held if there is no housing around it, (n,) bool."""
    if mesh.plane or mesh.body == FLEXIBLE_SPLINE or geometry.housing > 0.0:
        return np.zeros(len(points), dtype=bool)
    gear = geometry.gears[mesh.body]
    below = gear.outer_radius - np.hypot(points[:, 0], points[:, 1])
    away = np.min([np.abs(points[:, 2] - end) for end in gear.ends], axis=0)
    return np.hypot(below, away) < BESIDE * gear.rim


def _smooth_region(geometry: DriveGeometry, mesh: SectorMesh, node: int, touched: bool) -> str:
    """Region of a node without regard to edges of the cam and corners without a radius."""
    x, y, z = mesh.coords[node]
    radius, half = float(np.hypot(x, y)), 0.5 * geometry.face_width
    if not mesh.plane and _at_the_back(geometry, mesh, radius, float(z)):
        return BACK
    if not mesh.plane and z > half * (1.0 + 1e-9):
        return _region_of_the_cup(
            geometry.cup, NEAR * geometry.module, mesh, node, radius, float(z)
        )
    spline = mesh.body == FLEXIBLE_SPLINE
    inner = spline and radius < geometry.inner_radius + 0.5 * geometry.gears["flexible_spline"].rim
    if inner:
        return RIM_INSIDE
    s = mesh.arc_lengths.get(node)
    if _on_the_corner(geometry, mesh, radius, float(z), s is not None):
        return NOTCH_REGION
    if s is not None:
        return _region_of_the_flank(geometry, mesh, s, float(z), touched)
    root = mesh.profile.r_root_circle
    near = NEAR * geometry.module
    inside = UNDER_CONTACT if touched else INSIDE
    if not spline:
        gear = geometry.gears[mesh.body]
        if radius < root - near:
            return TIP if radius < mesh.profile.r_tip_circle + near else inside
        of_rim = RIM if radius > root + 0.5 * gear.rim else TOOTH_ROOT
        return OUTER if radius > gear.outer_radius - near else of_rim
    at_end = abs(z) > END * geometry.face_width and not mesh.plane
    if radius < root + near:
        return TOOTH_END if at_end else TOOTH_ROOT
    if radius > mesh.profile.r_tip_circle - near:
        return TIP
    return TOOTH_END if at_end and not touched else inside


def _at_the_back(geometry: DriveGeometry, mesh: SectorMesh, radius: float, z: float) -> bool:
    """Whether a point (mm) lies on the fillet at the back of the teeth, or close below it."""
    cup, near = geometry.cup, NEAR * geometry.module
    if mesh.body != "flexible_spline" or cup is None or cup.back_fillet == 0.0:
        return False
    wall = geometry.inner_radius + geometry.cup_thickness
    back = 0.5 * geometry.face_width
    return (
        back - near < z < back + cup.back_fillet + near
        and wall - near < radius < mesh.profile.r_root_circle + near
    )


def _on_the_corner(
    geometry: DriveGeometry, mesh: SectorMesh, radius: float, z: float, on_flank: bool
) -> bool:
    """Whether a point (mm) on the back of the teeth lies below the root, or on a flank closer to
    the corner between back and wall than elements of windows are long."""
    near = NEAR * geometry.module
    if mesh.body != "flexible_spline" or geometry.cup is None or mesh.plane:
        return False
    corner = geometry.inner_radius + (1.0 + AT_CORNER) * geometry.cup_thickness
    height = corner if on_flank else mesh.profile.r_root_circle + near
    return abs(z - 0.5 * geometry.face_width) < near and radius < height


def _region_of_the_flank(
    geometry: DriveGeometry, mesh: SectorMesh, s: float, z: float, touched: bool
) -> str:
    if abs(z) > END * geometry.face_width and not mesh.plane and not touched:
        return TOOTH_END
    if s >= mesh.profile.root_start:
        return TOOTH_ROOT
    return UNDER_CONTACT if touched else FLANK


def _region_of_the_cup(
    cup: CupGeometry, near: float, mesh: SectorMesh, node: int, radius: float, z: float
) -> str:
    """Region of a node of the wall, closed end or flange. near : mm"""
    wall = cup.wall
    r_center, z_center = wall.center
    beyond = radius - r_center if wall.outwards else r_center - radius
    on_plate = z > min(wall.faces) - near or (
        beyond > 0.0 and bool(wall.is_on_plate(np.array([radius]), np.array([z]))[0])
    )
    if on_plate and _is_attached(cup, radius):
        return ATTACHED
    if node in mesh.node_sets["bore"]:
        return "rim of the flange" if wall.outwards else "bore"
    if on_plate and beyond > BESIDE * wall.end_thickness:
        return "flange" if wall.outwards else "closed end"
    return FILLET if z > z_center - BESIDE * wall.thickness else CUP_WALL


def _is_attached(cup: CupGeometry, radius: float) -> bool:
    """Whether points at a radius (mm) of closed end or flange are clamped, or lie under bolts or
    between them, or beside that ring."""
    if cup.attached_ring is None or cup.beside_ring is None:
        return False
    (low, high), (inside, outside) = cup.attached_ring, cup.beside_ring
    return low - BESIDE * inside <= radius <= high + BESIDE * outside


def warning_of(geometry: DriveGeometry, region: str, point: np.ndarray) -> str:
    """Why a stress at a point (3,) mm of a region has no limit, or depends on the mesh; empty where
    it converges."""
    if region == CORNER:
        corners = [one for body in geometry.gears for one in sharp_corners(geometry, body)]
        nearest = min(corners, key=lambda one: float(one.distance(point[None])[0]))
        return f"beside {nearest.text}, {NO_RADIUS}"
    if region == NOTCH_REGION:
        radius = geometry.inner_radius + geometry.cup_thickness
        return f"{NOTCH} (radius {radius:.2f}, z {geometry.cup.wall.back:.2f} mm)"
    return {UNDER_CONTACT: AVERAGE, ATTACHED: CLAMPED, CAM_EDGE: EDGE}.get(region, "")
