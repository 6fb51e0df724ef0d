"""Contacts after a restart differ by Newton's tolerance: the page on restarts has the bound."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import swgpar
from support.paths import DESIGN, RECIPE, ROOT
from support.small_drive import PLANE
from swgpar.results.table import read_columns

BOUND = 1.4e-5


def test_contacts_after_a_restart_are_those_without_one(tmp_path: Path) -> None:
    short = (*PLANE, "steps.increment=2.0", "output.figures=false")
    for out, rotations in (("whole", (6.0,)), ("continued", (4.0, 6.0))):
        for rotation in rotations:
            design = swgpar.load_design(DESIGN, [*short, f"steps.rotation={rotation}"])
            swgpar.run(design, RECIPE, tmp_path / out, restart=rotation != rotations[0])
    for name in ("pairs.csv", "contact_lines.csv"):
        whole, continued = (read_columns(tmp_path / out / name) for out in ("whole", "continued"))
        assert list(whole) == list(continued)
        for column, values in whole.items():
            if values.dtype.kind == "f":
                change = np.nanmax(np.abs(values - continued[column]), initial=0.0)
                assert change <= BOUND * np.nanmax(np.abs(values), initial=1e-300), column


def test_the_page_on_restarts_has_the_bound() -> None:
    text = (ROOT / "docs" / "howto" / "restart.md").read_text(encoding="utf-8")
    assert "by up to 1.4e-5 of the largest value" in " ".join(text.split())
