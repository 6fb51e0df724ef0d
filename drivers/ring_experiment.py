"""Deflection of a steel ring pressed from inside by two bearings, beside the measurement (Appendix
A of the source).

Problem: a ring of 136 mm outer diameter and 4.5 mm thickness on two rigid round supports of 65 mm
diameter, each of which moves outward by a along the major axis. Measured was the inward deflection
b at 45 degrees from that axis, by a dial that travels with the movable support. Equations:
equilibrium with finite rotations and frictionless contact, in plane stress (quadrilaterals with
incompatible modes) and as a solid (hexahedra with incompatible modes). The modulus of elasticity
cancels; the width, which the source does not say, hardly matters, and neither does the supports'
radius.

Printed are, for every measured point, what a dial reads in the ways that can be meant

    moving   45 degrees, the dial travels with the movable support, by a against the ring's centre:
    as described centre   45 degrees, the dial stands still against the ring's centre: the inward
    deflection itself fixed    45 degrees, the dial stands still as the other support does; it reads
    outward, the sign is turned minor    90 degrees, against the ring's centre: half of what the
    ring's minor axis has lost

the torque that turns the ring, by internal friction (section A.9 set out to measure it), the change
by halving all elements, and a check against the closed form at a micrometre. About a minute on 2
cores.

    mpirun -n 2 python drivers/ring_experiment.py --out results/ring_experiment
"""

from __future__ import annotations

import argparse
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
from mpi4py import MPI

from plain_ring import PlainRingDesign, RingCounts, RingModel
from swgpar import log
from swgpar.geometry.cams.simplified import simplified
from swgpar.log import logger
from swgpar.materials import Isotropic
from swgpar.results.atomic import agreed, write_from_root

OUTER_DIAMETER, THICKNESS, SUPPORT_DIAMETER = 136.0, 4.5, 65.0
"""mm, sections A.3 and A.4"""

OUTWARD = np.array([0.127, 0.254, 0.381, 0.508, 0.635, 0.762, 0.813])
MEASURED = np.array([0.064, 0.127, 0.254, 0.381, 0.533, 0.737, 0.762])
"""a and b in mm, Table A.2; the dials show steps of 0.0005 inch, 0.013 mm."""

STEEL = Isotropic(E=206e3, nu=0.29)
READINGS = {
    "moving": "45°, dial moves with the support",
    "centre": "45°, dial at rest against the centre",
    "fixed": "45°, dial at rest like the other support",
    "minor": "90°, half the minor axis' loss",
}
LOSS_FACTOR = 3e-4
"""Of steel (Cremer and Heckl: 0.2 to 3 in 10 000)."""

SMALL = 1e-3
"""mm, the travel at which the closed form holds"""


def closed_form(angle: float, slenderness: float = 0.0, nu: float = 0.0) -> float:
    """Outward deflection of a ring under two opposite outward forces P, in units of P R³ / EI.

    Inextensional and without shear (slenderness 0) it is ((pi/2 - angle) cos angle + sin angle) / 4
    - 1 / pi for angles (rad) of 0 to pi/2 from the forces. In general it is a Fourier series: load
    p cos n angle makes N = p R / (n² - 1),
    |M| = N R and |Q| = n N. M + N R = 0 keeps the length of the centre line; the mean load, P / (pi
    R), stretches it.

    slenderness : thickness / R;  nu : Poisson's ratio, in the shear of a rectangular section
    """
    extension = slenderness**2 / 12.0
    shear = 1.2 * 2.0 * (1.0 + nu) * extension
    bending = 0.25 * ((0.5 * np.pi - angle) * np.cos(angle) + np.sin(angle)) - 1.0 / np.pi
    n = np.arange(2.0, 200001.0, 2.0)
    series = np.sum(n**2 / (n**2 - 1.0) ** 2 * np.cos(n * angle))
    return float(bending + 2.0 / np.pi * shear * series + extension / np.pi)


