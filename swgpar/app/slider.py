"""The slider of the browser, which keyboards and screen readers know."""

from __future__ import annotations

from collections.abc import Awaitable, Callable

from nicegui import events, ui

VALUE = "(event) => emit(Number(event.target.value))"

MOVING = 0.15
"""Seconds between two changes while a slider moves."""


class Slider(ui.element):
    """A slider between two numbers.

    moved : called with its value, and whether it still moves
    """

    def __init__(
        self,
        low: float,
        high: float,
        step: float,
        name: str,
        moved: Callable[[float, bool], Awaitable[None]],
    ) -> None:
        super().__init__("input")
        self.low, self.high = low, high
        self._place = low  # in the browser
        self.props["type"], self.props["aria-label"] = "range", name
        self.props["min"], self.props["max"], self.props["step"] = low, high, step
        self.props["value"] = low
        self.classes("swgpar-slider")

        async def moves(event: events.GenericEventArguments) -> None:
            self._place = float(event.args)
            await moved(self._place, True)

        async def rests(event: events.GenericEventArguments) -> None:
            self._place = float(event.args)
            await moved(self._place, False)

        self.on("input", moves, throttle=MOVING, js_handler=VALUE)
        self.on("change", rests, js_handler=VALUE)

    def show(self, value: float) -> None:
        """Put it to a value; nothing is sent where it stands there, and was put there: the browser
        draws what it was put to whenever it draws the window."""
        if (value, value) != (self._place, self.props["value"]):
            self._place = self.props["value"] = value
            self.update()
