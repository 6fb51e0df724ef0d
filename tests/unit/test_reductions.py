"""What spares work: coarser recipes, interpolation between meshes, history over one period."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from support.paths import DATA, DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar import load_design
from swgpar.analysis.coarse_start import levels
from swgpar.errors import InputError
from swgpar.evaluation.period import continued
from swgpar.fem.body import RING_GEAR
from swgpar.fem.sectors_in_reach import SectorsInReach
from swgpar.load.load_sequence import load_sequence
from swgpar.meshing import build_sector_meshes, load_recipe
from swgpar.meshing.interpolation import interpolation
from swgpar.meshing.recipe import FaceWidthRecipe
from swgpar.meshing.recipe_counts import coarser, with_counts


def test_coarser_recipes_halve_down_to_the_smallest() -> None:
    recipe = load_recipe("full")
    once = coarser(recipe)
    assert (once.flexible_spline.flank, once.flexible_spline.root, once.face_width.elements) == (
        9,
        2,
        6,
    )
    assert once.cup.end_ratio == recipe.cup.end_ratio
    assert coarser(once).face_width.elements == 4
    odd = with_counts(recipe, lambda *count: 9)
    assert odd.face_width.elements == 10  # even like the one it comes from
    for elements, half in ((3, 3), (7, 5), (9, 5), (2, 2), (4, 2), (6, 4)):
        width = recipe.model_copy(update={"face_width": FaceWidthRecipe(elements=elements)})
        assert coarser(width).face_width.elements == half
    for _ in range(10):
        recipe = coarser(recipe)
    assert coarser(recipe) == recipe


@pytest.mark.parametrize("overrides", [(), PLANE])
@pytest.mark.parametrize("gear", ["flexible_spline", "ring_gear"])
def test_linear_fields_survive_the_interpolation(gear: str, overrides: tuple[str, ...]) -> None:
    """A field linear in angle, radius and z is exact, inside the coarse mesh as outside, where it
    is extrapolated."""
    design = load_design(DESIGN, overrides)
    fine = build_sector_meshes(design.geometry, load_recipe(RECIPE))[gear]
    coarse = build_sector_meshes(design.geometry, coarser(load_recipe(RECIPE)))[gear]
    matrix = interpolation(coarse, fine)

    def fields(points: np.ndarray) -> np.ndarray:
        x, y, z = points.T
        return np.column_stack(
            [np.ones_like(x), np.arctan2(x, y), np.hypot(x, y), 0.0 * z if overrides else z]
        )

    assert np.abs(matrix @ fields(coarse.coords) - fields(fine.coords)).max() < 1e-9
    assert 0.0 > matrix.min() > -0.5 and matrix.max() < 1.5  # how far this extrapolates


def test_points_beside_flat_cells_alone_are_interpolated() -> None:
    """Nodes on conjugate flanks of a pancake nearest to a point have flat cells only."""
    geometry = load_design(DATA / "public" / "sw50_pancake_conj.toml").geometry
    recipe = load_recipe("forces")
    coarse, fine = (build_sector_meshes(geometry, one) for one in (coarser(recipe), recipe))
    for gear in coarse:
        weights = interpolation(coarse[gear], fine[gear])
        assert weights.sum(axis=1) == pytest.approx(1.0, abs=1e-9)
        assert np.abs(weights).max() < 1.5


def test_nodes_without_tetrahedra_are_refused() -> None:
    """The run then starts without coarser meshes."""
    sector = build_sector_meshes(load_design(DESIGN).geometry, load_recipe(RECIPE))["ring_gear"]
    flat = replace(sector, coords=sector.coords * (1.0, 1.0, 0.0))
    with pytest.raises(InputError, match="no state can be taken from the other mesh: QH6"):
        interpolation(flat, sector)


def test_levels() -> None:
    recipe = load_recipe("full")
    design = load_design(DESIGN, ["steps.start_levels=2"])
    assert levels(design.start_levels, recipe) == [coarser(coarser(recipe)), coarser(recipe)]
    assert levels(load_design(DESIGN).start_levels, recipe) == []
    # with friction the loaded state depends on the way
    rough = load_design(DESIGN, ["steps.start_levels=2", "contact.friction=0.1"])
    assert rough.start_levels == 0


def test_one_period_is_continued_over_the_rotation() -> None:
    design = load_design(DESIGN, ["steps.samples=4", "steps.rotation=30"])
    pitch = 360.0 / 42
    sequence = load_sequence(design)
    angles = [state.angle for state in sequence.from_loaded]
    assert np.degrees(angles[1:]) == pytest.approx([pitch * k / 4 for k in (1, 2, 3)])
    assert len(sequence.states) == 6
    rows = [
        {
            "step": 3 + k,
            "wg_angle_deg": np.degrees(a),
            "output_angle_deg": 1.0 - np.degrees(a) / 20.0,
            "fs_s1": 100.0 + k,
            "newton_iterations": 4,
            "wall_s": 1.0,
        }
        for k, a in enumerate(angles)  # the loaded state is the first of the period
    ]
    history = continued(sequence, rows)
    assert history[:4] == rows
    assert len(history) == 15 and history[-1]["wg_angle_deg"] == pytest.approx(14 * pitch / 4)
    assert [row["fs_s1"] for row in history] == [100.0 + k % 4 for k in range(15)]
    assert [row["step"] for row in history] == [3 + k for k in range(15)]
    # the output follows the line that the rows lie on
    expected = [1.0 - row["wg_angle_deg"] / 20.0 for row in history]
    assert [row["output_angle_deg"] for row in history] == pytest.approx(expected)
    assert sum(row["newton_iterations"] for row in history) == 16


def test_with_friction_a_period_settles_first() -> None:
    design = load_design(DESIGN, ["steps.samples=4", "steps.rotation=30", "contact.friction=0.1"])
    assert len(load_sequence(design).from_loaded) == 1 + 8
    with pytest.raises(
        InputError, match="steps.rotation = 10 is out of range: allowed 17.1429 deg"
    ):
        load_design(DESIGN, ["steps.samples=4", "steps.rotation=10", "contact.friction=0.1"])


def test_less_than_a_period_is_refused() -> None:
    with pytest.raises(InputError, match="steps.rotation = 6 is out of range: allowed 8.571"):
        load_design(DESIGN, ["steps.samples=4"])


class _Elements:
    """Counts how often it was laid out anew."""

    def __init__(self, count: int) -> None:
        self.sectors, self.active, self.count = np.arange(-1, count + 1), np.zeros(0, dtype=bool), 0
        self.bodies = {RING_GEAR: self}

    def activate(self, active: np.ndarray) -> None:
        assert len(active) == len(self.sectors)
        self.active, self.count = active, self.count + 1


def test_far_teeth_follow_the_near_ones_with_hysteresis() -> None:
    least, margin = 2, 3
    far = SectorsInReach(RING_GEAR, 61, _Elements.activate, (least, margin, 5))
    elements = _Elements(61)

    def near(*sectors: int) -> bool:
        return far.update(np.array(sectors, dtype=np.int64), elements)

    assert near(0, 1, 60)
    assert set(np.flatnonzero(far.active)) == {k % 61 for k in range(60 - margin, 62 + margin + 1)}
    assert not near(0, 1, 2)  # still with the least margin inside
    assert near(2 + margin - least)
    assert elements.active.sum() == pytest.approx(far.active.sum(), abs=2)
    assert (
        near() and not far.active.any()
    )  # before the teeth meet the ring gear is not there at all
    assert elements.count == 3
