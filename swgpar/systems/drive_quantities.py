"""Quantities of a drive that studies tabulate: the answers that are known before a run."""

from __future__ import annotations

from collections.abc import Mapping

from swgpar.design.drive_design import DriveDesign
from swgpar.results.quantity import Quantity

MAIN = ("mean.fs_s1", "mean.fs_s3", "mean.fs_vm", "mean.rg_vm", "mean.wg_torque_Nmm")
"""Those that tables and figures show."""


def quantities(design: DriveDesign) -> dict[str, Quantity]:
    """Known quantities of a design: "mean.fs_s1" over the rotation, "step1.fs_s1" at the end of a
    step, and so on."""
    from swgpar.drive_results.summary import known_answers  # a check needs no evaluations

    return {name: Quantity(kind.text, kind.unit) for name, kind in known_answers(design).items()}


def main_quantities(known: Mapping[str, Quantity]) -> tuple[str, ...]:
    """Names of those of `quantities` that tables and figures show."""
    if MAIN[0] in known:
        return MAIN
    of_program = tuple(name for name in known if name.startswith(("stiffness.", "ratcheting.")))
    return of_program or tuple(
        name for name in known if name.endswith((".torque_Nm", ".rotation_arcmin"))
    )


def describe_names(known: Mapping[str, Quantity]) -> str:
    """What a refusal of an unknown name says is allowed, of `quantities`."""
    names = [name for name in known if not name.startswith("step")]
    steps = ", or step1. to step4. with a column of history.csv" if len(names) < len(known) else ""
    return f"{', '.join(names)}{steps}"
