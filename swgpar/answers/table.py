"""Table of the answers of a run, by name."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from functools import cached_property

from swgpar.answers.answer import Answer, AnswerKind


class AnswerTable(Mapping[str, Answer]):
    """Mapping of the answers of a run by name; a summary derives from it."""

    @abstractmethod
    def answers(self) -> Iterator[Answer]:
        """The answers in the order in which they are shown."""

    def find(self, kind: AnswerKind) -> Answer | None:
        """The answer of this kind; None where the run does not have it."""
        return self._by_name.get(kind.name)

    @cached_property
    def _by_name(self) -> dict[str, Answer]:
        return {answer.name: answer for answer in self.answers()}

    def __getitem__(self, name: str) -> Answer:
        return self._by_name[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._by_name)

    def __len__(self) -> int:
        return len(self._by_name)
