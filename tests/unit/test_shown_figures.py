"""Figures that users ask for are those of pyplot, files need none; every page of the gallery has
one. Lines go through three points or more, and titles say what is shown."""

from __future__ import annotations

import io
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.figure import Figure

import swgpar
from support.paths import DATA, ROOT
from swgpar.drive_results.drive_data import DriveData
from swgpar.evaluation.transmission_error import TorqueOverTurns, TransmissionError
from swgpar.gear_trains.drawing import MomentCurve, draw_moments
from swgpar.presentation.ball_figure import draw_ball_loads
from swgpar.presentation.contact_figures import draw_load_sharing
from swgpar.presentation.program_figures import torque_against_rotation
from swgpar.results.figure_set import from_zero, plot_line
from swgpar.results.history import Curves

CONF = """
import sys
sys.path.insert(0, {extensions!r})
extensions = ["sphinx_gallery.gen_gallery", "gallery_hooks"]
sphinx_gallery_conf = {{"examples_dirs": "gallery", "gallery_dirs": "auto_gallery"}}
"""

PAGE = '"""\nTitle\n=====\n"""\n\nimport matplotlib.pyplot as plt\n\n{}\nplt.show()\n'


def test_plt_show_has_the_figures_of_a_result_and_files_leave_none(tmp_path: Path) -> None:
    pyplot.close("all")
    plot = _result().plot
    plot.save(tmp_path)
    assert pyplot.get_fignums() == [] and list(tmp_path.rglob("*.png"))
    figure = plot.stress()
    assert [pyplot.figure(number) for number in pyplot.get_fignums()] == [figure]
    pyplot.close("all")


def test_pyplot_keeps_the_newest_figures_without_a_warning(
    recwarn: pytest.WarningsRecorder,
) -> None:
    pyplot.close("all")
    plot = _result().plot
    with pyplot.rc_context({"figure.max_open_warning": 3}):
        mine = pyplot.figure()
        made = [plot.stress() for _ in range(5)]
        assert [pyplot.figure(number) for number in pyplot.get_fignums()] == [mine, *made[-2:]]
    assert not [warning for warning in recwarn if "opened" in str(warning.message)]
    made[0].savefig(io.BytesIO())
    pyplot.close("all")


@pytest.mark.parametrize("line, shown", [("plt.plot([1, 2])", True), ("", False)])
def test_a_page_of_the_gallery_without_a_figure_fails_the_build(
    line: str, shown: bool, tmp_path: Path
) -> None:
    pytest.importorskip("sphinx_gallery")
    extensions = str(ROOT / "docs" / "_extensions")
    (tmp_path / "conf.py").write_text(CONF.format(extensions=extensions))
    (tmp_path / "index.rst").write_text("Index\n=====\n")
    (tmp_path / "gallery").mkdir()
    (tmp_path / "gallery" / "GALLERY_HEADER.rst").write_text("Gallery\n=======\n")
    (tmp_path / "gallery" / "plot_one.py").write_text(PAGE.format(line))
    command = [sys.executable, "-m", "sphinx", "-q", str(tmp_path), str(tmp_path / "html")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.returncode == 0) is shown, done.stderr
    assert ("no figure: plot_one" in done.stderr) is not shown


def _result() -> swgpar.DriveResult:
    return swgpar.open_result(next((DATA / "first_format").iterdir()))


def _joined(figure: Figure, panel: int = 0) -> list[np.ndarray]:
    """Places (n, 2) of the lines of a panel that are more than marks and have no constant value."""
    lines = [line for line in figure.axes[panel].lines if line.get_linestyle() != "None"]
    return [line.get_xydata() for line in lines if np.ptp(line.get_ydata()) > 0.0]


