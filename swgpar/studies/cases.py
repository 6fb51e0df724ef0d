"""From a study file to its cases: each is a checked design, or the reason why it is none."""

from __future__ import annotations

import itertools
import math
import re
from collections import Counter
from pathlib import Path
from typing import Any

from swgpar.errors import InputError
from swgpar.input.quantities import show
from swgpar.input.toml_file import apply_overrides, read_toml
from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.results.quantity import Quantity
from swgpar.studies.case import Case, Job, named, not_known
from swgpar.studies.run_file import refusals_of, refuse_mesh
from swgpar.studies.spec import CaseSection, Study, folder_name
from swgpar.systems import System, system_of_table


def expand(study: Study) -> list[Job]:
    """All jobs of a study in the order of its tables.

    Raises InputError when the study file cannot be used; a refused design is a case with a
    `refusal`, and only when there is no other case a reason to raise.
    """
    with refusals_of(study.name):
        jobs = _expand(study)
        if all(job.case.design is None for job in jobs):
            raise InputError(f"every case is refused: {jobs[0].case.refusal}")
    return jobs


def _expand(study: Study) -> list[Job]:
    section = study.section
    table = read_toml(study.folder / section.design)
    system = system_of_table(table)
    base = apply_overrides(system.without_output(table), section.set)
    _check_number(study)
    recipes: dict[Path, MeshRecipe] = {}
    cases: list[Case] = []
    for entry in study.cases:
        meshes = _meshes(study, entry, system)
        stems, wanted = [mesh.stem for mesh in meshes], Path(section.compared).stem
        compared = stems.index(wanted) if wanted in stems else len(stems) - 1
        recipes.update({mesh: load_recipe(mesh) for mesh in meshes if mesh not in recipes})
        for varied, suffix in combinations(section.vary, section.mode):
            name = "_".join(filter(None, (entry.name, suffix))) or Path(section.design).stem
            design, refusal, known = None, "", {}
            try:
                table = apply_overrides({**base, **entry.section}, entry.set)
                design = system.load(apply_overrides(table, varied))
                system.check_published(design, entry.published)
                known = system.quantities(design)
            except InputError as error:
                design, refusal = None, str(error)
            shown = _shown(section.quantities, known, system)
            name = folder_name(name)
            cases.append(
                Case(name, varied, design, refusal, known, shown, meshes, compared, entry, system)
            )
    _check_names(study, cases)
    return [
        Job(case, mesh, recipes.get(mesh) if mesh else None, max(len(case.meshes) - 1 - index, 0))
        for case in cases
        for index, mesh in enumerate(case.meshes or (None,))
    ]


def _check_number(study: Study) -> None:
    """Refuse more runs than the study allows, before any of them is made."""
    section = study.section
    lengths = [len(values) for values in section.vary.values()]
    together = math.prod(lengths) if section.mode == "grid" else max(lengths, default=1)
    runs = together * sum(max(len(case.meshes or section.meshes), 1) for case in study.cases)
    if runs > section.max_cases:
        raise InputError(
            f"the study has {show(runs)} runs: allowed up to study.max_cases = "
            f"{section.max_cases}, which may be raised"
        )


def _meshes(study: Study, case: CaseSection, system: System[Any, Any]) -> tuple[Path, ...]:
    """Recipes of a case, coarse to fine."""
    section = study.section
    if "mesh" not in system.options:
        for key, given in (
            ("study.meshes", section.meshes),
            ("study.compared", section.compared),
            (f"study.case {show(case.name)}: meshes", case.meshes),
        ):
            refuse_mesh(f"{key} = {show(given)}", given, system)
        return ()
    if not section.meshes:
        given = " = [] is empty" if "meshes" in section.model_fields_set else " is missing"
        raise InputError(
            f"study.meshes{given}: give a list of texts, one mesh recipe or more, coarse to fine"
        )
    if section.compared and section.compared not in section.meshes:
        raise InputError(
            f"study.compared = {show(section.compared)} is none of study.meshes = "
            f"{show(section.meshes)}"
        )
    meshes = tuple(map(study.mesh, case.meshes or section.meshes))
    stems = [folder_name(mesh.stem) for mesh in meshes]
    if len(set(stems)) < len(stems):
        raise InputError(
            f"meshes = {show(stems)} have a name twice: allowed are recipes of different names"
        )
    return meshes


def _shown(names: list[str], known: dict[str, Quantity], system: System) -> tuple[str, ...]:
    """The quantities that the study asks for, as far as the case has them."""
    if not names:
        return system.main_quantities(known)
    return tuple(dict.fromkeys(number for name in names for number in named(name, known)))


def _check_names(study: Study, cases: list[Case]) -> None:
    """Refuse cases of one name, and names of quantities that no case has or a compared case has
    not."""
    twice = [name for name, count in Counter(case.name for case in cases).items() if count > 1]
    if twice:
        raise InputError(
            f"{show(twice[0])} is the name of two cases: allowed are different names and values"
        )
    designed = [case for case in cases if case.design is not None]
    for case in designed:
        for name in case.section.published:
            if name not in case.known:
                where = f"study.case {show(case.section.name)}: published."
                raise not_known(where, case.known, case.system, name)
    together = {name: quantity for case in designed for name, quantity in case.known.items()}
    for name in study.section.quantities if designed else ():
        if not named(name, together):
            raise not_known("study.quantities = ", together, designed[0].system, name)


def combinations(vary: dict[str, list[Any]], mode: str) -> list[tuple[dict[str, Any], str]]:
    """Values by key, and the name they give a case, for all combinations ("grid") or in step
    ("sweep")."""
    if not vary:
        return [({}, "")]
    last = Counter(key.rpartition(".")[2] for key in vary)
    columns = []
    for key, values in vary.items():
        short = key.rpartition(".")[2]
        title = short if last[short] == 1 else key
        texts = [f"{title}={label}" for label in labels(values)]
        columns.append(list(zip(itertools.repeat(key), values, texts)))
    chosen = itertools.product(*columns) if mode == "grid" else zip(*columns)
    return [
        ({key: value for key, value, _ in row}, "_".join(text for *_, text in row))
        for row in chosen
    ]


def labels(values: list[Any]) -> list[str]:
    """A short text for each value, fit for the name of a folder; tables by type, or by their number
    in the list."""
    texts = []
    for number, value in enumerate(values, start=1):
        text = value.get("type", str(number)) if isinstance(value, dict) else value
        text = ",".join(map(show, text)) if isinstance(text, list) else text
        text = text if isinstance(text, str) else show(text)
        texts.append(re.sub(r"[^A-Za-z0-9_.,+=-]", "-", text))
    count = Counter(texts)
    return [
        f"{text}-{number}" if count[text] > 1 and isinstance(value, dict) else text
        for number, (text, value) in enumerate(zip(texts, values), start=1)
    ]
