"""Where the nodal fields of a finished run are read from: its files, or the memory of the ranks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, Protocol

import h5py
import numpy as np
from mpi4py import MPI

from swgpar.errors import InputError, OutputError
from swgpar.results.atomic import reason_of
from swgpar.results.fields import (
    FLANKS,
    MESH,
    BodyPart,
    FlankGrids,
    increment_name,
    stored,
)
from swgpar.results.folder import FIELD_INDEX, FIELDS


class BodyMesh(NamedTuple):
    """Mesh of the modelled part of a body.

    points : (n, 3) float64, mm, undeformed; sector by sector, nodes between two appear twice
    cells : (m, 8) int64, hexahedra in VTK order
    """

    points: np.ndarray
    cells: np.ndarray


class FieldSource(Protocol):
    """Mesh and nodal fields of a run, whole and the same on every rank; every call is collective.

    Attributes
    ----------
    gathered : whether the ranks hold the fields together; else each can read them alone
    """

    gathered: bool

    @property
    def increments(self) -> Sequence[int]:
        """Increments that have fields: their rows in the history, from 1."""

    def mesh(self, body: str) -> BodyMesh:
        """Mesh of the modelled part of a body."""

    def flanks(self, body: str) -> FlankGrids:
        """Nodes of the flanks of one sector of a body."""

    def names(self, body: str, increment: int) -> tuple[str, ...]:
        """Fields of a body at one of `increments`."""

    def read(self, body: str, name: str, increment: int) -> np.ndarray:
        """A nodal field (n[, n_components]) of a body at one of `increments`."""


class FieldFiles:
    """Fields in the files of a results folder."""

    gathered = False

    def __init__(self, folder: Path) -> None:
        self._folder = folder / FIELDS
        with h5py.File(folder / FIELD_INDEX, "r") as file:
            parts = [name for name in file if name != MESH]
        self.increments = sorted(int(name.rpartition("_")[2]) for name in parts)

    def mesh(self, body: str) -> BodyMesh:
        return BodyMesh(*(self._get(MESH, f"{body}/{name}") for name in ("points", "cells")))

    def flanks(self, body: str) -> FlankGrids:
        return FlankGrids(*(self._get(MESH, f"{body}/{name}") for name in FLANKS))

    def names(self, body: str, increment: int) -> tuple[str, ...]:
        with self._open(increment_name(increment)) as file:
            return tuple(file[body])

    def read(self, body: str, name: str, increment: int) -> np.ndarray:
        return self._get(increment_name(increment), f"{body}/{name}")

    def _open(self, part: str) -> h5py.File:
        path = self._folder / f"{part}.h5"
        try:
            return h5py.File(path, "r")
        except OSError as error:
            raise OutputError(f"cannot read {path}: {reason_of(error)}") from None

    def _get(self, part: str, name: str) -> np.ndarray:
        with self._open(part) as file:
            return file[name][:]


class FieldParts:
    """Fields in memory: every rank keeps those of its sectors; reading gathers them."""

    gathered = True

    def __init__(self, comm: MPI.Comm, bodies: Mapping[str, BodyPart]) -> None:
        self._comm, self._bodies = comm, bodies
        self._fields: dict[str, dict[int, dict[str, np.ndarray]]] = {body: {} for body in bodies}

    @property
    def increments(self) -> list[int]:
        return sorted(next(iter(self._fields.values())))

    def keep(self, increment: int, fields: Mapping[str, Mapping[str, np.ndarray]]) -> None:
        """Keep fields of this rank: body -> name -> (n_sectors, n_local[, n_components])."""
        for body, values in fields.items():
            self._fields[body][increment] = {
                name: stored(name, array) for name, array in values.items()
            }

    def mesh(self, body: str) -> BodyMesh:
        part = self._bodies[body]
        n_local = part.points.shape[1]
        sector = np.arange(part.total)[:, None, None] * n_local
        points = self._gather(part, part.points.reshape(-1, 3))
        return BodyMesh(points, (part.cells + sector).reshape(-1, 8))

    def flanks(self, body: str) -> FlankGrids:
        grids = self._bodies[body].flanks
        assert grids is not None  # it is asked of gears only
        return grids

    def names(self, body: str, increment: int) -> tuple[str, ...]:
        return tuple(sorted(self._fields[body][increment]))

    def read(self, body: str, name: str, increment: int) -> np.ndarray:
        return self._gather(self._bodies[body], self._fields[body][increment][name])

    def _gather(self, part: BodyPart, rows: np.ndarray) -> np.ndarray:
        """All rows of a body on every rank, from the rows of the sectors that each rank owns."""
        n_local = part.points.shape[1]
        whole = np.empty((part.total * n_local, *rows.shape[1:]), dtype=rows.dtype)
        spans = self._comm.allgather((part.first * n_local, len(rows)))
        # rank by rank: no message is larger than one part
        for rank, (first, count) in enumerate(spans):
            if rank == self._comm.rank:
                whole[first : first + count] = rows
            self._comm.Bcast(whole[first : first + count], root=rank)
        return whole


def chosen_increment(known: Sequence[int], increment: int) -> int:
    """The increment with an index in the list of those with fields; negative from the end."""
    if not -len(known) <= increment < len(known):
        raise InputError(
            f"increment = {increment} has no fields: allowed {-len(known)} to {len(known) - 1}"
        )
    return known[increment]
