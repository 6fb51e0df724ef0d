"""scripts/import_graph.py on small packages: rooms, arrows, levels, circles; and
scripts/number_path.py's search."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.paths import ROOT
from support.scripts import load_script

graph = load_script(ROOT / "scripts" / "import_graph.py")
path = load_script(ROOT / "scripts" / "number_path.py")

SOURCES = {
    "__init__.py": "from house.top import x\n",
    "base.py": "import numpy\n",
    "middle/__init__.py": "",
    "middle/first.py": "from house import base\nfrom house.middle import second\n",
    "middle/second.py": "from __future__ import annotations\nfrom ..base import y\n",
    "top.py": "def x():\n    import house.middle.first\n    from house.base import z\n",
}


def package(folder: Path, sources: dict[str, str]) -> Path:
    for name, text in sources.items():
        file = folder / "house" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    return folder / "house"


def test_rooms_arrows_and_levels(tmp_path: Path) -> None:
    found = graph.import_graph(package(tmp_path, SOURCES))
    assert found == {"base": set(), "middle": {"base"}, "top": {"middle", "base"}}
    assert graph.levels(found) == {"base": 0, "middle": 1, "top": 2}
    assert graph.counts(found) == "3 rooms on 3 levels, 3 arrows"


def test_circles_are_named(tmp_path: Path) -> None:
    sources = SOURCES | {"base.py": "from house import top\n"}
    with pytest.raises(ValueError, match="base, middle, top"):
        graph.levels(graph.import_graph(package(tmp_path, sources)))


def test_circles_of_files(tmp_path: Path) -> None:
    """Names that a package hands on lead to the file that defines them; imports in functions
    count."""
    sources = {
        "__init__.py": "",
        "a/__init__.py": "from house.a.one import x as y\n",
        "a/one.py": "from house.b import two\n",
        "a/core.pyx": "import numpy\n",
        "b/__init__.py": "from house.b.three import deep\n\ndef own(): ...\n",
        "b/two.py": "def f():\n    from house.a import y\n",
        "b/three.py": "from house.a.core import kernel\n",
        "c.py": "from house.b import deep, own\n",
    }
    files = graph.file_graph(package(tmp_path, sources))
    assert files["house.b.two"] == {"house.a.one"}
    assert files["house.b.three"] == {"house.a.core"}
    assert files["house.c"] == {"house.b", "house.b.three"}
    assert graph.circles(files) == [["house.a.one", "house.b.two"]]
    assert graph.file_counts(files).splitlines()[1] == "circle: house.a.one, house.b.two"


def test_largest_room(tmp_path: Path) -> None:
    house = package(tmp_path, SOURCES)
    assert graph.largest_room(house) == "largest room: middle with 50.0% of 8 lines"


def test_picture(tmp_path: Path) -> None:
    image = tmp_path / "graph.png"
    graph.draw(graph.import_graph(package(tmp_path, SOURCES)), "house", image)
    assert image.stat().st_size > 1000


@pytest.mark.parametrize(
    ("value", "held"),
    [
        (1.2345, True),
        (-1234.5, True),
        (1.2346, False),
        (True, False),
        ("load.torque=1.2345", True),
        (["a", {"torque": 617.25}], True),
        (np.array([0.0, 1234.5]), True),
        (np.arange(3), False),
    ],
)
def test_a_number_is_recognised(value: object, held: bool) -> None:
    number = path.Number([1.2345 * unit for unit in path.TORQUE_UNITS], ["1.2345"])
    assert number(value) == held


class Plan:
    """What is followed in `LOW` and `TOP`."""


LOW = """
def ask(plan): return 1
def other(x): return x
def more(plan): return 2
"""
TOP = """
def run(plan):
    ask(plan)
    other(3)
    last(plan)
    ask(plan)

def last(plan):
    more(plan)
"""


def test_the_way_through_modules_of_two_levels() -> None:
    """Functions count once, at their first entry; a stay in a higher module than before is a
    climb."""
    low: dict[str, Any] = {"__name__": "house.low"}
    exec(compile(LOW, "low.py", "exec"), low)
    top: dict[str, Any] = {**low, "__name__": "house.top"}
    exec(compile(TOP, "top.py", "exec"), top)
    watch = path.Watch("house", path.of_class("Plan"), asked=True)
    sys.setprofile(watch)
    try:
        top["run"](Plan())
    finally:
        sys.setprofile(None)
    way = path.find_way(watch, {"house.low": 0, "house.top": 1})
    assert [(stay.module, stay.functions, stay.climb) for stay in way.stays] == [
        ("house.top", ["run"], False),
        ("house.low", ["ask"], False),
        ("house.top", ["last"], True),
        ("house.low", ["more"], False),
    ]
    assert way.counts() == {"modules": 2, "functions": 4, "lines": 9, "climbs": 1}


def test_modules_in_a_circle_share_a_level() -> None:
    assert path.module_levels({"a": {"b"}, "b": {"a", "c"}, "c": set(), "d": {"a"}}) == {
        "a": 1,
        "b": 1,
        "c": 0,
        "d": 2,
    }