@pytest.mark.parametrize("points, lines", [(2, 0), (3, 1)])
def test_no_line_goes_through_two_points(
    points: int, lines: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    angle = np.arange(float(points))
    column = {"wg_torque_Nmm": angle**2}
    monkeypatch.setattr(DriveData, "curves", lambda self: Curves(angle, column, angle, column))
    assert len(_joined(_result().plot.torque())) == lines
    balls = {
        "step": np.full(points, 4.0),
        "increment": np.arange(points),
        "ball": np.zeros(points),
        "cam_angle_deg": angle,
        "wg_angle_deg": angle,
        "load_N": 1.0 + angle,
    }
    assert len(_joined(draw_ball_loads(balls, None, "angle"), 1)) == lines
    program = {
        "stage": np.full(points, "loading"),
        "rotation_arcmin": angle,
        "torque_Nm": angle**2,
    }
    figure = torque_against_rotation(program, SimpleNamespace(stiffness=None, ratcheting=None))
    assert len(_joined(figure)) == lines
    pairs = {
        "angle_deg": angle,
        "force_share": angle,
        "flank": np.full(points, "clockwise"),
        "increment": angle + 1.0,
    }
    history = {"wg_angle_deg": angle, "pairs_in_contact": angle}
    assert len(_joined(draw_load_sharing(pairs, history, "angle"), 1)) == lines
    figure = draw_moments("title", "time", [MomentCurve(angle, angle, angle, "label")])
    assert len(_joined(figure)) == len(_joined(figure, 1)) == lines


def test_a_constant_does_not_lie_on_the_edge_of_its_panel() -> None:
    axes = Figure().subplots()
    plot_line(axes, [0.0, 1.0, 2.0], [54.0, 54.0, 54.0])
    from_zero(axes)
    low, high = axes.get_ylim()
    assert low == 0.0 and 55.0 < high < 60.0


@pytest.mark.parametrize("points, mark", [(3, "o"), (40, "None")])
def test_few_points_have_marks(points: int, mark: str) -> None:
    axes = Figure().subplots()
    assert plot_line(axes, np.arange(points), np.arange(points)).get_marker() == mark
    pyplot.close("all")


def test_ratcheting_starts_at_its_origin() -> None:
    program = {
        "stage": np.full(3, "ratcheting"),
        "rotation_arcmin": np.array([5.0, 10.0, 15.0]),
        "torque_Nm": np.array([1.0, 4.0, 3.0]),
    }
    peak = SimpleNamespace(peak_rotation_deg=0.2, peak_torque_Nm=4.2, yield_torque_Nm=2.5)
    figure = torque_against_rotation(program, SimpleNamespace(stiffness=None, ratcheting=peak))
    (line,) = _joined(figure)
    assert line.tolist() == [[0.0, 0.0], [5.0, 1.0], [10.0, 4.0], [15.0, 3.0]]
    assert figure.axes[0].get_title().startswith("ratcheting")
    assert [2.5, 2.5] in [list(line.get_ydata()) for line in figure.axes[0].lines]
    pyplot.close("all")


@pytest.mark.parametrize(
    "turns, words", [(0.02, "one period of the ideal drive"), (2.0, "2 turns with deviations")]
)
def test_titles_tell_the_ideal_drive_from_one_with_deviations(turns: float, words: str) -> None:
    result = _result()
    torque = TorqueOverTurns(mean=1.0, peak_to_peak=0.0, spectrum=())
    error = TransmissionError(
        turns=turns,
        angles=4,
        peak_to_peak=2.0,
        amplitude=1.0,
        mean=0.0,
        spectrum=(),
        torque=torque,
    )
    result.summary = replace(result.summary, transmission_error=error)
    names = "wg_angle_deg", "transmission_error_arcsec", "wg_torque_Nmm"
    result.transmission_error = dict.fromkeys(names, np.arange(4.0))
    assert words in result.plot.transmission_error_spectrum().axes[0].get_title()
    assert "ideal drive" in result.plot.transmission_error().axes[0].get_title()
    pyplot.close("all")
