"""Start of PETSc: no file that nobody named, wherever it is started from."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from support.commands import environment, execute, run_command, succeed, swgpar
from support.paths import DESIGN, RECIPE, ROOT
from support.small_drive import PLANE

FOUND = "from swgpar.petsc import PETSc; print(PETSc.Options().getAll())"


@pytest.fixture
def hostile(tmp_path: Path) -> Path:
    """A working directory and home with files that PETSc would read and execute."""
    for name in (".petscrc", "petscrc"):
        (tmp_path / name).write_text(
            f"-dll_prepend {tmp_path}/evil.so\n-found {name}\n", encoding="utf-8"
        )
    return tmp_path


def options_of(code: str, cwd: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    variables = {**environment(), "HOME": str(cwd), **variables}
    command = [sys.executable, "-P", "-c", code]
    return subprocess.run(
        command, capture_output=True, text=True, cwd=cwd, env=variables, timeout=120
    )


def test_no_file_is_read(hostile: Path) -> None:
    done = options_of(FOUND, hostile)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "{'skip_petscrc': None}" and not done.stderr


@pytest.mark.parametrize("command", ["check", "mesh", "run"])
def test_commands_in_a_hostile_directory(tmp_path: Path, command: str) -> None:
    """Whoever opens one of these pipes waits for ever: PETSc, and the one that Gmsh brings."""
    for name in (".petscrc", "petscrc"):
        os.mkfifo(tmp_path / name)
    out = [] if command == "check" else ["--out", tmp_path / "out"]
    overrides = (*PLANE, "steps.rotation=2.0", "steps.increment=2.0")
    full = swgpar(command, DESIGN, "--mesh", RECIPE, *out, "--set", *overrides)
    succeed(full, cwd=tmp_path, HOME=str(tmp_path), timeout=120.0)


def test_the_environment_gives_options_but_names_no_file(hostile: Path) -> None:
    assert "'given': '1'" in options_of(FOUND, hostile, PETSC_OPTIONS="-given 1").stdout
    for words in ("-options_file x", "-Options_File x", "-dll_append x"):
        done = options_of(FOUND, hostile, PETSC_OPTIONS=words)
        assert done.returncode == 1
        assert (
            f"PETSC_OPTIONS holds {words.split()[0]}: files are named on the command line only"
            in done.stderr
        )


def test_files_of_the_command_line_are_read(tmp_path: Path) -> None:
    (tmp_path / "mine").write_text("-given 2\n", encoding="utf-8")
    start = (
        "from swgpar import petsc; petsc.start(['-before', 'a', '-options_file', 'mine', '-after', "
        "'b c']); "
    )
    found = ast.literal_eval(
        options_of(start + FOUND, tmp_path).stdout.splitlines()[0]
    )  # PETSc may comment behind it
    assert found["before"] == "a" and found["given"] == "2" and found["after"].startswith("b")
    (tmp_path / "mine").write_text("given 2\n", encoding="utf-8")
    assert (
        "options of PETSc: Unknown first token"
        in options_of(start + FOUND, tmp_path).stderr.splitlines()[-1]
    )
    os.remove(tmp_path / "mine")
    assert "-options_file mine: there is no such file" in options_of(start + FOUND, tmp_path).stderr


@pytest.mark.parametrize(
    ("ranks", "option", "words"),
    [
        (
            1,
            "-stiffness_ksp_type nonsense",
            "-stiffness_ksp_type nonsense: Unable to find requested KSP type nonsense",
        ),
        (
            2,
            "-stiffness_mat_mumps_icntl_7 abc",
            "-stiffness_mat_mumps_icntl_7 abc: Input string abc has no",
        ),
        (1, "-snes_lag_jacobian 2x", "-snes_lag_jacobian 2x: Input string 2x has no integer value"),
        (2, "-snes_max_it 0", "-snes_max_it is not available, as the program decides when"),
        (2, "-malloc_debug maybe", "Unknown logical value: maybe"),
        (
            1,
            "-stiffness_pc_type jacobi -stiffness_ksp_type preonly",
            "-stiffness_ksp_type preonly solves with lu or cholesky alone",
        ),
        (2, "-stiffness_pc_type ilu", "type ILU and matrix type mpiaij"),
        (2, "-stiffness_pc_type icc", "-stiffness_pc_type icc: Could not locate a solver type"),
        (
            2,
            "-stiffness_pc_factor_mat_solver_type petsc",
            "-stiffness_pc_factor_mat_solver_type petsc: MatSolverType petsc does not support",
        ),
        (1, "-options_file nowhere", "-options_file nowhere: there is no such file"),
    ],
)
def test_options_that_cannot_be_used_are_refused(
    tmp_path: Path, ranks: int, option: str, words: str
) -> None:
    done = execute(run_command(tmp_path / "run", *option.split(), ranks=ranks), timeout=300.0)
    (sentence,) = done.stderr.splitlines()
    assert done.returncode == 2 and sentence.startswith("swgpar: error: ") and words in sentence


@pytest.mark.parametrize(
    "options",
    [
        "-stiffness_pc_factor_mat_solver_type petsc",
        "-stiffness_ksp_type cg -stiffness_pc_type bjacobi",
        "-stiffness_ksp_type minres -stiffness_pc_type sor",
    ],
)
def test_other_linear_solvers_solve(tmp_path: Path, options: str) -> None:
    """`tests/mpi/test_linear.py` tries all of them on one system."""
    short = (*PLANE, "steps.rotation=2.0", "steps.increment=2.0")
    done = succeed(run_command(tmp_path / "run", *options.split(), overrides=short))
    assert "nothing has used" not in done.stdout and not done.stderr


def test_a_linear_solver_that_fails_is_named(tmp_path: Path) -> None:
    more = ("solver.max_cutbacks=0",)
    options = ("-stiffness_pc_type", "jacobi", "-stiffness_ksp_max_it", "100")
    done = execute(
        run_command(tmp_path / "run", *options, overrides=(*PLANE, *more)), timeout=300.0
    )
    (sentence,) = done.stderr.splitlines()
    assert done.returncode == 3 and "linear solver (gmres with jacobi): DIVERGED_MAX_IT" in sentence


@pytest.mark.parametrize("ranks", [1, 2])
def test_options_that_nothing_uses_are_named(tmp_path: Path, ranks: int) -> None:
    words = (
        "-snes_monitorr",
        "-snes_lag_jacobian",
        "1",
        "-stiffness_ksp_max_it",
        "abc",
        "-options_left",
        "0",
    )
    short = (*PLANE, "steps.rotation=2.0", "steps.increment=2.0")
    done = succeed(run_command(tmp_path / "run", *words, ranks=ranks, overrides=short))
    sentence = "options of PETSc that nothing has used: -snes_monitorr, -stiffness_ksp_max_it"
    assert [
        line.partition("  ")[2] for line in done.stdout.splitlines() if "nothing has used" in line
    ] == [sentence]
    assert sentence in (tmp_path / "run" / "run.log").read_text(encoding="utf-8")


def test_a_gear_train_uses_no_options_of_petsc(tmp_path: Path) -> None:
    command = swgpar(
        "run", ROOT / "drivers" / "ring_modes.toml", "--out", tmp_path / "ring", "-snes_monitor"
    )
    done = succeed([*command, "--set", "output.figures=false"])
    assert "options of PETSc that nothing has used: -snes_monitor" in done.stdout


def test_petsc_is_started_in_one_place() -> None:
    """Nothing else imports petsc4py, which would start it with the files of the working
    directory."""
    found = [
        str(path.relative_to(ROOT))
        for folder in ("swgpar", "tests", "scripts", "drivers", "docs")
        for path in sorted((ROOT / folder).rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Import)
        and any(alias.name.startswith("petsc4py") for alias in node.names)
        or isinstance(node, ast.ImportFrom)
        and (node.module or "").startswith("petsc4py")
    ]
    assert set(found) == {"swgpar/petsc.py"}
