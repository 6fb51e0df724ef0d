"""Every study of the repository expands into designs, and drives into meshes that can be built;
nothing is run."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from support.paths import DRIVERS
from swgpar.meshing import build_sector_meshes
from swgpar.studies.case import Job
from swgpar.studies.cases import expand
from swgpar.studies.spec import load_study
from swgpar.systems import system_of_section

FILES = sorted((DRIVERS / "studies").glob("*.toml"))
REFUSED = {
    ("double_arc", "r_dedendum=0.8"): "no root land is left",
    ("four_roller", "r_4=10"): "where the rollers touch",
    ("quadruple_arc", "r_addendum=0.9"): "r_tip = 0.3 with r_addendum = 0.9 does not meet",
    ("quadruple_arc", "r_root=0.7"): "no root land is left",
}
"""Cases that show a refusal."""


@cache
def jobs_of(path: Path) -> list[Job]:
    return expand(load_study(path))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_geometry(path: Path) -> None:
    jobs = jobs_of(path)
    refused = {
        (path.stem, job.case.name): job.case.refusal for job in jobs if job.case.design is None
    }
    meant = {case: words for case, words in REFUSED.items() if case[0] == path.stem}
    assert refused.keys() == meant.keys()
    assert all(words in refused[case] for case, words in meant.items())
    given = [
        (job.case.design.geometry, job.recipe)
        for job in jobs
        if job.case.design is not None and job.recipe is not None
    ]
    # cases that differ in what acts have one mesh
    for geometry, recipe in {repr(each): each for each in given}.values():
        assert len(build_sector_meshes(geometry, recipe)) == 2


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_one_period(path: Path) -> None:
    """Means of the plane model are over one period in 8 angles; cases at 45 degrees end there in
    their period."""
    for case in {job.case.name: job.case for job in jobs_of(path)}.values():
        if (
            case.system is not system_of_section("drive")
            or case.design is None
            or case.design.drive.model != "plane"
        ):
            continue
        drive, steps = case.design.drive, case.design.steps
        if (
            case.design.deviations is not None or case.design.has_program
        ):  # whole turns, or no rotation
            continue
        period = 360.0 / (drive.teeth_rg if drive.layout == "ring_fixed" else drive.teeth_fs)
        share, count = (45.0 / period % 1.0, 1) if "45deg" in case.name else (1.0, 8)
        assert steps.rotation == pytest.approx(share * period, rel=1e-12)
        assert steps.samples or steps.increment == pytest.approx(steps.rotation / count, rel=1e-14)
