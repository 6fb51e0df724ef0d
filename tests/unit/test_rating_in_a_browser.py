"""The page of a rating sheet in a headless browser: nothing is cut, remarks have room."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from swgpar.answers.answer import Answer
from swgpar.answers.verdict import Limit, Sense, Verdict
from swgpar.rating.page import rating_page
from swgpar.rating.sheet import RatedVerdict, RatingSheet

CHROMIUM = shutil.which("chromium")
sync_api = pytest.importorskip("playwright.sync_api")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs chromium")

PRINTED = 718
"""Pixels between the margins of a page of A4."""

SENTENCE = (
    "9.021 N on the end of the face width: no property of the drive, and the stress at the teeth "
    "may be off by more than its error"
)


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Of a sheet with the longest names and numbers."""
    clearance = "clearance of the rigid teeth in the dynamic spline"
    verdicts = (
        Verdict(clearance, Answer("c", 0.022194, "mm", "", place=SENTENCE), None),
        Verdict(
            "hysteresis",
            Answer("h", 2.621, "arc minutes", "", error=0.052),
            Limit(-0.0025, Sense.AT_LEAST, "rating.hysteresis"),
            "a lower bound",
            is_lower_bound=True,
        ),
    )
    rated = tuple(RatedVerdict(one, "repeated peak torque") for one in verdicts)
    path = Path(tmp_path_factory.mktemp("sheet")) / "rating.html"
    path.write_bytes(rating_page(RatingSheet("Rating", rated, (), {}, None)))
    return path.as_uri()


@pytest.fixture(scope="module")
def browser() -> Iterator[sync_api.Browser]:
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.mark.parametrize(
    ("media", "width"),
    [("print", PRINTED), ("screen", 1300), ("screen", 1100), ("screen", 961), ("screen", 400)],
)
def test_nothing_is_cut(browser: sync_api.Browser, address: str, media: str, width: int) -> None:
    page = browser.new_page(viewport={"width": width, "height": 900})
    page.emulate_media(media=media)
    page.goto(address)
    assert page.evaluate("document.documentElement.scrollWidth") == width
    remarks = page.locator(".further").first.bounding_box()
    assert remarks is not None and remarks["width"] > 0.2 * width
    page.close()
