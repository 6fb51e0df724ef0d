"""A smooth ring on ellipses that are longer than its bore, by elements and in closed form, beside a
published study of a toothed spline on its cam: the tables of docs/verification/stretch.md."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
from mpi4py import MPI
from page import markdown, put
from scipy.optimize import brentq

from plain_ring import PlainRingDesign, RingCounts, RingModel
from support.cam_ring import HALF_ANGLE, ellipse, tight_ring
from swgpar.geometry.cams import EllipticalCam
from swgpar.materials import Isotropic

PAGE = Path("docs/verification/stretch.md")
STEEL = Isotropic(E=200e3, nu=0.3)
BORE = 0.5 * 78.575
"""mm, radius; with the axes of the cam (diameters, mm) the base case of the study."""

AXES = (79.1724, 78.0114)
RATIOS = (1.005, 1.015, 1.025)
DEFLECTIONS = (0.0075, 0.015, 0.030)
PUBLISHED = {
    0.0103: (0.0176, 0.0176, 0.0354),
    0.0155: (0.0089, 0.0261, 0.0439),
    0.0207: (0.0177, 0.0354, 0.0528),
}
"""Largest stress over E of the study by thickness over radius, for the three perimeter ratios."""

COUNTS = RingCounts(240, 4, 1)


def stresses(a: float, b: float, thickness: float) -> tuple[float, float]:
    """Largest tension over E, by elements and in closed form.

    a, b : mm, semi-axes;  thickness : mm
    """
    design = PlainRingDesign(2.0 * (BORE + thickness), thickness, 1.0, True, STEEL)
    model = RingModel(design, COUNTS, EllipticalCam(a, b), HALF_ANGLE, MPI.COMM_SELF)
    model.mount()
    found = model.stresses()["s1"]
    model.destroy()
    return found / STEEL.E, tight_ring(a, b, BORE, thickness, STEEL.E)["s1"] / STEEL.E


def axes(ratio: float, deflection: float) -> tuple[float, float]:
    """Semi-axes (mm) of an ellipse whose perimeter is `ratio` times that of the bore, and whose
    semi-axes differ by twice `deflection` times the bore's radius."""
    half = deflection * BORE

    def excess(mean: float) -> float:
        length = ellipse(mean + half, mean - half, 0.0)[1].sum()
        return float(length / (2.0 * np.pi * BORE) - ratio)

    mean = brentq(excess, 0.9 * BORE, 1.2 * BORE, xtol=1e-12)
    return mean + half, mean - half


def base_case() -> str:
    """The base case for each of the three thicknesses, in MPa."""
    rows = [["thickness / radius", "elements, MPa", "closed form, MPa"]]
    for ratio in PUBLISHED:
        found = stresses(0.5 * AXES[0], 0.5 * AXES[1], ratio * BORE)
        rows.append([f"{ratio:g}", *(f"{value * STEEL.E:.1f}" for value in found)])
    return markdown(rows)


def all_cases() -> str:
    """The 27 cases beside the published values."""
    head = ["thickness / radius", "perimeters"]
    head += [f"e/R {value:g}: elements, closed form" for value in DEFLECTIONS]
    rows = [[*head, "published, toothed"]]
    for (thickness, published), (k, ratio) in product(PUBLISHED.items(), enumerate(RATIOS)):
        cells = []
        for deflection in DEFLECTIONS:
            found, exact = stresses(*axes(ratio, deflection), thickness * BORE)
            cells.append(f"{found:.4f}, {exact:.4f}")
        rows.append([f"{thickness:g}", f"{ratio:g}", *cells, f"{published[k]:.4f}"])
    return markdown(rows)


def main() -> None:
    put(PAGE, "base_case", base_case())
    put(PAGE, "all_cases", all_cases())


if __name__ == "__main__":
    main()
