"""The app in a headless browser."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest

import swgpar
from support.paths import DESIGN, RECIPE
from swgpar.app.loaded_states import PLANE, open_session, solve_state
from swgpar.design.drive_design import DriveDesign

CHROMIUM = shutil.which("chromium")
sync_api = pytest.importorskip("playwright.sync_api")
pytest.importorskip("nicegui")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs chromium")

SOON, JOB = 60_000, 300_000
"""ms, for the page and for a run on two ranks; a loaded machine is slow."""

HOSTILE = "<img src=x onerror=alert(1)>"
"""A name that would be a script in a page, of a search and of a design."""

CONTROLS = {"button", "textbox", "combobox", "slider", "spinbutton", "switch", "link", "menuitem"}
"""Roles of what is operated."""


ABANDONED = re.compile(
    r"ERROR: +Exception in ASGI application\n(?:(?!ERROR:).*\n)*?"
    r"RuntimeError: No response returned\.\n"
)
"""What the server's library says where a browser has left a page before all of it has come."""


class Served:
    """A server in a workspace, and its address."""

    def __init__(self, source: Path) -> None:
        command = [sys.executable, "-P", "-m", "swgpar.cli", "app", str(source), "--no-browser"]
        # NiceGUI serves otherwise within a test
        alone = {name: value for name, value in os.environ.items() if "PYTEST" not in name}
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115  (closed with this object)
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=self._errors, text=True, env=alone
        )
        assert self.process.stdout is not None
        self.address = self.process.stdout.readline().split()[-1]

    @property
    def children(self) -> list[Path]:
        """Processes that the server has started, as folders of /proc."""
        pid = self.process.pid
        text = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="utf-8")
        return [Path(f"/proc/{child}") for child in text.split()]

    @property
    def errors(self) -> str:
        """What it has said of errors: of handlers that have failed, for one."""
        self._errors.seek(0)
        return ABANDONED.sub("", self._errors.read().decode())

    def ended(self, number: int) -> int:
        """Exit code of the server after a signal."""
        self.process.send_signal(number)
        return self.process.wait(timeout=60.0)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    text = DESIGN.read_text(encoding="utf-8").replace("rotation = 6.0", "rotation = 0.0")
    (tmp_path / "one.toml").write_text(text.replace("fields = false", "fields = true"))
    shutil.copy(RECIPE, tmp_path / "tiny.toml")
    (tmp_path / f"{HOSTILE}.toml").write_text("[optimise]\n", encoding="utf-8")
    return tmp_path


@pytest.fixture
def page() -> Iterator[sync_api.Page]:
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1300, "height": 850})
        page.set_default_timeout(SOON)
        sync_api.expect.set_options(timeout=SOON)
        yield page
        browser.close()


@pytest.fixture
def servers() -> Iterator[list[Served]]:
    """The servers of a test; those that still run after it are killed."""
    started: list[Served] = []
    yield started
    for served in started:
        if served.process.poll() is None:
            served.process.kill()
            served.process.wait()


def opened(page: sync_api.Page, source: Path, servers: list[Served]) -> Served:
    """A server whose page is shown."""
    served = Served(source)
    servers.append(served)
    for _ in range(600):  # it listens a moment after it has said so
        with suppress(sync_api.Error):
            page.goto(served.address)
            break
        time.sleep(0.1)
    page.wait_for_selector(".js-plotly-plot .trace")
    return served


def press(page: sync_api.Page, name: str) -> None:
    page.get_by_role("button", name=name, exact=True).click()


def job(page: sync_api.Page, text: str) -> sync_api.Locator:
    return page.locator(".swgpar-job").filter(has_text=text)


def enter(page: sync_api.Page, key: str, text: str) -> None:
    field = page.locator(f'input[data-key="{key}"]')
    field.fill(text)
    field.press("Tab")


