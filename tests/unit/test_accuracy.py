"""What an accuracy asked for changes in design and recipe, and when refinement ends."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest
from mpi4py import MPI

from support.drive_groups import PLANE as PLANE_DRIVE
from support.messages import Messages
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar import load_design
from swgpar.analysis.accuracy import with_accuracy
from swgpar.analysis.coarse_start import MeshedDrive
from swgpar.analysis.drive_mesh_error import (
    LEAST,
    LEAST_AT_LOADED_ENDS,
    LEAST_WITH_EDGES,
    ORDER,
    SAFETY,
    CoarserMesh,
    MeshComparison,
    coarser_recipe,
    drive_error,
    least_error,
)
from swgpar.analysis.mesh_refinement import ChosenMesh, choose_mesh
from swgpar.analysis.shortcuts import FEWEST, with_shortcuts
from swgpar.errors import InputError
from swgpar.flank_pressure.pair_contact import FACE_END, pair_contacts
from swgpar.input.toml_file import to_toml
from swgpar.largest_stress.root_stress import BETWEEN, ENDS, RootStress, resolve_root_stress
from swgpar.largest_stress.window_recipes import LEVELS
from swgpar.load.load_sequence import load_sequence
from swgpar.meshing import load_recipe
from swgpar.meshing.recipe_counts import (
    FEWEST_ALONG_ROOT,
    RATIO,
    body_ratio,
    coarsened,
    contact_ratio,
    refined,
    resized,
    with_counts,
)

LOADED = ["steps.rotation=0", "steps.bent_start=true"]


def chosen(
    accuracy: float, *overrides: str, times: float = 1.0, largest: int | None = None
) -> ChosenMesh:
    """The small plane drive on the mesh for an accuracy. times : elements in every direction of the
    first mesh"""
    design = with_accuracy(load_design(DESIGN, [*PLANE, *LOADED, *overrides]), accuracy)
    drive, recipe = MeshedDrive(design, MPI.COMM_SELF), resized(load_recipe(RECIPE), times)
    return choose_mesh(drive, recipe, accuracy, largest=largest)


def test_a_resized_recipe_scales_every_count_and_no_grading() -> None:
    recipe = load_recipe("full")
    finer = resized(recipe, 2.0)
    for title, section in recipe.model_dump(exclude_none=True).items():
        for name, value in section.items():
            expected = 2 * value if type(value) is int else value
            assert getattr(getattr(finer, title), name) == expected, (title, name)
    assert resized(load_recipe("plane_coarse"), 0.1).flexible_spline.tip == 2
    with pytest.raises(InputError, match="is out of range: allowed"):
        resized(recipe, 100.0)


def test_a_chosen_recipe_can_be_read_again(tmp_path: Path) -> None:
    for name in ("full", "plane"):
        recipe = load_recipe(name)
        (tmp_path / "recipe.toml").write_text(to_toml(recipe.model_dump()))
        assert load_recipe(tmp_path / "recipe.toml") == recipe


def test_what_the_design_says_itself_is_kept() -> None:
    design = with_accuracy(load_design(DESIGN, [*PLANE, "steps.rotation=9"]), 0.01)
    assert design.steps.samples == 8
    own = [*PLANE, "steps.rotation=9", "steps.samples=3"]
    design = with_accuracy(load_design(DESIGN, own), 0.01)
    assert design.steps.samples == 3
    # less than a period
    assert with_accuracy(load_design(DESIGN, [*PLANE, "steps.rotation=4"]), 0.01).steps.samples == 0


def test_no_two_angles_of_an_accuracy_show_the_same_state() -> None:
    """Half a pitch on, two lobes at odd numbers of teeth have changed places."""
    odd = load_design(
        DESIGN, [*PLANE, "drive.teeth_fs=41", "drive.teeth_rg=43", "steps.rotation=9"]
    )
    for accuracy, samples in ((0.1, 3), (0.02, 5), (0.01, 9), (0.002, 17)):
        assert with_accuracy(odd, accuracy).steps.samples == samples


def test_accuracies_that_cannot_be_had() -> None:
    for accuracy in (0.0, 0.5, float("nan")):
        with pytest.raises(InputError, match="out of range: allowed 0.001 to 0.2"):
            with_accuracy(load_design(DESIGN, PLANE), accuracy)


def windows(levels: list[float], part: str = BETWEEN) -> RootStress:
    """The largest stress, on these windows."""
    place = {
        "region": "",
        "tooth": 0,
        "radius": 0.0,
        "z": 0.0,
        "angle_deg": 0.0,
        "elements": 1,
    }
    return RootStress(
        s1=levels[-1], error=0.0, on_mesh=0.0, part=part, by_part={part: levels}, **place
    )


def compared(levels: list[float], part: str = BETWEEN) -> CoarserMesh:
    """The mesh that plane_fine is compared with, with these stresses on its windows."""
    return CoarserMesh(coarsened(load_recipe("plane_fine")), {part: levels})


def test_ratios_are_those_of_the_counts() -> None:
    """No count of plane_fine is rounded, but for the smallest ones."""
    fine = load_recipe("plane_fine")
    coarse = coarser_recipe(fine)
    assert coarse is not None
    assert body_ratio(coarse, fine) == contact_ratio(coarse, fine) == RATIO
    for name in ("root", "under", "rim", "flank"):
        counts = [getattr(one.flexible_spline, name) for one in (fine, coarse)]
        assert counts[0] == RATIO * counts[1], name


@pytest.mark.parametrize("name", ["plane_coarse", "forces"])
def test_the_coarser_mesh_of_a_usual_run_shows_flanks_too(name: str) -> None:
    """It has as few elements along the flanks as find contacts."""
    recipe = load_recipe(name)
    coarse = coarser_recipe(recipe)
    assert coarse == coarsened(recipe)
    for gear in ("flexible_spline", "ring_gear"):
        assert getattr(recipe, gear).flank == RATIO * getattr(coarse, gear).flank == RATIO * FEWEST
    assert contact_ratio(coarse, recipe) == RATIO


def test_fewer_elements_along_flanks_would_find_no_contacts() -> None:
    recipe = load_recipe("plane_coarse")
    few = with_counts(recipe, lambda _, name, own: FEWEST if name == "flank" else own)
    coarse = coarser_recipe(few)
    assert coarse is not None and contact_ratio(coarse, few) is None
    assert body_ratio(coarse, few) == RATIO
    none = with_counts(recipe, lambda _, name, own: FEWEST - 1 if name == "flank" else own)
    assert coarser_recipe(none) is None
    assert coarser_recipe(load_recipe("coarse")) is None  # four along the face width


@pytest.mark.parametrize("name", ["coarse", "forces", "medium", "full", "plane", "plane_fine"])
def test_no_ratio_is_below_the_one_that_is_meant(name: str) -> None:
    """Rounding makes meshes coarser, or finer, than that ratio. Of four elements along the root
    three are left, since two show errors that four do not have."""
    recipe = load_recipe(name)
    four = recipe.flexible_spline.root == FEWEST_ALONG_ROOT + 1
    for coarse, fine in ((coarsened(recipe), recipe), (recipe, refined(recipe))):
        ratio = body_ratio(coarse, fine)
        least = 4 / 3 if four and fine is recipe else RATIO
        assert ratio is None or ratio >= least
        assert contact_ratio(coarse, fine) > 1.0


def test_without_fewer_elements_in_root_and_rim_there_is_no_estimate() -> None:
    """The recipe `coarse` has the fewest already: a coarser one would show no error there."""
    recipe = load_recipe("coarse")
    coarser = CoarserMesh(coarsened(recipe), {BETWEEN: [250.0, 280.0]})
    assert drive_error(coarser, recipe, windows([252.0, 282.0, 290.0]), 0.004) is None
    assert drive_error(None, recipe, windows([252.0, 282.0, 290.0]), 0.004) is None


def test_the_error_of_the_drive_s_mesh_follows_from_a_coarser_one() -> None:
    """An error of the displacements' order is found; the windows' own, which both share,
    cancels."""
    recipe, left = load_recipe("plane_fine"), 1.0 / RATIO**ORDER
    fine = windows([260.0 + 9.0 * left, 290.0 + 9.0 * left, 300.0])
    found = drive_error(compared([269.0, 299.0]), recipe, fine, 0.004)
    expected = SAFETY * left * 9.0 * fine.s1 / fine.levels[1]
    assert found == pytest.approx(expected)
    # the first window was not computed
    coarser = compared([math.nan, 299.0])
    assert drive_error(coarser, recipe, fine, 0.004) == pytest.approx(expected)
    # a change that is small by chance
    same, fine = compared([270.0, 290.0]), windows([270.0, 290.0, 300.0])
    assert drive_error(same, recipe, fine, 0.004) == pytest.approx(0.004 * 300.0)
    before = replace(windows([280.0]), drive_error=9.0)
    assert drive_error(same, recipe, fine, 0.004, before) == pytest.approx(9.0 * left)
    at_ends = replace(before, part=ENDS)
    assert drive_error(same, recipe, fine, 0.004, at_ends) == pytest.approx(0.004 * 300.0)


def test_the_same_part_of_the_teeth_is_compared_between_meshes() -> None:
    """At the ends the second window gives too much, on either mesh."""
    recipe, shown = load_recipe("plane_fine"), SAFETY / (RATIO**ORDER - 1.0)
    stresses = {BETWEEN: [260.0, 280.0], ENDS: [265.0, 295.0]}
    coarser = CoarserMesh(coarsened(recipe), stresses)
    between, ends = windows([262.0, 281.25]), windows([267.0, 297.5], ENDS)
    assert drive_error(coarser, recipe, between, 0.0) == pytest.approx(1.25 * shown)
    assert drive_error(coarser, recipe, ends, 0.0) == pytest.approx(2.5 * shown)
    # an end that was followed on no window which both meshes have
    alone = windows([267.0], ENDS)
    assert drive_error(compared([math.nan, 295.0], ENDS), recipe, alone, 0.0) is None


def test_another_part_has_another_error() -> None:
    """A further window may find the largest stress in another part of the teeth."""
    recipe, shown = load_recipe("plane_fine"), SAFETY / (RATIO**ORDER - 1.0)
    stresses = {BETWEEN: [math.nan, 280.0], ENDS: [math.nan, 250.0]}
    coarser = CoarserMesh(coarsened(recipe), stresses)
    comparison = MeshComparison(recipe, coarser, [], 20)
    at_ends = comparison.with_errors(windows([270.0, 290.0], ENDS))
    assert at_ends.drive_error == pytest.approx(40.0 * shown)
    between = comparison.with_errors(windows([270.0, 285.0, 290.0]))
    assert between.drive_error == pytest.approx(5.0 * shown * 290.0 / 285.0)


def test_contacts_on_edges_leave_more_of_an_error() -> None:
    involute = {"type": "involute", "pressure_angle": 20.0, "cutter_radius": 0.2}
    profiles = {
        "flexible_spline.profile": involute,
        "ring_gear.profile": {**involute, "cutter_teeth": 80},
    }
    recipe = load_recipe("plane_coarse")
    for values, least in ((profiles, LEAST_WITH_EDGES), ({}, LEAST["plane"])):
        design = with_shortcuts(load_design(PLANE_DRIVE, values), recipe, levels=False).design
        model = MeshedDrive(design, MPI.COMM_SELF).load(recipe)
        contacts = pair_contacts(model, load_sequence(design).loaded)
        for part in (BETWEEN, ENDS):
            assert least_error(recipe, contacts, part) == least
        # at the ends of teeth, where the load is on an end of the face width
        at_end = [replace(contacts[0], edge=1, edge_place=f"{FACE_END} and the tip")]
        assert least_error(recipe, at_end, ENDS) == LEAST_AT_LOADED_ENDS > LEAST_WITH_EDGES
        assert least_error(recipe, at_end, BETWEEN) == LEAST_WITH_EDGES


def test_a_finer_mesh_of_a_cup_has_a_smaller_least_error() -> None:
    """It stands for few elements in root, below it and in the rim: all of them have to be more."""
    usual = load_recipe("forces")
    finer, more = refined(usual), RATIO**ORDER
    assert least_error(usual, [], BETWEEN) == LEAST["cup"]
    assert least_error(load_recipe("full"), [], BETWEEN) == LEAST["cup"]  # three along the root
    assert least_error(finer, [], BETWEEN) == pytest.approx(LEAST["cup"] / more)
    assert least_error(refined(refined(finer)), [], BETWEEN) == LEAST["plane"]


def test_the_error_holds() -> None:
    """Against a mesh of the drive with twice the elements in every direction and a further
    window."""
    found = chosen(0.2, times=2.0)
    error, s1, design = found.root_stress.total_error, found.root_stress.s1, found.model.design
    found.model.destroy()
    finer = MeshedDrive(design, MPI.COMM_SELF).load(resized(found.model.recipe, 2.0))
    loaded = load_sequence(design).loaded
    reference = resolve_root_stress(finer, loaded, LEVELS["plane"] + 1).s1
    finer.destroy()
    true = abs(s1 - reference)
    print(f"s1 {s1:.2f} for {reference:.2f} MPa: error {error:.2f} for {true:.2f} MPa")
    # the recipe is one of cup drives, whose layers below the root leave a least error
    assert 0.5 * true < error < max(3.0 * true, 1.01 * LEAST["cup"] * s1)


def test_the_best_mesh_is_returned_where_the_accuracy_is_out_of_reach() -> None:
    with Messages() as messages:
        found = chosen(0.001, largest=10_000)
    elements = found.model.n_elements()
    found.model.destroy()
    assert found.error > 0.001 and elements <= 10_000
    assert any(
        "no finer mesh is taken: the drive has at most 10000 elements" in text
        for text in messages.texts
    )


def test_no_finer_mesh_is_taken_for_the_least_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """As beside an edge, whose compliance no mesh resolves: a finer one would have the same."""
    for module in ("drive_mesh_error", "mesh_refinement"):
        monkeypatch.setattr(f"swgpar.analysis.{module}.least_error", lambda *_: 0.5)
    with Messages() as messages:
        found = chosen(0.2)
    recipe = found.model.recipe
    found.model.destroy()
    assert found.root_stress.drive_error == pytest.approx(0.5 * found.root_stress.s1)
    assert recipe in (load_recipe(RECIPE), refined(load_recipe(RECIPE)))
    assert any("is the least one" in text for text in messages.texts)


def test_with_friction_every_mesh_is_loaded_step_by_step() -> None:
    """The state is the one that a run has on this mesh, which depends on the path to it."""
    found = chosen(0.2, "contact.friction=0.1")
    design = found.model.design
    alone = MeshedDrive(design, MPI.COMM_SELF).load(found.model.recipe)
    assert found.error <= 0.2
    assert found.model.stresses()[0] == pytest.approx(alone.stresses()[0], rel=1e-9)
    for model in (found.model, alone):
        model.destroy()
