"""Smooth and toothed rings on ellipses that are longer than their bore, beside a published study of
a toothed spline on its cam: the tables of docs/verification/stretch.md."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from mpi4py import MPI
from page import markdown, put
from scipy.optimize import brentq

from plain_ring import PlainRingDesign, RingCounts, RingModel, RingSectors
from support.cam_ring import HALF_ANGLE, ellipse, tight_ring
from swgpar.geometry.cams import EllipticalCam
from swgpar.materials import Isotropic
from swgpar.meshing.drive_geometry import DriveGeometry, GearGeometry
from swgpar.meshing.recipe import MeshRecipe, ToothRecipe
from swgpar.meshing.sector import SectorMesh
from swgpar.meshing.tooth_sector import build_sector
from swgpar.profiles import make_profile
from swgpar.profiles.keys import Trapezoid
from swgpar.profiles.teeth import Teeth

PAGE = Path("docs/verification/stretch.md")
STEEL = Isotropic(E=200e3, nu=0.3)
BORE = 0.5 * 78.575
"""mm, radius; with the axes of the cam (diameters, mm) the base case of the study."""

AXES = (79.1724, 78.0114)
RATIOS = (1.005, 1.015, 1.025)
PUBLISHED = {
    0.4: (0.0176, 0.0176, 0.0354),
    0.6: (0.0089, 0.0261, 0.0439),
    0.8: (0.0177, 0.0354, 0.0528),
}
"""Largest stress over E of the study by thickness, mm, for the three perimeter ratios."""

RADIUS, MIDDLE = 38.7, 0.6
"""mm: radius to which the study refers its lengths, and the thickness that has it as its bore."""

DIFFERENCE = 0.03 * RADIUS
"""mm, of the cam's axes (diameters), of the largest deflection."""

COUNTS = RingCounts(240, 4, 1)

SECTORS = 318
"""Teeth of the toothed ring: one more than in the study, so that a half or a third of it is
modelled."""

MODULE, ADDENDUM, DEDENDUM = 0.25, 1.0, 1.25
"""mm; over the module. The study does not state the heights of its teeth."""

ROOT_RADII = (0.3, 0.1)
"""Of the root arcs, over the module."""

STRETCH = 0.005
"""Of the bore of toothed rings without deflection."""


@dataclass(frozen=True)
class ToothedRing:
    """Trapezoidal teeth on a ring of the thickness `rim`, mm, with root arcs of `root_radius`
    modules."""

    rim: float
    root_radius: float

    def mesh(self, design: PlainRingDesign) -> SectorMesh:
        """Sector of one tooth; the root circle is the outer one of `design`."""
        flank_angle = np.radians(20.0)
        module = design.outer_radius / (0.5 * SECTORS - DEDENDUM)
        heights = ADDENDUM * module, DEDENDUM * module
        teeth = Teeth(SECTORS, module, flank_angle, *heights, external=True)
        keys = Trapezoid(type="trapezoid", flank_angle=20.0, r_root=self.root_radius * module)
        gear = GearGeometry(make_profile(keys, teeth), self.rim, (-0.5, 0.5))
        counts = ToothRecipe(
            tip=2, layers=3, layer_ratio=1.5, flank=8, root=12, under=6, under_ratio=4.0, rim=2
        )
        geometry = DriveGeometry(
            model="plane",
            gears={"flexible_spline": gear},
            module=module,
            face_width=design.width,
            cam_width=design.width,
            inner_radius=design.inner_radius,
            cup=None,
            housing=0.0,
        )
        recipe = MeshRecipe(flexible_spline=counts, ring_gear=counts)
        return build_sector(geometry, recipe, "flexible_spline")