def undressed(page: sync_api.Page) -> list[str]:
    """Controls that a keyboard does not reach, or that have no name for a screen reader."""
    tree = page.context.new_cdp_session(page).send("Accessibility.getFullAXTree")
    found = []
    for node in tree["nodes"]:
        if node["ignored"] or node["role"]["value"] not in CONTROLS:
            continue
        has = {one["name"]: one["value"].get("value") for one in node["properties"]}
        name = node["name"]["value"].strip()
        if not name or not (has.get("focusable") or has.get("disabled")):
            found.append(f"{node['role']['value']} {name!r}")
    return found


def plane_answers(path: Path) -> set[str]:
    """Answers of the plane model of a design as the page shows them."""
    design = swgpar.load_design(path)
    assert isinstance(design, DriveDesign)
    state = solve_state(PLANE.table(design), PLANE.mesh, open_session())
    return {
        f"{one.text} {one.place} {one.value:.4g} {one.unit}".replace("  ", " ").strip()
        for one in state.answers
    }


def change_keys(page: sync_api.Page, clearance: sync_api.Locator) -> None:
    """By field and by slider; a wrong value has its sentence and changes nothing; interference
    appears and goes."""
    expect = sync_api.expect
    expect(clearance).to_contain_text("smallest clearance")
    undo = page.get_by_role("button", name="undo", exact=True)
    expect(undo).to_be_disabled()
    first = clearance.inner_text()
    enter(page, "drive.module", "1,02")
    expect(clearance).not_to_have_text(first)
    after = clearance.inner_text()
    enter(page, "drive.module", "-3")
    refusal = page.get_by_role("alert").filter(has_text="drive.module = -3 is out of range")
    expect(refusal).to_be_visible()
    assert clearance.inner_text() == after
    page.get_by_role("slider", name="drive.module").press("ArrowLeft")
    expect(clearance).not_to_have_text(after)
    expect(refusal).not_to_be_visible()
    page.get_by_text("[ring_gear]").click()
    enter(page, "ring_gear.c_P", "1.03")
    expect(clearance).to_contain_text("overlap")
    undo.click()
    expect(clearance).to_contain_text("smallest clearance")
    expect(page.get_by_role("button", name="redo", exact=True)).to_be_enabled()


def compare_variants(page: sync_api.Page, folder: Path) -> None:
    """The plane state is that of the interface, and that in 3D is cancelled; a copy stands beside
    its source, and is saved."""
    expect = sync_api.expect
    known = plane_answers(folder / "variants" / "one.toml")  # while the server computes it
    expect(page.get_by_text("no estimate of errors by the mesh")).to_be_visible()
    rows = page.locator(".swgpar-loaded tbody tr").all_inner_texts()
    assert known and {re.sub(r"\s+", " ", row).strip() for row in rows} == known
    press(page, "3D model")
    press(page, "cancel the loaded state")
    expect(page.get_by_text("cancelled", exact=True)).to_be_visible()
    press(page, "plane model")
    press(page, "copy")
    expect(page.get_by_label("variant")).to_have_value("one_2")
    expect(page.get_by_label("beside")).to_have_value("one")
    enter(page, "drive.addendum_coef", "0.57")
    changes = page.locator(".swgpar-changes")
    expect(changes).to_contain_text("drive.addendum_coef")
    expect(page.locator(".js-plotly-plot")).to_have_count(2)
    press(page, "save")
    expect(page.get_by_text("written one_2.toml")).to_be_visible()
    assert re.search(r"addendum_coef = 0\.57 +# addendum", (folder / "one_2.toml").read_text())
    page.reload()
    expect(changes).to_contain_text("drive.addendum_coef")


def ask_for_too_much(page: sync_api.Page) -> None:
    """What a start does not carry is said before it is made; another torque takes it back."""
    press(page, "new")
    torque = page.get_by_label("torque, N·m")
    torque.fill("600")
    torque.press("Enter")
    said = page.get_by_role("alert").filter(has_text="is more than this start carries")
    sync_api.expect(said).to_be_visible()
    torque.fill("1")
    sync_api.expect(page.get_by_role("button", name="make", exact=True)).to_be_visible()
    page.keyboard.press("Escape")
    sync_api.expect(torque).not_to_be_visible()


