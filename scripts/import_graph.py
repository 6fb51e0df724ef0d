"""What a package's rooms and files import, in numbers and as a picture of the rooms.

    python scripts/import_graph.py swgpar import_graph.png

A room is a folder or a loose module directly below the package. Imports in functions and below
`TYPE_CHECKING` count as well. A name that a package's `__init__.py` only hands on counts as an
import of the module that defines it. The picture has each room one level above all that it imports.

The script prints the numbers of rooms, levels and arrows; the numbers of files, of arrows between
files and of circles of files, with their members; and the largest room's share of the lines.
"""

from __future__ import annotations

import argparse
import ast
from pathlib import Path

Graph = dict[str, set[str]]
"""What each room, or each file, imports."""


def rooms(package: Path) -> dict[str, list[Path]]:
    """Rooms of a package with their source files; `__init__.py` of the package itself is none."""
    members: dict[str, list[Path]] = {}
    for path in sorted(package.rglob("*.py")):
        name = path.relative_to(package).parts[0].removesuffix(".py")
        if name != "__init__":
            members.setdefault(name, []).append(path)
    return members


def module_name(path: Path, package: Path) -> str:
    """Full name of the module in a source file."""
    parts = path.relative_to(package).with_suffix("").parts
    return ".".join([package.name, *parts]).removesuffix(".__init__")


def imported_names(path: Path, package: Path) -> dict[str, str]:
    """Full names from the package that a source file imports, each with its name in the file."""
    own = path.relative_to(package).parts
    names: dict[str, str] = {}
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name: alias.asname or alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = [package.name, *own[: len(own) - node.level]] if node.level else []
            base += node.module.split(".") if node.module else []
            names |= {
                ".".join([*base, alias.name]): alias.asname or alias.name for alias in node.names
            }
    return {name: inside for name, inside in names.items() if name.split(".")[0] == package.name}


def import_graph(package: Path) -> Graph:
    """Which room imports which other room."""
    members = rooms(package)
    graph: Graph = {}
    for room, paths in members.items():
        names = [name.split(".") for path in paths for name in imported_names(path, package)]
        graph[room] = {parts[1] for parts in names if len(parts) > 1 and parts[1] in members} - {
            room
        }
    return graph


def file_graph(package: Path) -> Graph:
    """Which module imports which other module; Cython modules import nothing here."""
    paths = {module_name(path, package): path for path in sorted(package.rglob("*.py"))}
    names = {module: imported_names(path, package) for module, path in paths.items()}
    handed_on = {
        f"{module}.{inside}": name
        for module, path in paths.items()
        if path.name == "__init__.py"
        for name, inside in names[module].items()
    }
    modules = paths.keys() | {module_name(path, package) for path in package.rglob("*.pyx")}

    def defined_in(name: str) -> str:
        """The module that a full name is, or in which it is defined."""
        # an installed package has compiled modules without their sources: they hand on themselves
        while name not in modules and handed_on.get(name, name) != name:
            name = handed_on[name]
        while name not in modules:
            name = name.rpartition(".")[0]
        return name

    return {
        module: {defined_in(name) for name in names.get(module, ())} - {module}
        for module in sorted(modules)
    }


def circles(graph: Graph) -> list[list[str]]:
    """Groups in which each member imports all others, directly or through others."""

    def reachable(start: str) -> set[str]:
        reached: set[str] = set()
        ahead = [start]
        while ahead:
            ahead += graph[ahead.pop()] - reached
            reached.update(ahead)
        return reached

    reach = {name: reachable(name) for name in graph}
    groups = {
        tuple(sorted(other for other in reach[name] if name in reach[other])) for name in graph
    }
    return sorted(list(group) for group in groups if group)


def levels(graph: Graph) -> dict[str, int]:
    """Level of every room: 0 for one that imports none, else one above the highest room that it
    imports.

    Raises ValueError where rooms import each other.
    """
    level: dict[str, int] = {}
    while len(level) < len(graph):
        ready = [
            name for name, needs in graph.items() if name not in level and needs <= level.keys()
        ]
        if not ready:
            raise ValueError(
                f"rooms import each other: {', '.join(sorted(graph.keys() - level.keys()))}"
            )
        level.update(
            {name: 1 + max((level[other] for other in graph[name]), default=-1) for name in ready}
        )
    return level


def positions(graph: Graph) -> dict[str, tuple[float, float]]:
    """Centre of every room: rows are levels, the lowest level on top; order in a row by the rooms
    above it."""
    level = levels(graph)
    place: dict[str, tuple[float, float]] = {}
    for row in range(max(level.values()) + 1):
        names = [name for name in graph if level[name] == row]
        wanted = {
            name: sum(place[other][0] for other in graph[name]) / len(graph[name])
            if graph[name]
            else 0.0
            for name in names
        }
        names.sort(key=lambda name: (wanted[name], name))
        for k, name in enumerate(names):
            place[name] = (
                (k - 0.5 * (len(names) - 1)) * 2.6 + (0.0, 1.2, -0.5, -1.5)[row % 4],
                -float(row),
            )
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
    """Rooms, levels and arrows as a sentence; without levels where rooms import each other."""
    arrows = sum(len(needs) for needs in graph.values())
    if groups := circles(graph):
        return (
            f"{len(graph)} rooms, {arrows} arrows; circles: "
            f"{'; '.join(', '.join(group) for group in groups)}"
        )
    return f"{len(graph)} rooms on {max(levels(graph).values()) + 1} levels, {arrows} arrows"


def file_counts(graph: Graph) -> str:
    """Files, arrows and circles as a sentence, and the members of every circle on a line."""
    arrows = sum(len(needs) for needs in graph.values())
    groups = circles(graph)
    lines = [f"{len(graph)} files, {arrows} arrows, {len(groups)} circles"]
    return "\n".join([*lines, *(f"circle: {', '.join(group)}" for group in groups)])


def largest_room(package: Path) -> str:
    """The room with the most lines of Python, and its share of all, as a sentence."""
    lines = {
        room: sum(len(path.read_text(encoding="utf-8").splitlines()) for path in paths)
        for room, paths in rooms(package).items()
    }
    total = sum(lines.values())
    room = max(lines, key=lambda name: lines[name])
    return f"largest room: {room} with {lines[room] / total:.1%} of {total} lines"


def main() -> None:
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("package", type=Path, nargs="?", default=Path("swgpar"))
    options.add_argument(
        "image", type=Path, nargs="?", help="PNG or SVG; without it only the numbers are printed"
    )
    options.add_argument("--title")
    chosen = options.parse_args()
    package = chosen.package.resolve()
    graph = import_graph(package)
    print(counts(graph))
    print(file_counts(file_graph(package)))
    print(largest_room(package))
    if chosen.image is not None:
        draw(graph, chosen.title or f"{package.name}: {counts(graph)}", chosen.image)


if __name__ == "__main__":
    main()
