"""Files of other programs from a design or from a result, by the names of their formats."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from swgpar.design.drive_design import DriveDesign
from swgpar.drive_results.drive_data import DriveData
from swgpar.errors import InputError
from swgpar.exchange.calculix import write_calculix
from swgpar.exchange.dxf import write_dxf
from swgpar.exchange.flank_points import write_flank_points
from swgpar.exchange.fmu import write_fmu
from swgpar.exchange.points import write_points
from swgpar.exchange.step import write_step
from swgpar.exchange.tables import write_look_up, write_parquet
from swgpar.exchange.vtkhdf import write_vtkhdf
from swgpar.exchange.xdmf import write_xdmf
from swgpar.meshing import MeshRecipe
from swgpar.whole_files import whole_files

OF_DESIGN: Mapping[str, Callable[[DriveDesign, Path], list[Path]]] = {
    "step": write_step,
    "dxf": write_dxf,
    "csv": write_points,
    "teeth": write_flank_points,
}
"""Formats of a design: its geometry."""

ON_MESH = "inp"
"""Format of a design on a mesh: a job of another program."""

OF_RESULT: Mapping[str, Callable[[DriveData, Path], list[Path]]] = {
    "vtkhdf": write_vtkhdf,
    "xdmf": write_xdmf,
    "parquet": write_parquet,
    "lookup": write_look_up,
    "fmu": write_fmu,
}
"""Formats of a result: its fields and tables."""


def export_files(
    source: DriveDesign | DriveData,
    folder: Path,
    formats: Sequence[str],
    *,
    recipe: MeshRecipe | None = None,
    ripple: DriveData | None = None,
    idle: DriveData | None = None,
    overwrite: bool = False,
) -> list[Path]:
    """Write the files of the formats into a folder, which is made; call it on one rank. They get
    their names when all are complete.

    recipe : mesh of the formats that have one;  ripple : result over a period, for the format fmu
    idle : result without a torque, for the losses in the formats fmu and lookup
    overwrite : whether files that are there are replaced

    Raises OutputError where they are there otherwise, InputError for a format that the source does
    not have, one whose package or mesh is missing, or a mesh that no format has.
    """
    writers: dict[str, Callable[..., list[Path]]]
    if isinstance(source, DriveDesign):
        noun, writers = "a design", {**OF_DESIGN, ON_MESH: partial(write_calculix, recipe=recipe)}
    else:
        noun, writers = "a result", {**OF_RESULT}
        writers["fmu"] = partial(write_fmu, periodic=ripple, idle=idle)
        writers["lookup"] = partial(write_look_up, idle=idle)
    for name in formats:
        if name not in writers:
            raise InputError(
                f'format = "{name}" is not available for {noun}: allowed {", ".join(writers)}'
            )
        if name == ON_MESH and recipe is None:
            raise InputError(f'format = "{name}" needs a mesh recipe: --mesh, or mesh= in Python')
    if recipe is not None and ON_MESH not in formats:
        raise InputError(f"a mesh recipe is of no use without the format {ON_MESH}")
    given = {"ripple": ripple, "idle": idle}
    for option, allowed in (("ripple", ("fmu",)), ("idle", ("fmu", "lookup"))):
        if given[option] is not None and not set(formats) & set(allowed):
            raise InputError(
                f"--{option} is not available for the format {', '.join(formats)}: allowed with "
                f"{' and '.join(allowed)}"
            )
    with whole_files(folder, overwrite=overwrite) as made:
        paths = [path for name in formats for path in writers[name](source, made)]
    return [folder / path.name for path in paths]
