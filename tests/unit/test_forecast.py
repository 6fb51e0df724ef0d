"""Forecast of a run: counts are those of the model, needs grow with them, what does not fit is refused."""

from __future__ import annotations

import pytest
from mpi4py import MPI

import swgpar
from support.paths import DESIGN, DRIVERS, RECIPE, REFERENCE
from swgpar.analysis.drive_model import build_drive_model
from swgpar.analysis.forecast import Forecast, forecast, free_memory, require_memory
from swgpar.design.design_file import load_design
from swgpar.errors import InputError
from swgpar.meshing import load_recipe


@pytest.mark.parametrize("overrides", [(), ("drive.layout=spline_fixed",), ("solver.twofold_symmetry=false",)])
def test_counts_are_those_of_the_model(overrides: tuple[str, ...]) -> None:
    design, recipe = load_design(DESIGN, overrides), load_recipe(RECIPE)
    found = forecast(design, recipe)
    model = build_drive_model(design, recipe, comm=MPI.COMM_SELF)
    counts = model.counts().values()
    assert (found.elements, found.unknowns) == (model.n_elements(), sum(count["dofs"] for count in counts))
    model.destroy()


def test_needs_grow_with_the_mesh() -> None:
    design = load_design(REFERENCE)
    coarse, full = (forecast(design, load_recipe(name)) for name in ("coarse", "full"))
    # measured on two ranks: docs/verification/forecast.md
    assert coarse.memory == pytest.approx(1.9, rel=0.25) and full.memory == pytest.approx(6.1, rel=0.25)
    assert full.seconds > 5.0 * coarse.seconds


def test_what_does_not_fit_is_refused() -> None:
    require_memory(Forecast(1, 1, 0.9 * free_memory(), 1.0))
    with pytest.raises(InputError, match="need about 1e[+]06 GB of memory: allowed are meshes that need less than"):
        require_memory(Forecast(1, 1, 1e6, 1.0))


def test_a_check_with_a_mesh_prints_the_needs() -> None:
    without, found = swgpar.check(DESIGN), swgpar.check(DESIGN, mesh=RECIPE)
    assert found["unknowns modelled"] > 0 and set(without) < set(found)
    with pytest.raises(InputError, match="has no mesh"):
        swgpar.check(DRIVERS / "ring_supported.toml", mesh="coarse")
