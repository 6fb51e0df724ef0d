"""One window: keys of the design, section of the teeth, answers, jobs."""

from __future__ import annotations

import shlex
from collections import defaultdict
from functools import partial

from nicegui import ui

from swgpar.app.answers_panel import AnswersPanel
from swgpar.app.drawings import drawings_of, show_drawings
from swgpar.app.fields import FormField, form_fields, is_optional, missing_sections
from swgpar.app.jobs_panel import JobsPanel
from swgpar.app.key_control import KeyControl
from swgpar.app.new_drive import NewDrive
from swgpar.app.section_form import SectionDialog
from swgpar.app.section_panel import SectionPanel
from swgpar.app.state import AppState
from swgpar.errors import SwgparError

LOOK = 0.1
"""Seconds between two looks at the loaded states."""

JOBS = 1.0
"""Seconds between two looks at the jobs."""

PLAY = 0.2
"""Seconds between two pictures while the cam turns."""

KEYS = "keys"
PARTS = {KEYS: "swgpar-shows-keys", "answers and jobs": "swgpar-shows-answers"}
"""Parts of a narrow window below the section of the teeth, and classes that show them."""


class Page:
    """One window. Its parts are drawn again in all windows when the state has changed."""

    def __init__(self, state: AppState) -> None:
        self.state = state
        self.controls: dict[str, KeyControl] = {}
        with ui.header().classes("items-center gap-4 q-px-md q-py-xs swgpar-header"):
            ui.label("swgpar").classes("text-h6")
            self.variant = ui.select([], label="variant", on_change=self._choose)
            self.beside = ui.select([], label="beside", on_change=self._choose)
            self.new_drive = NewDrive(state)
            self.header()
        with ui.row().classes("w-full items-start gap-4 swgpar-columns") as self.columns:
            self.part = ui.toggle(list(PARTS), value=KEYS, on_change=self._choose_part)
            self.part.classes("swgpar-parts").props("spread no-caps dense")
            self._choose_part()
            with _region("swgpar-form", "keys of the design"):
                self.form()
            with _region("swgpar-section", "section of the teeth"):
                self.section = SectionPanel(state)
            with _region("swgpar-answers", "answers and jobs"):
                self.jobs = JobsPanel(state)
                self.answers = AnswersPanel(state)
        ui.timer(LOOK, state.look_at_states)
        ui.timer(JOBS, state.look_at_jobs)
        ui.timer(PLAY, self.section.turn)
        state.windows.append(self)
        ui.context.client.on_delete(lambda: state.windows.remove(self))

    def _choose_part(self) -> None:
        """Show the keys or the answers, where the window has no room for both."""
        self.columns.classes(remove=" ".join(PARTS.values()), add=PARTS[self.part.value])

    # -- header ------------------------------------------------------------------------------------

    def header(self) -> None:
        """Variants, undo, redo, save, and what can be copied."""
        for choice in (self.variant, self.beside):
            choice.props("dense dark outlined").classes("min-w-24")
        self._draw_names()
        for name, step in (
            ("undo", lambda: self.state.change(lambda variant: variant.undo())),
            ("redo", lambda: self.state.change(lambda variant: variant.redo())),
            ("new", self.new_drive.open),
            ("copy", self._copy),
            ("save", self._save),
        ):
            ui.button(name, on_click=step).props("flat dense color=white")
        with ui.dropdown_button("as text", auto_close=True).props("flat dense color=white"):
            ui.item("command line", on_click=lambda: self._clip(self._command()))
            ui.item("Python", on_click=lambda: self._clip(self._python()))
            ui.item("TOML", on_click=lambda: self._clip(self.state.variant.text))

    def _draw_names(self) -> None:
        """Show which variants there are, and which are shown."""
        workspace = self.state.workspace
        names = sorted(workspace.variants)
        for choice, offered, value in (
            (self.variant, names, workspace.shown),
            (self.beside, ["", *names], workspace.beside),
        ):
            if choice.options != offered or choice.value != value:
                choice.set_options(offered, value=value)

    async def _choose(self) -> None:
        workspace, chosen = self.state.workspace, (self.variant.value, self.beside.value)
        if chosen != (workspace.shown, workspace.beside):
            await self.state.show(*chosen)

    async def _copy(self) -> None:
        workspace = self.state.workspace
        source = workspace.variant
        workspace.add(workspace.free_name(source.name), source.design)
        workspace.beside = source.name
        await self.state.draw()

    async def _save(self, *, overwrite: bool = False) -> None:
        try:
            path = self.state.workspace.save(overwrite=overwrite)
        except SwgparError as error:
            if overwrite:
                ui.notify(str(error), type="warning")
                return
            with ui.dialog() as dialog, ui.card():
                ui.label(str(error))
                with ui.row():
                    ui.button("replace", on_click=lambda: dialog.submit(True))
                    ui.button("leave it", on_click=lambda: dialog.submit(False)).props("flat")
            if await dialog:
                await self._save(overwrite=True)
            return
        ui.notify(f"written {path.name}", type="positive")

    def _command(self) -> str:
        name = shlex.quote(f"variants/{self.state.variant.name}.toml")
        return f"swgpar run {name} --mesh coarse --out results/{self.state.variant.name}"

    def _python(self) -> str:
        name = self.state.variant.name
        return (
            "import swgpar\n\n"
            f'design = swgpar.load_design("variants/{name}.toml")\n'
            f'result = swgpar.run(design, mesh="coarse", out="results/{name}")\n'
        )

    def _clip(self, text: str) -> None:
        self.state.workspace.keep()
        ui.clipboard.write(text)
        with ui.dialog() as dialog, ui.card():
            ui.label("copied to the clipboard").classes("text-caption")
            ui.label(text).classes("swgpar-log swgpar-text")
            ui.button("close", on_click=dialog.close).props("flat dense")
        dialog.open()

    # -- form --------------------------------------------------------------------------------------

    @ui.refreshable_method
    def form(self) -> None:
        """Fields of all keys in their sections, and the sections that can be added."""
        design = self.state.variant.design
        sections: dict[str, list[FormField]] = defaultdict(list)
        for field in form_fields(design):
            sections[field.section].append(field)
        self.controls.clear()
        for name, fields in sections.items():
            with ui.expansion(f"[{name}]", value=name == "drive").classes("w-full"):
                if drawings := drawings_of(design, name):
                    show = partial(show_drawings, name, drawings)
                    button = ui.button("drawing", on_click=show).props("flat dense no-caps")
                    button.props["aria-label"] = f"drawing of [{name}]"
                for field in fields:
                    self.controls[field.key] = KeyControl(field, self.state.set)
                if is_optional(design, name):
                    step = partial(self._without, name)
                    ui.button("leave out this section", on_click=step).props("flat dense no-caps")
        with ui.dropdown_button("add a section", auto_close=True).props("flat dense no-caps"):
            for section in missing_sections(design):
                dialog = SectionDialog(self.state, section)
                item = ui.item(f"[{section.name}]", on_click=dialog.open)
                item.tooltip(section.text)

    async def _without(self, section: str) -> None:
        refusal = await self.state.change(lambda variant: variant.change({section: None}))
        if refusal:
            ui.notify(refusal, type="warning")

    # -- what the state draws ----------------------------------------------------------------------

    def draw_section(self) -> None:
        """Draw the pictures of the teeth."""
        self.section.draw()

    def draw_design(self) -> None:
        """Draw all else that depends on designs."""
        self.section.clearance.refresh()
        fields = {field.key: field for field in form_fields(self.state.variant.design)}
        self._draw_names()
        if fields.keys() != self.controls.keys():
            self.form.refresh()
        for key, control in self.controls.items():
            control.show(fields[key], self.state.refused.get(key))
        self.answers.draw()

    def draw_states(self) -> None:
        """Draw loaded states."""
        self.section.draw_states()
        self.answers.plane.refresh()

    def draw_jobs(self) -> None:
        """Draw the queue, and the sheet that a job may have written."""
        self.jobs.jobs.refresh()
        self.answers.verdict.draw()

    def draw_logs(self) -> None:
        """Draw what jobs that run have printed and written."""
        self.jobs.draw_logs()
        self.answers.verdict.look()


def _region(classes: str, name: str) -> ui.column:
    """A column that screen readers offer by its name."""
    column = ui.column().classes(classes).props("role=region")
    column.props["aria-label"] = name
    return column
