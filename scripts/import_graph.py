"""Picture of a package's rooms: which room imports which, each room one level above all that it imports.

    python scripts/import_graph.py swgpar import_graph.png

A room is a folder or a loose module directly below the package. Imports below `TYPE_CHECKING` count as well. The script
prints the numbers of rooms, levels and arrows.
"""

from __future__ import annotations

import argparse
import ast
from collections.abc import Mapping
from pathlib import Path

Graph = dict[str, set[str]]
"""The rooms that each room imports."""


def rooms(package: Path) -> dict[str, list[Path]]:
    """Rooms of a package with their source files; `__init__.py` of the package itself is none."""
    found: dict[str, list[Path]] = {}
    for path in sorted(package.rglob("*.py")):
        name = path.relative_to(package).parts[0].removesuffix(".py")
        if name != "__init__":
            found.setdefault(name, []).append(path)
    return found


def imported(path: Path, package: Path, names: Mapping[str, object]) -> set[str]:
    """Rooms (of `names`) that a source file imports."""
    own = path.relative_to(package).parts
    found: list[str] = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = [package.name, *own[: len(own) - node.level]] if node.level else []
            base += node.module.split(".") if node.module else []
            found += [".".join([*base, alias.name]) for alias in node.names]
    parts = (name.split(".") for name in found)
    return {part[1] for part in parts if len(part) > 1 and part[0] == package.name and part[1] in names}


def import_graph(package: Path) -> Graph:
    """Which room imports which other room."""
    found = rooms(package)
    return {
        name: set().union(*(imported(path, package, found) for path in paths)) - {name} for name, paths in found.items()
    }


def levels(graph: Graph) -> dict[str, int]:
    """Level of every room: 0 for one that imports none, else one above the highest room that it imports.

    Raises ValueError where rooms import each other.
    """
    level: dict[str, int] = {}
    while len(level) < len(graph):
        ready = [name for name, needs in graph.items() if name not in level and needs <= level.keys()]
        if not ready:
            raise ValueError(f"rooms import each other: {', '.join(sorted(graph.keys() - level.keys()))}")
        level.update({name: 1 + max((level[other] for other in graph[name]), default=-1) for name in ready})
    return level


def positions(graph: Graph) -> dict[str, tuple[float, float]]:
    """Centre of every room: rows are levels, the lowest level on top; order in a row by the rooms above it."""
    level = levels(graph)
    place: dict[str, tuple[float, float]] = {}
    for row in range(max(level.values()) + 1):
        names = [name for name in graph if level[name] == row]
        wanted = {
            name: sum(place[other][0] for other in graph[name]) / len(graph[name]) if graph[name] else 0.0
            for name in names
        }
        names.sort(key=lambda name: (wanted[name], name))
        for k, name in enumerate(names):
            place[name] = (k - 0.5 * (len(names) - 1)) * 2.6 + (0.0, 1.2, -0.5, -1.5)[row % 4], -float(row)
    return place


def draw(graph: Graph, title: str, image: Path) -> None:
    """Write the picture."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    place = positions(graph)
    width = max(x for x, _ in place.values()) - min(x for x, _ in place.values()) + 3.0
    height = 1.0 - min(y for _, y in place.values())
    fig, ax = plt.subplots(figsize=(0.62 * width + 0.5, 0.72 * height + 0.6))
    colours = plt.get_cmap("tab20")
    for k, (name, needs) in enumerate(graph.items()):
        for other in needs:
            span = abs(place[other][1] - place[name][1])
            ax.annotate(
                "",
                xy=(place[other][0], place[other][1] - 0.22),
                xytext=(place[name][0], place[name][1] + 0.22),
                arrowprops={
                    "arrowstyle": "-|>",
                    "color": colours(k % 20),
                    "alpha": 0.75,
                    "lw": 1.0,
                    "shrinkA": 0,
                    "shrinkB": 0,
                    "connectionstyle": f"arc3,rad={0.0 if span < 1.5 else 0.12}",
                },
            )
    for k, name in enumerate(graph):
        x, y = place[name]
        box = {"boxstyle": "round,pad=0.35", "fc": "white", "ec": colours(k % 20), "lw": 1.6}
        ax.text(x, y, name, ha="center", va="center", fontsize=9, bbox=box)
    ax.set_title(title, fontsize=11)
    ax.set_xlim(min(x for x, _ in place.values()) - 1.5, max(x for x, _ in place.values()) + 1.5)
    ax.set_ylim(min(y for _, y in place.values()) - 0.5, 0.5)
    ax.axis("off")
    fig.tight_layout()
    fig.savefig(image, dpi=110)
    plt.close(fig)


def counts(graph: Graph) -> str:
    """Rooms, levels and arrows as a sentence."""
    arrows = sum(len(needs) for needs in graph.values())
    return f"{len(graph)} rooms on {max(levels(graph).values()) + 1} levels, {arrows} arrows"


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("package", type=Path, nargs="?", default=Path("swgpar"))
    options.add_argument("image", type=Path, nargs="?", help="PNG or SVG; without it only the numbers are printed")
    options.add_argument("--title")
    chosen = options.parse_args()
    graph = import_graph(chosen.package.resolve())
    print(counts(graph))
    if chosen.image is not None:
        draw(graph, chosen.title or f"{chosen.package.name}: {counts(graph)}", chosen.image)


if __name__ == "__main__":
    main()
