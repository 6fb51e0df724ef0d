"""Scripts of drivers/, examples of the README and scripts of the gallery: they run as they stand.

They run in a folder with small designs under the names of the design files, and on the smallest
mesh in place of the named ones. The site's build (scripts/docs) runs every script of the gallery on
one rank and fails with it, with its own design. Those that have the line `# ranks: 1 2` run on two
ranks here.
"""

from __future__ import annotations

import re
import shlex
import shutil
import sys
from pathlib import Path

import pytest

from support.commands import on_ranks, succeed
from support.paths import DESIGN, DRIVERS, RECIPE, ROOT
from support.small_drive import PLANE
from support.small_trains import SMALL
from swgpar.input.toml_file import apply_overrides, read_toml, toml_value

README = (ROOT / "README.md").read_text(encoding="utf-8")
GALLERY = sorted((ROOT / "docs" / "gallery").glob("plot_*.py"))

ARGUMENTS = {
    "cup_rotation.py": (
        "--design",
        DESIGN,
        "--mesh",
        RECIPE,
        "--set",
        "steps.rotation=2",
        "steps.increment=2",
    ),
    "ring_experiment.py": ("--sectors", 24, "--radial", 1, "--axial", 1),
}
"""Of the scripts of drivers/: small problems. A new script needs an entry."""


def blocks(language: str) -> list[str]:
    """Code blocks of the README."""
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def on_the_small_mesh(text: str) -> str:
    """Names of recipes, as options and as Python strings, give way to the smallest recipe;
    accuracies are low."""
    text = re.sub(r"--mesh (coarse|medium|full|plane\w*)\b", f"--mesh {RECIPE}", text)
    text = re.sub(r'"(coarse|medium|full|plane|plane_coarse|plane_fine)"', repr(str(RECIPE)), text)
    return re.sub(r"(accuracy[ =])[0-9.]+", r"\g<1>0.2", text)


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A folder with drivers/ as the README names them: every drive is the small one, gear trains
    are small."""
    drivers = tmp_path / "drivers"
    drivers.mkdir()
    for path in DRIVERS.glob("*.py"):
        shutil.copy(path, drivers)
    for path in DRIVERS.glob("*.toml"):
        if path.stem.startswith(("cup_", "plane_")):
            plane = PLANE if path.stem.startswith("plane_") else ()
            # the example in Python prints the stress at the teeth
            root = f"output.root_stress={str(bool(plane)).lower()}"
            short = ["steps.rotation=9", "steps.increment=9", "output.fields=true", root]
            table = apply_overrides(read_toml(DESIGN), [*short, *plane])
        else:
            table = apply_overrides(read_toml(path), SMALL.get(path.stem, ()))
        lines = [f"{key} = {toml_value(value)}" for key, value in table.items()]
        (drivers / path.name).write_text("\n".join(lines), encoding="utf-8")
    return tmp_path


def test_commands_of_the_readme(checkout: Path) -> None:
    """In their order, as some continue what others have begun, each on one rank.

    Not the scripts of the checkout, which install, and no study, which has too many runs.
    """
    lines = [
        re.sub(r"^mpirun -n \d+ ", "", line)
        for block in blocks("bash")
        for line in block.splitlines()
    ]
    commands = [
        line for line in lines if line.startswith(("swgpar ", "python ")) and " study " not in line
    ]
    assert commands
    for line in commands:
        words = shlex.split(on_the_small_mesh(line), comments=True)
        succeed([sys.executable if word == "python" else word for word in words], cwd=checkout)


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("number", range(len(blocks("python"))))
def test_python_of_the_readme(number: int, ranks: int, checkout: Path) -> None:
    (checkout / "example.py").write_text(
        on_the_small_mesh(blocks("python")[number]), encoding="utf-8"
    )
    succeed([*on_ranks(ranks), sys.executable, "example.py"], cwd=checkout)


@pytest.mark.parametrize("script", sorted(DRIVERS.glob("*.py")), ids=lambda path: path.name)
def test_script_of_drivers(script: Path, tmp_path: Path) -> None:
    out = tmp_path / "results"
    succeed([sys.executable, str(script), "--out", str(out), *map(str, ARGUMENTS[script.name])])
    assert any(path.suffix == ".csv" for path in out.iterdir())


def gallery_runs() -> list[tuple[Path, int]]:
    """Scripts of the gallery that name more than one number of ranks, with the largest of them."""
    found = []
    for script in GALLERY:
        named = re.search(
            r"^# ranks:((?: \d+)+)$", script.read_text(encoding="utf-8"), re.MULTILINE
        )
        if named:
            found.append((script, max(map(int, named[1].split()))))
    return found


@pytest.mark.parametrize(
    ("script", "ranks"), gallery_runs(), ids=lambda value: getattr(value, "name", f"{value} ranks")
)
def test_script_of_the_gallery(script: Path, ranks: int, checkout: Path) -> None:
    gallery = checkout / "docs" / "gallery"
    gallery.mkdir(parents=True)
    (gallery / script.name).write_text(
        on_the_small_mesh(script.read_text(encoding="utf-8")), encoding="utf-8"
    )
    succeed([*on_ranks(ranks), sys.executable, str(gallery / script.name)], cwd=checkout)
