"""Files of other programs from a design or from a result, by the names of their formats."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from swgpar.analysis.drive_result import DriveResult
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.exchange.dxf import write_dxf
from swgpar.exchange.fmu import write_fmu
from swgpar.exchange.step import write_step
from swgpar.exchange.tables import write_look_up, write_parquet
from swgpar.exchange.vtkhdf import write_vtkhdf
from swgpar.exchange.xdmf import write_xdmf

OF_DESIGN: Mapping[str, Callable[[DriveDesign, Path], list[Path]]] = {"step": write_step, "dxf": write_dxf}
"""Formats of a design: its geometry."""

OF_RESULT: Mapping[str, Callable[[DriveResult, Path], list[Path]]] = {
    "vtkhdf": write_vtkhdf,
    "xdmf": write_xdmf,
    "parquet": write_parquet,
    "lookup": write_look_up,
    "fmu": write_fmu,
}
"""Formats of a result: its fields and tables."""


def export_files(
    source: DriveDesign | DriveResult, folder: Path, formats: Sequence[str], ripple: DriveResult | None = None
) -> list[Path]:
    """Write the files of the formats into a folder, which is made; call it on one rank.

    ripple : result over a period, for the format fmu

    Raises
    ------
    InputError
        A format that the source does not have, or one whose package is missing.
    """
    writers: dict[str, Callable[[Any, Path], list[Path]]]
    writers = dict(OF_DESIGN if isinstance(source, DriveDesign) else OF_RESULT)
    noun = "a design" if isinstance(source, DriveDesign) else "a result"
    for name in formats:
        if name not in writers:
            raise InputError(f'format = "{name}" is not available for {noun}: allowed {", ".join(writers)}')
    if ripple is not None:
        if "fmu" not in formats:
            raise InputError(f"--ripple is not available for the format {', '.join(formats)}: allowed with fmu")
        writers["fmu"] = partial(write_fmu, periodic=ripple)
    folder.mkdir(parents=True, exist_ok=True)
    return [path for name in formats for path in writers[name](source, folder)]
