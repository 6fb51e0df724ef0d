"""Scripts of the checkout as modules: what they define, without running their main program."""

from __future__ import annotations

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType


def load_script(path: Path) -> ModuleType:
    """Execute a script under its file's name, so that `if __name__ == "__main__":` does not apply."""
    spec = spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None, path
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