def press(
    design: PlainRingDesign,
    counts: RingCounts,
    travels: np.ndarray,
    support_diameter: float = SUPPORT_DIAMETER,
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> dict[str, np.ndarray]:
    """Readings (n,) mm at the supports' travels (n,) mm: those of `READINGS`, and `top`, outward at
    the major axis.

    `torque` (n,) N mm is that of the internal friction with a loss factor of 1.
    """
    # both supports are one curve, drawn apart by the pose: a stadium of which only the ends can
    # touch
    cam = simplified(design.inner_radius, 0.5 * support_diameter)
    model = RingModel(design, counts, cam, np.radians(20.0), comm)
    kind = "plane" if design.plane else "solid"
    rows = []
    for travel in travels:
        iterations = model.spread(float(travel))
        half = [model.dial(0.25 * np.pi, moved) for moved in (travel, 0.0, -travel)]
        rows.append(
            (
                *half[:2],
                -half[2],
                model.dial(0.5 * np.pi),
                -model.dial(0.0),
                model.hysteresis_torque(),
            )
        )
        sizes = (2 * counts.sectors, counts.radial) + (() if design.plane else (counts.axial,))
        mesh = " x ".join(map(str, sizes))
        logger.info("%s, %s elements: a = %.3f mm, %d iterations", kind, mesh, travel, iterations)
    model.destroy()
    return dict(zip((*READINGS, "top", "torque"), np.array(rows).T))


def thin_ring_torque(travel: np.ndarray, width: float) -> np.ndarray:
    """Torque (n,) N mm of a thin ring with a loss factor of 1 under two forces that move by
    `travel` (n,) mm each.

    4 P^2 R^3 / (pi E I) times the sum of n / (n^2 - 1)^2 over even n; P follows from the travel by
    `closed_form`.
    """
    radius = 0.5 * (OUTER_DIAMETER - THICKNESS)
    bending = STEEL.E * width * THICKNESS**3 / 12.0
    force = travel * bending / (closed_form(0.0) * radius**3)
    n = np.arange(2.0, 2001.0, 2.0)
    return 4.0 * force**2 * radius**3 / (np.pi * bending) * np.sum(n / (n**2 - 1.0) ** 2)


def table(computed: dict[str, dict[str, np.ndarray]], width: float) -> list[str]:
    """Lines of the tables; computed : readings in the plane and of the solid;  width : mm, of the
    ring"""
    plane, solid = computed["plane"], computed["solid"]
    lines = []
    for name, text in READINGS.items():
        lines += [
            f"{name}: {text}",
            "     a  measured b   b plane      b 3D  difference (3D - measured)   b/a",
        ]
        for k, a in enumerate(OUTWARD):
            b = solid[name][k]
            lines.append(
                f"{a:6.3f}  {MEASURED[k]:10.3f}  {plane[name][k]:8.4f}  {b:8.4f}  "
                f"{b - MEASURED[k]:10.3f} {b / a:23.3f}"
            )
        off = solid[name] - MEASURED
        rms = np.sqrt(np.mean(off**2))
        lines += [
            f"        root mean square of the difference {rms:.3f} mm, largest "
            f"{np.abs(off).max():.3f} mm",
            "",
        ]
    lines.append(f"torque (N mm) by internal friction, loss factor {LOSS_FACTOR:g}")
    lines.append("     a     plane        3D  thin ring")
    thin = thin_ring_torque(OUTWARD, width)
    for k, a in enumerate(OUTWARD):
        torques = [LOSS_FACTOR * values[k] for values in (plane["torque"], solid["torque"], thin)]
        lines.append(f"{a:6.3f}  " + "  ".join(f"{torque:8.4f}" for torque in torques))
    lines.append("")
    slope, offset = np.polyfit(OUTWARD, MEASURED, 1)
    spread = np.std(MEASURED - slope * OUTWARD - offset)
    return [
        *lines,
        "measured b/a: " + " ".join(f"{v:.3f}" for v in MEASURED / OUTWARD),
        f"line through the measured points: b = {slope:.3f} a {offset:+.3f} mm, rms deviation "
        f"{spread:.3f} mm",
    ]


def csv(computed: dict[str, dict[str, np.ndarray]]) -> bytes:
    """All readings, a row per measured point."""
    columns = {"a_mm": OUTWARD, "b_measured_mm": MEASURED}
    columns |= {
        f"{name}_{kind}_mm": computed[kind][name]
        for name in READINGS
        for kind in ("plane", "solid")
    }
    rows = [",".join(f"{v:.6g}" for v in row) for row in zip(*columns.values())]
    return ("\n".join([",".join(columns), *rows]) + "\n").encode()


def figure(computed: dict[str, dict[str, np.ndarray]]) -> bytes:
    """b against a, as a PNG."""
    from matplotlib.figure import Figure

    drawing = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = drawing.add_subplot()
    axes.plot(OUTWARD, MEASURED, "ko", label="measured (Table A.2)")
    for k, (name, text) in enumerate(READINGS.items()):
        axes.plot(OUTWARD, computed["plane"][name], f"C{k}-", label=f"{text}, plane")
        axes.plot(OUTWARD, computed["solid"][name], f"C{k}x", label=f"{text}, 3D")
    axes.set(
        xlabel="outward deflection a at the major axis (mm)", ylabel="inward deflection b (mm)"
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    file = io.BytesIO()
    drawing.savefig(file, format="png", dpi=120)
    return file.getvalue()


def checks(
    designs: dict[str, PlainRingDesign],
    counts: RingCounts,
    fine: dict[str, dict[str, np.ndarray]],
    support: float,
) -> list[str]:
    """Lines on the mesh, the closed form, the width and the supports' radius; fine : readings with
    halved elements."""
    last, lines = OUTWARD[-1:], []

    def change(text: str, new: dict[str, np.ndarray], old: dict[str, np.ndarray]) -> None:
        moves = ", ".join(f"{name} {new[name][-1] - old[name][-1]:+.5f}" for name in READINGS)
        lines.append(f"{text} changes b at a = {last[0]:g} mm by {moves} mm")

    coarse = {kind: press(design, counts, last, support) for kind, design in designs.items()}
    for kind in designs:
        change(f"{kind}: halving the elements", fine[kind], coarse[kind])
    small = press(designs["plane"], counts, np.array([SMALL]), support)
    mean = 0.5 * OUTER_DIAMETER - 0.5 * THICKNESS
    for angle, name in ((0.25 * np.pi, "centre"), (0.5 * np.pi, "minor")):
        thin = -closed_form(angle) / closed_form(0.0)
        thick = -closed_form(angle, THICKNESS / mean, STEEL.nu) / closed_form(
            0.0, THICKNESS / mean, STEEL.nu
        )
        ratio = small[name][0] / small["top"][0]
        lines.append(
            f"{name}: inward over outward at a = {SMALL:g} mm {ratio:.4f}, thin ring {thin:.4f}, "
            f"with shear {thick:.4f}"
        )
    solid = designs["solid"]
    others = {
        "half the width": (0.5, support),
        "twice the width": (2.0, support),
        "supports of 60 mm": (1.0, 60.0),
    }
    for text, (factor, diameter) in others.items():
        other = press(replace(solid, width=factor * solid.width), counts, last, diameter)
        change(f"solid: {text}", other, coarse["solid"])
    return lines


def main() -> None:
    """Compute, print and write the tables and the figure."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--out", type=Path, default=Path("results/ring_experiment"))
    options.add_argument("--width", type=float, default=10.0, help="width of the ring, mm")
    options.add_argument("--support-diameter", type=float, default=SUPPORT_DIAMETER, help="mm")
    options.add_argument(
        "--sectors", type=int, default=120, help="coarse mesh: half the elements around the ring"
    )
    options.add_argument(
        "--radial", type=int, default=2, help="coarse mesh: elements through the thickness"
    )
    options.add_argument(
        "--axial", type=int, default=2, help="coarse mesh: elements along the width of the solid"
    )
    arguments = options.parse_args()

    comm = MPI.COMM_WORLD
    with agreed(comm, arguments.out):
        if comm.rank == 0:
            arguments.out.mkdir(parents=True, exist_ok=True)
    counts = RingCounts(arguments.sectors, arguments.radial, arguments.axial)
    designs = {
        kind: PlainRingDesign(OUTER_DIAMETER, THICKNESS, arguments.width, kind == "plane", STEEL)
        for kind in ("plane", "solid")
    }
    support = arguments.support_diameter
    fine = {
        kind: press(design, counts.refined(), OUTWARD, support) for kind, design in designs.items()
    }
    lines = [*table(fine, arguments.width), *checks(designs, counts, fine, support)]
    write_from_root(comm, arguments.out / "ring_experiment.csv", csv(fine))
    write_from_root(
        comm, arguments.out / "ring_experiment.png", figure(fine) if comm.rank == 0 else b""
    )
    if comm.rank == 0:
        print("\n".join(["", *lines]))


if __name__ == "__main__":
    with log.session(MPI.COMM_WORLD):
        main()
