"""Frozen cells of the state before an augmentation, where the contacts do not settle after it."""

from __future__ import annotations

from types import SimpleNamespace

from swgpar.load.load_states import LoadState, Stage
from swgpar.solve.newton import NewtonSolver
from swgpar.solve.solve_state import SolveState


class Cells:
    """Cells that only know whether they are frozen."""

    frozen = True

    def are_frozen(self) -> bool:
        return self.frozen

    def freeze(self) -> None:
        self.frozen = True

    def release(self) -> None:
        self.frozen = False

    def freeze_friction_bounds(self) -> tuple[float, float]:
        return 0.0, 0.0


def solver(augmentations: int) -> NewtonSolver:
    """Without a problem, in the middle of a run whose cells are frozen."""
    made = NewtonSolver.__new__(NewtonSolver)
    made.problem, made.line_search = SimpleNamespace(cells=Cells()), SimpleNamespace()
    made.line_search.descending = False
    made.state = SolveState(LoadState(Stage.LOAD, 3), [], 10, residuals=[1.0, 2e-3, 1e-3, 1e-3])
    made.state.augmentations = augmentations
    return made


def test_after_an_augmentation_stale_cells_are_placed_anew_once() -> None:
    newton = solver(augmentations=1)
    newton._break_cycle()
    assert not newton.problem.cells.frozen
    assert not newton.line_search.descending
    assert newton.state.residuals == [1e-3]  # what the stale cells had does not count as reached
    newton._break_cycle()
    assert newton.problem.cells.frozen
    assert newton.line_search.descending


def test_without_an_augmentation_the_frozen_cells_stay() -> None:
    newton = solver(augmentations=0)
    newton._break_cycle()
    assert newton.problem.cells.frozen
    assert newton.line_search.descending
