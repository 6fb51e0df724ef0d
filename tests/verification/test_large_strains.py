"""Both elements at strains of 1 to 10 %, against exact solutions of the law that is linear in
stretches, and that law against others with the same E and nu."""

from __future__ import annotations

import pytest

from support.large_strains import (
    LAWS,
    PlaneLaw,
    bent_beam,
    biot,
    least_stiffness,
    pressed_ring,
    stretched_bar,
)
from swgpar.checks.strain_checks import LARGEST_STRAIN, LAW_SPREAD

both_elements = pytest.mark.parametrize("plane", [True, False], ids=["plane", "solid"])
strains = pytest.mark.parametrize("strain", [0.01, 0.05, LARGEST_STRAIN])


@both_elements
@pytest.mark.parametrize("strain", [-LARGEST_STRAIN, 0.02, LARGEST_STRAIN])
def test_bar(strain: float, plane: bool) -> None:
    exact = PlaneLaw(biot, 0.48).uniaxial(strain)
    assert stretched_bar(strain, 0.48, plane) == pytest.approx(exact, rel=1e-9)


@both_elements
@strains
def test_bending_to_an_arc(strain: float, plane: bool) -> None:
    """An element has one rotation: within it that of the beam differs by up to the strain over the
    number of elements of its depth, a strain of half its square."""
    moment, fibre = PlaneLaw(biot, 0.3).bending(2.0 * strain)
    found = bent_beam(strain, 0.3, 4, plane)
    assert found[0] == pytest.approx(moment, rel=0.2 * strain**2 + 2e-5)
    assert found[1] == pytest.approx(fibre, rel=0.1 * strain)


@both_elements
@strains
def test_ring_on_a_mandrel(strain: float, plane: bool) -> None:
    exact = PlaneLaw(biot, 0.48).expansion(10.0, 11.0, strain)
    # the chords of 64 elements around a quarter, and four elements over the depth
    assert pressed_ring(strain, 0.48, 4, plane) == pytest.approx(exact, rel=2e-4)


@both_elements
def test_elements_are_stable(plane: bool) -> None:
    """Three times beyond the limit, in compression too."""
    for strain in (-3.0 * LARGEST_STRAIN, 3.0 * LARGEST_STRAIN):
        assert least_stiffness(strain, 0.48, plane) > 0.3


@pytest.mark.parametrize("poisson", [0.3, 0.48])
@pytest.mark.parametrize("strain", [-0.05, 0.01, 0.05])
def test_the_stated_spread_is_that_of_the_laws(strain: float, poisson: float) -> None:
    """To the first order in the strain; the second adds a tenth at 5 %."""
    linear = PlaneLaw(biot, poisson).uniaxial(strain)
    apart = [abs(PlaneLaw(law, poisson).uniaxial(strain) / linear - 1.0) for law in LAWS.values()]
    assert max(apart) == pytest.approx(LAW_SPREAD * abs(strain), rel=1.5 * abs(strain) + 0.01)
    assert min(apart) > 0.3 * LAW_SPREAD * abs(strain)
