"""Elements at the limits of shape and material: few draws of what `scripts/bench/stability` does
with many."""

from __future__ import annotations

import pytest

from support.element_limits import AMOUNTS, POISSON, bending, patch

both_elements = pytest.mark.parametrize("dims", [2, 3])


@both_elements
@pytest.mark.parametrize("amount", AMOUNTS)
def test_distorted_patch(dims: int, amount: float) -> None:
    """Up to the limit, where an element is inside out at a Gauss point and is refused, constant
    stress is exact."""
    for seed in range(3):
        found = patch(dims, amount, seed)
        assert found.refused == (not found.quality["min_jacobian"] > 0.0)
        # the strain of 1e-8 leaves eight digits of a position's sixteen
        assert found.patch < 1e-6
        assert found.rotation < 1e-13


@both_elements
@pytest.mark.parametrize("stretch", [1.0, 30.0, 1000.0])
def test_aspect_ratio(dims: int, stretch: float) -> None:
    """Errors are those of the last digit of the positions, which counts `stretch` times across the
    elements."""
    found = patch(dims, 0.25, 0, stretch)
    assert found.quality["max_aspect_ratio"] >= stretch
    assert found.patch < 1e-7 * max(stretch, 10.0)
    assert found.rotation < 1e-14 * max(stretch, 10.0)
    # bending of elements longer than deep loses the ratio's fourth power to round-off, of deeper
    # ones nothing
    assert abs(bending(dims, 1.0 / stretch, 0.3) - 1.0) < 1e-5


@both_elements
@pytest.mark.parametrize("poisson", POISSON)
def test_poisson(dims: int, poisson: float) -> None:
    """No locking: regular elements bend exactly with any ratio."""
    assert (
        patch(dims, 0.25, 0, 1.0, poisson).patch < 1e-4
    )  # 1 / (1 - 2 nu) = 500 times the round-off
    assert abs(bending(dims, 10.0, poisson) - 1.0) < 1e-5
