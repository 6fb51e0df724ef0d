"""The dialog that makes a variant from catalogue numbers."""

from __future__ import annotations

from typing import Any, get_args

from nicegui import ui

from swgpar.api.designs import new
from swgpar.app.fields import number_of
from swgpar.app.state import AppState
from swgpar.checks.starter import Layout, Model, Shape
from swgpar.errors import SwgparError

NUMBERS = {"ratio": "50", "pitch diameter, mm": "50", "torque, N·m": "15"}
"""Labels of what is asked for, and what stands there first."""

CHOICES = {"model": get_args(Model), "layout": get_args(Layout), "shape": get_args(Shape)}
"""Arguments of `swgpar.new` with their values, the usual one first."""


MAKE, MAKE_STILL = "make", "make it all the same"
"""What the button says, and what it says when the start does not carry the torque."""


class NewDrive:
    """Asks for ratio, diameter and torque, and shows the drive that `swgpar.new` makes of them.
    What the start does not carry is said first."""

    def __init__(self, state: AppState) -> None:
        self.state = state
        with ui.dialog() as self.dialog, ui.card().classes("w-80"):
            ui.label("a new drive").props("role=heading aria-level=2").classes("text-bold")
            self.numbers = [ui.input(label, value=text) for label, text in NUMBERS.items()]
            self.choices = {
                name: ui.select(list(values), value=values[0], label=name)
                for name, values in CHOICES.items()
            }
            for entry in (*self.numbers, *self.choices.values()):
                entry.classes("w-full").props("dense").on_value_change(self._forget)
            for entry in self.numbers:
                entry.on("keydown.enter", self._make)
            self.numbers[0].props("autofocus")
            self.said = ui.label().classes("text-negative text-caption").props("role=alert")
            with ui.row():
                self.make = ui.button(MAKE, on_click=self._make)
                ui.button("close", on_click=self.dialog.close).props("flat")

    def open(self) -> None:
        """Ask."""
        self._forget()
        self.dialog.open()

    def _forget(self) -> None:
        """Of other numbers nothing has been said."""
        self.said.text, self.make.text = "", MAKE

    async def _make(self) -> None:
        workspace = self.state.workspace
        chosen: dict[str, Any] = {name: choice.value for name, choice in self.choices.items()}
        warnings: list[str] = []
        try:
            ratio, diameter, torque = (number_of(each.value or "") for each in self.numbers)
            numbers = {"ratio": ratio, "diameter": diameter, "torque": torque}
            design = new(**numbers, **chosen, warn=warnings.append)
        except SwgparError as error:
            self.said.text = str(error)
            return
        if warnings and self.make.text == MAKE:
            self.said.text, self.make.text = "; ".join(warnings), MAKE_STILL
            return
        workspace.add(workspace.free_name("drive"), design)
        workspace.beside = ""
        self.dialog.close()
        await self.state.draw()
