"""The app in a headless browser."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from urllib.request import urlopen

import pytest

from support.paths import DESIGN, RECIPE

CHROMIUM = shutil.which("chromium")
sync_api = pytest.importorskip("playwright.sync_api")
pytest.importorskip("nicegui")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs chromium")

SOON = 60_000
"""ms; a loaded machine is slow."""


class Served:
    """A server in a workspace, and its address."""

    def __init__(self, folder: Path) -> None:
        command = [sys.executable, "-P", "-m", "swgpar.cli", "app", str(folder), "--no-browser"]
        # NiceGUI serves otherwise within a test
        alone = {name: value for name, value in os.environ.items() if "PYTEST" not in name}
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=alone)
        assert self.process.stdout is not None
        self.address = self.process.stdout.readline().split()[-1]
        for _ in range(600):  # it listens a moment after it has said so
            with suppress(OSError), urlopen(self.address):
                return
            time.sleep(0.1)

    def kill(self) -> None:
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()


@pytest.fixture(scope="module")
def page() -> Iterator[sync_api.Page]:
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser.new_page(viewport={"width": 1300, "height": 850})
        browser.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("workspace")
    text = DESIGN.read_text(encoding="utf-8").replace("rotation = 6.0", "rotation = 0.0")
    (folder / "one.toml").write_text(text.replace("fields = false", "fields = true"))
    shutil.copy(RECIPE, folder / "tiny.toml")
    # a name that would be a script in a page, of a design and of a search
    (folder / "<img src=x onerror=alert(1)>.toml").write_text("[optimise]\n", encoding="utf-8")
    return folder


@pytest.fixture
def served(folder: Path, page: sync_api.Page) -> Iterator[Served]:
    served = Served(folder / "one.toml")
    page.goto(served.address)
    page.wait_for_selector(".js-plotly-plot", timeout=SOON)
    yield served
    served.kill()


def job(page: sync_api.Page, text: str) -> sync_api.Locator:
    return page.locator(".swgpar-job").filter(has_text=text)


def choose(page: sync_api.Page, label: str, option: str) -> None:
    page.get_by_label(label, exact=True).click()
    page.get_by_role("option", name=option, exact=True).click()


def enter(page: sync_api.Page, key: str, text: str) -> None:
    field = page.locator(f'input[data-key="{key}"]')
    field.fill(text)
    field.press("Tab")


def test_a_change_a_wrong_value_and_a_killed_server(
    page: sync_api.Page, served: Served, folder: Path
) -> None:
    """A key is changed, the clearance follows; a wrong value has its sentence; the plane state
    comes; after a kill everything is there again."""
    status = page.get_by_role("status")
    sync_api.expect(status).to_contain_text("smallest clearance", timeout=SOON)
    before = status.inner_text()
    enter(page, "drive.module", "1,02")
    sync_api.expect(status).not_to_have_text(before, timeout=SOON)
    after = status.inner_text()
    enter(page, "drive.module", "-3")
    refusal = page.get_by_role("alert").filter(has_text="drive.module = -3 is out of range")
    sync_api.expect(refusal).to_be_visible(timeout=SOON)
    assert status.inner_text() == after
    page.wait_for_selector(".swgpar-plane td", timeout=SOON)
    served.kill()
    again = Served(folder)
    try:
        page.goto(again.address)
        page.wait_for_selector(".js-plotly-plot", timeout=SOON)
        sync_api.expect(page.get_by_role("status")).to_have_text(after, timeout=SOON)
        page.get_by_role("button", name="copy").click()
        sync_api.expect(page.get_by_label("variant")).to_have_value("one_2", timeout=SOON)
    finally:
        again.kill()
    assert (folder / "variants" / "one_2.toml").exists()
    assert "module = 1.02" in (folder / "variants" / "one.toml").read_text(encoding="utf-8")


def test_a_cup_job_a_cancelled_one_two_variants_and_files(
    page: sync_api.Page, served: Served, folder: Path
) -> None:
    """The cup runs to its end on two ranks while the page is loaded anew, and its view opens; a job
    is cancelled; a copy stands beside its source; files are saved and exported."""
    alerts: list[str] = []
    page.on("dialog", lambda dialog: alerts.append(dialog.message))
    choose(page, "mesh", "tiny.toml")
    page.get_by_role("button", name="run", exact=True).click()
    sync_api.expect(job(page, "1: runs")).to_be_visible(timeout=SOON)
    assert "mpirun -n 2 swgpar run jobs/1.toml --mesh tiny.toml" in page.content()
    page.get_by_role("button", name="rate", exact=True).click()
    job(page, "2: waits").get_by_role("button", name="cancel").click()
    sync_api.expect(job(page, "2: cancelled")).to_be_visible(timeout=SOON)
    page.reload()
    # two variants
    page.get_by_role("button", name="copy", exact=True).click()
    sync_api.expect(page.get_by_label("beside")).to_have_value("one", timeout=SOON)
    enter(page, "drive.addendum_coef", "0.59")
    changes = page.locator(".swgpar-changes")
    sync_api.expect(changes).to_contain_text("drive.addendum_coef", timeout=SOON)
    sync_api.expect(page.locator(".js-plotly-plot")).to_have_count(2, timeout=SOON)
    name = page.get_by_label("variant").input_value()
    # files
    page.get_by_role("button", name="save", exact=True).click()
    sync_api.expect(page.get_by_text(f"written {name}.toml")).to_be_visible(timeout=SOON)
    assert "# addendum of gears without their own" in (folder / f"{name}.toml").read_text()
    sync_api.expect(job(page, "1: finished")).to_be_visible(timeout=SOON)
    page.locator(".swgpar-export").click()
    page.get_by_text("DXF", exact=True).click()
    sync_api.expect(job(page, "3: finished")).to_be_visible(timeout=SOON)
    assert list((folder / "results" / f"{name}_3").glob("*.dxf"))
    # the view of the report
    job(page, "1: finished").get_by_role("button", name="3D").click()
    frame = page.frame_locator("iframe.swgpar-view")
    sync_api.expect(frame.locator("#scene canvas")).to_be_visible(timeout=SOON)
    assert not alerts


def test_the_page_is_closed_without_the_token(served: Served, page: sync_api.Page) -> None:
    other = page.context.browser.new_context().new_page()
    answer = other.goto(served.address.partition("?")[0])
    assert answer is not None and answer.status == 403
    other.context.close()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_server_ends_with_its_processes(folder: Path, number: signal.Signals) -> None:
    """Also where it is killed."""
    served = Served(folder)
    children = Path(f"/proc/{served.process.pid}/task/{served.process.pid}/children")
    worker = [int(child) for child in children.read_text().split()]
    assert worker
    served.process.send_signal(number)
    assert served.process.wait(timeout=60.0) in (0, 143, -number)
    for _ in range(300):
        left = [child for child in worker if Path(f"/proc/{child}").exists()]
        if not left:
            return
        time.sleep(0.1)
    raise AssertionError(f"processes {left} go on")