def look_at_a_narrow_window(page: sync_api.Page) -> None:
    """The answers are not behind the keys; a section has its drawing."""
    expect = sync_api.expect
    page.get_by_role("button", name="drawing of [drive]", exact=True).click()
    drawing = page.get_by_role("img", name="keys of [drive]: drive teeth", exact=True)
    expect(drawing).to_be_visible()
    assert drawing.evaluate("one => one.decode().then(() => one.naturalWidth)") > 500
    press(page, "close")
    page.set_viewport_size({"width": 400, "height": 850})
    keys, rate = page.locator(".swgpar-form"), page.get_by_role("button", name="rate", exact=True)
    expect(keys).to_be_visible()
    expect(rate).not_to_be_visible()
    press(page, "answers and jobs")
    expect(rate).to_be_visible()
    expect(keys).not_to_be_visible()
    page.set_viewport_size({"width": 1300, "height": 850})


def look_at_jobs(page: sync_api.Page, folder: Path) -> None:
    """The first one ends and its view opens; another one is cancelled; files are exported."""
    expect = sync_api.expect
    expect(job(page, "1: finished")).to_be_visible(timeout=JOB)
    job(page, "1: finished").get_by_role("button", name="3D").click()
    scene = page.frame_locator("iframe.swgpar-view").locator("#scene canvas")
    expect(scene).to_be_visible()
    press(page, "close")
    press(page, "run")
    job(page, "2: runs").get_by_role("button", name="cancel").click()
    expect(job(page, "2: cancelled")).to_be_visible()
    page.locator(".swgpar-export").click()
    page.get_by_text("DXF", exact=True).click()
    expect(job(page, "3: finished").get_by_role("link")).not_to_have_count(0)
    assert list((folder / "results" / "one_2_3").glob("*.dxf"))


def test_a_session_with_a_killed_server(
    page: sync_api.Page, folder: Path, servers: list[Served]
) -> None:
    """A run on two ranks goes on while its server is killed and another one takes over. No server
    leaves a process; a hostile name does nothing; the keyboard reaches every control."""
    alerts: list[str] = []
    page.on("dialog", lambda dialog: alerts.append(dialog.message))
    clearance = page.get_by_role("status").filter(has_text="tip of a lobe")
    served = opened(page, folder / "one.toml", servers)
    with pytest.raises(HTTPError, match="403"):
        urlopen(served.address.partition("?")[0])
    sync_api.expect(page.get_by_text(f"optimise {HOSTILE}.toml")).to_be_visible()
    page.get_by_label("mesh", exact=True).click()
    page.get_by_role("option", name="tiny.toml", exact=True).click()
    press(page, "run")
    begun = job(page, "1: runs")
    sync_api.expect(begun).to_contain_text("mpirun -n 2 swgpar run jobs/1.toml --mesh tiny")
    change_keys(page, clearance)
    changed, children = clearance.inner_text(), served.children
    assert served.ended(signal.SIGKILL) == -signal.SIGKILL and children
    served = opened(page, folder, servers)
    sync_api.expect(clearance).to_have_text(changed)
    sync_api.expect(page.get_by_label("mesh", exact=True)).to_have_value("tiny.toml")
    ask_for_too_much(page)
    look_at_a_narrow_window(page)
    compare_variants(page, folder)
    look_at_jobs(page, folder)
    assert undressed(page) == []
    assert not alerts
    assert [one.errors for one in servers] == ["", ""]
    children += served.children
    assert served.ended(signal.SIGTERM) in (0, 143, -signal.SIGTERM)
    for _ in range(300):
        if not (left := [child for child in children if child.exists()]):
            return
        time.sleep(0.1)
    raise AssertionError(f"processes {left} go on")
