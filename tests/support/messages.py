"""What swgpar logs, for tests of messages."""

from __future__ import annotations

import logging

LOGGER = logging.getLogger("swgpar")


class Messages(logging.Handler):
    """Keeps what is logged inside `with`, on this rank."""

    def __init__(self) -> None:
        super().__init__()
        self.texts: list[str] = []
        self.earlier = LOGGER.level

    def emit(self, record: logging.LogRecord) -> None:
        self.texts.append(record.getMessage())

    def __enter__(self) -> Messages:
        self.earlier = LOGGER.level
        LOGGER.setLevel(logging.INFO)
        LOGGER.addHandler(self)
        return self

    def __exit__(self, *_: object) -> None:
        LOGGER.removeHandler(self)
        LOGGER.setLevel(self.earlier)
