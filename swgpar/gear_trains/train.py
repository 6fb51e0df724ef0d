"""Gear trains by name: their design files, runs and figures."""

from __future__ import annotations

import platform
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol, TypeVar

import numpy as np
import scipy
from mpi4py import MPI

from swgpar.errors import InputError, OutputError
from swgpar.gear_trains import cascade, gear_pair, planetary, planetary_stage, ring
from swgpar.gear_trains.common_sections import TrainDesign
from swgpar.gear_trains.published import check_published, compare
from swgpar.gear_trains.result import (
    Computed,
    StoredTrainSummary,
    TrainResult,
    TrainSummary,
    read,
    summary_from,
    write,
)
from swgpar.input.quantities import show
from swgpar.input.toml_file import validate
from swgpar.log import logger, ranks_text
from swgpar.results.atomic import agreed, reason_of
from swgpar.results.figure_set import Drawings, NamedFigures
from swgpar.results.folder import SUMMARY, TRAIN_RESULTS, open_log, prepare, read_summary
from swgpar.results.lock import releasing
from swgpar.results.quantity import Quantity
from swgpar.run_options import RunOptions
from swgpar.version import __version__

SECTION = "gear_train"
"""The section that makes a design file that of a gear train."""


D = TypeVar("D", bound=TrainDesign, contravariant=True)


class TrainModel(Protocol[D]):
    """A kind of gear train: a package with these names.

    Design : its design file;  check_fit : refuses values that do not fit each other
    quantities : what can be compared;  derived : for `swgpar check`
    compute : all results;  drawings : all figures of a result
    """

    @property
    def Design(self) -> type[TrainDesign]: ...
    def check_fit(self, design: D) -> None: ...
    def quantities(self, design: D) -> Mapping[str, Quantity]: ...
    def derived(self, design: D) -> dict[str, float]: ...
    def compute(self, design: D, comm: MPI.Comm) -> Computed: ...
    def drawings(self, result: TrainResult) -> Drawings: ...


MODELS: dict[str, TrainModel[Any]] = {
    "cascade": cascade,
    "gear_pair": gear_pair,
    "planetary": planetary,
    "planetary_stage": planetary_stage,
    "ring": ring,
}


def make_train(table: dict[str, Any]) -> TrainDesign:
    """A checked design from the content of its file; problems are InputErrors of one sentence."""
    section = table.get(SECTION)
    name = section.get("model") if isinstance(section, dict) else None
    choices = " or ".join(f'"{name}"' for name in MODELS)
    if name is None:
        raise InputError(f"{SECTION}.model is missing: allowed {choices}")
    if not isinstance(name, str) or name not in MODELS:
        raise InputError(f"{SECTION}.model = {show(name)} is not available: allowed {choices}")
    model = MODELS[name]
    design = validate(model.Design, table).made_by(make_train)
    model.check_fit(design)
    known = model.quantities(design)
    for section, given in design.to_compare().items():
        check_published(given, known, section)
    return design


def model_of(design: TrainDesign) -> TrainModel[Any]:
    """The kind of a design."""
    return next(model for model in MODELS.values() if model.Design is type(design))


@releasing
def run_train(design: TrainDesign, options: RunOptions) -> TrainResult:
    """Compute a gear train; collective. Of the options it has `out`, `overwrite` and `comm`.

    Raises
    ------
    InputError, OutputError, ConvergenceError
        On all ranks.
    """
    folder, comm, model = options.out, options.comm, model_of(design)
    begin = time.perf_counter()
    if folder is not None:
        prepare(folder, comm, TRAIN_RESULTS, restart=False, overwrite=options.overwrite)
    open_log(folder, comm)
    for sentence in design.remarks():
        logger.warning(sentence)
    with reported_arithmetic():
        computed = model.compute(design, comm)
    require_finite(computed.quantities)
    seconds = comm.bcast(time.perf_counter() - begin)
    values, known = computed.quantities, model.quantities(design)
    result = TrainResult(
        computed.history,
        computed.tables,
        TrainSummary(values, comm.size, _versions(), seconds, computed.task_s, design, known),
        [
            row
            for section, given in design.to_compare().items()
            for row in compare(given, values, known, section)
        ],
        None if folder is None else folder.absolute(),
    )
    if folder is not None:
        write(result, folder, comm)
    logger.info("finished in %.1f s on %s", seconds, ranks_text(comm.size))
    return _with_figures(result, comm)


@contextmanager
def reported_arithmetic() -> Iterator[None]:
    """Refuse values in their ranges that are too far apart for the arithmetic in the block."""
    try:
        with np.errstate(all="ignore"):  # what is not finite then is found in the results
            yield
    except (np.linalg.LinAlgError, ArithmeticError, ValueError, MemoryError) as error:
        raise InputError(
            f"the gear train cannot be computed with these values: {reason_of(error)}"
        ) from None


def require_finite(values: Mapping[str, float | list[float]]) -> None:
    """Refuse infinite results by name, or none at all. A NaN stands for what there is not."""
    numbers = {name: np.atleast_1d(value) for name, value in values.items()}
    infinite = [name for name, value in numbers.items() if np.isinf(value).any()]
    if infinite or all(np.isnan(value).all() for value in numbers.values()):
        what = f"{infinite[0]} is not finite" if infinite else "no result is a number"
        raise InputError(f"the gear train cannot be computed with these values: {what}")


def open_train(folder: Path, comm: MPI.Comm) -> TrainResult:
    """Result of a finished run from its folder; collective, every rank reads the files.

    Raises OutputError for a summary.json that this version does not read.
    """
    with agreed(comm, folder, "read"):
        stored = read_summary(folder)
        try:
            design = make_train(stored.design)
            content = StoredTrainSummary.model_validate(stored.model_dump())
            summary = summary_from(content, design, model_of(design).quantities(design))
        except (InputError, TypeError, ValueError):
            raise OutputError(
                f"{folder / SUMMARY} of swgpar {stored.written_by} is not the summary of a gear "
                f"train that swgpar {__version__} reads"
            ) from None
        result = read(folder.absolute(), stored, summary)
    return _with_figures(result, comm)


def _with_figures(result: TrainResult, comm: MPI.Comm) -> TrainResult:
    drawings = model_of(result.summary.design).drawings(result)
    return replace(result, plot=NamedFigures(drawings, comm))


def _versions() -> dict[str, str]:
    return {
        "swgpar": __version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
    }
