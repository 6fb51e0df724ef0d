"""Files of a results folder that this program has made, by a list in the folder: no others are
removed or replaced, and no link is followed.

A file stands in the list before it gets its name. So a run that is killed has listed all it has
left.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

from swgpar.errors import OutputError

LIST = "swgpar.files"
"""In the results folder: a line for each file that was made there."""

PARTS = ("fields", "figures", "tables", "best")
"""Folders inside a results folder whose files are in its list."""


def begin(folder: Path, adopted: Iterable[str] = ()) -> None:
    """Make a list where there is none; call it on one rank.

    adopted : patterns of files that are in a new list: those of a run that an earlier version has
        begun, and that is continued

    Raises OutputError where the list, or a folder for parts of the results, is a link.
    """
    for name in (LIST, *PARTS):
        refuse_link(folder / name)
    found = [path for path in _matching(folder, adopted) if not path.is_symlink()]
    with suppress(FileExistsError), (folder / LIST).open("x", encoding="utf-8") as file:
        file.writelines(f"{path.relative_to(folder).as_posix()}\n" for path in found)


def refuse_link(path: Path) -> None:
    """Raise OutputError for a link: what it points to is not part of the results."""
    if path.is_symlink():
        raise OutputError(
            f"{path} is a link, and results are not written through links: remove it, or choose "
            "another folder"
        )


def names(folder: Path) -> set[str]:
    """Paths of the files in the list, relative to the folder; none without a list."""
    try:
        return set((folder / LIST).read_text(encoding="utf-8").splitlines())
    except FileNotFoundError:
        return set()
    except UnicodeDecodeError:
        raise OutputError(f"cannot read {folder / LIST}: it is no UTF-8 text") from None


def note(path: Path) -> None:
    """Add a file that is about to be made to the list of its results folder, if it is in one.

    Raises OutputError where there is a file of this name that is not in the list.
    """
    folder = _results_folder(path)
    if folder is None:
        return
    name = path.relative_to(folder).as_posix()
    if name in names(folder):
        return
    if os.path.lexists(path):
        raise not_made(path)
    flags = os.O_APPEND | os.O_WRONLY | os.O_NOFOLLOW
    handle = os.open(folder / LIST, flags)
    try:
        os.write(handle, f"{name}\n".encode())
    finally:
        os.close(handle)


def require_own(folder: Path, patterns: Iterable[str]) -> None:
    """Refuse a folder that has links, or files that are not in its list, under names that will be
    written. patterns : of these names"""
    known, has_list = names(folder), (folder / LIST).exists()
    for path in _matching(folder, patterns):
        refuse_link(path)
        if not has_list:
            raise OutputError(
                f"{path} is there, and the folder has no list of the files that runs have made "
                f"({LIST}), like those of earlier versions: remove or move the folder, or choose "
                "another one"
            )
        if path.relative_to(folder).as_posix() not in known:
            raise not_made(path)


def require_none_of(folder: Path, patterns: Iterable[str], inputs: Iterable[Path]) -> None:
    """Refuse inputs of a run that would be replaced by its results. patterns : of their names"""
    read = {path.resolve() for path in inputs}
    for path in _matching(folder, patterns):
        if path.resolve() in read:
            raise OutputError(
                f"{path} is read by this run, which would replace it: copy it to another folder"
            )


def not_made(path: Path) -> OutputError:
    """The refusal to replace a file that is not in the list."""
    return OutputError(
        f"{path} is there, and was not made by a run in this folder: move it, or choose another "
        "folder"
    )


def remove(folder: Path, patterns: Iterable[str], kept: Iterable[Path] = ()) -> None:
    """Remove files of the list; call it on one rank.

    patterns : of their names;  kept : resolved paths of files that stay, and leave the list
    """
    known, stay = names(folder), set(kept)
    for path in _matching(folder, patterns):
        name = path.relative_to(folder).as_posix()
        if name in known and not path.is_symlink() and path.resolve() not in stay:
            path.unlink()
    left = sorted(
        f"{name}\n"
        for name in known
        if os.path.lexists(folder / name) and (folder / name).resolve() not in stay
    )
    temporary = folder / f"{LIST}.new"
    temporary.unlink(missing_ok=True)
    with temporary.open("x", encoding="utf-8") as file:
        file.writelines(left)
    os.replace(temporary, folder / LIST)


def _matching(folder: Path, patterns: Iterable[str]) -> Iterator[Path]:
    """Files and links of these names; those in a folder that is a link are not the folder's."""
    for pattern in patterns:
        part, _, _ = pattern.rpartition("/")
        if part and (folder / part).is_symlink():
            continue
        yield from sorted(folder.glob(pattern))


def _results_folder(path: Path) -> Path | None:
    """The results folder that a file belongs to; None outside of any."""
    parent = path.parent
    folder = parent.parent if parent.name in PARTS else parent
    return folder if (folder / LIST).exists() else None