def largest_tension(
    cam: EllipticalCam, bore: float, thickness: float, sectors: RingSectors, copies: int = 2
) -> float:
    """Largest tension of a ring on a cam, over E.

    bore, thickness : mm, radius, and without teeth
    copies : parts of the ring that are alike, one of which is modelled
    """
    design = PlainRingDesign(2.0 * (bore + thickness), thickness, 1.0, True, STEEL)
    model = RingModel(design, sectors, cam, HALF_ANGLE, MPI.COMM_SELF, copies)
    model.mount()
    found = model.stresses()["s1"]
    model.destroy()
    return found / STEEL.E


def ellipse_of(length: float, difference: float) -> EllipticalCam:
    """Ellipse with the perimeter of a circle of the radius `length`, mm, whose axes (diameters)
    differ by `difference`, mm."""
    half = 0.25 * difference

    def excess(mean: float) -> float:
        return float(ellipse(mean + half, mean - half, 0.0)[1].sum() / (2.0 * np.pi) - length)

    mean = brentq(excess, 0.9 * length, 1.1 * length, xtol=1e-12)
    return EllipticalCam(mean + half, mean - half)


def base_case() -> str:
    """The base case for each of the three thicknesses, in MPa."""
    rows = [["thickness, mm", "closed form, MPa", "elements, MPa", "with teeth, MPa", "ratio"]]
    a, b = 0.5 * AXES[0], 0.5 * AXES[1]
    for thickness in PUBLISHED:
        exact = tight_ring(a, b, BORE, thickness, STEEL.E)["s1"]
        ring = EllipticalCam(a, b), BORE, thickness
        toothed = ToothedRing(thickness, ROOT_RADII[0])
        smooth, found = (STEEL.E * largest_tension(*ring, one) for one in (COUNTS, toothed))
        values = (exact, smooth, found)
        cells = [f"{value:.1f}" for value in values]
        rows.append([f"{thickness:g}", *cells, f"{found / exact:.2f}"])
    return markdown(rows)


def all_cases() -> str:
    """The nine published values beside smooth rings whose bore is smaller where they are thicker,
    on the same cams."""
    head = ["thickness, mm", "perimeters", "stretch of the bore", "elements", "closed form"]
    rows = [[*head, "published, toothed", "published over stretch"]]
    for (thickness, published), (k, ratio) in product(PUBLISHED.items(), enumerate(RATIOS)):
        bore = RADIUS + MIDDLE - thickness
        stretch = ratio * RADIUS / bore - 1.0
        cells = [f"{thickness:g}", f"{ratio:g}", f"{stretch:.4f}"]
        if stretch > 0.0:
            cam = ellipse_of(ratio * RADIUS, DIFFERENCE)
            exact = tight_ring(cam.a, cam.b, bore, thickness, STEEL.E)["s1"] / STEEL.E
            found = largest_tension(cam, bore, thickness, COUNTS)
            cells += [f"{found:.4f}", f"{exact:.4f}", f"{published[k]:.4f}"]
            cells += [f"{published[k] / stretch:.2f}"]
        else:
            cells += ["loose", "loose", f"{published[k]:.4f}", ""]
        rows.append(cells)
    return markdown(rows)


def notch_factors() -> str:
    """Largest tension of toothed rings that are stretched without deflection, over E and the
    stretch."""
    rows = [["thickness, mm", *(f"root arcs of {radius:g} modules" for radius in ROOT_RADII)]]
    for thickness in PUBLISHED:
        bore, cells = RADIUS + MIDDLE - thickness, []
        for radius in ROOT_RADII:
            cam = ellipse_of((1.0 + STRETCH) * bore, 0.0)
            found = largest_tension(cam, bore, thickness, ToothedRing(thickness, radius), copies=3)
            cells.append(f"{found / STRETCH:.2f}")
        rows.append([f"{thickness:g}", *cells])
    return markdown(rows)


def main() -> None:
    put(PAGE, "base_case", base_case())
    put(PAGE, "all_cases", all_cases())
    put(PAGE, "notch_factors", notch_factors())


if __name__ == "__main__":
    main()
