"""Tables of the keys of design files, mesh recipes and study files, made from their models.

    python docs/generators/key_tables.py FOLDER

writes `keys_<file>.md` into the folder, one for each kind of input file, for pages to include.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from _folder import output_folder
from pydantic.fields import FieldInfo

from swgpar.design.drive_design import DriveDesign
from swgpar.gear_trains.cascade.design import CascadeDesign
from swgpar.gear_trains.gear_pair.design import GearPairDesign
from swgpar.gear_trains.planetary.design import PlanetaryDesign
from swgpar.gear_trains.planetary_stage.design import PlanetaryStageDesign
from swgpar.gear_trains.ring.design import RingDesign
from swgpar.input.quantities import Section, show, unit_of
from swgpar.meshing.recipe import MeshRecipe
from swgpar.optimisation.spec import OptimiseSection
from swgpar.studies.spec import CaseSection, StudySection

Row = tuple[str, str, str, str, str]
"""Key, meaning, unit, default and allowed values."""

GEARS = ("g1", "g2", "g3", "g4")
MESHES = ("g1_g1", "g1_g2", "g3_g4")
FILES: dict[str, tuple[type[Section], dict[str, str]]] = {
    "drive": (DriveDesign, {"ring_gear": "flexible_spline"}),
    "mesh_recipe": (MeshRecipe, {"ring_gear": "flexible_spline"}),
    "cascade": (
        CascadeDesign,
        dict.fromkeys(GEARS, "pinion") | dict.fromkeys(MESHES, "rack_pinion"),
    ),
    "gear_pair": (GearPairDesign, {"gear_2": "gear_1"}),
    "planetary": (PlanetaryDesign, {}),
    "planetary_stage": (PlanetaryStageDesign, {}),
    "ring": (RingDesign, {}),
}
"""Input files with sections: model, and sections whose rows are those of another one."""

DRAWINGS: dict[str, tuple[str, ...]] = {
    "drive": ("drive_teeth",),
    "flexible_spline": (
        "profile_quadruple_arc",
        "profile_double_arc",
        "profile_common_tangent",
        "profile_trapezoid",
        "profile_s_shaped",
        "profile_cycloid",
        "profile_involute",
        "profile_points",
        "profile_conjugate",
        "tip_relief",
    ),
    "ring_gear": ("housing",),
    "dynamic_spline": ("drive_pancake",),
    "wave_generator": ("cams", "cam_sizes", "bearing"),
    "cup": ("drive_section", "cup_shapes", "end_contours", "cup_attachment"),
    "micro_geometry": ("crowning", "slope"),
    "material": ("material",),
    "load": ("drive_front",),
    "contact": ("contact_cells",),
    "steps": ("load_stages",),
    "solver": ("ownership",),
    "output": ("output",),
    "stiffness": ("stiffness_loop",),
    "ratcheting": ("ratcheting",),
    "deviations": ("deviations",),
    "fatigue": ("haigh",),
    "losses": ("losses",),
    "frequencies": ("modes",),
    "output_bearing": ("output_bearing",),
}
"""Drawings of `docs/drawings` beside the sections of a drive: they show what the keys measure."""


def choices(field: FieldInfo) -> list[type[Section]]:
    """The sections a field may hold; none for a plain value."""
    types = get_args(field.annotation) or (field.annotation,)
    return [t for t in types if isinstance(t, type) and issubclass(t, Section)]


def kind(section: type[Section]) -> str:
    """Value of `type` that chooses a section."""
    return get_args(section.model_fields["type"].annotation)[0]


def allowed_values(field: FieldInfo) -> str:
    """Range or choices in words."""
    options = get_args(field.annotation)
    if get_origin(field.annotation) is Literal:
        return " or ".join(f"`{option}`" for option in options if option)
    if field.annotation is bool:
        return "true or false"
    if field.annotation in (str, str | None):
        return "a text"
    if get_origin(field.annotation) is list:
        kinds = {str: "texts", Any: "values", list[float]: "pairs of numbers"}
        return (
            f"a list of "
            f"{kinds.get(options[0], 'tables' if get_origin(options[0]) is dict else 'numbers')}"
        )
    if get_origin(field.annotation) is dict:
        return "a table"
    limits = {
        name: show(getattr(limit, name))
        for limit in field.metadata
        for name in ("gt", "ge", "lt", "le")
        if hasattr(limit, name)
    }
    if "ge" in limits and "le" in limits:
        words = [f"{limits['ge']} to {limits['le']}"]
    else:
        form = {"gt": "above {}", "ge": "{} or more", "lt": "below {}", "le": "up to {}"}
        words = [form[name].format(limits[name]) for name in form if name in limits]
    kind_of_number = "whole number" if field.annotation is int else ""
    return ", ".join(filter(None, [*words, kind_of_number])) or "any number"


def default_value(field: FieldInfo) -> str:
    """Default as it stands in TOML."""
    if field.is_required():
        return "**required**"
    default: Any = field.get_default(call_default_factory=True)
    if default is None or default in ("", [], {}):
        return "none"
    return f"`{show(default)}`"


def row(key: str, field: FieldInfo) -> Row:
    """The row of one plain key."""
    unit = unit_of(field)
    meaning = str(field.description).removesuffix(f" ({unit})").replace("|", "\\|")
    return key, meaning, unit, default_value(field), allowed_values(field)


def table(lines: list[Row]) -> str:
    """A Markdown table."""
    head = "| key | meaning | unit | default | allowed |\n|---|---|---|---|---|\n"
    return head + "".join(f"| `{key}` | {' | '.join(cells)} |\n" for key, *cells in lines)


def figure(drawing: str) -> str:
    """A drawing, from pages one folder below the root of the documents."""
    return f"```{{image}} ../_generated/{drawing}.png\n:width: 90%\n:alt: {drawing}\n```\n"


def plain_rows(
    section: type[Section], prefix: str = "", skip: tuple[str, ...] = ()
) -> Iterator[Row]:
    """Rows of the plain keys of a section, and of the sections inside it that are no choice."""
    for name, field in section.model_fields.items():
        if name not in skip:
            yield from rows_of(f"{prefix}{name}", field)


def rows_of(key: str, field: FieldInfo) -> Iterator[Row]:
    """The row of a plain key, or those of the keys of a section; none of a choice of sections."""
    inner = choices(field)
    if len(inner) == 1:
        yield from plain_rows(inner[0], f"{key}.")
    elif not inner:
        yield row(key, field)


def chosen(prefix: str, kinds: list[type[Section]]) -> dict[str, list[Row]]:
    """Rows of a section with a choice of types: type and common keys, then by type; caption ->
    rows."""
    first = kinds[0].model_fields
    common = [
        name
        for name in first
        if name != "type"
        and all(name in other.model_fields for other in kinds)
        and len({row(name, other.model_fields[name]) for other in kinds}) == 1
    ]
    types = " or ".join(f"`{kind(section)}`" for section in kinds)
    shared = [(f"{prefix}type", str(first["type"].description), "", f'`"{kind(kinds[0])}"`', types)]
    out = {
        "": shared + [line for name in common for line in rows_of(f"{prefix}{name}", first[name])]
    }
    for section in kinds:
        out[f'With `{prefix}type = "{kind(section)}"`:'] = list(
            plain_rows(section, prefix, ("type", *common))
        )
    return out


def section_rows(field: FieldInfo) -> dict[str, list[Row]]:
    """All rows of a section of a file; caption -> rows."""
    kinds = choices(field)
    if len(kinds) > 1:
        return chosen("", kinds)
    out = {"": list(plain_rows(kinds[0]))}
    for prefix, inner in choices_inside(kinds[0]):
        for caption, lines in chosen(prefix, inner).items():
            out.setdefault(caption, []).extend(lines)
    return out


def choices_inside(
    section: type[Section], prefix: str = ""
) -> Iterator[tuple[str, list[type[Section]]]]:
    """Prefix and choice of the sections inside of a section that have types, at any depth."""
    for name, field in section.model_fields.items():
        inner = choices(field)
        if len(inner) > 1:
            yield f"{prefix}{name}.", inner
        elif inner:
            yield from choices_inside(inner[0], f"{prefix}{name}.")


def file_tables(design: type[Section], alike: dict[str, str]) -> str:
    """Headings and tables of one kind of input file.

    alike : section -> another one, whose rows are not repeated for it
    """
    parts = []
    for name, field in design.model_fields.items():
        parts.append(f"## `[{name}]`\n")
        if design is DriveDesign:
            parts += [figure(drawing) for drawing in DRAWINGS.get(name, ())]
        if not choices(field):
            parts.append(f"{str(field.description).capitalize()}.\n")
            continue
        tables = section_rows(field)
        if name in alike:
            known = section_rows(design.model_fields[alike[name]])
            tables = {
                c: [line for line in lines if line not in known.get(c, [])]
                for c, lines in tables.items()
            }
            more = " and these:" if any(tables.values()) else "."
            parts.append(f"The keys of `[{alike[name]}]`{more}\n")
        for caption, lines in tables.items():
            if lines:
                parts.append(f"{caption}\n\n{table(lines)}" if caption else table(lines))
    return "\n".join(parts)


def main(folder: Path) -> None:
    """Write all pages."""
    for name, (design, alike) in FILES.items():
        (folder / f"keys_{name}.md").write_text(file_tables(design, alike), encoding="utf-8")
    sections = {"study": StudySection, "study_case": CaseSection, "optimise": OptimiseSection}
    for name, section in sections.items():
        (folder / f"keys_{name}.md").write_text(table(list(plain_rows(section))), encoding="utf-8")


if __name__ == "__main__":
    main(output_folder(__doc__))
