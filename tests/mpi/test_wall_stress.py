"""The wall behind the teeth by rings and slices: the truth within the error, on any number of
ranks, in drives unlike the reference."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

import swgpar
from support.cup_shapes import CLAMPED, HAT, HAT_CLAMPED, Changes, bolted, cone, shaped
from support.paths import RECIPE
from support.stepping import WORLD, loaded
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.fem.stress import principal
from swgpar.largest_stress import wall_stress
from swgpar.largest_stress.places import OF_REGION, find_places
from swgpar.largest_stress.wall_stress import (
    RINGS,
    CoarseWall,
    WallStress,
    resolve_wall,
    ring_stresses,
)
from swgpar.largest_stress.window_recipes import LEVELS
from swgpar.meshing.wall_sector import WallCounts
from swgpar.model.regions import sector_regions

SHARP: Changes = {"fillet_radius": 1.0, "end_thickness": 0.6, "length": 8.0}
HUB: Changes = SHARP | {
    "end_contour": [
        {"radius": 12.0, "thickness": 0.3, "rounding": 0.3},
        {"radius": 11.0, "thickness": 1.2, "rounding": 0.3},
    ],
    "attachment": "clamped",
    "clamping_radius": 9.0,
}
"""Bends most where a thin closed end becomes a hub."""

FILLETS: dict[str, Changes] = {
    "cup": SHARP,
    "clamped hat": HAT_CLAMPED | SHARP,
    "hub": HUB | {"fillet_radius": 1.5, "length": 10.0},
    "cone": cone(60.0, rounding=0.3) | CLAMPED,
}
"""Walls that bend most in a sharp fillet, or in roundings of their contours. The mesh of the drive
has one element there."""

REGIONS = {"hub": "closed end", "cone": "cup wall"}
"""Where they bend most, but for the fillet."""

BOLTED: Changes = bolted(8) | SHARP | {"bolt_circle": 26.0}
"""Eight bolts close to the fillet, around which the closed end bends most."""

CASES = FILLETS | {"bolts": BOLTED}
cases = pytest.mark.parametrize("case", list(FILLETS))


@lru_cache
def drive(case: str, *, alone: bool = False) -> LoadStepper:
    return loaded(shaped(CASES[case]), MPI.COMM_SELF if alone else WORLD)[0]


def resolved(stepper: LoadStepper) -> WallStress:
    # the same drive as the coarser one: only the least error by its mesh
    coarse = CoarseWall(ring_stresses(stepper.model, stepper.load_state), 1.5)
    return resolve_wall(stepper.model, stepper.load_state, 0.0, coarse)


@pytest.mark.parallel([2, 3])
@pytest.mark.parametrize("case", ["clamped hat", "hub"])
def test_any_number_of_ranks_gives_the_same(case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    coarse = tuple(WallCounts(6 + k, 3, 0.7) for k in range(3))
    monkeypatch.setattr(wall_stress, "SLICES", coarse)
    found, alone = resolved(drive(case)), resolved(drive(case, alone=True))
    parallel_assert(list(found.places) == list(alone.places) and len(found.levels) > 1)
    for name, place in found.places.items():
        # Newton's tolerance of the windows
        parallel_assert(place.value == pytest.approx(alone.places[name].value, rel=1e-3), name)


@cases
def test_a_finer_whole_ring_is_within_the_error(case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nodal averages of the drive are far from it, in the wrong region even, but in the cone."""
    stepper = drive(case)
    model, state = stepper.model, stepper.load_state
    found = resolved(stepper)
    ring = wall_stress._solved_ring(model, state, WallCounts(16, 8)).problem
    regions = sector_regions(model.geometry, ring.layout.mesh)[False]
    region = REGIONS.get(case, "fillet")
    s1, _, mises = principal(ring.stress()[:, regions == region])
    ring.destroy()
    nodal = find_places(model, state, model.stresses()[1])
    for stress, truth in (("fs_s1", s1.max()), ("fs_vm", mises.max())):
        name = f"{stress}{OF_REGION}{region}"
        place, average = found.places[name], nodal[name].value
        print(f"{name}: {place.value:.1f} ± {place.error:.1f}, {truth:.1f}, nodal {average:.1f}")
        assert abs(place.value - truth) < place.error < 0.25 * truth
        assert case == "cone" or average < 0.8 * truth
        assert len(found.levels[name]) == len(wall_stress.SLICES)


def test_stress_beside_bolts_is_within_the_error() -> None:
    """Of a finer ring with more elements from bolt to bolt. It lies in line with a bolt."""
    stepper = drive("bolts")
    model, state = stepper.model, stepper.load_state
    found, closed_end = resolved(stepper), f"{OF_REGION}closed end"
    ring = wall_stress._solved_ring(model, state, WallCounts(12, 6, around=2.0)).problem
    truth = wall_stress._largest(ring, wall_stress._regions_of_ring(ring))
    ring.destroy()
    for stress in ("fs_s1", "fs_vm"):
        place, finer = found.places[f"{stress}{closed_end}"], truth[f"{stress}{closed_end}"].value
        print(f"{stress}: {place.value:.1f} ± {place.error:.1f}, {finer:.1f} on a finer ring")
        assert abs(place.value - finer) < place.error < 0.15 * finer
        assert len(found.levels[f"{stress}{closed_end}"]) == len(wall_stress.SLICES)
        # eight bolts on 40 teeth, the first one on +y
        assert place.tooth % 5 == 0


def test_a_run_takes_the_largest_stress_from_the_wall(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("rainflow")
    monkeypatch.setitem(LEVELS, "cup", 2)  # windows at the roots are not looked at
    sampled = ("steps.samples=2", "steps.rotation=9", "fatigue.size_factor=1.0")
    overrides = ("output.root_stress=true", *sampled)
    result = swgpar.run(shaped(HAT | SHARP, *overrides), RECIPE)
    places, regions = result.summary.stresses.places, result.summary.stresses.regions
    largest, fillet = places["fs_s1"], regions[f"fs_s1{OF_REGION}fillet"]
    assert largest.value == max(p.value for name, p in regions.items() if name[:5] == "fs_s1")
    assert largest.on_mesh == pytest.approx(np.max(result.history["fs_s1"]))
    factor = result.summary.fatigue.factors["fillet"]
    assert factor == pytest.approx(fillet.value / fillet.on_mesh) and factor > 1.1
    assert result.summary["largest.fs_s1"].value == largest.value
    assert fillet.value > 1.1 * fillet.on_mesh and fillet.error is None  # no coarser drive


def test_the_coarsest_ring_is_what_drives_are_compared_by() -> None:
    stepper = drive("cup")
    model, state = stepper.model, stepper.load_state
    on_ring = ring_stresses(model, state)
    assert on_ring == pytest.approx(resolve_wall(model, state).on_ring, rel=1e-9)
    coarse = CoarseWall({name: 0.9 * value for name, value in on_ring.items()}, 2.0)
    found, least = (resolve_wall(model, state, 0.0, one).places for one in (coarse, None))
    for name, place in found.items():
        assert least[name].error is None and place.value == pytest.approx(least[name].value)
        assert place.error > place.value * 0.1 / 3.0  # of second order
    assert len(RINGS) == 2
