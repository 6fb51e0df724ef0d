"""The page of the command line, made from the argument parser.

    python docs/generators/command_line.py FOLDER

writes `command_line.md` into the folder, for a page to include.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from pathlib import Path

from _folder import output_folder

from swgpar.cli import parser


def subcommands(top: argparse.ArgumentParser) -> Iterator[tuple[str, str, argparse.ArgumentParser]]:
    """Name, meaning and parser of the subcommands."""
    group = next(
        action for action in top._actions if isinstance(action, argparse._SubParsersAction)
    )
    for entry in group._choices_actions:
        command = group.choices[entry.dest]
        yield entry.dest, str(command.description or entry.help), command


def option_rows(command: argparse.ArgumentParser) -> Iterator[str]:
    """Rows of a definition list: an argument and its meaning."""
    formatter = command._get_formatter()
    for action in command._actions:
        if isinstance(action, argparse._HelpAction):
            continue
        values = formatter._format_args(action, formatter._get_default_metavar_for_optional(action))
        values = "" if action.nargs == 0 else values
        name = (
            " ".join([*action.option_strings[:1], values]).strip()
            if action.option_strings
            else action.dest
        )
        needed = " (required)" if action.required and action.option_strings else ""
        yield f"`{name}`\n: {formatter._expand_help(action)}{needed}\n"


def page(top: argparse.ArgumentParser) -> str:
    """All subcommands: what they do, their usage and their arguments."""
    parts = []
    for name, text, command in subcommands(top):
        usage = command.format_usage().removeprefix("usage: ").replace("\n       ", "\n").rstrip()
        parts.append(f"## `swgpar {name}`\n\n{text[0].upper()}{text[1:].rstrip('.')}.\n")
        parts.append(f"```text\n{usage}\n```\n")
        parts.extend(option_rows(command))
    return "\n".join(parts)


def main(folder: Path) -> None:
    """Write the page."""
    os.environ["COLUMNS"] = "96"
    (folder / "command_line.md").write_text(page(parser()), encoding="utf-8")


if __name__ == "__main__":
    main(output_folder(__doc__))
