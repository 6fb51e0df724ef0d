"""The nodes that one rank sees, numbered from 0: its own and ghosts."""

from __future__ import annotations

import numpy as np

from swgpar.fem.partition import Partition


class LocalNodes:
    """The nodes a rank sees: its own, in global order, then ghosts, then additional ghosts.

    needed : global block numbers whose local indices do not depend on the additional ones; negative
    ones are ignored
    additional : more global block numbers, indexed after all of those
    """

    def __init__(
        self, partition: Partition, needed: np.ndarray, additional: np.ndarray | None = None
    ) -> None:
        self.partition = partition
        self.row_start, self.n_own = partition.row_start, partition.n_own
        self.ghosts = self._foreign(needed)
        extra = self._foreign(additional) if additional is not None else np.zeros(0, dtype=np.int64)
        self.additional = np.setdiff1d(extra, self.ghosts)
        own = np.arange(self.row_start, self.row_start + self.n_own)
        self.number = np.concatenate([own, self.ghosts, self.additional]).astype(np.int32)

    def extended(self, additional: np.ndarray) -> LocalNodes:
        """These nodes and additional ones (n,) global numbers; the indices of these stay."""
        return LocalNodes(self.partition, self.ghosts, additional)

    def _foreign(self, number: np.ndarray) -> np.ndarray:
        number = np.unique(number)
        return number[~self.partition.owns(number) & (number >= 0)].astype(np.int64)

    def __len__(self) -> int:
        return len(self.number)

    def index(self, number: np.ndarray) -> np.ndarray:
        """Local index (int32) of global numbers; -1 for -1 and for nodes this rank does not see."""
        number = np.asarray(number)
        index = np.where(self.partition.owns(number), number - self.row_start, -1)
        first = self.n_own
        for ghosts in (self.ghosts, self.additional):
            if len(ghosts):
                position = np.minimum(np.searchsorted(ghosts, number), len(ghosts) - 1)
                index = np.where(ghosts[position] == number, first + position, index)
            first += len(ghosts)
        return index.astype(np.int32)
