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


class NewDrive:
    """Asks for ratio, diameter and torque, and shows the drive that `swgpar.new` makes of them."""

    def __init__(self, state: AppState) -> None:
        self.state = state
        with ui.dialog() as self.dialog, ui.card():
            ui.label("a new drive").props("role=heading aria-level=2").classes("text-bold")
            self.numbers = [ui.input(label, value=text) for label, text in NUMBERS.items()]
            self.choices = {
                name: ui.select(list(values), value=values[0], label=name)
                for name, values in CHOICES.items()
            }
            for entry in (*self.numbers, *self.choices.values()):
                entry.classes("w-full").props("dense")
            self.refusal = ui.label().classes("text-negative text-caption").props("role=alert")
            with ui.row():
                ui.button("make", on_click=self._make)
                ui.button("close", on_click=self.dialog.close).props("flat")

    def open(self) -> None:
        """Ask."""
        self.refusal.text = ""
        self.dialog.open()

    async def _make(self) -> None:
        workspace = self.state.workspace
        chosen: dict[str, Any] = {name: choice.value for name, choice in self.choices.items()}
        warnings: list[str] = []
        try:
            ratio, diameter, torque = (number_of(each.value or "") for each in self.numbers)
            numbers = {"ratio": ratio, "diameter": diameter, "torque": torque}
            design = new(**numbers, **chosen, warn=warnings.append)
        except SwgparError as error:
            self.refusal.text = str(error)
            return
        workspace.add(workspace.free_name("drive"), design)
        workspace.beside = ""
        self.dialog.close()
        for warning in warnings:
            ui.notify(warning, type="warning", multi_line=True, timeout=0, close_button="close")
        await self.state.draw()
