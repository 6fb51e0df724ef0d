"""Press fits in drives: of the ring gear in its housing, and of a bearing's outer race."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

from support.bearing import BEARING
from support.grown_ring import lame
from support.stepping import assert_agree, load_stepper, loaded, small
from swgpar.constraints.distributing_coupling import node_weights
from swgpar.evaluation.housing_values import housing_values
from swgpar.fem.body import OUTER_RACE
from swgpar.load.load_states import LoadState, Stage

HOUSING = ("ring_gear.housing.thickness=4.0", "ring_gear.housing.material={E=70e3, nu=0.33}")


def fit_tension(interference: float, *overrides: str) -> float:
    fit = f"ring_gear.housing.interference={interference}"
    stepper, row = loaded(small("plane", *HOUSING, fit, *overrides))
    stresses = {name: value for name, value in row.items() if name.startswith("housing_")}
    return housing_values(stepper.model, stresses)["fit_tension_MPa"]


def test_a_pressed_ring_gear_carries_as_a_ring_below_its_teeth() -> None:
    """Teeth carry no hoop stress: the ring of the rim alone gives the pressure, but for what the
    roots of teeth stiffen it by."""
    interference = 0.02
    design = small("plane", *HOUSING)
    steel, aluminium = design.materials["ring_gear"], design.materials["housing"]
    root, seam = design.profile("ring_gear").r_root_circle, design.geometry.gears["ring_gear"]
    seam = seam.outer_radius
    outward = lame(seam, design.geometry.outer_radius, (1.0, 0.0), aluminium, seam)[0]
    inward = lame(root, seam, (0.0, 1.0), steel, seam)[0]
    pressure = 0.5 * interference / (outward - inward)
    found = fit_tension(0.0) - fit_tension(interference)
    print(f"pressure of the fit {found:.2f} MPa, of the rim alone {pressure:.2f}")
    assert pressure < found < 1.1 * pressure


def test_a_race_pressed_into_the_spline_has_the_pressure_of_its_ring() -> None:
    """Without the balls. Lamé's equations give the race's radial displacement by the pressure."""
    interference = 0.01
    fit = f"wave_generator.bearing.race_interference={interference}"
    design = small("plane", *BEARING, fit)
    stepper = load_stepper(design)
    model = stepper.model
    state = LoadState(Stage.ENGAGE, 2, cam_clearance=1.0)  # balls are far away
    model.problem.search(state)
    assert model.solver.solve(state).converged
    pressed = model.problem.wave_generator.race.owned_pressure()
    force = float((pressed.weight * pressed.pressure).sum())
    area = 2.0 * np.pi * design.inner_radius * design.drive.face_width / design.copies
    race = model.elements.bodies[OUTER_RACE]
    mesh = race.layout.mesh
    nodes = mesh.node_sets["outer"]
    weight = node_weights(mesh.coords, nodes, mesh.ccw_nodes)
    before = race.positions()[race.owned][:, nodes, :2]
    moved = race.displacement(model.problem.displacement())[race.owned][:, nodes, :2]
    unit = before / np.linalg.norm(before, axis=-1, keepdims=True)
    inwards = -float((np.sum(moved * unit, axis=-1) @ weight / weight.sum()).mean())
    groove = design.bearing_sizes.outer_groove
    one = -lame(groove, design.inner_radius, (0.0, 1.0), design.material, design.inner_radius)[0]
    print(f"{force / area:.3f} MPa, by its displacement {inwards / one:.3f} MPa")
    assert 0.1 * interference < inwards < 0.5 * interference
    assert inwards / one == pytest.approx(force / area, rel=0.01)
    model.destroy()


@pytest.mark.parallel(2)
def test_two_ranks_give_the_same() -> None:
    names = ("fs_s1", "rg_vm", "race_vm", "housing_vm", "wg_torque_Nmm", "output_angle_deg")
    fits = ("ring_gear.housing.interference=0.02", "wave_generator.bearing.race_interference=0.01")
    _, parallel = loaded(small("plane", *BEARING, *HOUSING, *fits))
    _, alone = loaded(small("plane", *BEARING, *HOUSING, *fits), MPI.COMM_SELF)
    assert_agree(parallel, alone, names, 1e-6)
