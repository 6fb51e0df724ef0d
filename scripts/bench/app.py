"""Seconds of the app on this machine, from a change of a key to the picture and to the loaded
states of the plane model and in 3D, in a headless browser. Processes are those that wanted a core,
the app's included, on the average of the last minute."""

from __future__ import annotations

import argparse
import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

CHANGES, WARMING = 8, 2
"""Changes of each key for plane states; the first ones warm up and are left out."""

SOLID_CHANGES, SOLID_WARMING = 3, 1
"""The same for states in 3D: one of a drive with balls takes some ten seconds."""

KEYS = {"load.torque": -0.004, "drive.addendum_coef": -0.002, "flexible_spline.rim": -0.002}
"""Keys that are changed, and the relative size of a change: the load, which leaves the picture of
the teeth as it is, all teeth, and the neutral line."""

WARM = 300_000
"""ms for the first plane state."""

OBSERVE = """
() => {
  window.seen = {};
  const plot = document.querySelector('.js-plotly-plot');
  // a picture whose curves are moved ends with the second event alone
  for (const name of ['plotly_afterplot', 'plotly_react'])
    plot.on(name, () => { window.seen.picture ||= performance.now(); });
  new MutationObserver(() => {
    const busy = document.querySelector('[data-loaded-state]')?.dataset.loadedState;
    if (busy === 'computed' && window.seen.begun) window.seen.answer ||= performance.now();
    if (busy === 'busy') window.seen.begun = true;
  }).observe(document.body, { subtree: true, childList: true, attributes: true });
}"""


def serve(folder: Path) -> tuple[subprocess.Popen[str], str]:
    """The server of a folder, and its address."""
    command = [sys.executable, "-P", "-m", "swgpar.cli", "app", str(folder), "--no-browser"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=dict(os.environ))
    assert process.stdout is not None
    return process, process.stdout.readline().split()[-1]


def seconds(page: Page, key: str, text: str) -> tuple[float, float]:
    """From the change of a key to the picture and to the answer, s; nan where the picture stays."""
    page.evaluate("window.seen = {}")
    page.evaluate(
        """([key, text]) => {
          const field = document.querySelector(`input[data-key="${key}"]`);
          field.value = text;
          field.dispatchEvent(new Event('input'));
          window.seen.start = performance.now();
          field.dispatchEvent(new Event('change'));
        }""",
        [key, text],
    )
    page.wait_for_function("window.seen.answer", timeout=WARM)
    seen = page.evaluate("window.seen")
    picture, answer = (
        1e-3 * (seen.get(name, math.nan) - seen["start"]) for name in ("picture", "answer")
    )
    return picture, answer


def medians(page: Page, key: str, changes: int, warming: int) -> tuple[float, float]:
    """Median seconds to the picture and to the answer, after changes of a key; the first ones are
    left out."""
    first = float(page.locator(f'input[data-key="{key}"]').input_value() or 0.0)
    if not first:
        return math.nan, math.nan
    values = [first * (1.0 + KEYS[key] * (k + 1)) for k in range(changes)]
    found = [seconds(page, key, f"{value:.8g}") for value in values][warming:]
    picture, answer = (statistics.median(one) for one in zip(*found, strict=True))
    return picture, answer


def measure(page: Page, name: str) -> None:
    """Print the rows of a design whose page is shown."""
    page.wait_for_selector(".js-plotly-plot", timeout=60_000)
    page.wait_for_selector('[data-loaded-state="computed"]', timeout=WARM)
    for section in {key.rpartition(".")[0] for key in KEYS} - {"drive"}:
        page.get_by_text(f"[{section}]", exact=True).click()
        page.wait_for_selector(f'input[data-key^="{section}."]')
    page.evaluate(OBSERVE)
    plane = {key: medians(page, key, CHANGES, WARMING) for key in KEYS}
    in_space = page.get_by_role("button", name="3D model", exact=True)
    solid = dict.fromkeys(KEYS, math.nan)
    if in_space.is_visible():
        in_space.click()
        page.wait_for_selector('[data-loaded-state="busy"]')
        page.wait_for_selector('[data-loaded-state="computed"]', timeout=WARM)
        solid = {key: medians(page, key, SOLID_CHANGES, SOLID_WARMING)[1] for key in KEYS}
    for key, (picture, answer) in plane.items():
        if not math.isnan(answer):
            cells = (name, f"`{key}`", *map(_text, (picture, answer, solid[key])))
            print(f"| {' | '.join(cells)} | {os.getloadavg()[0]:.1f} |", flush=True)


def _text(seconds: float) -> str:
    """Seconds; nothing where the picture stays, and of what is not computed."""
    return "–" if math.isnan(seconds) else f"{seconds:.2g}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("designs", nargs="+", type=Path)
    given = parser.parse_args()
    heads = ("design", "key", "to picture, s", "to plane state, s", "to 3D state, s", "processes")
    print(f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )
        for design in given.designs:
            # a folder keeps what was shown, of another design too
            with tempfile.TemporaryDirectory() as folder:
                shutil.copy(design, folder)
                process, address = serve(Path(folder) / design.name)
                try:
                    page = browser.new_page(viewport={"width": 1300, "height": 850})
                    page.goto(address)
                    measure(page, design.stem)
                    page.close()
                finally:
                    process.terminate()
                    process.wait()
        browser.close()


if __name__ == "__main__":
    main()
