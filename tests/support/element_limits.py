"""Both elements under bad shapes and materials: what is exact on any mesh has to stay exact.

On a distorted patch the constant strains and a rigid rotation are exact; on regular elements of any
aspect ratio and with any Poisson's ratio a beam in pure bending is. An element that is inside out
at a Gauss point is refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from support.contact_blocks import block
from support.element_mesh import ElementMesh
from swgpar.materials import Isotropic
from swgpar.meshing.quality import element_quality

YOUNG, STRAIN = 210e3, 1e-8
"""MPa; strain of the patch, so small that the terms of second order stay below the errors that are
looked for."""


@dataclass(frozen=True)
class Patch:
    """A patch of 3 x 3 (x 3) elements whose inner nodes have moved.

    refused : whether the kernel refuses it;  quality : as in `swgpar.meshing.quality`
    patch : largest error of a constant stress over that stress;  rotation : stress by a rigid
    rotation over E
    """

    refused: bool
    quality: dict[str, float]
    patch: float = 0.0
    rotation: float = 0.0


def patch(dims: int, amount: float, seed: int, stretch: float = 1.0, poisson: float = 0.3) -> Patch:
    """Errors of a random patch.

    dims : 2 or 3;  amount : largest way of the inner nodes per direction, in elements;  stretch :
    of the whole, along y
    """
    rng = np.random.default_rng(seed)
    points, elements, inner = distorted_grid(dims, amount, rng)
    points[:, 1] *= stretch
    quality = element_quality(points, elements)
    try:
        mesh = ElementMesh(points, elements, Isotropic(E=YOUNG, nu=poisson))
    except ValueError:
        return Patch(True, quality)
    turn = Rotation.from_rotvec(
        rng.uniform(0.3, 3.0) * (rng.normal(size=3) if dims == 3 else np.array([0, 0, 1.0]))
    )
    rotation = np.abs(mesh.stress(points @ turn.as_matrix().T - points)).max() / YOUNG
    return Patch(False, quality, _constant(mesh, inner, poisson), float(rotation))


def distorted_grid(
    dims: int, amount: float, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, elements, and which points are inner ones; these are moved by up to `amount` elements
    per direction."""
    points, elements = _grid(dims, 3)
    inner = np.all((points[:, :dims] > 1e-9) & (points[:, :dims] < 3.0 - 1e-9), axis=1)
    points[inner, :dims] += rng.uniform(-amount, amount, (inner.sum(), dims))
    return points, elements, inner


def _grid(dims: int, n: int) -> tuple[np.ndarray, np.ndarray]:
    ends = np.linspace(0.0, n, n + 1)
    points, hexes, _ = block(ends, ends, ends if dims == 3 else np.array([0.0, 1.0]))
    return (points, hexes) if dims == 3 else flat(points, hexes)


