"""Pages of HTML that are one file and need nothing else: templates, tables and pictures.

Templates lie in the room of their page as `*.html.j2`. They escape every value. A page names its
scripts, and its content security policy lets no others run.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment

RANK = "results/rank.js"
"""Script that orders the rows of ranked tables by the column whose heading is clicked."""


@dataclass(frozen=True)
class Amount:
    """A number with a text of its own. value : by which rows are ordered"""

    value: float
    text: str


@dataclass(frozen=True)
class Table:
    """Texts stand on the left, numbers on the right.

    rows : cells of each;  ranked : whether headings order rows by `RANK`
    bad : numbers, from 0, of the rows in which something is wrong
    """

    header: Sequence[str]
    rows: Sequence[Sequence[Any]]
    ranked: bool = False
    bad: Collection[int] = ()

    @property
    def has_texts(self) -> list[bool]:
        """Of every column: whether all its cells are texts."""
        return [all(isinstance(row[k], str) for row in self.rows) for k in range(len(self.header))]


@dataclass(frozen=True)
class Picture:
    """A picture in the file itself. text : what it shows;  wide : whether as wide as the page"""

    png: bytes
    text: str
    wide: bool = False


def page(template: str, title: str, *, scripts: Sequence[str] = (), **values: Any) -> bytes:
    """The whole file.

    template, scripts : paths below the package;  values : what the template shows
    """
    from markupsafe import Markup  # as in `_environment`

    sources = [_source(name) for name in scripts]
    hashes = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in sources]
    allowed = " ".join(f"'sha256-{text}'" for text in hashes) or "'none'"
    shown = {
        "title": title,
        "scripts": [Markup(text) for text in sources],
        "allowed_scripts": Markup(allowed),
    }
    return render(template, **shown, **values).encode()


def render(template: str, **values: Any) -> str:
    """The text of a template, a path below the package, with escaped values."""
    return _environment().get_template(template).render(**values)


@cache
def _environment() -> Environment:
    # here, so that commands without pages start sooner
    from jinja2 import Environment, PackageLoader, StrictUndefined

    found = Environment(
        loader=PackageLoader("swgpar", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    found.filters |= {"number": number, "base64": lambda data: base64.b64encode(data).decode()}
    return found


def _source(name: str) -> str:
    environment = _environment()
    assert environment.loader is not None
    return environment.loader.get_source(environment, name)[0]


def number(value: Any) -> str:
    """A value in a table: five digits, nothing for None."""
    if value is None:
        return ""
    return f"{value:.5g}" if isinstance(value, float) else str(value)
