"""Natural frequencies against closed forms of rings and cylinders, and against the stiffness of the
drive."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

import swgpar
from plain_ring import PlainRingDesign, RingBody, RingCounts
from support.paths import DESIGN, RECIPE
from swgpar.evaluation.frequencies import LumpedMass, modes_of
from swgpar.load.load_states import LoadState, Stage
from swgpar.materials import Isotropic

pytest.importorskip("slepc4py")

STEEL = Isotropic(E=210e3, nu=0.3, density=7850.0)
RADIUS, THICKNESS = 50.0, 1.0
"""Of the middle surface, mm."""

ORDERS = np.array([2, 3])


def frequencies(width: float, plane: bool, counts: RingCounts, number: int) -> np.ndarray:
    """Lowest frequencies (Hz) of a free ring."""
    design = PlainRingDesign(2.0 * RADIUS + THICKNESS, THICKNESS, width, plane, STEEL)
    solver = RingBody(design, counts, MPI.COMM_SELF, copies=1).solver()
    state = LoadState(Stage.LOAD, 3, cam_clearance=0.0)
    solver.problem.search(state)
    mass = LumpedMass(solver.problem)
    modes = modes_of(solver, state, number, mass)
    return modes.frequency / (2.0 * np.pi)


def inextensional(n: np.ndarray, stiffness: float) -> np.ndarray:
    """Frequencies (Hz) of bending without stretch, n waves: n (n² - 1) / sqrt(n² + 1) sqrt(EI /
    (m R⁴)) / (2 pi), with EI and the mass m per width (Love, Mathematical Theory of Elasticity,
    293 and 334)."""
    mass = 1e-12 * STEEL.density * THICKNESS
    factor = np.sqrt(stiffness * THICKNESS**3 / 12.0 / (mass * RADIUS**4))
    return n * (n**2 - 1) / np.sqrt(n**2 + 1) * factor / (2.0 * np.pi)


def test_a_free_ring_in_plane_stress() -> None:
    found = frequencies(2.0, True, RingCounts(80, 4, 1), 4)
    exact = inextensional(ORDERS, STEEL.E)
    # each mode twice; thin-ring theory leaves out shares of (h / R)²
    assert found[::2] == pytest.approx(found[1::2], rel=1e-6)
    assert found[::2] == pytest.approx(exact, rel=1.5e-3)


def test_a_free_cylinder() -> None:
    """Rayleigh's and Love's modes of a cylinder without stretch, as long as its diameter."""
    found = frequencies(2.0 * RADIUS, False, RingCounts(40, 2, 20), 4)
    rayleigh = inextensional(np.array(2), STEEL.E / (1.0 - STEEL.nu**2))
    # one end moves against the other
    growth = 1.0 + 6.0 * (1.0 - STEEL.nu) / 4.0
    love = rayleigh * np.sqrt(growth / (1.0 + 3.0 / (4.0 * 5.0)))
    # the free ends contract, which Rayleigh leaves out: 0.15 % of error by the mesh, 0.4 % by that
    assert found[0] == pytest.approx(rayleigh, rel=6e-3)
    assert found[2] == pytest.approx(love, rel=6e-3)


LOADED = (
    "steps.rotation=0",
    "material.density=7850.0",
    "frequencies.number=2",
    "output.figures=false",
)


@pytest.mark.parametrize("attachment", ["edge", "clamped"])
def test_a_heavy_output_moves_on_the_stiffness_of_the_drive(attachment: str) -> None:
    """f = sqrt(K / J) / (2 pi), with the stiffness K by a small change of the torque."""
    held = [f"cup.attachment={attachment}"]
    held += ["cup.clamping_radius=10"] if attachment == "clamped" else []
    inertia = 0.1  # kg m², a hundred thousand times that of the flexible spline
    rotations = []
    for torque in (1.99, 2.01):
        overrides = [*held, "steps.rotation=0", f"load.torque={torque}", "solver.rtol=1e-10"]
        design = swgpar.load_design(DESIGN, [*overrides, "solver.far_teeth=modelled"])
        rotations.append(swgpar.run(design, RECIPE).history["output_angle_deg"][-1])
    stiffness = 0.02 / abs(np.radians(rotations[1] - rotations[0]))
    heavy = [*held, *LOADED, f"frequencies.output_inertia={inertia}", "solver.rtol=1e-10"]
    result = swgpar.run(swgpar.load_design(DESIGN, heavy), RECIPE)
    mode = result.summary.frequencies.modes[0]
    assert mode.energy["output"] > 0.999
    assert mode.frequency == pytest.approx(np.sqrt(stiffness / inertia) / (2.0 * np.pi), rel=5e-3)
