"""One window: keys of the design, section of the teeth, answers, jobs."""

from __future__ import annotations

import asyncio
from functools import partial

from nicegui import events, ui

from swgpar.app.answers_panel import AnswersPanel
from swgpar.app.choices import USUAL
from swgpar.app.drawings import drawings_of, show_drawings
from swgpar.app.fields import form_fields, is_optional, missing_sections
from swgpar.app.jobs import command_line
from swgpar.app.jobs_panel import JobsPanel
from swgpar.app.key_control import KeyControl
from swgpar.app.new_drive import NewDrive
from swgpar.app.section_form import SectionDialog
from swgpar.app.section_panel import SectionPanel
from swgpar.app.state import AppState
from swgpar.errors import SwgparError

KEYS = "keys"
PARTS = {KEYS: "swgpar-shows-keys", "answers and jobs": "swgpar-shows-answers"}
"""Parts of a narrow window below the section of the teeth, and classes that show them."""


class Page:
    """One window. Its parts are drawn again in all windows when the state has changed."""

    def __init__(self, state: AppState) -> None:
        self.state = state
        self.keys: set[str] = set()  # those of the form
        self.controls: dict[str, KeyControl] = {}  # of the sections that were opened
        self.buttons: dict[str, ui.button] = {}  # of the header
        self.opened = {"drive"}
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
        state.windows.append(self)
        ui.context.client.on_delete(lambda: state.windows.remove(self))

    def _choose_part(self) -> None:
        """Show the keys or the answers, where the window has no room for both."""
        self.columns.classes(remove=" ".join(PARTS.values()), add=PARTS[self.part.value])

    # -- header ------------------------------------------------------------------------------------

    def header(self) -> None:
        """Variants, undo, redo, save, and what can be copied."""
        for choice in (self.variant, self.beside):
            choice.props("dense dark outlined color=white").classes("min-w-24")
        self._draw_names()
        for name, step in (
            ("undo", lambda: self.state.change(lambda variant: variant.undo())),
            ("redo", lambda: self.state.change(lambda variant: variant.redo())),
            ("new", self.new_drive.open),
            ("copy", self._copy),
            ("save", self._save),
        ):
            self.buttons[name] = ui.button(name, on_click=step).props("flat dense color=white")
        self._draw_steps()
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

    def _draw_steps(self) -> None:
        """Offer the changes that can be undone and redone."""
        variant = self.state.variant
        for name, steps in (("undo", variant.before), ("redo", variant.after)):
            self.buttons[name].set_enabled(bool(steps))

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
        name, choices = self.state.variant.name, self.state.choices
        arguments = ["run", f"variants/{name}.toml", *choices.options, "--out", f"results/{name}"]
        return command_line(arguments, choices.ranks)

    def _python(self) -> str:
        name, choices = self.state.variant.name, self.state.choices
        mesh = "" if choices.mesh == USUAL else f' mesh="{choices.mesh}",'
        accuracy = f" accuracy={choices.accuracy}," if choices.accuracy else ""
        return (
            "import swgpar\n\n"
            f'design = swgpar.load_design("variants/{name}.toml")\n'
            f'result = swgpar.run(design,{mesh}{accuracy} out="results/{name}")\n'
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
        """Sections of the design, and those that can be added."""
        design = self.state.variant.design
        self.controls.clear()
        self.keys = {field.key for field in form_fields(design)}
        for name in dict.fromkeys(field.section for field in form_fields(design)):
            with ui.expansion(f"[{name}]", value=name in self.opened).classes("w-full") as folded:
                if name in self.opened:
                    self._draw_keys(name)
            folded.on_value_change(partial(self._open, name))
        with ui.dropdown_button("add a section", auto_close=True).props("flat dense no-caps"):
            for section in missing_sections(design):
                dialog = SectionDialog(self.state, section)
                item = ui.item(f"[{section.name}]", on_click=dialog.open)
                item.tooltip(section.text)
        self._draw_refused()

    def _draw_refused(self) -> None:
        """Files of the folder that are no designs, and why."""
        refused = self.state.workspace.refused
        if not refused:
            return
        title = f"not opened: {', '.join(refused)}"
        with ui.expansion(title).classes("w-full text-caption"):
            for name, sentence in refused.items():
                ui.label(f"{name}: {sentence}").classes("text-negative text-caption swgpar-text")

    def _open(self, name: str, event: events.ValueChangeEventArguments) -> None:
        """Unfold or fold a section. Its keys are drawn when it is unfolded first: the browser draws
        everything anew at each change, also what is folded."""
        if not event.value:
            self.opened.discard(name)
        elif name not in self.opened:
            self.opened.add(name)
            if not any(control.field.section == name for control in self.controls.values()):
                with event.sender:
                    self._draw_keys(name)

    def _draw_keys(self, section: str) -> None:
        """Fields of all keys of a section."""
        design = self.state.variant.design
        if drawings := drawings_of(design, section):
            show = partial(show_drawings, section, drawings)
            button = ui.button("drawing", on_click=show).props("flat dense no-caps")
            button.props["aria-label"] = f"drawing of [{section}]"
        for field in form_fields(design):
            if field.section == section:
                self.controls[field.key] = KeyControl(field, design.drive.module, self.state.set)
        if is_optional(design, section):
            step = partial(self._without, section)
            ui.button("leave out this section", on_click=step).props("flat dense no-caps")

    async def _without(self, section: str) -> None:
        refusal = await self.state.change(lambda variant: variant.change({section: None}))
        if refusal:
            ui.notify(refusal, type="warning")

    # -- what the state draws ----------------------------------------------------------------------

    def draw_section(self) -> list[asyncio.Task[None]]:
        """Draw the pictures of the teeth; tasks that end when the browser has drawn them."""
        return self.section.draw()

    def draw_design(self) -> None:
        """Draw all else that depends on designs."""
        self.section.clearance.refresh()
        fields = {field.key: field for field in form_fields(self.state.variant.design)}
        self._draw_names()
        self._draw_steps()
        if fields.keys() != self.keys:
            self.form.refresh()
        for key, control in self.controls.items():
            control.show(fields[key], self.state.refused.get(key))
        self.answers.draw()
        self.jobs.draw_durations()

    def draw_states(self) -> None:
        """Draw loaded states."""
        self.section.draw_states()
        self.answers.states.refresh()

    def draw_progress(self) -> None:
        """Draw where the computation of a loaded state is."""
        self.answers.draw_progress()

    def draw_choices(self) -> None:
        """Draw what is chosen for jobs."""
        self.jobs.draw_choices()

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
