"""The mesh recipe: how many elements go where."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from swgpar.errors import InputError
from swgpar.input.quantities import Section, quantity, show, show_key
from swgpar.input.toml_file import read_toml, validate

RECIPES = ("coarse", "forces", "medium", "full", "plane_coarse", "plane", "plane_fine")
"""Names of the package's recipes, coarse to fine: of the cup drive, of the plane model."""


class ToothRecipe(Section):
    """Elements of half a tooth cross-section of one gear, and of its rim."""

    tip: int = quantity(
        text="elements from the centre of the top land to the end of the tip edge", ge=2, le=40
    )
    layers: int = quantity(1, text="layers of elements directly below the flank", ge=1, le=40)
    layer_ratio: float = quantity(
        1.0, text="thickness of each layer over that of the next nearer the flank", ge=1.0, le=3.0
    )
    flank: int = quantity(
        text="elements along the flank, from the tip edge to the root arc's split; segments "
        "shorter than half of one have theirs beside these",
        ge=1,
        le=400,
    )
    root: int = quantity(
        text="elements from the split in the root arc to the middle of the root", ge=2, le=200
    )
    even_root: bool = quantity(
        False,
        text="whether elements above the split in the root arc, which the flank gives, are as long "
        "as those below it",
    )
    under: int = quantity(
        text="layers of elements between the root and the lower rim", ge=1, le=100
    )
    under_ratio: float = quantity(
        1.0, text="thickness of the lowest of these layers over that at the root", ge=1.0, le=20.0
    )
    rim: int = quantity(
        text="layers of elements in the lower rim (flexible spline: through the cup)", ge=1, le=100
    )


class FaceWidthRecipe(Section):
    """Elements along the face width."""

    elements: int = quantity(
        text="elements along the face width, in a pancake drive of each ring gear", ge=2, le=400
    )
    end_ratio: float = quantity(
        1.0, text="length of the middle elements over those at both ends", ge=1.0, le=10.0
    )


class CupRecipe(Section):
    """Elements along the cup's wall, from the back of the teeth to the bore."""

    cylinder: int = quantity(
        text="elements along the cylinder; of six decay lengths at most, a longer one has more",
        ge=1,
        le=400,
    )
    fillet: int = quantity(text="elements along the fillet", ge=1, le=100)
    closed_end: int = quantity(
        text="elements along closed end or flange; without its clamped ring, which has one; across "
        "washers two at least",
        ge=1,
        le=400,
    )
    end_ratio: float = quantity(
        1.0, text="length of middle over end elements, of cylinder and closed end", ge=1.0, le=20.0
    )
    joined_columns: bool = quantity(
        False, text="whether three columns of elements become one a pitch behind the teeth"
    )


class MeshRecipe(Section):
    """Element counts and gradings of a drive's mesh."""

    flexible_spline: ToothRecipe
    ring_gear: ToothRecipe
    face_width: FaceWidthRecipe | None = None
    cup: CupRecipe | None = None

    @property
    def model(self) -> Literal["plane", "cup"]:
        """Whether it has elements along the face width, as those of cup drives and pancakes."""
        return "plane" if self.face_width is None else "cup"


def is_recipe_name(mesh: str | Path) -> bool:
    """Whether `mesh` is a plain word, which names a recipe of the package, and no path."""
    path = Path(mesh)
    return path.name == str(path) and not path.suffix


def _is_file(path: Path) -> bool:
    """Whether there is such a file; names that no file system takes are none."""
    try:
        return path.is_file()
    except OSError:
        return False


def recipe_path(mesh: str | Path) -> Path:
    """The file of a recipe that is given by its name in the package ("coarse") or by its path.

    Raises InputError for a plain word that is neither.
    """
    path = Path(mesh)
    if str(path) in RECIPES:  # whatever the working directory holds
        return Path(__file__).with_name("recipes") / f"{path}.toml"
    if is_recipe_name(path) and not _is_file(path):
        raise InputError(
            f"mesh = {show(str(path))} is not available: allowed {', '.join(RECIPES)} or the path "
            f"of a mesh recipe"
        )
    return path


def load_recipe(mesh: str | Path) -> MeshRecipe:
    """Read a mesh recipe (TOML) by its name in the package or its path.

    Every failure is an `InputError` of one sentence.
    """
    path = recipe_path(mesh)
    table = read_toml(path)
    try:
        return make_recipe(table)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def make_recipe(table: dict[str, Any]) -> MeshRecipe:
    """Check the content of a mesh recipe; every problem is an `InputError` of one sentence."""
    for key, value in table.items():
        if key not in MeshRecipe.model_fields:
            allowed = ", ".join(MeshRecipe.model_fields)
            raise InputError(
                f"{show_key(key)} = {show(value)} is not a section of a mesh recipe: allowed "
                f"{allowed}"
            )
    return validate(MeshRecipe, table)
