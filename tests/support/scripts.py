"""Scripts of the checkout as modules: what they define, without running their main program."""

from __future__ import annotations

import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType


def load_script(path: Path) -> ModuleType:
    """Execute a script under its file's name, so that `if __name__ == "__main__":` does not apply.

    Imports of scripts beside it work, as in a run.
    """
    spec = spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None, path
    module = module_from_spec(spec)
    sys.modules[path.stem] = module
    sys.path.insert(0, str(path.parent))
    try:
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(path.parent))
    return module
