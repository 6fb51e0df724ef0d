"""The contact pattern draws the pressure that was computed: its integral is the force of the pair,
its largest value the pressure of the pair."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import StepPatch

import swgpar
from support.paths import DATA, DESIGN, DRIVERS, RECIPE
from support.small_drive import PLANE

PLAIN = ("output.root_stress=false", "output.figures=false")


def run(*values: str, design: Path = DESIGN, mesh: Path | str = RECIPE) -> swgpar.DriveResult:
    return swgpar.run(swgpar.load_design(design, [*values, *PLAIN]), mesh, progress=False)


def drawn_force(axes: Axes) -> tuple[float, float]:
    """Integral of the drawn pressure (N) and its largest value (MPa) in a map."""
    (cells,) = (one for one in axes.collections if isinstance(one, PolyCollection))
    corners = np.array([path.vertices[:4] for path in cells.get_paths()])
    size = np.ptp(corners, axis=1)
    pressure = np.asarray(cells.get_array())
    return float((size.prod(axis=1) * pressure).sum()), float(pressure.max())


def expected(result: swgpar.DriveResult, step: int) -> tuple[np.ndarray, np.ndarray]:
    """Forces (n,) N and pressures (n,) MPa of the pairs whose pressure is known, by force."""
    pairs = result.pairs
    last = pairs["increment"][pairs["step"] == step].max()
    known = (pairs["increment"] == last) & np.isfinite(pairs["pressure_MPa"])
    order = np.argsort(-pairs["force_N"][known])
    return pairs["force_N"][known][order], pairs["pressure_MPa"][known][order]


@pytest.mark.parametrize("values", [(), ("micro_geometry.fs_crowning=0.0",)])
def test_the_map_of_a_cup_has_the_forces(values: tuple[str, ...]) -> None:
    """Without crowning the load ends at the face width, and the pattern is far from an ellipse."""
    result = run(*values)
    known_steps = result.pairs["step"][np.isfinite(result.pairs["pressure_MPa"])]
    assert len(known_steps) > 1
    for step in np.unique(known_steps).astype(int):
        maps = [axes for axes in result.plot.contact_pattern(step).axes if axes.get_title()]
        drawn = sorted((drawn_force(axes) for axes in maps), reverse=True)
        for (force, pressure), known, top in zip(drawn, *expected(result, step), strict=True):
            assert force == pytest.approx(known, rel=0.01)
            # half spaces have cells, ends of the face width strips: see below
            assert top * (1.0 - 5e-3) <= pressure <= top * (1.0 + 1e-5)


@pytest.mark.parametrize("mesh", ["plane_coarse"])
def test_the_lines_of_a_plane_drive_have_the_forces(mesh: str) -> None:
    design = DRIVERS / "plane_half_turn.toml"
    result = run("steps.samples=2", design=design, mesh=mesh)
    width = result.summary.design.drive.face_width
    step = int(result.pairs["step"].max())
    (axes,) = result.plot.contact_pattern(step).axes
    stairs = [one.get_data() for one in axes.patches if isinstance(one, StepPatch)]
    drawn = sorted(
        ((float(p @ np.diff(edges)) * width, float(p.max())) for p, edges, _ in stairs),
        reverse=True,
    )
    for (force, pressure), known, top in zip(drawn, *expected(result, step), strict=True):
        assert force == pytest.approx(known, rel=0.01)
        # the figure has strips at fixed places, the largest pressure is that of the best place
        assert top * (1.0 - 5e-3) <= pressure <= top * (1.0 + 1e-5)


def test_the_pattern_begins_with_the_largest_pressure_of_all() -> None:
    result = run(*PLANE)
    pairs = result.pairs
    title = result.plot.contact_pattern()._suptitle.get_text()
    at = pairs["wg_angle_deg"][np.nanargmax(pairs["pressure_MPa"])]
    assert title.endswith(f"{at:.3g} degrees")


def test_results_without_cells_have_no_pattern() -> None:
    result = swgpar.open_result(DATA / "first_format" / "plane")
    assert "contact_pattern" not in result.plot.names
    with pytest.raises(swgpar.InputError, match=r"has no cells: allowed with "):
        result.plot.contact_pattern()
