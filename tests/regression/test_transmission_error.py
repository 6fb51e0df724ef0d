"""Transmission error through the Python interface: files, summary, figures, restart, studies."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.results.folder import SUMMARY

RATIO, TEETH_RG = -20.0, 42
OVAL = (
    "deviations.ring_gear.ovality=0.02",
    'deviations.mesh="same"',
    "steps.bent_start=true",
    "steps.rotation=0",
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("oval")
    swgpar.run(
        swgpar.load_design(DESIGN, [*PLANE, *OVAL]),
        mesh=RECIPE,
        out=out,
        plain=True,
        overwrite=True,
    )
    return out


def test_a_turn_with_deviations(folder: Path) -> None:
    result = swgpar.open_result(folder)
    rows, summary = result.transmission_error, result.summary.transmission_error
    assert len(
        rows["wg_angle_deg"]
    ) == TEETH_RG == summary.angles and summary.turns == pytest.approx(1.0)
    assert rows["wg_angle_deg"] == pytest.approx(360.0 / TEETH_RG * np.arange(TEETH_RG))
    error = 3600.0 * (rows["output_angle_deg"] - rows["wg_angle_deg"] / RATIO)
    assert rows["transmission_error_arcsec"] == pytest.approx(error, abs=1e-6)
    assert (
        summary.peak_to_peak
        == pytest.approx(np.ptp(error))
        == pytest.approx(2.0 * summary.amplitude)
    )
    # an oval ring gear repeats after half a turn: the second half is known
    assert (rows["newton_iterations"][TEETH_RG // 2 :] == 0).all()
    first = summary.spectrum[0]
    assert (first.order, first.cause) == (2.0, "ring gear (ovality), 2 per turn against it")
    assert summary.torque.mean == pytest.approx(rows["wg_torque_Nmm"].mean())
    assert "transmission_error_spectrum" in result.plot.names
    assert result.plot.transmission_error_spectrum() is not None


def test_an_interrupted_turn_is_continued(folder: Path) -> None:
    path = folder / "transmission_error.csv"
    before = path.read_text().splitlines()
    path.write_text("\n".join(before[:15]) + "\n")
    (folder / SUMMARY).unlink()
    design = swgpar.load_design(DESIGN, [*PLANE, *OVAL])
    result = swgpar.run(design, mesh=RECIPE, out=folder, plain=True, restart=True)
    assert path.read_text().splitlines()[:15] == before[:15]
    expected = np.array([line.split(",") for line in before[1:]], dtype=float)
    assert result.transmission_error["output_angle_deg"] == pytest.approx(expected[:, 1], abs=1e-9)
    assert result.transmission_error["wg_torque_Nmm"] == pytest.approx(expected[:, 3], rel=1e-6)


def test_the_period_of_an_ideal_drive() -> None:
    design = swgpar.load_design(
        DESIGN, [*PLANE, "steps.bent_start=true", "steps.samples=4", "steps.rotation=9"]
    )
    result = swgpar.run(design, mesh=RECIPE, plain=True)
    summary = result.summary.transmission_error
    assert summary.peak_to_peak == pytest.approx(result.summary.rotation.transmission_error_arcsec)
    ripple = summary.torque.peak_to_peak / abs(summary.torque.mean)
    assert ripple == pytest.approx(result.summary.rotation.torque_ripple)
    assert sorted(line.order for line in summary.spectrum) == pytest.approx([42.0, 84.0])
    assert summary.spectrum[0].cause.startswith("mesh of the teeth")


def test_a_study_over_deviations(tmp_path: Path) -> None:
    study = tmp_path / "study.toml"
    keys = [*PLANE, *OVAL[1:], "deviations.ring_gear.ovality=0.01"]
    changes = [key.replace('"', "'") for key in keys]
    study.write_text(
        f'[study]\ndesign = "{DESIGN}"\nmeshes = ["{RECIPE}"]\nset = {changes}\n'
        'quantities = ["transmission_error.peak_to_peak"]\n'
        "[study.vary]\ndeviations.ring_gear.ovality_direction = [0.0, 180.0]\n"
    )
    table = swgpar.study(study, tmp_path / "out").table
    values = table["transmission_error.peak_to_peak"]
    assert values[0] == pytest.approx(values[1], rel=1e-6) and values[0] > 0.0
