"""The steps of the page "Own preconditioner", in a copy of the package."""

from __future__ import annotations

from pathlib import Path

from support.commands import execute, run_command
from support.markdown import examples
from support.page_steps import copied_package, patch, require_count
from support.paths import ROOT
from support.small_drive import PLANE

PAGE = ROOT / "docs" / "howto" / "own_preconditioner.md"
SHORT = ("steps.rotation=2.0", "steps.increment=2.0")


def test_a_preconditioner_in_python_needs_no_change(tmp_path: Path) -> None:
    """The diagonal alone is too weak for a drive: the sentence says that it was used."""
    (tmp_path / "mine.py").write_text(examples(PAGE, "python")[0], encoding="utf-8")
    options = [
        "-stiffness_pc_type",
        "python",
        "-stiffness_pc_python_type",
        "mine.Diagonal",
        "-stiffness_ksp_max_it",
        "50",
    ]
    command = run_command(
        tmp_path / "run", *options, overrides=(*PLANE, *SHORT, "solver.max_cutbacks=0")
    )
    done = execute(command, timeout=300.0, PYTHONPATH=f"{ROOT}:{tmp_path}")
    assert done.returncode == 3 and "linear solver (gmres with python)" in done.stderr, done.stderr


def test_a_solver_is_added_as_the_page_says(tmp_path: Path) -> None:
    """Class and entry of the registry."""
    package = copied_package(tmp_path)
    (package / "solve" / "block_jacobi.py").write_text(examples(PAGE, "python")[1], "utf-8")
    (entry,) = examples(PAGE, "diff")
    patch(package / "design" / "linear_solvers.py", entry)
    require_count(PAGE, package)
    command = run_command(
        tmp_path / "run", overrides=(*PLANE, *SHORT, "solver.linear=block_jacobi")
    )
    done = execute(command, timeout=300.0, cwd=tmp_path, PYTHONPATH=str(tmp_path))
    assert done.returncode == 0, done.stderr
