"""scripts/setup keeps an environment that is there until there is another one in its place."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from support.paths import ROOT

# makes an environment like `python -m venv FOLDER`, whose pip cannot install anything
PYTHON = """#!/bin/sh
case "$1$2" in
  -mvenv) mkdir -p "$3/bin" && printf 'include-system-site-packages = false\\n' >"$3/pyvenv.cfg"
    for name in pip python; do printf '#!/bin/sh\\nexit 1\\n' >"$3/bin/$name"; done
    chmod +x "$3/bin/pip" "$3/bin/python" ;;
esac
"""


def setup(venv: Path, home: Path, python: str) -> subprocess.CompletedProcess[str]:
    variables = {**os.environ, "SWGPAR_VENV": str(venv), "HOME": str(home), "PYTHON": python}
    variables.pop("PYENV_ROOT", None)
    command = [str(ROOT / "scripts/setup"), "--wheels"]
    return subprocess.run(command, capture_output=True, text=True, env=variables, timeout=120.0)


@pytest.fixture
def venv(tmp_path: Path) -> Path:
    """An environment of the other kind."""
    found = tmp_path / "environment"
    found.mkdir()
    (found / "pyvenv.cfg").write_text("include-system-site-packages = true\n", encoding="utf-8")
    (found / "own").touch()
    (found / ".swgpar-stamp").touch()
    return found


@pytest.fixture
def failing_python(tmp_path: Path) -> Path:
    """An interpreter that makes environments in which nothing can be installed."""
    python = tmp_path / "python"
    python.write_text(PYTHON, encoding="utf-8")
    python.chmod(0o755)
    return python


def assert_kept(venv: Path) -> None:
    assert (venv / "own").exists() and "true" in (venv / "pyvenv.cfg").read_text(encoding="utf-8")
    assert list(venv.parent.glob(f"{venv.name}*")) == [venv]


def test_without_a_python_the_environment_stays(venv: Path, tmp_path: Path) -> None:
    done = setup(venv, tmp_path, str(tmp_path / "none"))
    assert done.returncode == 3 and "no Python" in done.stderr
    assert_kept(venv)


def test_an_environment_that_cannot_be_made_gives_the_other_one_back(
    venv: Path, tmp_path: Path, failing_python: Path
) -> None:
    done = setup(venv, tmp_path, str(failing_python))
    assert done.returncode == 3 and "could not be installed" in done.stderr
    assert_kept(venv)


def test_an_environment_of_somebody_else_stays(
    venv: Path, tmp_path: Path, failing_python: Path
) -> None:
    (venv / ".swgpar-stamp").unlink()
    done = setup(venv, tmp_path, str(failing_python))
    assert done.returncode == 1 and "that scripts/setup has not made" in done.stderr
    assert_kept(venv)
