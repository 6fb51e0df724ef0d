"""What a loaded state begins with: that of a coarser mesh, or that under another load."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from swgpar.analysis import coarse_start
from swgpar.load.load_states import LoadState, Stage
from swgpar.meshing import load_recipe

LOADED = LoadState(Stage.LOAD, 3, control="torque", torque=100.0)


@pytest.mark.parametrize(
    ("torque", "coarser", "expected"),
    [(95.0, True, "load"), (47.0, True, "mesh"), (-100.0, True, "mesh"), (47.0, False, "load")],
)
def test_a_state_under_another_load_is_a_start_where_loads_are_alike(
    torque: float, coarser: bool, expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun = []
    monkeypatch.setattr(coarse_start, "take_over", lambda *_: begun.append("mesh"))
    monkeypatch.setattr(coarse_start, "_advance", lambda _: begun.append("load"))
    models = SimpleNamespace(give_back=lambda _: None, keep_loaded=lambda _: None)
    drive: Any = SimpleNamespace(models=models, load=lambda *_: "on a coarser mesh")
    stepper: Any = SimpleNamespace(
        model=SimpleNamespace(phases=lambda _: nullcontext()),
        load_state=replace(LOADED, torque=torque),
        sequence=SimpleNamespace(start=LoadState(Stage.START, 0), loaded=LOADED),
    )
    coarse_start.start_loaded(stepper, drive, [load_recipe("forces")] if coarser else [])
    assert begun == [expected]
