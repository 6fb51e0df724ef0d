"""The server of the app: one page on the loopback address, behind a token."""

from __future__ import annotations

import secrets
import socket
from pathlib import Path

from nicegui import app, ui

from swgpar.api.designs import new
from swgpar.app.access import TokenGate
from swgpar.app.choices import Choices, read_choices
from swgpar.app.drawings import ADDRESS, FOLDER
from swgpar.app.jobs import JobQueue
from swgpar.app.page import Page
from swgpar.app.state import AppState
from swgpar.app.style import PRIMARY, STYLE
from swgpar.app.workspace import Workspace
from swgpar.errors import InputError

RESULTS = "results"
"""Folder of the workspace with the results of the jobs."""

LOOK, PLAY, JOBS = 0.05, 0.2, 1.0
"""Seconds between two looks at the loaded states, two pictures while the cam turns, and two looks
at the jobs."""

RECONNECT = 60.0
"""s for which a window that has lost its connection can come back: while a job runs, this process
has little of the machine."""


def free_port() -> int:
    """A port of the loopback address that nothing listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def require_port(port: int) -> int:
    """Refuse a port that cannot be listened on."""
    if not 1024 <= port <= 65535:
        raise InputError(f"port = {port} is out of range: allowed 1024 to 65535")
    with socket.socket() as probe:
        try:
            probe.bind(("127.0.0.1", port))
        except OSError as error:
            raise InputError(f"port = {port} cannot be used: {error.strerror}") from None
    return port


def open_workspace(source: Path) -> tuple[Workspace, Choices]:
    """The workspace of a folder, or that of the folder of a design file, and its choices.

    A folder without designs gets a new one. Raises InputError where there is no such folder.
    """
    folder = source if source.is_dir() else source.parent
    if not folder.is_dir():
        raise InputError(f"{source} is not there: give a folder or a design file")
    workspace, choices = Workspace(folder), read_choices(folder)
    workspace.bring_back()
    if source.is_file():
        if source.stem not in workspace.variants:
            workspace.open(source)
        workspace.shown = source.stem
    else:
        workspace.open_all()
        workspace.show_again(choices)
    if not workspace.variants:
        workspace.add("drive", new(ratio=50.0, diameter=50.0, torque=15.0))
        workspace.keep()
    return workspace, choices


def serve(source: Path, port: int | None = None, *, show: bool = True) -> None:
    """Serve the app until it is stopped.

    source : folder, or design file in it;  port : default a free one
    show : whether to open a browser
    """
    workspace, choices = open_workspace(source)
    state = AppState(workspace, JobQueue(workspace.folder), choices)
    for worker in state.workers.values():
        app.on_shutdown(worker.close)
    state.want_states()
    # one for all windows, and without one
    app.timer(LOOK, state.look_at_states)
    app.timer(PLAY, state.turn)
    app.timer(JOBS, state.look_at_jobs)
    results = workspace.folder / RESULTS
    results.mkdir(exist_ok=True)
    app.add_static_files(f"/{RESULTS}", results)
    app.add_static_files(ADDRESS, FOLDER)
    token = secrets.token_urlsafe(24)
    port = free_port() if port is None else require_port(port)
    app.add_middleware(TokenGate, token=token, port=port)

    def root() -> None:
        ui.add_css(STYLE)
        ui.colors(primary=PRIMARY)
        Page(state)

    address = f"http://127.0.0.1:{port}/?token={token}"
    app.on_startup(lambda: print(f"swgpar app: {address}", flush=True))
    ui.run(
        root,
        host="127.0.0.1",
        port=port,
        title=f"swgpar: {workspace.folder.name}",
        show=address if show else False,
        reload=False,
        dark=None,
        show_welcome_message=False,
        ws_per_message_deflate=False,  # pictures do not leave this machine
        reconnect_timeout=RECONNECT,
    )
