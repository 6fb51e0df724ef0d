"""Pages of HTML in tests: their tags, tables and what they take from outside."""

from __future__ import annotations

import re
from html.parser import HTMLParser

VOID = {"meta", "img", "input", "br"}


class Page(HTMLParser):
    """Tags of a page in their order.

    Attributes
    ----------
    open : tags that are not closed
    links : what `src`, `href` and `url()` name
    tables : headings of every table, and whether a container that scrolls is around it
    """

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.links: list[str] = [
            link for style in re.findall(r"url\(([^)]*)\)", text) for link in [style.strip("'\"")]
        ]
        self.tables: list[tuple[list[str], bool]] = []
        self._classes: list[str] = []
        self._heading = False
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.links += [
            value or "" for name, value in attributes if name in ("src", "href", "srcset", "action")
        ]
        if tag == "table":
            self.tables.append(([], any("scroll" in classes.split() for classes in self._classes)))
        if tag == "th" and self.tables:
            self.tables[-1][0].append("")
        self._heading = tag == "th"
        if tag not in VOID and not self.get_starttag_text().endswith("/>"):
            self.open.append(tag)
            self._classes.append(dict(attributes).get("class") or "")

    def handle_endtag(self, tag: str) -> None:
        self._heading = False
        if tag not in VOID and self.open and self.open[-1] == tag:
            self.open.pop()
            self._classes.pop()

    def handle_data(self, data: str) -> None:
        if self._heading:
            self.tables[-1][0][-1] += data


def assert_needs_nothing_else(text: str) -> Page:
    """Every tag is closed, tables scroll in containers, and nothing comes from outside; returns the
    page."""
    page = Page(text)
    assert page.open == []
    assert all(link.startswith(("data:", "#")) for link in page.links)
    assert page.tables and all(scrolls for _, scrolls in page.tables)
    code = re.sub(r"<pre>.*?</pre>", "", text, flags=re.DOTALL)
    assert not re.search(r"https?:|@import|<link|fetch\(|XMLHttpRequest", code)
    return page
