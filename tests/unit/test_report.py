"""report.html: one file with what a run gives, its checks and its drawings; and the surface that
its view shows."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyvista

import swgpar
from support.html_text import assert_needs_nothing_else
from support.paths import DESIGN, DRIVERS, RECIPE
from support.small_drive import PLANE, SHORT
from swgpar.checks.starter import Request, starter_design
from swgpar.design.sections import GEARS
from swgpar.drive_results.report_checks import checks
from swgpar.errors import InputError
from swgpar.evaluation.losses import DriveLosses, LossParts
from swgpar.evaluation.transmission_error import TorqueOverTurns, TransmissionError
from swgpar.geometry.rotation import rotated
from swgpar.largest_stress.root_stress import BETWEEN, RootStress
from swgpar.meshing import build_sector_meshes, load_recipe
from swgpar.presentation.answer_text import value_text
from swgpar.presentation.deformed_figures import deformed
from swgpar.presentation.drive_drawing import draw_drive
from swgpar.presentation.off_screen import off_screen_plotter
from swgpar.presentation.scene import sector_surface
from swgpar.presentation.view import view_plotter


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("report") / "run"
    design = swgpar.load_design(
        DESIGN, [*PLANE, *SHORT, "output.figures=false", "output.fields=true"]
    )
    swgpar.run(design, RECIPE, out)
    return out


def test_a_run_leaves_one_page_that_needs_nothing_else(folder: Path) -> None:
    text = (folder / "report.html").read_text(encoding="utf-8")
    page = assert_needs_nothing_else(text)
    assert page.tags.count("svg") == 2 and "canvas" in page.tags
    summary = swgpar.open_result(folder).summary
    for name, answer in summary.items():
        assert f">{value_text(answer.value, answer.error)}<" in text, name
    assert "balance of torques" in text and summary.versions["petsc"] in text
    assert f"teeth_fs = {summary.design.drive.teeth_fs}" in text


def test_the_report_opens_with_verdicts_and_answers_and_folds_tables_by_region(
    folder: Path,
) -> None:
    text = (folder / "report.html").read_text(encoding="utf-8")
    titles = re.findall("<h2>(.*?)</h2>", text)
    assert titles[:3] == ["Verdicts", "Answers", "The drive"]
    folded = re.findall("<details><summary>(.*?)</summary>(.*?)</details>", text, re.DOTALL)
    regions = [(title, table) for title, table in folded if ": " in title]
    assert len(regions) > 3
    for title, table in regions:
        names = re.findall(r"largest\.\w+ in ([\w ]+)<", table)
        assert names and set(names) == {title.split(": ")[1]}


@pytest.mark.parametrize(
    "value, error, text",
    [
        (31.403, 0.18, "31.40"),
        (3.6611, 1.5, "3.7"),
        (123456.0, 3500.0, "123500"),
        (-0.001, 0.5, "0.00"),
        (2043.21, None, "2043.2"),
        (134628.0, None, "134630"),
        (-1.5e8, None, "-150000000"),
        (2.3541e17, None, "2.3541e+17"),
        (1.234e-5, None, "1.234e-05"),
        (2043.21, 0.0, "2043.2"),
        (None, 1.0, "—"),
    ],
)
def test_a_value_has_the_digits_of_its_error(
    value: float | None, error: float | None, text: str
) -> None:
    assert value_text(value, error) == text


def test_the_transmission_error_with_deviations_is_an_answer(folder: Path) -> None:
    summary = swgpar.open_result(folder).summary
    torque = TorqueOverTurns(mean=1.0, peak_to_peak=0.0, spectrum=())
    error = TransmissionError(
        turns=1.0,
        angles=8,
        peak_to_peak=44.55,
        amplitude=22.3,
        mean=0.0,
        spectrum=(),
        torque=torque,
    )
    summary = replace(summary, transmission_error=error)
    assert summary["transmission_error.peak_to_peak"].value == 44.55
    assert (
        summary["rotation.transmission_error"].value == summary.rotation.transmission_error_arcsec
    )
    assert "1 turns with deviations" in list(summary.transmission_error.remarks())


def test_the_largest_of_the_regions_is_the_largest_of_the_body(folder: Path) -> None:
    summary = swgpar.open_result(folder).summary
    for stress in ("fs_s1", "fs_vm", "rg_vm"):
        regions = {
            name: place
            for name, place in summary.stresses.regions.items()
            if name.startswith(f"{stress} in ")
        }
        name, place = max(regions.items(), key=lambda item: item[1].value)
        largest = summary.stresses.places[stress]
        assert place == largest and name.endswith(f" in {largest.region}")
        assert len(regions) > 3 and all(
            place.region == name.split(" in ", 1)[1] for name, place in regions.items()
        )
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert (
        "ring gear, von Mises stress in outer surface" in text
        and "Not asked for: torsional stiffness" in text
    )


def test_verdicts_follow_the_numbers(folder: Path) -> None:
    result = swgpar.open_result(folder)
    summary = result.summary

    def verdicts(**changed: object) -> dict[str, bool | None]:
        return {c.name: c.good for c in checks(replace(summary, **changed), result.history)}

    assert verdicts()["balance of torques"] and verdicts()["elements"]
    largest = float(np.abs(result.history["tooth_torque_Nmm"]).max())
    numerics = replace(summary.numerics, balance_error_Nmm=0.01 * largest)
    assert verdicts(numerics=numerics)["balance of torques"] is False
    assert (
        verdicts(rotation=replace(summary.rotation, jammed="the teeth may jam"))["energy"] is False
    )
    on_edge = replace(summary.contact.largest, edge=1)
    assert verdicts(contact=replace(summary.contact, largest=on_edge))["edge contact"] is False
    assert verdicts(contact=replace(summary.contact, largest=None))["edge contact"] is None
    assert verdicts(contact=None)["edge contact"] is None
    root = RootStress(
        s1=100.0,
        error=20.0,
        on_mesh=90.0,
        region="tooth root",
        tooth=1,
        radius=20.0,
        z=0.0,
        angle_deg=0.0,
        part=BETWEEN,
        by_part={BETWEEN: [100.0]},
        elements=1000,
        drive_error=1.0,
    )
    assert verdicts(root_stress=root)["resolution"] is False
    assert verdicts(root_stress=replace(root, error=2.0))["resolution"] is True
    module = np.full(len(result.history["step"]), summary.design.drive.module)
    deep = {**result.history, "max_penetration_mm": module}
    assert {c.name: c.good for c in checks(summary, deep)}["penetration"] is False


def test_what_friction_takes_is_judged_where_it_is_known(folder: Path) -> None:
    """The input torque gains 8 N·mm; friction takes 2, 6 or an unknown part of them."""
    result = swgpar.open_result(folder)
    summary, history = result.summary, result.history
    design = summary.design.with_values({"contact.friction": 0.1, "steps.rotation": 18.0})
    rotation = replace(summary.rotation, means={"wg_torque_Nmm": 58.0}, wg_torque_expected_Nmm=50.0)

    def verdict(friction: float | None, half: float = 0.0) -> tuple[bool | None, str]:
        parts = LossParts(flank_friction=friction or 0.0, hysteresis=0.0, bearing=0.0)
        losses = DriveLosses(
            loss_torque_Nmm=2.0,
            parts_Nmm=parts,
            efficiency=0.9,
            no_load_torque_Nmm=None,
            work_per_turn_J=0.1,
            power_W=1.0,
            cam_force_N=100.0,
            flank_friction_coefficient=0.1,
        )
        of_angles = replace(rotation, sampling_error={"wg_torque_Nmm": half})
        judged = replace(summary, design=design, rotation=of_angles, losses=friction and losses)
        (energy,) = (c for c in checks(judged, history) if c.name == "energy")
        return energy.good, energy.text

    good, text = verdict(2.0)
    assert good is False
    assert text.endswith("2 N·mm by friction of the flanks; good within 2.5 N·mm")
    assert verdict(6.0)[0] is True and verdict(2.0, half=4.0)[0] is True
    assert verdict(None)[0] is True


def test_the_first_line_is_not_green_without_a_verdict_on_strength(folder: Path) -> None:
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "The strength of the drive is not judged." in text
    assert '<p class="ok">' not in text


@pytest.mark.parametrize("name", ["cup_45deg", "plane_half_turn"])
def test_drawings_have_the_dimensions(name: str) -> None:
    design = swgpar.load_design(DRIVERS / f"{name}.toml")
    drawings = draw_drive(design)
    outer = design.profile("ring_gear").r_root_circle + design.ring_gear.rim
    texts = [text.text for sheet in drawings for text in sheet.texts]
    for value in (
        f"⌀ {2 * outer:.4g}",
        f"{2 * design.major_semi_axis:.5g}",
        f"{design.flexible_spline.rim:.4g} rim",
    ):
        assert value in texts
    for outline in (outline for sheet in drawings for outline in sheet.outlines):
        numbers = [float(number) for number in re.findall(r"-?\d+\.\d\d", outline.path)]
        assert numbers and min(numbers) > 0.0 and max(numbers) < 700.0  # nothing is drawn outside


def test_rollers_are_drawn_as_circles() -> None:
    design, _ = starter_design(Request(60.0, 10.0, diameter=60.0, cam="four_roller"))
    front, _, _ = draw_drive(design)
    (rollers,) = (one.path for one in front.outlines if one.body == "wave_generator")
    curves, radius = rollers.split("Z")[:-1], front.scale * design.wave_generator.r_4
    assert len(curves) == 4
    for curve in curves:
        x, y = np.array(re.findall(r"-?\d+\.\d\d", curve), dtype=float).reshape(-1, 2).T
        assert np.hypot(x - x.mean(), y - y.mean()) == pytest.approx(radius, abs=0.02)


@pytest.mark.parametrize("gear", ["flexible_spline", "ring_gear"])
def test_the_surface_of_all_sectors_is_that_of_the_body(gear: str) -> None:
    mesh = build_sector_meshes(swgpar.load_design(DESIGN).geometry, load_recipe(RECIPE))[gear]
    triangles = sector_surface(mesh.coords, mesh.hexes)
    a, b, c = (mesh.coords[triangles[:, k]] for k in range(3))
    area = mesh.n_sectors * 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
    whole = swgpar.mesh(DESIGN, RECIPE).bodies[gear]
    kinds = np.full(len(whole.cells), pyvista.CellType.HEXAHEDRON)
    cells = np.hstack([np.full((len(whole.cells), 1), 8), whole.cells]).ravel()
    grid = pyvista.UnstructuredGrid(cells, kinds, whole.points)
    assert area == pytest.approx(
        grid.extract_surface(algorithm="dataset_surface").triangulate().area, rel=1e-3
    )


def test_the_view_of_a_folder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result = swgpar.open_result(folder)
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(InputError, match="view needs a display"):
        result.view()
    plotter = view_plotter(result, off_screen=True)
    picture = plotter.screenshot(return_img=True)
    plotter.close()
    assert picture.std() > 10.0  # something is drawn


def test_pictures_say_nothing_of_displays(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    plotter = off_screen_plotter(40, 30)
    assert plotter.screenshot(return_img=True).shape[:2] == (30, 40)
    plotter.close()
    captured = capfd.readouterr()
    assert captured.err == "" and captured.out == ""


def test_the_stress_around_the_spline_is_that_of_the_history(folder: Path) -> None:
    result = swgpar.open_result(folder)
    upper, lower = result.plot.stress_around().axes
    for axes, name in ((upper, "fs_s1"), (lower, "fs_vm")):
        largest = max(np.max(line.get_ydata()) for line in axes.lines)
        assert largest == pytest.approx(
            result.history[name][result.field_increments[-1] - 1], rel=1e-5
        )


def test_the_close_up_shows_a_spline_that_lies_on_the_cam(folder: Path) -> None:
    result = swgpar.open_result(folder)
    design = result.summary.design
    wg_angle = np.radians(result.history["wg_angle_deg"][-1])
    spline, _ = deformed([result.grid(-1, body, whole=True) for body in GEARS], 1.0)
    distance = design.cam_surface().evaluate(rotated(np.asarray(spline.points), -wg_angle))[0]
    # nodes of a coarse mesh lie up to the sagitta of its facets inside of the cam
    assert -0.02 * design.drive.module < distance.min() < 0.02 * design.drive.module
    assert result.plot.loaded_teeth().axes[0].get_ylabel() == "radius (mm)"


def test_the_report_of_a_gear_train(tmp_path: Path) -> None:
    result = swgpar.run(DRIVERS / "ring_supported.toml", out=tmp_path / "ring")
    text = (tmp_path / "ring" / "report.html").read_text(encoding="utf-8")
    assert_needs_nothing_else(text)
    answer = next(iter(result.summary.values()))
    assert (
        answer.name in text
        and answer.text in text
        and value_text(answer.value, answer.error) in text
    )
