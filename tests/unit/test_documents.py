"""Documents name what exists, say what the code says, and wrap at 100 columns."""

from __future__ import annotations

import ast
import inspect
import itertools
import re
from functools import lru_cache
from pathlib import Path

import pytest

from support.paths import ROOT
from support.scripts import load_script
from swgpar.analysis.shortcuts import MESHES
from swgpar.contact.friction import Friction
from swgpar.gear_trains import cascade, gear_pair, planetary, planetary_stage, ring
from swgpar.gear_trains.train import TrainModel
from swgpar.load.load_states import LoadState
from swgpar.solve.newton import NewtonSolver
from swgpar.solve.solve_state import NewtonSettings, SolveState

DOCS = ROOT / "docs"
GRAPH = load_script(ROOT / "scripts" / "import_graph.py")
FOLDERS = ("tutorial", "howto", "theory", "reference", "developer", "verification")
TOP = [ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
PAGES = [*TOP, *sorted(page for folder in FOLDERS for page in (DOCS / folder).rglob("*.md"))]
COLUMNS = 100

by_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))


def quoted(page: Path) -> list[str]:
    """Code spans outside of code blocks."""
    text = re.sub(
        r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL
    )
    return re.findall(r"`([^`\n]+)`", text)


@lru_cache
def sources() -> str:
    folders = ("swgpar", "scripts", "tests")
    files = [
        path
        for folder in folders
        for path in (ROOT / folder).rglob("*")
        if path.suffix in (".py", ".hpp", ".pyx")
    ]
    return "\n".join(path.read_text(encoding="utf-8") for path in files)


@by_page
def test_files_and_tests_exist(page: Path) -> None:
    for name in quoted(page):
        path, _, test = name.partition("::")
        if re.fullmatch(r"[\w./]+/[\w.]+\.(py|hpp|pyx|toml|md)", path):
            places = [
                folder / path
                for folder in (ROOT, ROOT / "swgpar", ROOT / "swgpar" / "gear_trains", DOCS)
            ]
            assert any(place.exists() for place in places), name
        if test:
            assert f"def {test}(" in sources(), name


@lru_cache
def classes() -> dict[str, tuple[set[str], list[str]]]:
    """Members and bases of all classes of the package."""
    found: dict[str, tuple[set[str], list[str]]] = {}
    for path in (ROOT / "swgpar").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                members, bases = found.setdefault(node.name, (set(), []))
                bases += [ast.unparse(base).split("[")[0].split(".")[-1] for base in node.bases]
                for part in ast.walk(node):
                    if isinstance(part, ast.FunctionDef):
                        members.add(part.name)
                    elif isinstance(part, (ast.Name, ast.Attribute)) and isinstance(
                        part.ctx, ast.Store
                    ):
                        members.add(part.id if isinstance(part, ast.Name) else part.attr)
    return found


def members(name: str) -> set[str]:
    own, bases = classes().get(name, (set(), []))
    return own.union(*(members(base) for base in bases))


@by_page
def test_classes_have_their_members(page: Path) -> None:
    for name in quoted(page):
        for owner, member in re.findall(r"\b([A-Z][a-z]\w+)\.(\w+)", name):
            assert member in members(owner), name


@by_page
def test_lines_wrap(page: Path) -> None:
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), start=1):
        # a row of a table is one line, and so is a generated sentence about a design
        generated = line.startswith("|") or ": refused: " in line or ": failed: " in line
        assert len(line) <= COLUMNS or generated, f"{page.name}:{number}"


# -- statements that the code decides --------------------------------------------------------------


def table_after(page: Path, head: str) -> list[list[str]]:
    """Cells of the rows of the table that begins with `head`."""
    lines = page.read_text(encoding="utf-8").splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith(head))
    rows = itertools.takewhile(lambda line: line.startswith("|"), lines[first + 2 :])
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]


