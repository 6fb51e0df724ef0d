"""Summaries of format 1, which had no number: the same values under other keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import asdict, fields
from typing import Any

import numpy as np

from swgpar.evaluation.largest_contact import largest_contact
from swgpar.evaluation.numerics import evaluate_numerics
from swgpar.evaluation.rotation import Rotation
from swgpar.evaluation.safety_and_life import CRITERIA, Life
from swgpar.evaluation.step_values import step_values
from swgpar.results.history import Row
from swgpar.results.table import as_rows


def from_first_format(
    content: Mapping[str, Any], rows: Sequence[Row], pairs: Mapping[str, np.ndarray]
) -> dict[str, Any]:
    """The content as it would stand in the present format.

    rows : of history.csv;  pairs : columns of pairs.csv. They have what the summary lacked.
    """
    found = dict(content)
    computed = rows[: content["increments"]]
    found["design"] = _with_materials(content["design"])
    found["rotation"] = {
        field.name: content[field.name] for field in fields(Rotation) if field.name in content
    }
    found["stresses"] = {name: content[name] for name in ("places", "regions")}
    found["steps"] = asdict(step_values(rows))
    found["numerics"] = asdict(evaluate_numerics(computed, content["condensed_MPa"]))
    found["program"] = (
        {"stages": content["program"]} if content["design"]["load"]["program"] else None
    )
    if content["contact"] and (contact := largest_contact(as_rows(pairs))):
        found["contact"] = asdict(contact)
    if fatigue := content["fatigue"]:
        found["fatigue"] = {
            **fatigue,
            "least": {name: fatigue[name] for name in CRITERIA},
            "regions": {
                name: {**region, "safety": {criterion: region[criterion] for criterion in CRITERIA}}
                for name, region in fatigue["regions"].items()
            },
            "windows": content["bearing"] is None and content["program"] is None,
            "life": {field.name: fatigue[field.name] for field in fields(Life)},
        }
    return found


def _with_materials(design: Mapping[str, Any]) -> dict[str, Any]:
    """The design with sections of materials in place of E and nu of the housing and of the
    bearing."""
    found = deepcopy(dict(design))
    general = found["material"]
    for section in (found["ring_gear"].get("housing"), found["wave_generator"].get("bearing")):
        if section:
            own = {name: section.pop(name, None) for name in ("E", "nu")}
            given = {name: value for name, value in own.items() if value is not None}
            section["material"] = {**general, **given} if given else None
    return found
