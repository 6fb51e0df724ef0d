"""What the elements of a flank lack in compliance: it is that of a far finer mesh, for any place of
a strip in an element, and small far from it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from support.contact_blocks import Block, Surface, arc_block
from support.element_mesh import ElementMesh
from support.hertz import SIZE, STEEL, WIDTH, flank_line, graded
from support.paths import DRIVERS
from swgpar import load_design
from swgpar.contact.missing_compliance import PATCH, MissingCompliance
from swgpar.fem.body import Body
from swgpar.meshing import build_sector_meshes, load_recipe
from swgpar.model.layouts import build_gear

STRIP = 0.1
"""mm, width of the loaded strip."""

FLAT = Surface((0.0, 0.0), -SIZE, -1)


def skewed(block: Block, slope: float) -> Block:
    """The block whose columns leave the flank at a slant; its outline stays."""
    x, y = block.points[:, 0], block.points[:, 1]
    points = block.points.copy()
    points[:, 0] += slope * y * (1.0 - y / SIZE) * (1.0 - (x / SIZE) ** 2)
    return replace(block, points=points)


def missing_compliance(block: Block) -> MissingCompliance:
    (grid,) = block.mesh.flanks
    return MissingCompliance(
        block.mesh, grid, Body(block.mesh, (block.material,), 1.0).in_plane_elasticity
    )


def among(missing: MissingCompliance, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """D (n, n) mm / (N/mm) of the cells of one line."""
    out = np.zeros(len(low) ** 2)
    missing.add(np.array([0, len(low)]), low, high, out)
    return out.reshape(len(low), -1)


def facet_cells(missing: MissingCompliance, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Ends (n,) mm of equal cells on all facets."""
    ends = np.linspace(missing.s[:-1], missing.s[1:], count + 1, axis=1)
    return ends[:, :-1].ravel(), ends[:, 1:].ravel()


def of_elements(block: Block, low: float, high: float) -> float:
    """Mean displacement (mm) of a strip on the flank under 1 N/mm, of elements alone."""
    weight, width = np.zeros(len(block.s)), high - low
    for k, (a, b) in enumerate(zip(block.s, block.s[1:])):
        left, right = max(a, low), min(b, high)
        if right > left:
            share = (0.5 * (left + right) - a) / (b - a)
            weight[k : k + 2] += (right - left) / width * np.array([1.0 - share, share])
    fixed = np.zeros(block.points.shape, dtype=bool)
    fixed[:, 2] = True
    fixed[np.abs(block.points[:, 1] - SIZE) < 1e-9] = True
    load = np.zeros_like(block.points)
    load[block.nodes, 1] = 0.5 * weight[:, None]
    u = np.zeros_like(load)
    free = np.flatnonzero(~fixed.ravel())
    stiffness = ElementMesh(block.points, block.hexes, block.material).tangent(u)
    u.ravel()[free] = spsolve(stiffness.tocsc()[free][:, free], load.ravel()[free])
    return float(weight @ u[block.nodes[:, 0], 1])


@cache
def exact() -> float:
    """That of a strip in the middle, by elements of a tenth of its width."""
    half = graded(0.1 * STRIP, STRIP, SIZE, 1.15)
    line = np.concatenate([-half[:0:-1], half])
    block = arc_block(line, half, WIDTH, FLAT, STEEL)
    return of_elements(block, SIZE - 0.5 * STRIP, SIZE + 0.5 * STRIP)


@pytest.mark.parametrize("element", [0.25, 0.8, 3.0])
@pytest.mark.parametrize("place", [0.0, 0.25, 0.5])
@pytest.mark.parametrize("slope", [0.0, 0.3, -0.6])
def test_approach_of_a_narrow_strip(element: float, place: float, slope: float) -> None:
    """Within 1 % of that of a far finer block; the elements alone yield 14 to 60 % less.

    0.4 of the 0.6 % are the compliance that keeps D positive. Columns at 31 degrees reach 1.03 %:
    the half plane knows nothing of the elements' slant beyond the patch.
    """
    line = flank_line(element)
    step = line[1] - line[0]
    depth = graded(step, 8.0 * step, SIZE, 1.15)
    block = skewed(arc_block(line, depth, WIDTH, FLAT, STEEL), slope)
    at = block.s[len(line) // 2] + place * step
    if place == 0.0:
        at += 0.5 * STRIP  # cells end at nodes
    low, high = at - 0.5 * STRIP, at + 0.5 * STRIP
    lacks = among(missing_compliance(block), np.array([low]), np.array([high]))[0, 0]
    found = of_elements(block, low, high)
    print(f"element {element}, place {place}, slope {slope}: {found / exact():.4f} of elements, ")
    print(f"   with what they lack {(found + lacks) / exact():.4f}")
    assert found < 0.95 * exact()
    assert found + lacks == pytest.approx(exact(), rel=0.01 if abs(slope) < 0.5 else 0.012)


@pytest.mark.parametrize("slope", [0.0, 0.3])
@pytest.mark.parametrize("count", [4, 16])
def test_symmetric_positive_and_of_short_range(slope: float, count: int) -> None:
    line = flank_line(2.0)
    block = skewed(arc_block(line, graded(2.0, 16.0, SIZE, 1.15), WIDTH, FLAT, STEEL), slope)
    missing = missing_compliance(block)
    low, high = facet_cells(missing, count)
    d = among(missing, low, high)
    assert np.abs(d - d.T).max() < 1e-12 * np.abs(d).max()
    values = np.linalg.eigvalsh(d)
    assert values[0] > 1e-3 * values[-1]
    # the surface between nodes is straight, which falls with the square of the distance
    facet = np.repeat(np.arange(len(line) - 1), count)
    apart = np.abs(facet[:, None] - facet)
    own, far = (np.abs(d[apart == k]).max() for k in (0, PATCH + 2))
    assert far < 0.01 * own
    assert np.abs(d[apart > 2 * PATCH]).max() < 0.005 * own


def test_uniform_pressure_lacks_little() -> None:
    """Elements show the compliance under a uniform pressure themselves: what is left is less than a
    tenth of that of one element, and positive."""
    line = flank_line(2.0)
    missing = missing_compliance(arc_block(line, graded(2.0, 16.0, SIZE, 1.15), WIDTH, FLAT, STEEL))
    low, high = facet_cells(missing, 8)
    lacks = among(missing, low, high) @ (high - low)
    of_element = (line[1] - line[0]) * (1.0 - STEEL.poisson**2) / STEEL.modulus
    print(lacks.min() / of_element, lacks.max() / of_element)
    assert 0.0 < lacks.min() and lacks.max() < 0.1 * of_element


@pytest.mark.parametrize("recipe", ["coarse", "forces"])
def test_columns_below_a_turned_tip_run_inwards(recipe: str) -> None:
    """A tip arc of 0.1 modules is turned away from its tooth: the elements below one of its facets
    lie beside it."""
    design = load_design(DRIVERS / "wave_generators" / "twin_deflection.toml")
    mesh = build_sector_meshes(design.geometry, load_recipe(recipe))["flexible_spline"]
    body = build_gear(mesh, design.materials, design.drive.face_width)
    for grid in mesh.flanks:
        missing = MissingCompliance(mesh, grid, body.in_plane_elasticity)
        assert np.isfinite(missing.green).all()
        assert np.linalg.eigvalsh(missing.green).max() > 0.0