def test_who_imports_drives_and_gear_trains() -> None:
    """CONTRIBUTING.md: gear trains are imported by `systems` alone, drives by neither studies nor
    optimisation."""
    imports = GRAPH.import_graph(ROOT / "swgpar")
    assert [room for room, needs in imports.items() if "gear_trains" in needs] == ["systems"]
    for room in ("studies", "optimisation"):
        assert not imports[room] & {
            "design",
            "model",
            "evaluation",
            "drive_results",
            "presentation",
        }, room


def test_files_of_gear_trains() -> None:
    """CONTRIBUTING.md: every gear train has these files, and offers what `TrainModel` lists."""
    for package in (cascade, gear_pair, planetary, planetary_stage, ring):
        folder = Path(package.__file__).parent
        assert {"design.py", "quantities.py", "run.py", "figures.py"} <= {
            path.name for path in folder.iterdir()
        }
        offered = [name for name in vars(TrainModel) if not name.startswith("_")]
        assert len(offered) == 6 and all(hasattr(package, name) for name in offered)


def test_dataclasses_that_are_frozen_and_those_that_are_not() -> None:
    """CONTRIBUTING.md names examples of both."""
    for frozen in (LoadState, NewtonSettings):
        assert frozen.__dataclass_params__.frozen
    for filled in (SolveState, Friction):
        assert not filled.__dataclass_params__.frozen


def test_who_solves_without_a_search() -> None:
    """developer/frozen_point.md: a solve begins with a search, but for the states of a drive with
    deviations."""
    assert inspect.signature(NewtonSolver.solve).parameters["search"].default is True
    without = [
        p
        for p in (ROOT / "swgpar").rglob("*.py")
        if "search=False" in p.read_text(encoding="utf-8")
    ]
    assert without == [ROOT / "swgpar" / "analysis" / "deviating_drive.py"]


def test_surfaces_that_can_touch() -> None:
    """theory/contact.md lists every class of contact."""
    listed = {
        row[2].strip("`")
        for row in table_after(DOCS / "theory" / "contact.md", "| pair | kind | class |")
    }
    sources = [
        path.read_text(encoding="utf-8") for path in (ROOT / "swgpar" / "contact").glob("*.py")
    ]
    found = re.findall(r"^class (\w+Contact)(?!\w|.*Protocol)", "\n".join(sources), re.MULTILINE)
    assert listed == set(found) - {"PointContact"}  # a law for one ball, no pair of surfaces


def test_default_meshes() -> None:
    """howto/mesh.md and the README: the recipe that a run takes when none is named."""
    rows = table_after(DOCS / "howto" / "mesh.md", "| recipe | model |")
    default = {
        model: row[0].strip("`")
        for row in rows
        if "default" in row[3]
        for model in row[1].split(", ")
    }
    assert default == MESHES
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert (
        f"Without `--mesh` the mesh is `{MESHES['cup']}`, for a plane model `{MESHES['plane']}`."
        in readme
    )


def test_sources_that_clang_format_checks() -> None:
    """developer/testing.md: all C++ headers and the C source of the FMU, and no Cython."""
    script = (ROOT / "scripts" / "test").read_text(encoding="utf-8")
    (patterns,) = re.findall(r"clang-format --dry-run -Werror \$\(git ls-files (.*)\)", script)
    assert patterns.split() == ["'swgpar/*.hpp'", "'swgpar/*.c'"]


def test_stations_of_a_number_exist() -> None:
    """developer/number.md: the files and functions of the stations exist; `quoted` covers their
    names."""
    rows = table_after(DOCS / "developer" / "number.md", "| station | file |")
    for _, places, _ in rows:
        files = re.findall(r"`([\w/]+\.py)`", places)
        names = re.findall(r"`(\w+)`", places)
        text = "\n".join((ROOT / "swgpar" / file).read_text(encoding="utf-8") for file in files)
        assert files and all(f"def {name}(" in text for name in names), places


@pytest.mark.parametrize("folder", ["drawings", "generators"])
def test_scripts_of_the_site_have_a_command_line(folder: str) -> None:
    """What a script takes from `sys.argv` itself would be a folder's name, `--help` too."""
    for script in sorted((DOCS / folder).glob("*.py")):
        assert "sys.argv" not in script.read_text(encoding="utf-8"), script
