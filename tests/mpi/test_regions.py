"""Largest stresses of the regions: the same on any number of ranks."""

from __future__ import annotations

from functools import lru_cache

import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from support.stepping import WORLD, loaded, small
from swgpar.largest_stress.places import OF_REGION, Place, find_places


@lru_cache
def regions(model: str, *, alone: bool = False) -> dict[str, Place]:
    """Of the loaded small drive. alone : every rank computes the whole drive"""
    stepper, _ = loaded(small(model), MPI.COMM_SELF if alone else WORLD)
    found = find_places(stepper.model, stepper.load_state, stepper.model.stresses()[1])
    return {name: place for name, place in found.items() if OF_REGION in name}


@pytest.mark.parametrize("model", ["plane", "cup"])
@pytest.mark.parallel([2, 3])
def test_any_number_of_ranks_gives_the_same(model: str) -> None:
    found, alone = regions(model), regions(model, alone=True)
    parallel_assert(list(found) == list(alone) and len(found) > 10)
    for name, place in found.items():
        parallel_assert(place.value == pytest.approx(alone[name].value, rel=1e-3, abs=1e-3), name)
        parallel_assert(place.region == alone[name].region, name)
    in_cup = {name.split(OF_REGION)[1] for name in found} & {"cup wall", "fillet", "bore"}
    parallel_assert(len(in_cup) == (3 if model == "cup" else 0))
