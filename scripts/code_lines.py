"""Lines of source code of a checkout by room, with the same wrapping everywhere.

    python scripts/code_lines.py [TREE] [--length 100]

Python files are formatted by `ruff` at the length in a temporary folder. Cython, C++, C, JavaScript
and templates count as they are; no line of theirs may be longer than the form of the project
allows. Empty lines and files that Git does not track do not count.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from collections import Counter
from pathlib import Path

SOURCES = (".py", ".pyx", ".pxd", ".pxi", ".hpp", ".cpp", ".c", ".js", ".css", ".j2")


def tracked_sources(tree: Path, package: str) -> list[Path]:
    """Source files of the package that Git tracks, relative to the tree."""
    listed = subprocess.run(
        ["git", "-C", str(tree), "ls-files", package], capture_output=True, text=True, check=True
    ).stdout
    return [
        Path(name)
        for name in listed.splitlines()
        if name.endswith(SOURCES) and (tree / name).exists()
    ]


def code_lines(tree: Path, package: str = "swgpar", length: int = 100) -> Counter[str]:
    """Lines that are not empty, by room, once the Python files are wrapped at this length."""
    lines: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        copies = []
        for name in tracked_sources(tree, package):
            copy = Path(folder) / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes((tree / name).read_bytes())
            copies.append((name, copy))
        command = ["ruff", "format", "--quiet", "--isolated", "--line-length", str(length), folder]
        subprocess.run(command, check=True)
        for name, copy in copies:
            room = name.parts[1].removesuffix(".py")
            lines[room] += sum(
                bool(line.strip()) for line in copy.read_text(encoding="utf-8").splitlines()
            )
    return lines


def main() -> None:
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("tree", type=Path, nargs="?", default=Path("."))
    options.add_argument("--length", type=int, default=100)
    chosen = options.parse_args()
    lines = code_lines(chosen.tree, length=chosen.length)
    total = lines.total()
    for room, number in lines.most_common():
        print(f"{number:7d}  {100.0 * number / total:5.1f} %  {room}")
    print(f"{total:7d}           all")


if __name__ == "__main__":
    main()
