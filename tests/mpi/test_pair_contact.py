"""Contact of the pairs under load: Hertz where the flanks are arcs, equilibrium, the same on any
number of ranks."""

from __future__ import annotations

from dataclasses import asdict
from functools import lru_cache

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from support.stepping import WORLD, Row, loaded, rotate, small
from swgpar.fem.body import RING_GEAR
from swgpar.flank_pressure.pair_contact import PairContact, moved_teeth, pair_contacts
from swgpar.materials import Isotropic, contact_modulus

CLOCKWISE = "clockwise"


@lru_cache
def contacts(model: str, *, alone: bool = False) -> tuple[list[PairContact], Row]:
    """Contacts of the loaded small drive. alone : every rank computes the whole drive"""
    stepper, row = loaded(small(model), MPI.COMM_SELF if alone else WORLD)
    return pair_contacts(stepper.model, stepper.load_state), row


@pytest.mark.parametrize("model", ["plane", "cup"])
@pytest.mark.parallel([1, 2, 3])
def test_any_number_of_ranks_gives_the_same(model: str) -> None:
    found, alone = contacts(model)[0], contacts(model, alone=True)[0]
    parallel_assert(len(found) == len(alone) > 0)
    for one, other in zip(found, alone):
        a, b = asdict(one), asdict(other)
        parallel_assert(len(a.pop("stations")) == len(b["stations"]) > 0)
        for name, value in a.items():
            # the contact ends between two strips of a grid that depends on round-off
            rel = 2e-2 if name == "half_width_mm" else 1e-3
            same = (
                value == b[name]
                if isinstance(value, (int, str))
                else np.isclose(value, b[name], rtol=rel, atol=1e-6)
            )
            parallel_assert(bool(same), f"{name}: {value} and {b[name]}")


@pytest.mark.parametrize("layout", ["ring_fixed", "spline_fixed"])
@pytest.mark.parametrize("model", ["plane", "cup"])
@pytest.mark.parallel([1, 2])
def test_the_torques_of_the_pairs_make_the_output_torque(model: str, layout: str) -> None:
    """With the ring gear fixed, its torque is that of output and wave generator together."""
    design = small(model, f"drive.layout={layout}")
    stepper, row = loaded(design)
    found = pair_contacts(stepper.model, stepper.load_state)
    on_ring_gear = stepper.model.copies * sum(one.torque_Nmm for one in found)
    expected = row["output_torque_Nmm"]
    if layout == "ring_fixed":
        expected = -(expected + row["wg_torque_Nmm"])
    parallel_assert(on_ring_gear == pytest.approx(expected, rel=1e-6))
    parallel_assert(
        abs(row["output_torque_Nmm"]) == pytest.approx(1000.0 * design.load.torque, rel=1e-12)
    )
    parallel_assert(
        stepper.model.copies * sum(one.force_share for one in found)
        == pytest.approx(1.0, rel=1e-12)
    )
    parallel_assert(stepper.model.copies * len(found) == row["pairs_in_contact"])


@pytest.mark.parallel(1)
def test_the_forces_carry_the_torque() -> None:
    """Tangential force at the contact; normals lie within 8 degrees of the pressure angle of 20
    degrees."""
    found, row = contacts("plane")
    torque = 2.0 * sum(
        one.force_N * np.cos(np.radians(20.0)) * (one.radius_mm + 1.0) for one in found
    )
    assert torque == pytest.approx(abs(row["tooth_torque_Nmm"]), rel=0.06)


@pytest.mark.parallel(1)
def test_an_arc_on_a_straight_flank_has_the_pressure_of_hertz() -> None:
    """The upper arc of 1 mm of the flexible spline lies on the straight part of the ring gear's
    flank."""
    (one,) = contacts("plane")[0]
    load, modulus = (
        one.line_load_Nmm,
        contact_modulus(*[Isotropic(E=210e3, nu=0.29)] * 2, plane_stress=True),
    )
    # the facet turns by 0.7 rad and has a joint of the profile inside, where the polynomial of its
    # heights smooths the curvature: the pressure is 2.0 % low and the half width 2.3 %
    assert one.pressure_MPa == pytest.approx(np.sqrt(load * modulus / (np.pi * 1.0)), rel=0.025)
    assert one.half_width_mm == pytest.approx(
        np.sqrt(4.0 * load * 1.0 / (np.pi * modulus)), rel=0.025
    )
    assert not one.edge
    # finer cells carry the force of those in equilibrium
    assert one.line_load_Nmm * one.width_mm == pytest.approx(one.force_N, rel=1e-4)


@pytest.mark.parametrize("layout", ["ring_fixed", "spline_fixed"])
@pytest.mark.parallel(1)
def test_sliding_is_the_motion_between_two_angles(layout: str) -> None:
    """Positions of both flanks at the contact, half a degree before and after the loaded state, at
    1 rad/s."""
    design = small("plane", f"drive.layout={layout}", f"load.input_speed={30.0 / np.pi}")
    stepper, _ = loaded(design)
    (one,) = pair_contacts(stepper.model, stepper.load_state)
    half = np.radians(0.5)
    s, flat = np.array([[one.stations[0].s_mm]]), np.zeros(1)
    places = []
    for angle in (-half, half):
        rotate(stepper, angle)
        pairs = [
            p
            for p in stepper.problem.flanks_of(RING_GEAR).pairs
            if (p.sector, p.side > 0) == (one.tooth, one.flank == CLOCKWISE)
        ]
        ((_, tooth, _),), ((_, facing, _),) = moved_teeth(
            stepper.model, pairs, stepper.problem.flanks_of(RING_GEAR)
        )
        places.append((tooth.sections(flat), facing.sections(flat)))
    (tooth, facing), (tooth_after, facing_after) = places
    foot = 0.5 * sum(ring.distance(flank.from_profile(s))[1] for flank, ring in places)
    low, high = tooth.from_profile(s + np.array([[-1e-3], [1e-3]]))[:, 0]
    moved = tooth_after.from_profile(s) - tooth.from_profile(s)
    ring_moved = facing_after.from_profile(foot) - facing.from_profile(foot)
    sliding = (moved - ring_moved)[0, 0] @ (high - low) / np.linalg.norm(high - low)
    assert one.sliding_mm_s == pytest.approx(sliding / (2.0 * half), rel=0.05)
