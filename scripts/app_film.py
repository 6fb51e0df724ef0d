"""Record docs/images/app.gif: the cam turns, a key is changed until teeth overlap, the change is
taken back, the loaded state appears.

    python scripts/app_film.py drivers/plane_half_turn.toml docs/images/app.gif
"""

from __future__ import annotations

import argparse
import io
import shutil
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

sys.path.insert(0, str(Path(__file__).parent / "bench"))
from app import serve

SIZE = {"width": 1100, "height": 720}
SHRUNK = 820, 537
"""Pixels of the window, and of the film."""

KEY, OVERLAPS = "ring_gear.c_P", (0.99, 1.0, 1.01, 1.02, 1.03, 0.97)
"""A key, and values of it, of which the last ones but one make teeth overlap."""

CLEARANCE = ".swgpar-section [role=status]"
CHANGED = "([line, before]) => document.querySelector(line).innerText !== before"

WHEEL = 8
"""Notches of the wheel."""

COLOURS = 64
LONG = 300_000
"""Milliseconds for a loaded state on a machine that does other work."""

MS = {"turn": 120, "change": 700, "end": 2000}
"""Milliseconds of a frame."""


class Film:
    """Frames of a page, and how long each is shown."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.frames: list[Image.Image] = []
        self.ms: list[int] = []

    def take(self, kind: str) -> None:
        shot = Image.open(io.BytesIO(self.page.screenshot())).convert("RGB").resize(SHRUNK)
        self.frames.append(shot.quantize(COLOURS, dither=Image.Dither.NONE))
        self.ms.append(MS[kind])

    def write(self, path: Path) -> None:
        first, *others = self.frames
        first.save(
            path, save_all=True, append_images=others, duration=self.ms, loop=0, optimize=True
        )


def record(page: Page, film: Film) -> None:
    """What the film shows."""
    page.wait_for_selector('[data-loaded-state="computed"]', timeout=LONG)
    page.get_by_role("button", name="play", exact=True).click()
    for _ in range(24):
        page.wait_for_timeout(150)
        film.take("turn")
    page.get_by_role("button", name="stop", exact=True).click()
    page.get_by_role("slider", name="angle of the cam, degrees").press("Home")
    page.wait_for_timeout(3000)
    zoom(page, -1)
    field = page.locator(f'input[data-key="{KEY}"]')
    page.get_by_text("[ring_gear]", exact=True).click()
    field.scroll_into_view_if_needed()
    for value in OVERLAPS:
        before = page.locator(CLEARANCE).inner_text()
        field.fill(f"{value:g}")
        field.press("Enter")
        page.wait_for_function(CHANGED, arg=[CLEARANCE, before])
        page.wait_for_timeout(900)
        film.take("change")
    zoom(page, 1)
    page.get_by_role("button", name="loaded", exact=True).click()
    page.wait_for_selector('[data-loaded-state="computed"]', timeout=LONG)
    page.wait_for_timeout(2500)
    film.take("end")


def zoom(page: Page, way: int) -> None:
    """Turn the wheel above the teeth, -1 to see them larger."""
    plot = page.locator(".js-plotly-plot").bounding_box()
    assert plot is not None
    page.mouse.move(plot["x"] + 0.42 * plot["width"], plot["y"] + 0.47 * plot["height"])
    for _ in range(WHEEL):
        page.mouse.wheel(0, way * 300)
        page.wait_for_timeout(400)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("design", type=Path)
    parser.add_argument("film", type=Path)
    given = parser.parse_args()
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        shutil.copy(given.design, folder)
        process, address = serve(Path(folder) / given.design.name)
        try:
            browser = playwright.chromium.launch(
                executable_path=shutil.which("chromium"), args=["--no-sandbox"]
            )
            page = browser.new_page(viewport=SIZE)
            page.goto(address)
            page.wait_for_selector(".js-plotly-plot", timeout=60_000)
            film = Film(page)
            record(page, film)
            film.write(given.film)
            browser.close()
        finally:
            process.terminate()
            process.wait()


if __name__ == "__main__":
    main()
