"""Errors of pressures, forces and shares of the flanks by a coarser mesh and by the increments."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import pytest

from swgpar.analysis.contact_errors import (
    LAW,
    LEAST_PRESSURE,
    LEAST_PRESSURE_OF_SHORT,
    LEAST_PRESSURE_WITH_EDGES,
    contact_errors,
)
from swgpar.analysis.drive_mesh_error import (
    LEAST_FORCE,
    LEAST_FORCE_WITH_EDGES,
    ORDER,
    SAFETY,
    CoarserMesh,
    shown_error,
)
from swgpar.evaluation.contact_error_shares import (
    MISSED,
    UNKNOWN,
    ContactErrorShares,
    error_of_largest,
)
from swgpar.flank_pressure.pair_contact import PairContact
from swgpar.meshing import load_recipe
from swgpar.meshing.recipe_counts import RATIO, body_ratio, coarsened, contact_ratio

FINE = load_recipe("plane_fine")
COARSE = coarsened(FINE)
FACTOR = SAFETY / (RATIO**ORDER - 1.0)
"""Error over a change between two meshes."""


def pair(tooth: int, pressure: float, *, force: float = 100.0, edge: int = 0) -> PairContact:
    return PairContact(
        tooth=tooth,
        flank="clockwise",
        ring_tooth=tooth,
        angle_deg=0.0,
        force_N=force,
        force_share=0.25,
        torque_Nmm=0.0,
        pressure_MPa=pressure,
        edge=edge,
    )


def errors(coarse: Sequence[PairContact], fine: Sequence[PairContact]) -> ContactErrorShares:
    """Of the pairs on the coarser mesh and on the mesh itself."""
    return contact_errors(CoarserMesh(COARSE, {}, coarse), FINE, fine, lobes=2)


def test_the_change_from_the_coarser_mesh_shows_the_error() -> None:
    found = errors([pair(1, 500.0, force=90.0)], [pair(1, 540.0)])
    assert found.pressure == pytest.approx(math.hypot(FACTOR * 40.0 / 540.0, LAW))
    assert found.force == pytest.approx(FACTOR * 10.0 / 100.0)


def test_a_share_has_the_errors_of_the_force_and_of_all_forces() -> None:
    """Here it does not change at all, by chance: one pair has all of both."""
    found = errors([pair(1, 500.0, force=90.0)], [pair(1, 500.0)])
    assert found.force_share == pytest.approx(math.sqrt(2.0) * FACTOR * 10.0 / 100.0)
    beside = [pair(1, 500.0), pair(2, 400.0, force=50.0)]
    assert errors(beside, beside).force_share == LEAST_FORCE["plane"]


def test_a_pressure_has_half_of_the_error_of_forces() -> None:
    """It goes with the root of the force, also where it is the same on all meshes by chance."""
    found = errors([pair(1, 520.0, force=90.0)], [pair(1, 520.0, force=110.0)])
    assert found.force == pytest.approx(FACTOR * 20.0 / 110.0)
    assert found.pressure == pytest.approx(math.hypot(0.5 * found.force, LAW))


def test_the_pair_with_the_largest_value_is_compared_as_well() -> None:
    """Where another pair has the largest one on a coarser mesh, the two largest can be equal."""
    found = errors([pair(1, 500.0), pair(2, 600.0)], [pair(1, 600.0)])
    assert found.pressure == pytest.approx(math.hypot(FACTOR * 100.0 / 600.0, LAW))
    # a pair that one mesh does not have
    found = errors([pair(2, 580.0)], [pair(1, 600.0)])
    assert found.pressure == pytest.approx(math.hypot(FACTOR * 20.0 / 600.0, LAW))


def test_pairs_on_edges_do_not_count_among_those_off_edges() -> None:
    edge, fine = pair(2, 900.0, edge=1), [pair(1, 600.0), pair(2, 1500.0, edge=1)]
    found = errors([pair(1, 560.0), edge], fine)
    assert found.pressure_off_edges == pytest.approx(math.hypot(FACTOR * 40.0 / 600.0, LAW))
    assert found.pressure == pytest.approx(math.hypot(FACTOR * 600.0 / 1500.0, LAW))
    assert errors([edge], [edge]).pressure_off_edges is None


def test_in_space_one_mesh_with_fewer_elements_in_all_directions_shows_the_errors() -> None:
    cup = load_recipe("forces")
    coarse = coarsened(cup)
    ratio = contact_ratio(coarse, cup)
    assert ratio == RATIO > body_ratio(coarse, cup)  # flanks and face width decide
    found = contact_errors(CoarserMesh(coarse, {}, [pair(1, 500.0)]), cup, [pair(1, 600.0)], 2)
    assert found.pressure == pytest.approx(100.0 / 600.0 / (ratio**2 - 1.0))
    assert found.force == LEAST_FORCE["cup"]
    same = contact_errors(CoarserMesh(coarse, {}, [pair(1, 600.0)]), cup, [pair(1, 600.0)], 2)
    assert same.pressure == LEAST_PRESSURE
    # a pressure goes with the root of the force, also where it is the same by chance
    before, after = [pair(1, 600.0, force=90.0)], [pair(1, 600.0, force=100.0)]
    found = contact_errors(CoarserMesh(coarse, {}, before), cup, after, 2)
    assert found.force == pytest.approx(SAFETY * 0.1 / (ratio**2 - 1.0))
    assert found.pressure == pytest.approx(0.5 * found.force)


def test_without_a_coarser_mesh_nothing_is_known() -> None:
    assert contact_errors(None, FINE, [pair(1, 600.0)], 2) == UNKNOWN
    # a pressure that could not be computed
    unknown = [pair(1, math.nan)]
    assert errors(unknown, unknown).pressure is None


def test_the_force_of_a_pair_that_carries_alone_has_no_estimate() -> None:
    """It follows from the torque, until another pair touches."""
    alone = [replace(pair(1, 600.0), force_share=0.5)]
    found = errors(alone, alone)
    assert found.force is found.force_share is None
    assert found.pressure == pytest.approx(math.hypot(0.5 * LEAST_FORCE["plane"], LAW))


def test_every_other_increment_shows_what_lies_between() -> None:
    rows = [{"increment": k, "p": p} for k, p in ((1, 400.0), (2, 500.0), (3, 450.0))]

    def largest(some: Sequence[dict[str, float]]) -> float:
        return max((row["p"] for row in some), default=0.0)

    assert error_of_largest(rows, largest, 0.02) == pytest.approx(0.02 * 500.0 + MISSED * 50.0)
    assert error_of_largest(rows[:1], largest, 0.02) == pytest.approx(0.02 * 400.0)
    assert error_of_largest(rows, largest, None) is None


def test_only_counts_that_differ_decide() -> None:
    """A change between meshes of the same counts has no ratio."""
    assert shown_error(COARSE, FINE, -1.5) == pytest.approx(1.5 * FACTOR)
    with pytest.raises(ValueError, match="empty"):
        shown_error(FINE, FINE, 1.0)


def test_a_pair_that_carries_little_beside_edges_has_no_estimate() -> None:
    """Nearly all of the load is on edges: what remains for the other changes with the mesh."""
    for force, known in ((29.0, False), (31.0, True)):
        pairs = [pair(1, 60.0, force=force), pair(2, 900.0, edge=1)]
        assert (errors(pairs, pairs).pressure_off_edges is not None) == known


def test_forces_are_less_certain_where_a_contact_lies_on_an_edge() -> None:
    fine = [pair(1, 600.0), pair(2, 900.0, edge=1)]
    assert errors(fine, fine).force == LEAST_FORCE_WITH_EDGES > LEAST_FORCE["plane"]


def test_pressures_of_cups_are_less_certain_beside_an_edge() -> None:
    cup = load_recipe("forces")
    pairs = [pair(1, 600.0), pair(2, 900.0, edge=1)]
    found = contact_errors(CoarserMesh(coarsened(cup), {}, pairs), cup, pairs, 2)
    assert found.pressure_off_edges == LEAST_PRESSURE_WITH_EDGES > LEAST_PRESSURE


def test_pressures_of_cups_are_less_certain_where_the_contact_is_nearly_a_point() -> None:
    """The contact with the largest pressure decides."""
    cup = load_recipe("forces")
    slender = replace(pair(1, 600.0), width_mm=1.0, half_width_mm=0.05)
    short = replace(pair(2, 500.0), width_mm=0.8, half_width_mm=0.05)

    def share(*pairs: PairContact) -> float | None:
        return contact_errors(CoarserMesh(coarsened(cup), {}, pairs), cup, pairs, 2).pressure

    assert share(slender, short) == LEAST_PRESSURE
    assert share(slender, replace(short, pressure_MPa=700.0)) == LEAST_PRESSURE_OF_SHORT
    assert share(slender, replace(short, pressure_MPa=700.0, width_mm=0.91)) == LEAST_PRESSURE


def test_a_peak_as_narrow_as_the_cells_has_an_error_of_its_own() -> None:
    """The pair with the largest pressure counts, with and without edges; forces are as before."""
    same = [pair(0, 100.0), pair(1, 50.0)]
    peaked = [replace(same[0], unresolved=0.2), same[1]]
    assert errors(same, peaked).pressure == pytest.approx(0.2)
    assert errors(same, peaked).pressure_off_edges == pytest.approx(0.2)
    assert errors(same, peaked).force == errors(same, same).force
    beside = [same[0], replace(same[1], unresolved=0.2)]
    assert errors(same, beside) == errors(same, same)
    assert "unresolved" not in peaked[0].row()
