"""Answers beside the section: loaded state, rating sheet, differences of variants, geometry."""

from __future__ import annotations

from nicegui import ui

from swgpar.app.plane_state import PlaneState
from swgpar.app.state import AppState
from swgpar.app.tables import heading, live_label, say, table
from swgpar.app.verdict_panel import VerdictPanel
from swgpar.checks.derived_geometry import derived_geometry
from swgpar.input.differences import differences
from swgpar.input.quantities import show, unit_of_key
from swgpar.results.quantity import with_unit


class AnswersPanel:
    """Answers of the variants that are shown."""

    def __init__(self, state: AppState) -> None:
        self.state = state
        heading("plane model, loaded")
        self.said = live_label().classes("text-caption")
        self.plane()
        self.verdict = VerdictPanel(state)
        self.changes()
        with ui.expansion("derived geometry", on_value_change=self._opened) as self.folded:
            self.geometry()
        self.folded.classes("w-full")

    def draw(self) -> None:
        """Draw what depends on designs."""
        self.plane.refresh()
        self.verdict.draw()
        self.changes.refresh()
        if self.folded.value:
            self.geometry.refresh()

    @ui.refreshable_method
    def plane(self) -> None:
        """Answers of the plane model under the torque of the design."""
        worker, shown = self.state.worker, self.state.shown
        states = [worker.state(variant.design) for variant in shown]
        self.said.props["data-plane-state"] = "busy" if worker.is_busy else "computed"
        self.said.update()
        say(self.said, "is computed …" if worker.is_busy else _computed(states))
        for found in states:
            if found is not None and found.reason:
                ui.label(found.reason).classes("text-negative text-caption").props("role=alert")
        texts = [_texts(found) for found in states]
        names = list(dict.fromkeys(name for one in texts for name in one))
        if names:
            headings = [variant.name for variant in shown] if len(shown) > 1 else ["value"]
            rows = [[name, *(one.get(name, "") for one in texts)] for name in names]
            table(["answer", *headings], rows, "plane model").classes("swgpar-plane")

    @ui.refreshable_method
    def changes(self) -> None:
        """Keys in which the variants differ."""
        if len(self.state.shown) < 2:
            return
        first, second = (variant.design for variant in self.state.shown)
        heading("keys that differ")
        rows = [
            [with_unit(one.key, unit_of_key(first, one.key)), _value(one.first), _value(one.second)]
            for one in differences(first, second)
        ]
        names = [variant.name for variant in self.state.shown]
        if not rows:
            ui.label("none").classes("text-caption")
            return
        table(["key", *names], rows, "keys that differ").classes("swgpar-changes")

    @ui.refreshable_method
    def geometry(self) -> None:
        """What follows from the design without a run; slower than the section, so folded."""
        if self.folded.value:
            values = derived_geometry(self.state.variant.design)
            rows = [[name, f"{value:.6g}"] for name, value in values.items()]
            table(["quantity", "value"], rows, "derived geometry")

    def _opened(self) -> None:
        self.geometry.refresh()


def _computed(states: list[PlaneState | None]) -> str:
    """How long the first state has taken."""
    if states[0] is None:
        return ""
    return f"computed in {states[0].seconds:.1f} s; no estimate of errors by the mesh"


def _texts(state: PlaneState | None) -> dict[str, str]:
    """Values of answers by their texts."""
    if state is None:
        return {}
    return {
        one.text: f"{one.value:.4g} {one.unit}"
        + ("" if one.error is None else f" ± {one.error:.2g}")
        for one in state.answers
    }


def _value(value: object) -> str:
    return "—" if value is None else show(value)
