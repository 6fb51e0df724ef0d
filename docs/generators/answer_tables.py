"""Tables of the answers of a run, made from what the evaluations declare.

    python docs/generators/answer_tables.py FOLDER

writes `answers.md` into the folder, for the reference of the summary to include.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from _folder import output_folder

from swgpar.answers.answer import AnswerKind, declared_answers
from swgpar.drive_results.summary import ANSWER_GROUPS
from swgpar.evaluation.step_values import StepValues


def kinds_of(name: str) -> tuple[AnswerKind, ...]:
    """Kinds of a group; those of the steps are alike, and the columns of the history are their
    names."""
    group = ANSWER_GROUPS[name]
    if group is StepValues:
        text = (
            "column of history.csv at the end of the step: 1 deflection, 2 engagement, 3 load, 4 "
            "rotation"
        )
        return (AnswerKind("step1.COLUMN to step4.COLUMN", text, "that of the column", "values"),)
    return declared_answers(group)


def tables() -> Iterator[str]:
    """Lines of the page."""
    for name, group in ANSWER_GROUPS.items():
        asked = f", with `{group.ASKED_BY}`" if group.ASKED_BY else ""
        yield f"### {group.TITLE[0].upper()}{group.TITLE[1:]}\n"
        yield f"`summary.{name}`{asked}: {{py:class}}`{group.__module__}.{group.__name__}`\n"
        yield "| name | attribute | unit | meaning |\n|---|---|---|---|"
        for kind in kinds_of(name):
            text = kind.text.replace("|", "\\|")
            yield f"| `{kind.name}` | `{kind.path}` | {kind.unit} | {text} |"
        yield ""


def classes() -> str:
    """Directives that document the fields of all groups."""
    lines = [
        f".. autoclass:: {group.__module__}.{group.__name__}()" for group in ANSWER_GROUPS.values()
    ]
    return "\n```{eval-rst}\n" + "\n".join(lines) + "\n```\n"


def main(folder: Path) -> None:
    """Write the page."""
    text = "\n".join(tables()) + "\n## Fields of the groups\n" + classes()
    (folder / "answers.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(output_folder(__doc__))
