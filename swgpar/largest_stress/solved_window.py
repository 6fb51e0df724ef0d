"""A window in its equilibrium."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.largest_stress.local_problem import LocalProblem, WindowState
from swgpar.load.load_states import LoadState
from swgpar.meshing import MeshRecipe
from swgpar.model.drive_model import DriveModel


@contextmanager
def solved_window(
    model: DriveModel,
    state: LoadState,
    tooth: int,
    recipe: MeshRecipe,
    states: dict[int, WindowState],
    gear: str = FLEXIBLE_SPLINE,
) -> Iterator[LocalProblem]:
    """The window around a modelled tooth in its equilibrium, which replaces that of the coarser one
    in `states`; collective."""
    first = model.partition.layouts[gear].first_tooth
    window = LocalProblem(model, state, first + tooth, recipe, gear, states.get(tooth))
    try:
        window.solve()
        states[tooth] = window.equilibrium()
        yield window
    finally:
        window.destroy()
