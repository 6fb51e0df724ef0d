"""A ring on an elliptical cam, with its closed form."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from plain_ring import PlainRingDesign, RingCounts, RingModel
from swgpar.design.sections import ContactSection, Solver
from swgpar.geometry.cams import EllipticalCam
from swgpar.materials import Isotropic

INNER, THICKNESS, DEFLECTION = 58.2, 1.0, 2.0
"""mm: inner radius and rim of the reference drive's flexible spline, and its diametral
deflection."""

STEEL = Isotropic(E=210e3, nu=0.0)
"""Without lateral strain, so that a solid and plane stress have the same answer."""

HALF_ANGLE = np.radians(15.0)
FIRST = RingCounts(30, 1, 1)
"""Of level 0: sectors of two elements, elements through the thickness and along the width of 1
mm."""


def ellipse(a: float, b: float, offset: float, n: int = 7200) -> tuple[np.ndarray, np.ndarray]:
    """Curvature (n,) 1/mm and arc length (n,) mm at n points of the curve `offset` (mm) outside an
    ellipse.

    a, b : mm, semi-axes
    """
    t = 2.0 * np.pi * np.arange(n) / n
    speed = np.hypot(b * np.cos(t), a * np.sin(t))
    bend = a * b / speed**3
    return bend / (1.0 + bend * offset), speed * 2.0 * np.pi / n * (1.0 + bend * offset)


def closed_form(deflection: float = DEFLECTION) -> dict[str, float]:
    """Of the ring of the reference drive, 1 mm wide. deflection : mm, diametral"""
    a, b = INNER + 0.5 * deflection, INNER - 0.5 * deflection
    return tight_ring(a, b, INNER, THICKNESS, STEEL.E)


def tight_ring(a: float, b: float, r: float, t: float, young: float) -> dict[str, float]:
    """Largest tensile stress (MPa) and integrated contact pressure (N) of a ring of 1 mm width on
    an elliptical cam.

    a, b : mm, semi-axes of the cam;  r, t : mm, inner radius and thickness of the ring

    The inner surface lies on the ellipse, sections stay plane and normal to it. A fibre at the
    distance y from it, of length (r + y) dphi, becomes (1 + k y) ds: its strain is s' (1 + k y) /
    (r + y) - 1 with s' = ds / dphi. The energy E / 2 (s'^2 A2 - 2 s' A1 + A0) per angle, with A2 =
    int (1 + k y)^2 / (r + y) dy, A1 = int (1 + k y) dy and A0 = int (r + y) dy, has no explicit
    phi; s' dw/ds' - w is therefore constant: s'^2 A2 = C^2, where 2 pi C = oint sqrt(A2) ds. The
    contact force is the derivative of the energy pi E C^2 - E oint A1 ds + ... with respect to the
    cam's normal growth. Shear is left out: (t / R)^2 of the bending. The fit is tight: the ring
    touches all round.
    """

    def second(k: np.ndarray) -> np.ndarray:
        inner = (1.0 - k * r) ** 2 * np.log((r + t) / r) + 2.0 * k * (1.0 - k * r) * t
        return inner + 0.5 * k**2 * ((r + t) ** 2 - r**2)

    def constant(offset: float) -> float:
        k, ds = ellipse(a, b, offset)
        return float((np.sqrt(second(k)) * ds).sum() / (2.0 * np.pi))

    def energy(offset: float) -> float:
        k, ds = ellipse(a, b, offset)
        return float(young * (np.pi * constant(offset) ** 2 - ((t + 0.5 * k * t**2) * ds).sum()))

    k = ellipse(a, b, 0.0)[0]
    stretch, step = constant(0.0) / np.sqrt(second(k)), 1e-3
    # bending outside at the major axis; inside at the minor one where stretch governs
    fibres = stretch / r, stretch * (1.0 + k * t) / (r + t)
    return {
        "s1": young * float(np.max(fibres) - 1.0),
        "contact force": (energy(step) - energy(-step)) / (2.0 * step),
    }


def ring_on_cam(
    level: int, plane: bool, incompatible: bool, quadrature: int, linear: str, comm: MPI.Comm
) -> tuple[int, dict[str, float]]:
    """Unknowns of the modelled half, and largest tensile stress and contact force of the ring on
    the cam.

    quadrature : Gauss points per direction on a face;  linear : "direct" or "iterative"
    """
    k = 2**level
    outer = INNER + THICKNESS
    design = PlainRingDesign(
        2.0 * outer,
        THICKNESS,
        1.0,
        plane,
        STEEL,
        ContactSection(wg_quadrature=quadrature),
        Solver(linear=linear),
    )
    counts = RingCounts(k * FIRST.sectors, k * FIRST.radial, FIRST.axial)
    cam = EllipticalCam(INNER + 0.5 * DEFLECTION, INNER - 0.5 * DEFLECTION)
    model = RingModel(design, counts, cam, HALF_ANGLE, comm, incompatible=incompatible)
    model.mount()
    unknowns = model.ring.partition.dims * (
        model.ring.partition.n_global - len(model.ring.partition.multiplier_nodes)
    )
    values = {"s1": model.stresses()["s1"], "contact force": model.contact_force()}
    model.destroy()
    return unknowns, values
