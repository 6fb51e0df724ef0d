"""The steps of the page "Own preconditioner", in a copy of the package."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from support.commands import execute, run_command
from support.markdown import examples
from support.paths import ROOT
from support.small_drive import PLANE

PAGE = ROOT / "docs" / "howto" / "own_preconditioner.md"
SHORT = ("steps.rotation=2.0", "steps.increment=2.0")


def replace(path: Path, pattern: str, text: str) -> None:
    """Replace what stands once in a file."""
    source, count = re.subn(pattern, text, path.read_text(encoding="utf-8"))
    assert count == 1, path
    path.write_text(source, encoding="utf-8")


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
    """Class, entry of the registry and value of the key: three files."""
    package = tmp_path / "swgpar"
    shutil.copytree(ROOT / "swgpar", package, ignore=shutil.ignore_patterns("__pycache__"))
    _, code, registry, key = examples(PAGE, "python")
    (package / "solve" / "block_jacobi.py").write_text(code, encoding="utf-8")
    solvers, sections = package / "solve" / "linear_solvers.py", package / "design" / "sections.py"
    line = "from swgpar.solve.factors import"
    replace(solvers, line, f"from swgpar.solve.block_jacobi import BlockJacobi\n{line}")
    replace(solvers, r"LINEAR_SOLVERS: [^}]*\}\n", registry)
    replace(sections, r"Literal\[\"direct\", \"iterative\"\]", re.search(r"Literal\[.*?\]", key)[0])
    command = run_command(
        tmp_path / "run", overrides=(*PLANE, *SHORT, "solver.linear=block_jacobi")
    )
    done = execute(command, timeout=300.0, cwd=tmp_path, PYTHONPATH=str(tmp_path))
    assert done.returncode == 0, done.stderr
