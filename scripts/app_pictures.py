"""Record docs/images/app.gif and docs/images/app.png, on a machine that does nothing else: they
show how long states take.

The film: the cam turns, a key is changed until teeth overlap, the change is taken back, the loaded
state appears. The picture: the loaded state in 3D, after a change, beside that of the plane model.

    python scripts/app_pictures.py docs/images
"""

from __future__ import annotations

import argparse
import io
import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, ViewportSize, sync_playwright

sys.path.insert(0, str(Path(__file__).parent / "bench"))
from app import serve

DRIVERS = Path(__file__).parents[1] / "drivers"
FILM, PICTURE = DRIVERS / "plane_half_turn.toml", DRIVERS / "cup_45deg.toml"
"""Designs that are shown."""

SIZE: ViewportSize = {"width": 1100, "height": 720}
SHRUNK = 820, 537
"""Pixels of the window, and of the film."""

PICTURE_SIZE: ViewportSize = {"width": 1300, "height": 850}
CHANGE = "flexible_spline.rim", "0.998"
"""Key and value, near to that of the design, whose state the picture shows: the process is warm."""

KEY, OVERLAPS = "ring_gear.c_P", (0.99, 1.0, 1.01, 1.02, 1.03, 0.97)
"""A key, and values of it, of which the last ones but one make teeth overlap."""

CLEARANCE = ".swgpar-section [role=status]"
CHANGED = "([line, before]) => document.querySelector(line).innerText !== before"

WHEEL = 8
"""Notches of the wheel."""

COLOURS, PICTURE_COLOURS = 64, 160
COMPUTED = '[data-loaded-state="computed"]'
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
    page.wait_for_selector(COMPUTED, timeout=LONG)
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
    page.wait_for_selector(COMPUTED, timeout=LONG)
    page.wait_for_timeout(2500)
    film.take("end")


def picture(page: Page, path: Path) -> None:
    """The loaded state in 3D of a design that has changed."""
    page.wait_for_selector(COMPUTED, timeout=LONG)
    page.get_by_role("button", name="3D model", exact=True).click()
    page.wait_for_selector('[data-loaded-state="busy"]')
    page.wait_for_selector(COMPUTED, timeout=LONG)
    key, value = CHANGE
    page.get_by_text(f"[{key.partition('.')[0]}]", exact=True).click()
    field = page.locator(f'input[data-key="{key}"]')
    field.fill(value)
    field.press("Enter")
    page.wait_for_selector('[data-loaded-state="busy"]')
    page.wait_for_selector(COMPUTED, timeout=LONG)
    page.get_by_role("button", name="loaded", exact=True).click()
    page.get_by_text("[drive]", exact=True).scroll_into_view_if_needed()
    zoom(page, -1, 3)
    page.mouse.move(5, 5)  # no answer below the pointer
    page.wait_for_timeout(2500)
    shot = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    shot.quantize(PICTURE_COLOURS, dither=Image.Dither.NONE).save(path, optimize=True)


def zoom(page: Page, way: int, notches: int = WHEEL) -> None:
    """Turn the wheel above the teeth, -1 to see them larger."""
    plot = page.locator(".js-plotly-plot").bounding_box()
    assert plot is not None
    page.mouse.move(plot["x"] + 0.42 * plot["width"], plot["y"] + 0.47 * plot["height"])
    for _ in range(notches):
        page.mouse.wheel(0, way * 300)
        page.wait_for_timeout(400)


def shown(design: Path, size: ViewportSize, record: Callable[[Page], None]) -> None:
    """Record the page of a design in a window of a size."""
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        shutil.copy(design, folder)
        process, address = serve(Path(folder) / design.name)
        try:
            browser = playwright.chromium.launch(
                executable_path=shutil.which("chromium"), args=["--no-sandbox"]
            )
            page = browser.new_page(viewport=size)
            page.goto(address)
            page.wait_for_selector(".js-plotly-plot", timeout=60_000)
            record(page)
            browser.close()
        finally:
            process.terminate()
            process.wait()


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    shown(PICTURE, PICTURE_SIZE, lambda page: picture(page, folder / "app.png"))

    def film(page: Page) -> None:
        frames = Film(page)
        record(page, frames)
        frames.write(folder / "app.gif")

    shown(FILM, SIZE, film)


if __name__ == "__main__":
    main()
