"""Every script of the gallery runs on two ranks; `scripts/docs` runs them on one."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from support.commands import on_ranks, succeed
from support.paths import ROOT

SCRIPTS = sorted((ROOT / "docs" / "gallery").glob("plot_*.py"))


def test_there_are_scripts() -> None:
    assert len(SCRIPTS) >= 12


@pytest.mark.parametrize("script", SCRIPTS, ids=[script.stem for script in SCRIPTS])
def test_the_script_runs(script: Path, tmp_path: Path) -> None:
    succeed([*on_ranks(2), sys.executable, str(script)], cwd=tmp_path)
    assert not list(tmp_path.iterdir()), "a script of the gallery leaves no files"
