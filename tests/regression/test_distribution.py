"""An sdist, the wheel built from it, and that wheel in an empty environment: all sources and data
files are there."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest

from support.commands import environment
from support.paths import DESIGN, ROOT

PARTS = ("CMakeLists.txt", "MANIFEST.in", "CHANGELOG.md", "CITATION.cff", "LICENSE", "README.md")
BUILD = ("pyproject.toml", "setup.cfg", "setup.py")
HOOK = (
    "import sys; from scikit_build_core.setuptools import build_meta; "
    "build_meta.build_{}(sys.argv[1])"
)


def sources(*suffixes: str) -> set[str]:
    return {
        str(path.relative_to(ROOT))
        for path in (ROOT / "swgpar").rglob("*")
        if path.suffix in suffixes
    }


def call(command: list[object], cwd: Path, **variables: str) -> str:
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        capture_output=True,
        text=True,
        env={**environment(), **variables},
    )
    assert done.returncode == 0, done.stderr + done.stdout
    return done.stdout


def build(kind: str, source: Path, folder: Path) -> Path:
    """An sdist or a wheel, with kernels that are compiled fast."""
    folder.mkdir()
    call(
        [sys.executable, "-c", HOOK.format(kind), folder], source, SKBUILD_CMAKE_BUILD_TYPE="Debug"
    )
    (made,) = folder.iterdir()
    return made


@pytest.fixture(scope="module")
def sdist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sdist")
    source = folder / "checkout"
    shutil.copytree(ROOT / "swgpar", source / "swgpar")
    for name in (*PARTS, *BUILD):
        shutil.copy(ROOT / name, source)
    return build("sdist", source, folder / "dist")


def test_sdist_has_all_sources(sdist: Path) -> None:
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {*PARTS, *BUILD} <= names
    assert sources(".py", ".pyx", ".hpp", ".c", ".toml", ".typed") <= names
    assert not [name for name in names if name.endswith((".so", ".pyc"))]


def test_wheel_runs_in_an_empty_environment(sdist: Path, tmp_path: Path) -> None:
    """The packages that it needs are those of this environment, which come after what the new one
    has."""
    shutil.unpack_archive(sdist, tmp_path)
    (unpacked,) = tmp_path.iterdir()
    wheel = build("wheel", unpacked, tmp_path / "dist")
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    assert sources(".py", ".c", ".toml", ".typed") <= names
    assert len([name for name in names if name.endswith(".so")]) == len(sources(".pyx"))

    venv.create(tmp_path / "empty", symlinks=True)
    python = tmp_path / "empty" / "bin" / "python"
    call(
        [
            sys.executable,
            "-m",
            "pip",
            "--python",
            python,
            "install",
            "--no-deps",
            "--no-index",
            wheel,
        ],
        tmp_path,
    )
    packages = Path(
        call(
            [python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"], tmp_path
        ).strip()
    )
    others = [path for path in sys.path if path and ROOT not in (Path(path), Path(path).parent)]
    (packages / "others.pth").write_text("\n".join(others), encoding="utf-8")
    variables = {
        "PYTHONPATH": "",
        "PYTHONNOUSERSITE": "1",
        "HOME": str(tmp_path),
        "PATH": os.environ["PATH"],
    }
    found = call(
        [python, "-c", "import swgpar.kernel._elements as m; print(m.__file__)"],
        tmp_path,
        **variables,
    )
    assert found.startswith(str(packages))
    command = tmp_path / "empty" / "bin" / "swgpar"
    told = call([command, "check", DESIGN, "--mesh", "coarse"], tmp_path, **variables)
    assert "unknowns" in told
