"""Arguments of another type in the Python interface: one sentence that names the argument."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import swgpar
from support.paths import DESIGN, DRIVERS, RECIPE
from support.small_drive import PLANE
from swgpar.errors import InputError

STARTER = {"ratio": 50, "torque": 1.0, "diameter": 40.0}
PAIR = {"study": {"design": str(DRIVERS / "gear_pair.toml")}}

CALLS: dict[str, Callable[..., Any]] = {
    "design": lambda d: swgpar.load_design(5),
    "overrides": lambda d: swgpar.load_design(DESIGN, 5),
    "overrides = .*text": lambda d: swgpar.load_design(DESIGN, [5]),
    "overrides = .*texts": lambda d: swgpar.load_design(DESIGN, {5: 1}),
    "overrides = .* list": lambda d: d.with_values(5),
    "mesh": lambda d: swgpar.run(d, 5),
    "out": lambda d: swgpar.run(d, RECIPE, 5),
    "accuracy": lambda d: swgpar.run(d, RECIPE, accuracy="x"),
    "restart": lambda d: swgpar.run(d, RECIPE, restart="no"),
    "comm": lambda d: swgpar.run(d, RECIPE, comm=5),
    "folder": lambda d: swgpar.open_result(5),
    "study": lambda d: swgpar.study(5),
    "study.design": lambda d: swgpar.study({"study": {"design": object()}}),
    "out = 6": lambda d: swgpar.study(PAIR, 6),
    "optimisation": lambda d: swgpar.optimise(5, "out"),
    "out = 7": lambda d: swgpar.optimise("search.toml", 7),
    "out = 8": lambda d: swgpar.rate(d, 8),
    "formats": lambda d: swgpar.export(d, "out", "step"),
    "formats = 5": lambda d: swgpar.export(d, "out", 5),
    "out = 9": lambda d: swgpar.export(d, 9, ["csv"]),
    "formats = .vtu.": lambda d: swgpar.mesh(d, RECIPE, "out", "vtu"),
    "out = 10": lambda d: swgpar.mesh(d, RECIPE, 10),
    "ratio": lambda d: swgpar.new(**{**STARTER, "ratio": "x"}),
    "torque": lambda d: swgpar.new(**{**STARTER, "torque": None}),
    "diameter": lambda d: swgpar.new(**{**STARTER, "diameter": "40"}),
    "profile": lambda d: swgpar.new(**STARTER, profile="x"),
    "cam": lambda d: swgpar.new(**STARTER, cam=5),
    "model": lambda d: swgpar.new(**STARTER, model="x"),
    "shape": lambda d: swgpar.new(**STARTER, shape="x"),
    "layout": lambda d: swgpar.new(**STARTER, layout="x"),
    "lobes": lambda d: swgpar.new(**STARTER, lobes=7),
    "out = 11": lambda d: swgpar.new(11, **STARTER),
}


@pytest.mark.parametrize("name", CALLS)
def test_other_types_are_refused(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    if name.startswith(("optimisation", "out = 7")):
        pytest.importorskip("optuna")
    design = swgpar.load_design(DESIGN, PLANE)
    with pytest.raises(InputError, match=rf"(^|: ){name}") as caught:
        CALLS[name](design)
    assert str(caught.value).isprintable() and not list(tmp_path.iterdir())
