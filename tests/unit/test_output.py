"""What a command writes where standard output takes nothing, or not all letters, and exports on a
full disk."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import swgpar
from support.commands import environment, execute, run_command
from support.commands import swgpar as command
from support.paths import DESIGN, RECIPE
from support.small_disk import mounted_disk
from support.small_drive import PLANE
from swgpar.errors import InputError, OutputError

SHORT = (*PLANE, "steps.rotation=2.0", "steps.increment=2.0", "output.figures=false")


def into_full(words: list[str]) -> subprocess.CompletedProcess[str]:
    """Run a command whose standard output is a device that is always full."""
    with open("/dev/full", "w") as full:
        return subprocess.run(
            words, stdout=full, stderr=subprocess.PIPE, text=True, env=environment(), timeout=300.0
        )


@pytest.mark.parametrize("run", [False, True])
def test_a_full_device_behind_the_output_has_a_sentence(tmp_path: Path, run: bool) -> None:
    words = run_command(tmp_path / "run", overrides=SHORT) if run else command("check", DESIGN)
    done = into_full(words)
    assert done.returncode == 4
    assert done.stderr == ("swgpar: error: cannot write standard output: No space left on device\n")
    if run:
        assert (tmp_path / "run" / "summary.json").exists()


def test_letters_that_the_encoding_lacks_are_escaped(tmp_path: Path) -> None:
    done = execute(command("check", DESIGN), PYTHONIOENCODING="ascii")
    assert done.returncode == 0 and r"1 \xb5m" in done.stdout and not done.stderr
    words = run_command(tmp_path / "run", overrides=SHORT)
    done = execute(words, PYTHONIOENCODING="ascii")
    assert done.returncode == 0 and done.stdout.isascii() and not done.stderr


PETSC4PY = """
import sys
def init(arguments):
    sys.stderr.write("A module that was compiled using NumPy 1.x cannot be run\\n" * 20)
    raise ImportError("numpy.core.multiarray failed to import\\nmore")
"""


def test_a_petsc4py_for_another_numpy_has_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "petsc4py").mkdir()
    (tmp_path / "petsc4py" / "__init__.py").write_text(PETSC4PY, encoding="utf-8")
    path = os.pathsep.join([str(tmp_path), *sys.path[1:], os.environ.get("PYTHONPATH", "")])
    done = execute(run_command(tmp_path / "run", overrides=SHORT), PYTHONPATH=path)
    (sentence,) = done.stderr.splitlines()
    assert done.returncode == 1 and "petsc4py cannot be loaded with NumPy" in sentence
    assert sentence.endswith("needs numpy<2")


@pytest.fixture
def full(tmp_path: Path) -> Iterator[Path]:
    """A folder on a disk with 8 kB left."""
    with mounted_disk(tmp_path / "disk", 64) as disk:
        (disk.place / "ballast").write_bytes(bytes(56 * 1024))
        yield disk.place


@pytest.mark.parametrize("kind", ["step", "dxf", "inp", "teeth", "mesh"])
def test_exports_on_a_full_disk_leave_nothing(full: Path, kind: str) -> None:
    with pytest.raises(OutputError, match="cannot (be writ|write)") as caught:
        if kind == "mesh":
            swgpar.mesh(DESIGN, RECIPE, full / "out", ["vtu", "msh"])
        else:
            mesh = RECIPE if kind == "inp" else None
            swgpar.export(DESIGN, full / "out", [kind], mesh=mesh)
    assert str(caught.value).isprintable() and ".swgpar-" not in str(caught.value)
    assert not list((full / "out").iterdir())


def test_exports_replace_files_only_when_asked(tmp_path: Path) -> None:
    own = tmp_path / "wave_generator.csv"
    own.write_text("own", encoding="utf-8")
    with pytest.raises(OutputError, match=r"wave_generator\.csv exists: replace it with overwrite"):
        swgpar.export(DESIGN, tmp_path, ["dxf", "csv"])
    assert own.read_text(encoding="utf-8") == "own"
    assert [path.name for path in tmp_path.iterdir()] == [own.name]
    paths = swgpar.export(DESIGN, tmp_path, ["csv"], overwrite=True)
    assert own in paths and own.read_text(encoding="utf-8") != "own"
    swgpar.mesh(DESIGN, RECIPE, tmp_path)
    with pytest.raises(OutputError, match=r"drive_40_42\.vtu exists"):
        swgpar.mesh(DESIGN, RECIPE, tmp_path)
    done = execute(
        command(
            "mesh", DESIGN, "--mesh", RECIPE, "--out", tmp_path, "--format", "vtu", "--overwrite"
        )
    )
    assert done.returncode == 0, done.stderr


def test_the_files_of_a_mesh_need_memory(tmp_path: Path) -> None:
    design = swgpar.load_design(DESIGN, {"solver.memory_limit": 1e-3})
    with pytest.raises(InputError, match="need about 0.00525 GB of memory: allowed are meshes"):
        swgpar.mesh(design, RECIPE, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_starter_file_of_any_name_can_be_read(tmp_path: Path) -> None:
    path = tmp_path / "a\nb = [ 'c'.toml"
    swgpar.new(path, ratio=50, diameter=42.0, torque=2.0, model="plane")
    assert swgpar.load_design(path)
