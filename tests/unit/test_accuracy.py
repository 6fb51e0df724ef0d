"""What an accuracy asked for changes in design and recipe."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import pytest
from mpi4py import MPI

from support.paths import DESIGN, DRIVERS, REFERENCE
from support.small_drive import PLANE
from swgpar.analysis.coarse_start import LoadedState
from swgpar.analysis.mesh_refinement import (
    GROUPS,
    LARGEST,
    RTOL,
    Doublings,
    Refinement,
    error_after,
    refine,
    with_accuracy,
)
from swgpar.design.design_file import load_design
from swgpar.errors import InputError
from swgpar.meshing import load_recipe
from swgpar.meshing.recipe import to_toml
from swgpar.meshing.recipe_counts import coarser, doubled


def test_groups_hold_every_count_once_and_no_grading() -> None:
    recipe = load_recipe("full")
    finer = recipe
    for counts in GROUPS.values():
        finer = doubled(finer, counts)
    for title, section in recipe.model_dump(exclude_none=True).items():
        for name, value in section.items():
            expected = 2 * value if isinstance(value, int) else value
            assert getattr(getattr(finer, title), name) == expected, (title, name)
    notch = doubled(recipe, GROUPS["root and rim"], 3)
    assert notch.flexible_spline.root == 8 * recipe.flexible_spline.root and notch.ring_gear == recipe.ring_gear


def test_a_chosen_recipe_can_be_read_again(tmp_path: Path) -> None:
    for name in ("full", "plane"):
        recipe = load_recipe(name)
        (tmp_path / "recipe.toml").write_text(to_toml(recipe))
        assert load_recipe(tmp_path / "recipe.toml") == recipe


def test_what_the_design_says_itself_is_kept() -> None:
    design = with_accuracy(load_design(DESIGN, [*PLANE, "steps.rotation=9"]), 0.01)
    assert design.steps.samples == 8 and design.solver.rtol == RTOL
    own = [*PLANE, "steps.rotation=9", "steps.samples=3", "solver.rtol=1e-8"]
    design = with_accuracy(load_design(DESIGN, own), 0.01)
    assert design.steps.samples == 3 and design.solver.rtol == 1e-8
    # less than a period
    assert with_accuracy(load_design(DESIGN, [*PLANE, "steps.rotation=4"]), 0.01).steps.samples == 0


def test_sectors_are_condensed_where_that_leaves_out_little() -> None:
    plane = DRIVERS / "plane_half_turn.toml"
    assert with_accuracy(load_design(plane), 0.02).solver.condensed_sectors
    assert not with_accuracy(load_design(plane), 0.005).solver.condensed_sectors
    assert not with_accuracy(load_design(plane, ["solver.condensed_sectors=false"]), 0.02).solver.condensed_sectors
    assert not with_accuracy(load_design(DESIGN, PLANE), 0.2).solver.condensed_sectors
    assert not with_accuracy(load_design(plane.with_name("cup_45deg.toml")), 0.1).solver.condensed_sectors


def test_accuracies_that_cannot_be_had() -> None:
    design = load_design(DESIGN, PLANE)
    for accuracy in (0.0, 0.5, float("nan")):
        with pytest.raises(InputError, match="out of range: allowed 0.001 to 0.2"):
            with_accuracy(design, accuracy)
    with pytest.raises(InputError, match="--accuracy needs contact.friction = 0, not 0.1"):
        with_accuracy(load_design(DESIGN, [*PLANE, "contact.friction=0.1"]), 0.01)


class Analytic:
    """Stands in for `Refinement`: s1 = 300 MPa less errors of the first order; b takes more elements than a."""

    ERRORS, EVERY, FINEST, LEFT_OUT = (60.0, -3.0), 300.0, 10**9, 0.0

    def __init__(self) -> None:
        self.groups, self.doublings, self.levels, self.largest = ("a", "b"), (0, 0), {}, self.FINEST
        self.loads, self.omitted_stress = [], defaultdict(lambda: self.LEFT_OUT)

    def size(self, doublings: Doublings) -> int:
        size = 1000 * 2 ** doublings[0] * 8 ** doublings[1]
        return size if size <= self.largest else 0

    def stress(self, doublings: Doublings) -> float:
        return self.EVERY - sum(error / 2**count for error, count in zip(self.ERRORS, doublings))

    def load(self, doublings: Doublings) -> LoadedState:
        assert self.size(doublings)
        self.doublings, self.levels[doublings] = (
            doublings,
            LoadedState(self.size(doublings), {"fs_s1": self.stress(doublings), "fs_s3": 0.0}),
        )
        self.loads.append(doublings)
        return self.levels[doublings]


@pytest.mark.parametrize(("asked", "doublings"), [(0.2, (1, 0)), (0.05, (3, 0)), (0.02, (5, 0)), (0.01, (7, 1))])
def test_the_group_is_refined_that_has_the_larger_error_for_its_elements(asked: float, doublings: Doublings) -> None:
    """Errors of the first order are found exactly; those of both groups add up, whatever their signs."""
    levels = Analytic()
    found, error, stresses = refine(levels, asked)
    assert found == levels.doublings == doublings
    assert len(levels.loads) == len(set(levels.loads)) + (doublings == (1, 0))  # back from the trial of b
    true = 60.0 / 2 ** doublings[0] + 3.0 / 2 ** doublings[1]
    assert stresses == {"fs_s1": pytest.approx(true), "fs_s3": 0.0}
    assert error == pytest.approx(true / (levels.stress(doublings) + true)) and error <= asked


def test_what_condensed_sectors_leave_out_counts() -> None:
    class Condensed(Analytic):
        LEFT_OUT = 4.0

    assert refine(Condensed(), 0.05)[1] == pytest.approx((7.5 + 3.0 + 4.0) / (295.5 + 14.5))
    assert refine(Analytic(), 0.04)[0] == (3, 0) and refine(Condensed(), 0.04)[0] == (4, 0)
    found, error, _ = refine(Condensed(), 0.01)  # no mesh brings back what is left out
    assert found == (0, 0) and error > 0.01


def test_refinement_ends_where_nothing_helps() -> None:
    class Blocked(Analytic):
        def size(self, doublings: Doublings) -> int:
            return super().size(doublings) if doublings[0] <= 2 else 0

    found, error, _ = refine(Blocked(), 0.01)
    assert found == (2, 0) and error > 0.01  # b could be doubled, and would not do
    assert Blocked().size((2, 1))

    class Single(Analytic):
        FINEST = 1000

    assert refine(Single(), 0.2) == ((0, 0), 1.0, {})


def test_a_change_that_is_small_by_chance_is_no_convergence() -> None:
    class Chance(Analytic):
        def stress(self, doublings: Doublings) -> float:
            return 273.0 if doublings == (2, 0) else super().stress(doublings)  # as with (1, 0), by chance

    found, _, stresses = refine(Chance(), 0.05)
    assert found == (4, 0) and stresses["fs_s1"] == pytest.approx(22.5 / 2.0 + 3.0)
    assert error_after(5.0) == 5.0 and error_after(0.1, -8.0) == 4.0


def test_a_recipe_that_is_too_fine_is_coarsened() -> None:
    """Every group can be doubled below the largest size."""
    design = load_design(REFERENCE)
    full = load_recipe("full")
    found = Refinement(design, full, [], MPI.COMM_SELF, largest=LARGEST[3])
    assert found.base == coarser(full)
    assert 0 < found.size((0, 0, 0)) < min(found.size(doublings) for doublings in ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    assert found.size((9, 0, 0)) == 0  # more than a count may be
    assert Refinement(design, found.base, [], MPI.COMM_SELF, largest=LARGEST[3]).base == found.base
