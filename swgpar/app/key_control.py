"""The control of one key of the design: its field, its slider, the sentence of a refused entry."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Any

from nicegui import ui

from swgpar.app.fields import FormField
from swgpar.app.slider import Slider

SLIDERS = 3.0
"""A slider goes from 0 to this multiple of the value that its key has when it is drawn, and to both
sides where a value may be below 0."""

SMALL = 0.2
"""Length over the module to which the slider of a length goes that is 0 when it is drawn."""

WIDE = 1000.0
"""Width of a range up to which the slider of another number goes through all of it."""

STEPS = 600
"""Places of a slider."""


def slider_range(field: FormField, module: float) -> tuple[float, float] | None:
    """Ends of the slider of a number; None where nothing says how large a change is.

    module : mm, of the design
    """
    if field.value > 0.0:
        far = SLIDERS * field.value
        return max(-far if field.low < 0.0 else 0.0, field.low), min(far, field.high)
    if field.high - field.low <= WIDE:
        return field.low, field.high
    if field.unit == "mm":
        far = max(SMALL * module, SLIDERS * abs(field.value))
        return max(-far, field.low), min(far, field.high)
    return None


class KeyControl:
    """The control of one key.

    field : of the design that is shown;  module : mm, of that design
    change : called with the field, a new entry, and whether its slider still moves
    """

    def __init__(
        self,
        field: FormField,
        module: float,
        change: Callable[[FormField, Any, bool], Awaitable[None]],
    ) -> None:
        self.field, self._module, self._change = field, module, change
        self._shown = self._moves = False
        self.slider: Slider | None = None
        with ui.element("div").classes("w-full q-mb-sm"):
            self.entry = self._make_entry()
            help_text = "; ".join(text for text in (field.text, field.allowed) if text)
            self.entry.classes("w-full").props("dense")
            with self.entry:  # above: the sentence of a refusal is below
                ui.tooltip(help_text).props('anchor="top middle" self="bottom middle"')
            self.entry.props["data-key"] = field.key
            self.entry.props["aria-description"] = help_text
            self.entry.props["aria-label"] = f"{field.key}, {field.unit}".rstrip(", ")
            if field.kind != "switch":  # the range where nothing points, too
                self.entry.props["hint"] = help_text
                self.entry.props("hide-hint hide-bottom-space")
            self.place = ui.element("div")
            self.refusal = ui.label().classes("text-negative text-caption").props("role=alert")
        self.show(field, None)

    def show(self, field: FormField, refused: tuple[Any, str] | None) -> None:
        """Show the value of the design, or an entry that was refused with its sentence."""
        self.field, self._shown = field, True
        value = refused[0] if refused is not None else _as_entry(field)
        if self.entry.value != value:
            self.entry.value = value
        if _is_number(field) and not self._moves:
            self._show_slider(field.value)
        self.refusal.text = "" if refused is None else refused[1]
        self.refusal.set_visibility(refused is not None)
        self._shown = False

    def _make_entry(self) -> Any:
        """A switch, a choice, or a field of text that is taken over when it is left."""
        field = self.field
        label = f"{field.name}, {field.unit}" if field.unit else field.name
        if field.kind == "switch":
            return ui.switch(label, value=bool(field.value), on_change=self._changed)
        if field.kind == "choice":
            choices = [*field.choices, *([""] if field.optional else [])]
            return ui.select(choices, value=_as_entry(field), label=label, on_change=self._changed)
        entry = ui.input(label, value=_as_entry(field))
        # the text of the event: that of the entry may arrive after it
        entry.on("change", lambda event: self._entered(event.args))
        return entry

    def _show_slider(self, value: float) -> None:
        """Put the slider to a value; one that does not reach it goes further then."""
        if self.slider is None or not self.slider.low <= value <= self.slider.high:
            if (ends := slider_range(self.field, self._module)) is None:
                return
            self.place.clear()
            step = 1.0 if self.field.kind == "whole number" else (ends[1] - ends[0]) / STEPS
            with self.place:
                self.slider = Slider(*ends, step, f"slider of {self.field.key}", self._slid)
            self.slider.props["data-slider"] = self.field.key
        self.slider.show(value)

    async def _changed(self) -> None:
        if not self._shown:
            await self._entered(self.entry.value)

    async def _entered(self, entry: Any) -> None:
        if entry != _as_entry(self.field):
            entry = None if entry == "" and self.field.optional else entry
            await self._change(self.field, entry, False)

    async def _slid(self, value: float, moves: bool) -> None:
        self._moves = moves
        await self._change(self.field, f"{value:.6g}", moves)


def _is_number(field: FormField) -> bool:
    """Whether a key has a number; one that is left out has none."""
    return field.kind in ("number", "whole number") and field.value is not None


def _as_entry(field: FormField) -> Any:
    """The value of a field as its control has it."""
    if field.kind == "switch":
        return bool(field.value)
    return "" if field.value is None else str(field.value)
