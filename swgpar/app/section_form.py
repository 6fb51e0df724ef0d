"""The dialog that adds a section to a design."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from swgpar.app.fields import MissingSection
from swgpar.app.state import AppState


class SectionDialog:
    """Asks for the keys that a section needs, and adds it."""

    def __init__(self, state: AppState, section: MissingSection) -> None:
        self.state, self.section = state, section
        self.entries: dict[str, Any] = {}
        self.dialog: ui.dialog | None = None
        self.refusal: ui.label | None = None

    async def open(self) -> None:
        """Ask where keys are needed; else add the section at once."""
        if not self.section.required:
            await self._add()
            return
        with ui.dialog() as dialog, ui.card():
            ui.label(self.section.text).classes("text-caption")
            for field in self.section.required:
                label = f"{field.name}, {field.unit}".rstrip(", ")
                if field.kind == "choice":
                    entry: Any = ui.select(list(field.choices), label=label)
                else:
                    entry = ui.input(label)
                entry.classes("w-full").tooltip(f"{field.text}; {field.allowed}".rstrip("; "))
                entry.props["aria-label"] = field.key
                self.entries[field.key] = entry
            self.refusal = ui.label().classes("text-negative text-caption").props("role=alert")
            with ui.row():
                ui.button("add", on_click=self._add)
                ui.button("close", on_click=dialog.close).props("flat")
        self.dialog = dialog
        dialog.open()

    async def _add(self) -> None:
        fields = {field.key: field for field in self.section.required}
        values = {key: fields[key].parsed(entry.value) for key, entry in self.entries.items()}
        content = {key.rpartition(".")[2]: value for key, value in values.items()}
        given = {name: value for name, value in content.items() if value not in (None, "")}
        name = self.section.name
        refusal = await self.state.change(lambda variant: variant.change({name: given}))
        if refusal and self.refusal is not None:
            self.refusal.text = refusal
        elif refusal:
            ui.notify(refusal, type="warning")
        elif self.dialog is not None:
            self.dialog.close()
