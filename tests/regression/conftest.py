"""The uninterrupted run that the tests of this folder compare with."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.commands import run_command, succeed


@pytest.fixture(scope="session")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("plain") / "run"
    succeed([*run_command(out), "output.fields=true", "output.figures=true"])
    return out
