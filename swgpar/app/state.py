"""What all windows of the app show, and what their controls do."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol

from swgpar.api.runs import load_mesh
from swgpar.app.choices import Choices
from swgpar.app.fields import FormField
from swgpar.app.jobs import AppJob, JobQueue
from swgpar.app.loaded_states import PLANE, SOLID, ShownState, StateModel
from swgpar.app.state_worker import StateWorker
from swgpar.app.workspace import Variant, Workspace, has_section
from swgpar.errors import SwgparError
from swgpar.rating.planned_runs import rating_loads
from swgpar.results.atomic import write_file

DRAWN = 0.25
"""Seconds after which nothing waits any more for pictures in browsers: one that nobody sees is slow
to say that it is drawn."""


class Window(Protocol):
    """A page that shows the state."""

    def draw_section(self) -> list[asyncio.Task[None]]:
        """Draw the pictures of the teeth; tasks that end when the browser has drawn them."""

    def draw_design(self) -> None:
        """Draw all else that depends on designs."""

    def draw_states(self) -> None:
        """Draw loaded states."""

    def draw_progress(self) -> None:
        """Draw where the computation of a loaded state is."""

    def draw_choices(self) -> None:
        """Draw what is chosen for jobs."""

    def draw_jobs(self) -> None:
        """Draw the queue, and what follows from its results."""

    def draw_logs(self) -> None:
        """Draw what jobs that run have printed."""


class AppState:
    """What all windows of the app show.

    workspace : variants;  queue : jobs;  workers : of loaded states, by their models
    choices : beside the designs
    angle_deg : of the cam;  plays : whether it turns;  loaded : whether the section shows the
    loaded state in place of gaps
    refused : entries that were refused and their sentences, by their keys
    windows : that are open;  was_busy : whether they show that a state is computed
    """

    def __init__(self, workspace: Workspace, queue: JobQueue, choices: Choices) -> None:
        self.workspace, self.queue = workspace, queue
        self.workers = {model: StateWorker(model) for model in (PLANE, SOLID)}
        self.choices = choices
        self.angle_deg, self.plays, self.loaded = 0.0, False, False
        self.refused: dict[str, tuple[Any, str]] = {}
        self.windows: list[Window] = []
        self.was_busy = [False, False]

    @property
    def variant(self) -> Variant:
        """The one that is shown."""
        return self.workspace.variant

    @property
    def shown(self) -> list[Variant]:
        """The one that is shown, and the one beside it."""
        other = self.workspace.other
        return [self.variant, *([other] if other is not None else [])]

    def model_of(self, variant: Variant) -> StateModel:
        """Model whose loaded state is shown of a variant; a plane drive has no other."""
        return SOLID if self.choices.is_solid and variant.design.drive.model != "plane" else PLANE

    @property
    def worker(self) -> StateWorker:
        """Of the states that are shown of the variant."""
        return self.workers[self.model_of(self.variant)]

    def loaded_state(self, variant: Variant) -> ShownState | None:
        """The loaded state that is shown of a variant; None before it is computed."""
        return self.workers[self.model_of(variant)].state(variant.design)

    def want_states(self) -> None:
        """Ask for the loaded states of the variants that are shown."""
        shown = self.shown
        self.workers[PLANE].want([variant.design for variant in shown])
        solid = [one.design for one in shown if self.model_of(one) is SOLID]
        self.workers[SOLID].want(solid)

    def choose_model(self, is_solid: bool) -> None:
        """Show loaded states of drives in 3D, or of plane models."""
        self.choices.is_solid = is_solid
        self.remember()
        self.want_states()
        self.draw_states()

    def choose(self, mesh: str, accuracy: str, ranks: int) -> None:
        """Choose for the next jobs; see `Choices`."""
        chosen = replace(self.choices, mesh=mesh, accuracy=accuracy, ranks=ranks)
        if chosen != self.choices:
            self.choices = chosen
            self.remember()
            for window in self.windows:
                window.draw_choices()

    def remember(self) -> None:
        """Keep the choices, and which variants are shown, for the next server."""
        workspace = self.workspace
        self.choices.shown, self.choices.beside = workspace.shown, workspace.beside
        self.choices.keep(workspace.folder)

    async def set(self, field: FormField, entry: Any, moves: bool = False) -> None:
        """Take over an entry of the form; a refused one stays with its sentence.

        moves : whether a slider still moves
        """
        try:
            dragged = field.key if moves else ""
            self.variant.change({field.key: field.parsed(entry)}, dragged=dragged)
        except SwgparError as error:
            self.refused[field.key] = entry, str(error)
        else:
            self.refused.clear()
        await self.draw(keeps=not moves)

    async def change(self, step: Callable[[Variant], Any]) -> str:
        """Change the variant that is shown; the sentence that refuses it, else an empty one."""
        try:
            step(self.variant)
        except SwgparError as error:
            return str(error)
        self.refused.clear()
        await self.draw()
        return ""

    async def show(self, name: str, beside: str) -> None:
        """Show a variant, and another one beside it; none under an empty name."""
        self.workspace.shown, self.workspace.beside = name, beside
        self.refused.clear()
        await self.draw(keeps=False)

    async def draw(self, *, keeps: bool = True) -> None:
        """Draw all that depends on designs in all windows. The sections come first: while browsers
        draw them, loaded states and all else would take the processor from them.

        keeps : whether the variant is written into its file
        """
        if drawn := self.draw_sections():
            await asyncio.wait(drawn, timeout=DRAWN)
        if keeps:
            self.workspace.keep()
        if (self.choices.shown, self.choices.beside) != (
            self.workspace.shown,
            self.workspace.beside,
        ):
            self.remember()
        self.want_states()
        for window in self.windows:
            window.draw_design()

    def turn(self) -> None:
        """Turn the cam on while it plays."""
        if self.plays and not self.loaded:
            self.angle_deg = (self.angle_deg + 1.0) % 360.0
            self.draw_sections()

    def draw_sections(self) -> list[asyncio.Task[None]]:
        """Draw the pictures of the teeth in all windows; tasks that end when the browsers have
        drawn them."""
        return [task for window in self.windows for task in window.draw_section()]

    def look_at_states(self) -> None:
        """Take over states that have been computed."""
        new = [worker.look() for worker in self.workers.values()]
        busy = [worker.is_busy for worker in self.workers.values()]
        if any(new) or busy != self.was_busy:
            self.was_busy = busy
            self.draw_states()
        elif any(busy):
            for window in self.windows:
                window.draw_progress()

    def draw_states(self) -> None:
        """Draw loaded states in all windows."""
        for window in self.windows:
            window.draw_states()

    def look_at_jobs(self) -> None:
        """Start and end jobs."""
        if self.queue.step():
            self.draw_jobs()
        elif self.queue.runs:
            for window in self.windows:
                window.draw_logs()

    def draw_jobs(self) -> None:
        """Draw the queue in all windows."""
        for window in self.windows:
            window.draw_jobs()

    def queue_design(self, command: str, options: Sequence[str], ranks: int) -> AppJob:
        """A job with the design that is shown. Raises SwgparError where it cannot begin."""
        if command == "rate":
            rating_loads(self.variant.design)
        number = self.queue.next_number
        name, folder = f"jobs/{number}.toml", self.workspace.folder
        (folder / "jobs").mkdir(exist_ok=True)
        write_file(folder / name, self.variant.text.encode())
        out = f"results/{self.variant.name}_{number}"
        arguments = [command, name, *options, "--out", out]
        return self.queue.add(arguments, out, ranks, self.variant.name)


def files_of(folder: Path, section: str) -> list[Path]:
    """Files of a folder that begin a search or a study: with the section [SECTION]."""
    return [
        path
        for path in sorted(folder.glob("*.toml"))
        if not path.is_symlink() and has_section(path, section)
    ]


def recipes_of(folder: Path) -> list[str]:
    """Names of mesh recipes of a folder."""
    names = []
    for path in sorted(folder.glob("*.toml")):
        with suppress(SwgparError):
            load_mesh(path)
            names.append(path.name)
    return names
