"""A window in its equilibrium."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.largest_stress.local_problem import LocalProblem
from swgpar.largest_stress.window_state import WindowState
from swgpar.load.load_states import LoadState
from swgpar.meshing import MeshRecipe
from swgpar.model.drive_model import DriveModel

States = dict[tuple[int, int | None], WindowState]
"""Equilibria of windows by modelled tooth and by `middle`, see `solved_window`."""


@contextmanager
def solved_window(
    model: DriveModel,
    state: LoadState,
    tooth: int,
    recipe: MeshRecipe,
    states: States,
    gear: str = FLEXIBLE_SPLINE,
    middle: int | None = None,
) -> Iterator[LocalProblem]:
    """The window around a modelled tooth in its equilibrium, which `states` keeps for the next
    finer one; collective.

    middle : number, of any turn, of the tooth in the window around which a narrow one lies; None
    for a window of all sectors
    """
    coarser = states.get((tooth, middle), states.get((tooth, None)))
    around = model.partition.layouts[gear].first_tooth + tooth if middle is None else middle
    window = LocalProblem(model, state, around, recipe, gear, coarser, narrow=middle is not None)
    try:
        window.solve()
        states[tooth, middle] = window.equilibrium()
        yield window
    finally:
        window.destroy()
