"""The study file: which designs are computed, drives on which meshes, and what they are compared
with."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from swgpar.errors import InputError
from swgpar.input.quantities import Section, quantity, show, show_key
from swgpar.input.regular_file import read_regular
from swgpar.input.require import require
from swgpar.input.toml_file import read_toml, split_override, validate
from swgpar.studies.run_file import RunFile, RunsSection, flat, refusals_of, require_only

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.,+=-]*")
"""Names of cases are names of folders."""


LONGEST_NAME = 100
"""Letters of the name of a case or mesh."""


def folder_name(text: str) -> str:
    """A name for a folder inside another one, made from keys, values and names of files.

    Letters that do not fit are replaced, a long text by its beginning and a number that stands for
    the whole of it.
    """
    name = re.sub(r"[^\w.,+=-]", "-", text)
    name = name if name[0].isalnum() else f"_{name}"
    if len(name) <= LONGEST_NAME:
        return name
    number = hashlib.sha256(text.encode(errors="surrogateescape")).hexdigest()[:12]
    return f"{name[: LONGEST_NAME - 13]}-{number}"


class CaseSection(Section):
    """One `[[study.case]]`."""

    name: str = quantity(text="letters, digits and _ . , + = -")
    set: list[str] = quantity([], text='"section.key=value" for this case')
    section: dict[str, Any] = quantity({}, text="whole sections that replace those of the design")
    meshes: list[str] = quantity([], text="mesh recipes of this case instead of the study's")
    published: dict[str, float] = quantity({}, text="published values of this case by quantity")
    tolerance: dict[str, float] = quantity({}, text="largest difference by quantity (percent)")
    note: str = quantity("", text="a remark for the report")


class StudySection(RunsSection):
    """The `[study]` without its cases."""

    meshes: list[str] = quantity(
        [], text="mesh recipes of a drive, coarse to fine, relative to this file"
    )
    compared: str = quantity(
        "", text="the one of the meshes that published values are compared on; else the last"
    )
    quantities: list[str] = quantity(
        [], text="quantities in tables and figures; else the usual ones"
    )
    mode: Literal["grid", "sweep"] = quantity(
        "grid", text="all combinations of the varied values, or in step"
    )
    max_cases: int = quantity(
        100_000, text="largest number of runs, cases times meshes", ge=1, le=100_000_000
    )
    vary: dict[str, Any] = quantity({}, text="keys of the design file with lists of values")


class _CaseFile(Section):
    case: CaseSection


class _StudyFile(Section):
    study: StudySection


@dataclass(frozen=True)
class Study(RunFile[StudySection]):
    """The checked content of a study file.

    cases : its [[study.case]], one without a name when there are none
    """

    cases: tuple[CaseSection, ...]


def load_study(path: str | Path) -> Study:
    """Read and check a study file; every problem is an `InputError` of one sentence that names the
    file."""
    path = Path(path)
    table = read_toml(path)
    return _make_study(table, str(path), path.parent, read_regular(path).decode("utf-8-sig"))


def make_study(table: Mapping[str, Any]) -> Study:
    """Check the content of a study file; its paths are relative to the working directory."""
    text = json.dumps(table, indent=2, ensure_ascii=False, default=repr)
    return _make_study(table, "study", Path(), text)


def _make_study(table: Mapping[str, Any], name: str, folder: Path, text: str) -> Study:
    with refusals_of(name):
        require_only("study", table, "a study file")
        study = dict(table.get("study", {}))
        tables = study.pop("case", [])
        if isinstance(study.get("vary"), dict):
            study["vary"] = flat(study["vary"])
        section = validate(_StudyFile, {"study": study}).study
        if not isinstance(tables, list):
            raise InputError(
                f"study.case = {show(tables)} is not a list of cases: write [[study.case]]"
            )
        cases = tuple(_case(number, entry) for number, entry in enumerate(tables, start=1))
        _check_study(section)
        for case in cases:
            _check_case(case, section)
    return Study(name, folder, text, section, cases or (CaseSection.model_construct(name=""),))


def _case(number: int, table: dict[str, Any]) -> CaseSection:
    with refusals_of(f"[[study.case]] {number}"):
        if isinstance(table, dict):
            table = {**table, **_numbers(table)}
        return validate(_CaseFile, {"case": table}).case


def _numbers(table: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """`published` and `tolerance` by single numbers: a list gives name[1], name[2].., its tolerance
    stands for all."""
    keys = ("published", "tolerance")
    given = {key: flat(table[key]) for key in keys if isinstance(table.get(key), dict)}
    published = given.get("published", {})
    counts = {name: len(value) for name, value in published.items() if isinstance(value, list)}

    def numbered(name: str, value: Any) -> dict[str, Any]:
        if name not in counts:
            return {name: value}
        numbers = value if isinstance(value, list) else [value] * counts[name]
        return {f"{name}[{index}]": number for index, number in enumerate(numbers, start=1)}

    return {
        key: {k: v for name, value in values.items() for k, v in numbered(name, value).items()}
        for key, values in given.items()
    }


def _check_study(study: StudySection) -> None:
    for override in study.set:
        split_override(override)
    for key, values in study.vary.items():
        where = f'study.vary."{show_key(key)}"'
        if not isinstance(values, list) or not values:
            raise InputError(
                f"{where} = {show(values)} is not a list of values: allowed one value or more"
            )
        if "." not in key and not all(isinstance(value, dict) for value in values):
            raise InputError(
                f'{where} holds a value: allowed "section.key", or tables for a whole section'
            )
        for other in study.vary:
            if other.startswith(f"{key}."):
                raise InputError(
                    f'{where} replaces study.vary."{show_key(other)}": allowed is one of both'
                )
    lengths = {key: len(values) for key, values in study.vary.items()}
    if study.mode == "sweep" and len(set(lengths.values())) > 1:
        counted = ", ".join(f"{show_key(key)} has {n}" for key, n in lengths.items())
        raise InputError(
            f'study.mode = "sweep" takes values in step: allowed are lists of one length, but '
            f"{counted}"
        )


def _check_case(case: CaseSection, study: StudySection) -> None:
    where = f"study.case {show(case.name)}"
    if not NAME.fullmatch(case.name) or len(case.name) > LONGEST_NAME:
        raise InputError(
            f"study.case.name = {show(case.name)} names no folder: allowed letters, digits and _ . "
            f", + = -, at most {LONGEST_NAME}"
        )
    for override in case.set:
        key, _ = split_override(override)
        for varied in study.vary:
            if f"{key}.".startswith(f"{varied}.") or varied.startswith(f"{key}."):
                raise InputError(
                    f"{where} sets {show_key(key)}, which study.vary varies: allowed in one of both"
                )
    for name, value in case.section.items():
        if not isinstance(value, dict):
            raise InputError(
                f"{where}: section.{show_key(name)} = {show(value)} is not a section: allowed a "
                "table"
            )
    for name, percent in case.tolerance.items():
        tolerance = f"{where}: tolerance.{show_key(name)}"
        if name not in case.published:
            raise InputError(
                f"{tolerance} has no published value: allowed {', '.join(case.published)}"
            )
        require(percent > 0.0, tolerance, percent, "above 0 to inf %")
        if case.published[name] == 0.0:
            raise InputError(
                f"{tolerance} is a share of a published 0: allowed for other values only"
            )
