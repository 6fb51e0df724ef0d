"""Answers beside the section: loaded state, rating sheet, differences of variants, geometry."""

from __future__ import annotations

from collections.abc import Iterator

from nicegui import ui

from swgpar.app.loaded_states import PLANE, SOLID, ShownState
from swgpar.app.state import AppState
from swgpar.app.tables import heading, live_label, say, table
from swgpar.app.verdict_panel import VerdictPanel
from swgpar.app.workspace import Variant
from swgpar.checks.clearance import clearances
from swgpar.checks.derived_geometry import derived_geometry
from swgpar.input.differences import differences
from swgpar.input.quantities import show, unit_of_key
from swgpar.results.quantity import with_unit

LONG = 2.0
"""Seconds of a computation from which it can be cancelled: a shorter one would show a button that
goes at once."""


class AnswersPanel:
    """Answers of the variants that are shown."""

    def __init__(self, state: AppState) -> None:
        self.state = state
        heading("loaded state")
        choices = {False: PLANE.name, True: SOLID.name}
        self.model = ui.toggle(choices, value=state.choices.is_solid, on_change=self._choose)
        self.model.props("dense no-caps size=sm").classes("swgpar-toggle")
        self.said = live_label().classes("text-caption")
        with ui.row().classes("items-center"):
            self.cancel = ui.button("cancel", on_click=self._cancel).props("flat dense")
            self.cancel.props["aria-label"] = "cancel the loaded state"
            self.go_on = ui.button("compute", on_click=self._go_on).props("flat dense")
        self.states()
        self.verdict = VerdictPanel(state)
        self.changes()
        with ui.expansion("derived geometry", on_value_change=self._opened) as self.folded:
            self.geometry()
        self.folded.classes("w-full")

    def draw(self) -> None:
        """Draw what depends on designs."""
        self.states.refresh()
        self.verdict.draw()
        self.changes.refresh()
        if self.folded.value:
            self.geometry.refresh()

    def draw_progress(self) -> None:
        """Say where the computation of the state is, or how long it has taken."""
        worker = self.state.worker
        busy = "busy" if worker.is_busy else "computed"
        if self.said.props.get("data-loaded-state") != busy:
            self.said.props["data-loaded-state"] = busy
            self.said.update()
        self.cancel.set_visibility(worker.is_busy and worker.seconds > LONG)
        self.go_on.set_visibility(worker.is_cancelled)
        if worker.is_busy:
            say(self.said, " ".join(filter(None, ("computing", worker.progress, "…"))))
        elif worker.is_cancelled:
            say(self.said, "cancelled")
        else:
            say(self.said, _computed(self.state.loaded_state(self.state.variant)))

    @ui.refreshable_method
    def states(self) -> None:
        """Answers of loaded states under the torque of the design."""
        state = self.state
        self.model.set_visibility(state.variant.design.drive.model != "plane")
        self.model.value = state.choices.is_solid
        self.draw_progress()
        for text in dict.fromkeys(text for one in state.shown for text in self._overlaps(one)):
            ui.label(text).classes("text-negative text-caption")
        shown = [(one.name, state.loaded_state(one)) for one in state.shown]
        if len(shown) == 1:
            model = state.model_of(state.variant)
            plane = state.workers[PLANE].state(state.variant.design)
            shown = [(model.name, shown[0][1])]
            shown = [(PLANE.name, plane), *shown] if model is SOLID else shown
        for name, found in shown:
            if found is not None and found.reason:
                text = f"{name}: {found.reason}" if len(shown) > 1 else found.reason
                ui.label(text).classes("text-negative text-caption").props("role=alert")
        texts = [_texts(found) for _, found in shown]
        names = list(dict.fromkeys(name for one in texts for name in one))
        if names:
            rows = [[name, *(one.get(name, "") for one in texts)] for name in names]
            places = _places(state.loaded_state(state.variant))
            notes = [places.get(name, "") for name in names]
            headings = ["answer", *(name for name, _ in shown)]
            table(headings, rows, "loaded state", notes).classes("swgpar-loaded")

    def _overlaps(self, variant: Variant) -> Iterator[str]:
        """What overlaps of rigid teeth mean for the loaded state of a variant."""
        for one in clearances(variant.design.rigid_pairs):
            if not one.overlaps:
                continue
            what = f"teeth overlap with the {one.ring.replace('_', ' ')}"
            if one.ring == "ring_gear" or self.state.model_of(variant) is SOLID:
                yield f"{what} before they are loaded: a state takes longer, or is not found"
            else:
                yield f"{what}, which the plane model does not have"

    def _choose(self) -> None:
        if bool(self.model.value) != self.state.choices.is_solid:
            self.state.choose_model(bool(self.model.value))

    def _cancel(self) -> None:
        self.state.worker.cancel()
        self.state.draw_states()

    def _go_on(self) -> None:
        self.state.worker.go_on()
        self.state.draw_states()

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


def _computed(state: ShownState | None) -> str:
    """How long a state has taken."""
    if state is None:
        return ""
    return f"computed in {state.seconds:.1f} s; no estimate of errors by the mesh"


def _texts(state: ShownState | None) -> dict[str, str]:
    """Values of answers by their texts."""
    if state is None:
        return {}
    return {
        one.text: f"{one.value:.4g} {one.unit}"
        + ("" if one.error is None else f" ± {one.error:.2g}")
        for one in state.answers
    }


def _places(state: ShownState | None) -> dict[str, str]:
    """Places of answers by their texts."""
    return {one.text: one.place for one in state.answers} if state is not None else {}


def _value(value: object) -> str:
    return "—" if value is None else show(value)
