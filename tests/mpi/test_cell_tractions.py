"""Tangential tractions of the flanks' cells as rows of a file; the same tests on 1 and 2 ranks."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

from swgpar.contact.friction import NO_TOOTH, CellTractions, PairKey, from_rows, to_rows

SECTORS = 7


def tractions(comm: MPI.Comm) -> tuple[dict[PairKey, CellTractions], int, int]:
    """Those of the flanks of this rank's sectors, and these; some flanks touch nothing, and ranks
    have different numbers of cells."""
    first, end = (SECTORS * (comm.rank + k) // comm.size for k in (0, 1))
    store = {}
    for sector in range(first, end):
        for side in (1, -1):
            n = (3 * sector + side) % 5
            if n:
                rng = np.random.default_rng(10 * sector + side + 1)
                ends = np.sort(rng.uniform(0.0, 2.0, (n, 2)), axis=1)
                store[sector, side, sector - 3] = CellTractions(
                    np.sort(rng.integers(0, 4, n)), *ends.T, rng.uniform(-9.0, 9.0, (n, 2))
                )
    return store, first, end


def assert_same(a: dict[PairKey, CellTractions], b: dict[PairKey, CellTractions]) -> None:
    assert a.keys() == b.keys() and len(a) > 0
    for key, cells in a.items():
        for name in ("line", "low", "high", "traction"):
            np.testing.assert_array_equal(getattr(cells, name), getattr(b[key], name))
        assert b[key].line.dtype == np.int64


@pytest.mark.parallel([1, 2])
def test_rows_of_all_ranks_give_the_tractions_back() -> None:
    comm = MPI.COMM_WORLD
    store, first, end = tractions(comm)
    # a flank of another rank's sector is left to that rank
    elsewhere = (end % SECTORS, 1, 0) if comm.size > 1 else None
    seen = dict(store)
    if elsewhere is not None:
        seen[elsewhere] = CellTractions(
            np.zeros(9, dtype=np.int64), *np.ones((2, 9)), np.ones((9, 2))
        )
    rows = to_rows(seen, first, end, comm)
    assert all(len(values) == end - first for values in rows.values())
    whole = {name: np.concatenate(comm.allgather(values)) for name, values in rows.items()}
    every = {key: cells for part in comm.allgather(store) for key, cells in part.items()}
    assert_same(every, from_rows(whole))


def test_no_tractions() -> None:
    rows = to_rows({}, 0, SECTORS, MPI.COMM_SELF)
    tooth, _ = rows.values()
    assert (tooth == NO_TOOTH).all() and from_rows(rows) == {}
