"""Study files in tests: their jobs, and refusals."""

from __future__ import annotations

from pathlib import Path

import pytest

from swgpar.errors import InputError
from swgpar.studies.case import Job
from swgpar.studies.cases import expand
from swgpar.studies.spec import load_study


def jobs_of(path: Path) -> list[Job]:
    return expand(load_study(path))


def assert_refused(path: Path, words: str) -> None:
    """In one sentence that begins with the file's name and holds the words."""
    with pytest.raises(InputError) as caught:
        jobs_of(path)
    message = str(caught.value)
    assert words in message and message.startswith(str(path)) and "\n" not in message
