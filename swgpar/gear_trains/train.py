"""Gear trains by name: their design files, runs and figures."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import scipy
from mpi4py import MPI

from swgpar import log
from swgpar.errors import InputError
from swgpar.gear_trains import cascade, gear_pair, planetary, ring
from swgpar.gear_trains.common_sections import TrainDesign
from swgpar.gear_trains.published import Quantities, check_published, compare
from swgpar.gear_trains.result import TrainResult, write
from swgpar.input.quantities import show
from swgpar.input.toml_file import apply_overrides, read_toml, validate
from swgpar.log import logger
from swgpar.results.atomic import agreed
from swgpar.results.folder import prepare
from swgpar.version import __version__

SECTION = "gear_train"
"""The section that makes a design file that of a gear train."""


@dataclass(frozen=True)
class TrainModel:
    """A kind of gear train.

    design : its design file;  check_fit : refuses values that do not fit each other
    quantities : what can be compared;  derived : for `swgpar check`;  compute : all results;  draw : all figures
    """

    design: type[TrainDesign]
    check_fit: Callable[[Any], None]
    quantities: Callable[[Any], Quantities]
    derived: Callable[[Any], dict[str, float]]
    compute: Callable[[Any, MPI.Comm], TrainResult]
    draw: Callable[[Path, dict[str, Any]], list[Path]]


def _model(package: ModuleType, design: type[TrainDesign]) -> TrainModel:
    return TrainModel(design, package.check_fit, package.quantities, package.derived, package.compute, package.draw)


MODELS = {
    "cascade": _model(cascade, cascade.CascadeDesign),
    "gear_pair": _model(gear_pair, gear_pair.GearPairDesign),
    "planetary": _model(planetary, planetary.PlanetaryDesign),
    "ring": _model(ring, ring.RingDesign),
}


def is_gear_train(path: str | Path) -> bool:
    """Whether a design file is that of a gear train; every problem is an `InputError` of one sentence."""
    return SECTION in read_toml(path)


def load_train(path: str | Path, overrides: Sequence[str] = ()) -> TrainDesign:
    """Read and check the design file of a gear train; every problem is an `InputError` of one sentence."""
    return make_train(apply_overrides(read_toml(path), overrides))


def make_train(table: dict[str, Any]) -> TrainDesign:
    """A checked design from the content of its file; every problem is an `InputError` of one sentence."""
    section = table.get(SECTION)
    name = section.get("model") if isinstance(section, dict) else None
    choices = " or ".join(f'"{name}"' for name in MODELS)
    if name is None:
        raise InputError(f"{SECTION}.model is missing: allowed {choices}")
    if not isinstance(name, str) or name not in MODELS:
        raise InputError(f"{SECTION}.model = {show(name)} is not available: allowed {choices}")
    model = MODELS[name]
    design = validate(model.design, table)
    model.check_fit(design)
    check_published(design.published, model.quantities(design))
    return design


def model_of(design: TrainDesign) -> TrainModel:
    """The kind of a design."""
    return next(model for model in MODELS.values() if model.design is type(design))


def run_train(
    design: TrainDesign, out_dir: str | Path, *, overwrite: bool = False, comm: MPI.Comm = MPI.COMM_WORLD
) -> list[dict[str, Any]]:
    """Compute a gear train and write its results to `out_dir`; collective.

    Returns the rows of published.csv on all ranks. Raises InputError, OutputError or ConvergenceError on all ranks.
    """
    out, begin, model = Path(out_dir), time.perf_counter(), model_of(design)
    prepare(out, comm, False, overwrite)
    log.start(comm)
    with agreed(comm, out / "run.log"):
        log.to_file(out / "run.log", comm)
    result = model.compute(design, comm)
    compared = compare(design.published, result.quantities, model.quantities(design))
    summary = {
        "quantities": dict(result.quantities),
        **result.summary,
        "ranks": comm.size,
        "versions": {
            "swgpar": __version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "scipy": scipy.__version__,
        },
        "wall_s": time.perf_counter() - begin,
        "design": design.model_dump(),
    }
    write(TrainResult(result.history, result.tables, result.quantities, summary), compared, out, comm)
    logger.info("finished in %.1f s on %d ranks", summary["wall_s"], comm.size)
    return compared


def train_figures(out: Path, summary: dict[str, Any]) -> list[Path]:
    """Draw all figures of a finished run into out/figures; call it on one rank. summary : content of summary.json"""
    return MODELS[summary["design"][SECTION]["model"]].draw(out, summary)
