"""Tables of a drive's run beside its history: contacts of flanks, fatigue and losses; in memory or
in files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from mpi4py import MPI

from swgpar.results.atomic import write_from_root
from swgpar.results.folder import (
    BALLS,
    CONTACT_LINES,
    CYCLE,
    LOSSES,
    PAIRS,
    PROGRAM,
    TRANSMISSION_ERROR,
)
from swgpar.results.sector_fields import SectorFields, read_sector, write_sector
from swgpar.results.table import format_columns, read_columns

Columns = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class DriveTables:
    """Columns of the tables, empty where there are none.

    pairs, contact_lines : contacts of the flanks under load;  program : points of a load program
    turns : transmission error over the sampled period or whole turns;  balls : loads of a bearing's
    balls
    cycle : stress where the safety is the least
    losses : at the angles of the sampled period;  sector : safety factors at the nodes of a sector,
    None without
    """

    pairs: Columns = field(default_factory=dict)
    contact_lines: Columns = field(default_factory=dict)
    program: Columns = field(default_factory=dict)
    turns: Columns = field(default_factory=dict)
    balls: Columns = field(default_factory=dict)
    cycle: Columns = field(default_factory=dict)
    losses: Columns = field(default_factory=dict)
    sector: SectorFields | None = None

    def write(self, folder: Path, comm: MPI.Comm) -> None:
        """Write what is evaluated at the end of a run; collective."""
        for name, columns in ((CYCLE, self.cycle), (LOSSES, self.losses)):
            if columns:
                write_from_root(comm, folder / name, format_columns(columns))
        if self.sector is not None:
            write_sector(folder, comm, self.sector)


def read_tables(folder: Path) -> DriveTables:
    """The tables in a results folder."""

    def columns(name: str) -> Columns:
        return read_columns(folder / name) if (folder / name).exists() else {}

    return DriveTables(
        pairs=columns(PAIRS),
        contact_lines=columns(CONTACT_LINES),
        program=columns(PROGRAM),
        turns=columns(TRANSMISSION_ERROR),
        balls=columns(BALLS),
        cycle=columns(CYCLE),
        losses=columns(LOSSES),
        sector=read_sector(folder),
    )