def flat(points: np.ndarray, hexes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The lower faces of one layer of hexahedra."""
    quads, number = np.unique(hexes[:, :4], return_inverse=True)
    return points[quads], number.reshape(-1, 4)


def _constant(mesh: ElementMesh, inner: np.ndarray, poisson: float) -> float:
    """Largest error of the stress, over all constant strains; displacement prescribed at the outer
    nodes."""
    worst, dims = 0.0, 3 if mesh.m == 8 else 2
    fixed = np.repeat(~inner[:, None], 3, axis=1)
    for i, j in combinations_with_replacement(range(dims), 2):
        strain = np.zeros((3, 3))
        strain[i, j] = strain[j, i] = STRAIN
        if dims == 3:
            volume = poisson / (1.0 - 2.0 * poisson) * np.trace(strain)
            stress = YOUNG / (1.0 + poisson) * (strain + volume * np.eye(3))
        else:
            plane = np.diag([1.0, 1.0, 0.0])
            stress = (
                YOUNG
                / (1.0 - poisson**2)
                * ((1.0 - poisson) * strain + poisson * np.trace(strain) * plane)
            )
        exact = mesh.points @ strain
        u = mesh.solve(fixed, exact, np.zeros_like(exact), iterations=2)
        wanted = stress[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
        worst = max(worst, float(np.abs(mesh.stress(u) - wanted).max() / np.abs(wanted).max()))
    return worst


def bending(dims: int, ratio: float, poisson: float) -> float:
    """Tip deflection over that of beam theory: one row of six regular elements, `ratio` times
    longer than deep.

    Statically supported, so that the section may contract; in space it may curve across as well.
    """
    length = 6.0 * ratio
    ends = np.array([-0.5, 0.5])
    points, hexes, _ = block(np.linspace(0.0, length, 7), ends, ends)
    points, elements = (points, hexes) if dims == 3 else flat(points, hexes)
    mesh = ElementMesh(points, elements, Isotropic(E=YOUNG, nu=poisson))
    root, tip = points[:, 0] < 1e-9, points[:, 0] > length * (1.0 - 1e-9)
    fixed = np.zeros(points.shape, dtype=bool)
    fixed[root, 0] = fixed[root & (points[:, 1] < 0.0), 1] = True
    fixed[np.flatnonzero(root)[0], 2] = True
    load, moment = np.zeros_like(points), 1e-9 * YOUNG / ratio**2
    # forces of a stress that is linear in y
    load[tip, 0] = -2.0 * moment * np.sign(points[tip, 1]) / tip.sum()
    u = mesh.solve(fixed, np.zeros_like(points), load)
    exact = moment * length**2 / (2.0 * YOUNG / 12.0)
    return float(u[tip, 1].mean() / exact)


AMOUNTS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8)
RATIOS = (1.0, 10.0, 100.0, 1000.0)
POISSON = (0.0, 0.3, 0.45, 0.49, 0.499)


def element_rows(draws: int = 50) -> list[dict[str, Any]]:
    """Rows of the table of `scripts/bench/stability`: the error, as drift, of both elements under
    bad shapes."""
    rows = []

    def add(case: str, error: float, text: str = "") -> None:
        rows.append(
            {
                "group": "elements",
                "case": case,
                "status": "converged",
                "drift": error,
                "reason": text,
            }
        )

    for dims, name in ((2, "quadrilaterals"), (3, "hexahedra")):
        for amount in AMOUNTS:
            drawn = [patch(dims, amount, seed) for seed in range(draws)]
            kept = [p for p in drawn if not p.refused]
            text = f"{len(drawn) - len(kept)} of {len(drawn)} patches refused"
            text += (
                f"; smallest scaled Jacobian "
                f"{min(p.quality['min_scaled_jacobian'] for p in kept):.2f}"
            )
            add(
                f"{name}, nodes moved by {amount:g} elements, patch test",
                max(p.patch for p in kept),
                text,
            )
            add(
                f"{name}, nodes moved by {amount:g} elements, rotation",
                max(p.rotation for p in kept),
            )
        for ratio in RATIOS:
            drawn = [patch(dims, 0.25, seed, ratio) for seed in range(draws)]
            text = f"aspect ratios to {max(p.quality['max_aspect_ratio'] for p in drawn):.0f}"
            add(f"{name}, stretched by {ratio:g}, patch test", max(p.patch for p in drawn), text)
            add(f"{name}, stretched by {ratio:g}, rotation", max(p.rotation for p in drawn))
            for side, value in (("long", ratio), ("deep", 1.0 / ratio)):
                add(
                    f"{name}, {ratio:g} times as {side}, bending",
                    abs(bending(dims, value, 0.3) - 1.0),
                )
        for poisson in POISSON:
            drawn = [patch(dims, 0.25, seed, 1.0, poisson) for seed in range(draws)]
            add(f"{name}, Poisson's ratio {poisson:g}, patch test", max(p.patch for p in drawn))
            add(
                f"{name}, Poisson's ratio {poisson:g}, bending",
                abs(bending(dims, 10.0, poisson) - 1.0),
            )
    return rows
