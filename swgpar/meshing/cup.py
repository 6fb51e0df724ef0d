"""The cup's slice of one tooth sector: the lower rim continued over cylinder and closed end to the bore."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.arrays import Floats, Ints
from swgpar.meshing.cross_section import CrossSection
from swgpar.meshing.recipe import CupRecipe
from swgpar.meshing.sweep import symmetric_steps


def meridian(design: DriveDesign, recipe: CupRecipe) -> tuple[Floats, Floats]:
    """Return the inner and the outer line of the cup in the meridian plane.

    Returns
    -------
    inner, outer : (n_station, 2) float64, mm
        Points (r, z) of the inner and outer surface, from the back of the teeth to the bore.

    The sizes of the cup are those of a checked design (`swgpar.design.fit_checks`).
    """
    cup, thickness = design.cup, design.cup_thickness
    back = 0.5 * design.drive.face_width
    # centre of the fillet's arcs
    r_centre = design.inner_radius + thickness - cup.fillet_radius
    z_centre = back + cup.length - cup.fillet_radius
    z = back + (z_centre - back) * symmetric_steps(recipe.cylinder, recipe.end_ratio)
    angle = np.linspace(0.0, 0.5 * np.pi, recipe.fillet + 1)[1:]
    r = r_centre - (r_centre - cup.inner_radius) * symmetric_steps(recipe.closed_end, recipe.end_ratio)[1:]
    lines = []
    for offset in (0.0, thickness):
        cylinder = np.stack((np.full_like(z, design.inner_radius + offset), z), axis=-1)
        radius = cup.fillet_radius - thickness + offset
        fillet = np.stack((r_centre + radius * np.cos(angle), z_centre + radius * np.sin(angle)), axis=-1)
        end = np.stack((r, np.full_like(r, back + cup.length - thickness + offset)), axis=-1)
        lines.append(np.concatenate((cylinder, fillet, end)))
    return lines[0], lines[1]


def attached_quads(section: CrossSection, root_too: bool) -> NDArray[np.bool_]:
    """Return the mask (n_quad,) of the quadrilaterals of the cross-section that the cup continues."""
    return section.rim_layer | section.root_layer if root_too else section.rim_layer


def depth_fractions(section: CrossSection, attached: NDArray[np.bool_], r_inner: float, thickness: float) -> Floats:
    """Return the fraction (n_node,) of the wall at the attached nodes: 0 at the inner, 1 at the outer surface.

    Where the layers below the root are attached, their top follows the root and the teeth; the fraction then
    counts layers instead of radius, and the cup's outer surface is level from its first station on.
    """
    nodes = np.unique(section.quads[attached])
    fraction = np.zeros(len(section.coords))
    fraction[nodes] = (np.hypot(*section.coords[nodes].T) - r_inner) / thickness
    extra = attached & section.root_layer
    if extra.any():
        layer = np.where(section.below_root, 0, -1)
        quads = section.quads[extra]
        # away from the interface circle, one layer at a time: a quadrilateral with exactly two numbered nodes
        # carries the next layer on its other two
        while np.any(layer[quads] < 0):
            edge = layer[quads]
            ready = np.count_nonzero(edge >= 0, axis=1) == 2
            ready &= np.all((edge < 0) | (edge == edge.max(axis=1, keepdims=True)), axis=1)
            following = quads[ready][edge[ready] < 0]
            layer[following] = edge[ready].max() + 1
        interface = fraction[nodes][layer[nodes] == 0].max()
        upper = nodes[layer[nodes] > 0]
        fraction[upper] = interface + (1.0 - interface) * layer[upper] / layer.max()
    return fraction


def cup_nodes(
    design: DriveDesign, recipe: CupRecipe, section: CrossSection, attached: NDArray[np.bool_]
) -> tuple[Floats, Ints]:
    """Return the nodes of the cup beyond the back of the teeth.

    Returns
    -------
    coords : (n_station - 1, n_column, 3) float64, mm
    columns : (n_column,) int32
        Nodes of the cross-section that are continued.
    """
    inner, outer = meridian(design, recipe)
    columns = np.unique(section.quads[attached]).astype(np.int32)
    fraction = depth_fractions(section, attached, design.inner_radius, design.cup_thickness)[columns]
    angle = np.arctan2(*section.coords[columns].T)
    rz = inner[1:, None] + fraction[None, :, None] * (outer - inner)[1:, None]
    coords = np.stack((rz[..., 0] * np.sin(angle), rz[..., 0] * np.cos(angle), rz[..., 1]), axis=-1)
    return coords, columns
