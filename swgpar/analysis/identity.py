"""Identity of what a run computes, by which a restart knows its own files."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

from swgpar.meshing import MeshRecipe
from swgpar.results.atomic import to_json


def identity(decisive: Mapping[str, Any], recipe: MeshRecipe, accuracy: float | None) -> str:
    """Identity of what is computed. decisive : `DriveDesign.decisive_keys`"""
    content = {"design": decisive, "recipe": recipe.model_dump(), "accuracy": accuracy}
    return hashlib.sha256(to_json(content)).hexdigest()
