"""The uninterrupted runs, plane and of the cup, that the tests of this folder compare with."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.commands import run_command, succeed
from support.small_drive import SHORT


@pytest.fixture(scope="session")
def cup(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("cup") / "run"
    succeed([*run_command(out, overrides=SHORT), "output.fields=true", "output.figures=true"])
    return out


@pytest.fixture(scope="session")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("plain") / "run"
    succeed([*run_command(out), "output.fields=true", "output.figures=true"])
    return out
