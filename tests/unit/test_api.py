"""The Python API on one rank: what goes in and comes out, in memory and in a folder."""

from __future__ import annotations

import inspect
import logging
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI

import swgpar
from support.messages import Messages
from support.paths import DESIGN, DRIVERS, RECIPE, ROOT
from support.small_drive import NO_SHORTCUTS, PLANE
from swgpar import log
from swgpar.design.drive_design import DriveDesign
from swgpar.input.toml_file import read_toml
from swgpar.presentation.figures import DriveFigures

OVERRIDES = [
    *PLANE,
    *NO_SHORTCUTS,
    "steps.rotation=4.0",
    "steps.increment=2.0",
    "output.fields=true",
]


@pytest.fixture(scope="module")
def design() -> DriveDesign:
    return swgpar.load_design(DESIGN, OVERRIDES)


@pytest.fixture(scope="module")
def result(design: DriveDesign) -> swgpar.DriveResult:
    return swgpar.run(design, RECIPE)


@pytest.fixture(scope="module")
def on_disk(design: DriveDesign, tmp_path_factory: pytest.TempPathFactory) -> swgpar.DriveResult:
    return swgpar.run(
        design.with_values({"output.figures": True}), RECIPE, tmp_path_factory.mktemp("run") / "out"
    )


def test_the_package_is_light() -> None:
    """Importing it starts neither MPI nor PETSc."""
    code = (
        "import swgpar, sys; print([m for m in ('mpi4py', 'petsc4py', 'numpy') if m in "
        "sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_check_loads_neither_other_systems_nor_what_runs_need(tmp_path: Path) -> None:
    """A check of a drive needs neither gear trains nor studies, PETSc, elements or figures."""
    code = (
        f"import swgpar, sys; swgpar.check({str(DESIGN)!r}); "
        "print([m for m in sys.modules if m.startswith(('swgpar.gear_trains', 'swgpar.studies', "
        "'swgpar.fem', 'petsc4py', 'h5py', 'meshio', 'matplotlib'))])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert done.stdout.strip() == "[]"


def test_public_names_exist_and_say_what_they_do() -> None:
    assert set(swgpar.__all__) <= set(dir(swgpar))
    for name in set(swgpar.__all__) - {"__version__"}:
        assert inspect.getdoc(getattr(swgpar, name)), name
    with pytest.raises(AttributeError, match="no attribute 'runs'"):
        swgpar.runs  # noqa: B018


def test_designs_from_files_and_tables(design: DriveDesign) -> None:
    table = read_toml(DESIGN)
    assert swgpar.load_design(table) == swgpar.load_design(DESIGN)
    assert swgpar.load_design(table, {"load.torque": np.float64(3.0)}).load.torque == 3.0
    assert swgpar.load_design(DRIVERS / "cascade.toml").gear_train.model == "cascade"
    assert table == read_toml(DESIGN)
    assert (
        swgpar.load_design(design) is design
        and swgpar.load_design(design, {"load.torque": 3.0}).load.torque == 3.0
    )
    with pytest.raises(swgpar.InputError, match="did you mean load.torque"):
        swgpar.load_design(DESIGN, {"load.torqe": 3.0})
    for function in (swgpar.load_design, swgpar.run, swgpar.check):
        with pytest.raises(
            swgpar.InputError, match="design is of the type int: allowed are a path, a dict"
        ):
            function(3)
    with pytest.raises(swgpar.InputError, match="study is of the type int: allowed are a path"):
        swgpar.study(3)


@pytest.mark.parametrize("file", sorted(DRIVERS.glob("*.toml")), ids=lambda file: file.stem)
def test_changed_designs_are_checked(file: Path) -> None:
    """`with_values` of nothing is the same design, with the same keys given; a wrong value is
    refused."""
    design = swgpar.load_design(file)
    same = design.with_values({})
    assert same == design and same.model_fields_set == design.model_fields_set
    with pytest.raises(swgpar.InputError):
        design.with_values({"output.figures": 3})


def test_recipes_by_name_path_and_table() -> None:
    plane = swgpar.load_mesh("plane_coarse")
    assert swgpar.load_mesh(plane.model_dump(exclude_none=True)) == plane
    assert swgpar.load_mesh(RECIPE).flexible_spline.flank == 2 and swgpar.load_mesh(plane) is plane
    with pytest.raises(swgpar.InputError, match="mesh is of the type float"):
        swgpar.load_mesh(1.5)
    with pytest.raises(
        swgpar.InputError,
        match='mesh = "corse" is not available: allowed coarse, forces, medium, full',
    ):
        swgpar.load_mesh("corse")


def test_a_recipe_of_one_s_own(tmp_path: Path) -> None:
    out = tmp_path / "recipe.toml"
    command = [
        sys.executable,
        str(ROOT / "mesh" / "refined_root.py"),
        "--recipe",
        str(RECIPE),
        "--out",
        str(out),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "ring_gear: " in done.stdout
    old, new = (swgpar.load_mesh(path).flexible_spline for path in (RECIPE, out))
    assert (new.root, new.rim, new.flank) == (2 * old.root, 2 * old.rim, old.flank)


def test_a_run_in_memory_leaves_no_files(
    design: DriveDesign,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    result = swgpar.run(design, RECIPE)
    assert result.folder is None and result.increments == len(result.history["step"]) == 5
    assert not list(tmp_path.iterdir()) and capfd.readouterr().out == ""


def test_history_and_summary(result: swgpar.DriveResult) -> None:
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame(result.history)
    rotation = table[table["step"] >= 4]
    summary = result.summary
    assert summary["mean.fs_s1"].value == pytest.approx(rotation["fs_s1"].mean(), rel=1e-14)
    assert summary["maximum.fs_s1"].value == rotation["fs_s1"].max()
    torque = rotation["wg_torque_Nmm"]
    assert summary.rotation.torque_ripple == pytest.approx(
        (torque.max() - torque.min()) / torque.mean(), rel=1e-12
    )
    error = 3600.0 * (rotation["output_angle_deg"] - rotation["wg_angle_deg"] / summary.ratio)
    assert summary.rotation.transmission_error_arcsec == pytest.approx(
        error.max() - error.min(), abs=1e-9
    )


def test_the_stress_at_the_teeth_is_resolved_where_it_is_asked_for(
    design: DriveDesign, result: swgpar.DriveResult, tmp_path: Path
) -> None:
    """Once, in the loaded state; a restart keeps it."""
    assert result.summary.root_stress is None
    asked = design.with_values(
        {"output.root_stress": True, "output.fields": False, "steps.rotation": 2.0}
    )
    found = swgpar.run(asked, RECIPE, tmp_path / "run")
    root = found.summary.root_stress
    (loaded,) = np.flatnonzero(found.history["step"] == 3)
    assert root.on_mesh == pytest.approx(found.history["fs_s1"][loaded], rel=1e-9)
    assert root.levels[-1] == root.s1 > root.on_mesh and 0.0 < root.error < 0.05 * root.s1
    longer = swgpar.run(
        asked.with_values({"steps.rotation": 4.0}), RECIPE, tmp_path / "run", restart=True
    )
    assert (
        longer.summary.stresses.places["fs_s1"].value
        >= found.summary.stresses.places["fs_s1"].value
        > 0.0
    )
    assert longer.summary.root_stress == root and longer.summary.phases_s["windows"] > 0.0


def test_fields(result: swgpar.DriveResult) -> None:
    for body, prefix in (("flexible_spline", "fs"), ("ring_gear", "rg")):
        points, cells = result.mesh(body)
        assert points.shape[1] == 3 and cells.shape[1] == 8 and cells.max() == len(points) - 1
        for increment in (0, -1):
            found = result.field("vm", increment, body)
            assert found.shape == (len(points),)
            assert found.max() == pytest.approx(result.history[f"{prefix}_vm"][increment], rel=1e-6)
    assert result.field("displacement").shape == (len(result.mesh().points), 3)
    assert result.field("stress").shape[1] == 6
    flanks = result.flank_pressure()
    assert (
        flanks.pressure.shape == (20, 2, len(flanks.s), len(flanks.z))
        and flanks.pressure.max() > 0.0
    )
    assert np.isin(flanks.pressure, result.field("pressure")).all()


def test_what_is_not_there_is_refused(result: swgpar.DriveResult, design: DriveDesign) -> None:
    with pytest.raises(
        swgpar.InputError, match="field 'mises' is not available on flexible_spline: allowed disp"
    ):
        result.field("mises")
    with pytest.raises(swgpar.InputError, match="increment = 5 has no fields: allowed -5 to 4"):
        result.field("vm", 5)
    with pytest.raises(swgpar.InputError, match="body 'cup' is not available"):
        result.field("vm", body="cup")
    with pytest.raises(swgpar.InputError, match="restart has no meaning for a gear train"):
        swgpar.run(DRIVERS / "ring_supported.toml", restart=True)
    with pytest.raises(swgpar.InputError, match="restart = true needs the results folder"):
        swgpar.run(design, RECIPE, restart=True)
    with pytest.raises(swgpar.OutputError, match="has no summary.json"):
        swgpar.open_result(DRIVERS)


def test_grids(result: swgpar.DriveResult) -> None:
    grid = result.grid()
    sizes = [len(result.mesh(body).points) for body in ("flexible_spline", "ring_gear")]
    assert grid.n_points == sum(sizes)
    assert np.isnan(grid.point_data["pressure"]).sum() == sizes[1]
    whole = result.grid(body="flexible_spline", whole=True)
    assert whole.n_points == 2 * sizes[0]
    # the added half is the same after half a turn
    centre = np.average(whole.points + whole.point_data["displacement"], axis=0)
    assert np.abs(centre[:2]).max() < 1e-9


def test_a_folder_gives_what_memory_gives(
    result: swgpar.DriveResult, on_disk: swgpar.DriveResult
) -> None:
    again = swgpar.open_result(on_disk.folder)
    for other in (on_disk, again):
        assert other.increments == result.increments
        for name, column in result.history.items():
            if name != "wall_s":
                np.testing.assert_allclose(other.history[name], column, rtol=1e-9, atol=1e-9)
        assert other.summary.keys() == result.summary.keys()
        for body in ("flexible_spline", "ring_gear"):
            np.testing.assert_array_equal(other.mesh(body).points, result.mesh(body).points)
            np.testing.assert_array_equal(other.mesh(body).cells, result.mesh(body).cells)
            assert other.names(body) == result.names(body)
        np.testing.assert_allclose(other.field("vm"), result.field("vm"), rtol=1e-5)
    written = {path.stem for path in (on_disk.folder / "figures").glob("*.png")}
    assert written == set(result.plot.names)


def test_figures(result: swgpar.DriveResult) -> None:
    plot = result.plot
    for draw in (
        plot.stress,
        plot.torque,
        plot.transmission_error,
        plot.pairs,
        plot.contact_pattern,
        plot.deformed,
    ):
        assert draw().axes
    assert "contact_pattern" in plot.names


def test_results_are_found_from_another_folder(
    design: DriveDesign, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = swgpar.run(design.with_values({"output.figures": False}), RECIPE, "out")
    opened = swgpar.open_result("out")
    train = swgpar.run(DRIVERS / "ring_supported.toml", out="ring")
    monkeypatch.chdir(DRIVERS)
    np.testing.assert_array_equal(result.field("vm"), opened.field("vm"))
    assert result.folder == opened.folder == tmp_path / "out" and train.folder == tmp_path / "ring"


def test_a_figure_that_cannot_be_drawn(
    result: swgpar.DriveResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(self: object) -> None:
        raise TypeError("no colours")

    monkeypatch.setattr("swgpar.presentation.figures.DriveFigures.stress", broken)
    with pytest.raises(swgpar.OutputError, match="cannot draw .*stress.png: no colours"):
        result.plot.save(tmp_path)


def test_a_run_leaves_the_logger_as_it_was() -> None:
    logger = logging.getLogger("swgpar")
    with Messages() as messages:
        before = logger.level, logger.propagate, list(logger.handlers)
        swgpar.run(DRIVERS / "ring_supported.toml", progress=True)
        assert (logger.level, logger.propagate, logger.handlers) == before
    assert any("finished in" in text for text in messages.texts)


def test_warnings_are_seen_without_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(logging.getLogger(), "handlers", [])  # without those of pytest
    logger = logging.getLogger("swgpar")
    with log.session(MPI.COMM_SELF, terminal=False):
        logger.info("quiet")
        logger.warning("loud")
    shown = capfd.readouterr()
    assert shown.err == "loud\n" and shown.out == ""
    with log.session(MPI.COMM_SELF, terminal=False, shown=False):
        logger.warning("loud")
    assert capfd.readouterr().err == ""


def test_a_gear_train(tmp_path: Path) -> None:
    here = swgpar.run(DRIVERS / "ring_supported.toml")
    there = swgpar.run(DRIVERS / "ring_supported.toml", out=tmp_path / "ring")
    assert here.plot.names == there.plot.names == ("mode_shapes",)
    assert (
        here.plot.mode_shapes().axes
        and (tmp_path / "ring" / "figures" / "mode_shapes.png").exists()
    )
    again = swgpar.open_result(tmp_path / "ring")
    for name, column in here.history.items():
        np.testing.assert_allclose(again.history[name], column, rtol=1e-12)
    assert dict(again.summary) == dict(here.summary) and again.compared == here.compared
    with pytest.raises(
        AttributeError, match="there is no figure 'modes': the result has mode_shapes"
    ):
        here.plot.modes  # noqa: B018


def test_check_and_mesh(design: DriveDesign, tmp_path: Path) -> None:
    assert swgpar.check(design)["ratio (wave generator / output)"] == -20.0
    assert swgpar.check(DRIVERS / "cup_45deg.toml", {"drive.layout": "spline_fixed"})[
        "ratio (wave generator / output)"
    ] == pytest.approx(61.0)
    mesh = swgpar.mesh(design, RECIPE, tmp_path / "mesh", formats=("vtu",))
    assert [path.name for path in (tmp_path / "mesh").iterdir()] == ["drive_40_42.vtu"]
    grid = mesh.grid()
    assert grid.n_cells == sum(values["elements"] for values in mesh.quality.values())
    assert grid.n_points == sum(len(body.points) for body in mesh.bodies.values())
    with pytest.raises(swgpar.InputError, match="a gear train has no mesh"):
        swgpar.mesh(DRIVERS / "cascade.toml", "coarse")


def test_a_study_in_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    content = {
        "design": str(DESIGN),
        "meshes": [str(RECIPE)],
        "set": [*PLANE, "steps.rotation=2.0", "steps.increment=2.0"],
        "vary": {"load.torque": [0.1, -1.0]},
    }
    monkeypatch.chdir(tmp_path)
    found = swgpar.study({"study": content})
    assert found.folder is None and found.report is None and not list(tmp_path.iterdir())
    assert found.table["load.torque"] == [0.1, -1.0] and found.table["status"] == [
        "finished",
        "failed",
    ]
    assert found.table["mean.fs_s1"][0] > 0.0 and found.table["mean.fs_s1"][1] is None
    assert found.failed == {
        "torque=-1 tiny": "load.torque = -1 is out of range: allowed 0 to 1000000000 N·m"
    }


@pytest.mark.parametrize(
    "name",
    ["pairs", "load_sharing", "contact_pattern", "haigh", "ball_loads", "torque_against_rotation"]
    + ["transmission_error_spectrum"],
)
def test_figures_of_what_a_run_does_not_have(name: str) -> None:
    """One sentence that says when there is such a figure."""
    tables = dict.fromkeys(
        ("pairs", "contact_lines", "balls", "program", "transmission_error", "history"), {}
    )
    summary = SimpleNamespace(bearing=None, transmission_error=None)
    result = SimpleNamespace(
        **tables, fatigue=None, fatigue_cycle={}, summary=summary, is_plane=True, increments=0
    )
    plot = DriveFigures(result, MPI.COMM_SELF, gathered=False)
    with pytest.raises(swgpar.InputError, match=r"^this run has no .*: allowed with "):
        getattr(plot, name)()
    assert name not in plot.names
