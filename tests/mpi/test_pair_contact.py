"""Contact of the pairs under load: Hertz where the flanks are arcs, equilibrium, the same on any number of ranks."""

from __future__ import annotations

from dataclasses import asdict
from functools import lru_cache

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from support.stepping import WORLD, Row, loaded, small
from swgpar.analysis.pair_contact import PairContact, pair_contacts
from swgpar.contact.line_contact import effective_modulus


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
                value == b[name] if isinstance(value, (int, str)) else np.isclose(value, b[name], rtol=rel, atol=1e-6)
            )
            parallel_assert(bool(same), f"{name}: {value} and {b[name]}")


@pytest.mark.parallel(1)
def test_the_forces_carry_the_torque() -> None:
    """Tangential force at the contact; normals lie within 8 degrees of the pressure angle of 20 degrees."""
    found, row = contacts("plane")
    torque = 2.0 * sum(one.force_N * np.cos(np.radians(20.0)) * (one.radius_mm + 1.0) for one in found)
    assert torque == pytest.approx(abs(row["tooth_torque_Nmm"]), rel=0.06)


@pytest.mark.parallel(1)
def test_an_arc_on_a_straight_flank_has_the_pressure_of_hertz() -> None:
    """The upper arc of 1 mm of the flexible spline lies on the straight part of the ring gear's flank."""
    (one,) = contacts("plane")[0]
    load, modulus = one.line_load_Nmm, effective_modulus(210e3, 0.29, plane_stress=True)
    assert one.pressure_MPa == pytest.approx(np.sqrt(load * modulus / (np.pi * 1.0)), rel=2e-3)
    assert one.half_width_mm == pytest.approx(np.sqrt(4.0 * load * 1.0 / (np.pi * modulus)), rel=0.01)
    assert not one.edge
