"""Bad inputs of all kinds of files, drawn by Hypothesis, and what becomes of them inside this
process.

An input begins as a file that is right. Its table is changed in one to three places, or its text is
damaged. What comes of it is refused by one printable sentence, or accepted with finite numbers.
Anything else is a fault.
"""

from __future__ import annotations

import datetime
import functools
import json
import math
import shutil
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from mpi4py import MPI

import swgpar
from support.paths import DATA, DESIGN, DRIVERS, RECIPE, REFERENCE
from support.right_files import Table, curve_file, pitch_file, right_files
from support.small_drive import PLANE
from support.small_trains import SMALL
from swgpar.analysis.forecast import forecast
from swgpar.analysis.run_record import RunRecord
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import LONGEST, SwgparError
from swgpar.input.toml_file import apply_overrides, read_toml
from swgpar.meshing import build_sector_meshes, load_recipe
from swgpar.optimisation.problem import make_problem
from swgpar.optimisation.spec import load_specification
from swgpar.results import checkpoint, parallel_hdf5
from swgpar.results.folder import CHECKPOINT
from swgpar.results.parallel_hdf5 import Block
from swgpar.studies.cases import expand
from swgpar.studies.spec import load_study
from swgpar.systems import system_of_section

SLOWEST = 60.0
"""Processor seconds after which an input counts as hanging: other programs may keep this one
waiting."""

MESHED = 2000
"""Elements of a sector up to which an accepted input is meshed."""

Path_ = tuple[str | int, ...]


@dataclass(frozen=True)
class BadInput:
    """kind : of the file;  files : name -> content, that of the file itself first;  what : how it
    was changed;  section : the newer section in which it was, if so"""

    kind: str
    files: dict[str, bytes]
    what: str
    section: str = ""


@dataclass
class Outcome:
    """fault : what is wrong with the way it ended, empty where nothing is;  sentence : of the
    refusal"""

    kind: str
    status: str
    sentence: str = ""
    fault: str = ""
    seconds: float = 0.0
    what: str = ""
    content: str = field(default="", repr=False)


# -- changes ---------------------------------------------------------------------------------------

EXTREME = (
    0.0,
    -0.0,
    1e-320,
    1e-300,
    1e-15,
    1e-9,
    1e9,
    1e15,
    1e300,
    math.inf,
    -math.inf,
    math.nan,
    1e-7,
    -1.0,
    0.5,
)
TEXTS = (
    "",
    " ",
    "=1+1",
    "../../x",
    "/etc/passwd",
    "\x1b]0;t\x07",
    "\u202e",
    "a\nb",
    "nan",
    3000 * "x",
    "\0",
    "#",
)
NUMBERS = st.one_of(
    st.sampled_from(EXTREME), st.floats(), st.integers(-3, 3000), st.integers(-(10**30), 10**30)
)
WORDS = st.one_of(st.sampled_from(TEXTS), st.text(max_size=20))
SCALARS = st.one_of(NUMBERS, WORDS, st.booleans(), st.just(datetime.date(2020, 2, 29)))
HOSTILE = st.one_of(
    SCALARS,
    st.lists(SCALARS, max_size=4),
    st.dictionaries(WORDS, SCALARS, max_size=3),
    st.builds(lambda: [[]]),
    st.builds(lambda: [{}]),
)
FACTORS = st.one_of(
    st.sampled_from((-1.0, 0.5, 2.0, 1.001)), st.integers(-12, 12).map(lambda power: 10.0**power)
)


def leaves(value: Any, above: Path_ = ()) -> Iterator[Path_]:
    """Paths of all values and tables below a table."""
    items = (
        value.items()
        if isinstance(value, dict)
        else enumerate(value)
        if isinstance(value, list)
        else ()
    )
    for key, item in items:
        yield (*above, key)
        yield from leaves(item, (*above, key))


def value_at(table: Any, path: Path_) -> Any:
    """The value at a path of keys."""
    for key in path:
        table = table[key]
    return table


@st.composite
def changed_tables(draw: st.DrawFn, kind: str) -> tuple[Table, str]:
    """A right table with one to three changes, and what they are."""
    table = json.loads(json.dumps(draw(st.sampled_from(right_files()[kind]))))
    done = []
    for _ in range(draw(st.sampled_from((1, 1, 1, 2, 3)))):
        paths = list(leaves(table))
        if not paths:
            break
        path = draw(st.sampled_from(paths))
        parent, old = value_at(table, path[:-1]), value_at(table, path)
        way = draw(st.sampled_from(("replace", "scale", "scale", "remove", "add", "swap")))
        if way == "scale" and isinstance(old, (int, float)) and not isinstance(old, bool):
            new = old * draw(FACTORS)
            parent[path[-1]] = (
                int(new)
                if isinstance(old, int) and abs(new) < 1e18 and draw(st.booleans())
                else new
            )
        elif way == "remove":
            del parent[path[-1]]
        elif way == "add" and isinstance(old, dict):
            old[draw(WORDS)] = draw(HOSTILE)
        elif way == "swap":
            other = draw(st.sampled_from(paths))
            if (
                other[: len(path)] == path or path[: len(other)] == other
            ):  # one of them is in the other
                continue
            parent[path[-1]], value_at(table, other[:-1])[other[-1]] = value_at(table, other), old
        else:
            parent[path[-1]] = draw(HOSTILE)
        done.append(f"{way} {'.'.join(map(str, path))}")
    return table, ", ".join(done)


@st.composite
def damaged(draw: st.DrawFn, content: bytes) -> tuple[bytes, str]:
    """A content that is cut, or has other bytes in between."""
    begin = draw(st.integers(0, len(content)))
    end = min(len(content), begin + draw(st.integers(0, 40)))
    new = draw(
        st.one_of(
            st.binary(max_size=40),
            st.sampled_from((b"[", b"]]", b'"""', b"\xff\xfe", b"\r", b"= = =")),
        )
    )
    if draw(st.integers(0, 3)) == 0:
        return content[:begin], f"cut at {begin}"
    return content[:begin] + new + content[end:], f"bytes at {begin}"


@functools.cache
def right_checkpoint(folder: Path) -> bytes:
    """A checkpoint with two data sets and attributes of a run, written into the folder."""
    rng = np.random.default_rng(1)
    blocks = {name: Block(rng.random((rows, n, 3)), 0, rows) for name, rows, n in SHAPES}
    checkpoint.write_checkpoint(folder / CHECKPOINT, MPI.COMM_SELF, blocks, RECORD)
    return (folder / CHECKPOINT).read_bytes()


KINDS = (
    *("drive", "gear train", "mesh recipe", "study", "optimisation"),
    *("pitch file", "curve file", "result", "checkpoint"),
)

FINISHED = DATA / "first_format"
"""Folders of finished runs whose files are damaged."""


@st.composite
def bad_inputs(draw: st.DrawFn, folder: Path) -> BadInput:
    """A bad input of any kind. folder : where a right checkpoint is written once"""
    kind = draw(st.sampled_from((*KINDS, "drive", "drive", "gear train")))
    if kind == "checkpoint":
        content, what = draw(damaged(right_checkpoint(folder)))
        return BadInput(kind, {CHECKPOINT: content}, what)
    if kind == "pitch file":
        content, what = draw(damaged(pitch_file()))
        column = draw(st.sampled_from(("pitch", "pitch", "", "tooth", "none")))
        return BadInput(
            kind, {"pitch.csv": content, "column": column.encode()}, f"{what}, column {column}"
        )
    if kind == "curve file":
        content, what = draw(damaged(curve_file()))
        return BadInput(kind, {"cam.csv": content}, what)
    if kind == "result":
        run = draw(st.sampled_from(sorted(path.name for path in FINISHED.iterdir())))
        names = [path.name for path in (FINISHED / run).iterdir() if path.is_file()]
        name = draw(st.sampled_from(sorted(names)))
        content, what = draw(damaged((FINISHED / run / name).read_bytes()))
        return BadInput(kind, {name: content, "run": run.encode()}, f"{run}/{name}, {what}")
    table, what = draw(changed_tables(kind))
    content = tomli_w.dumps(table).encode(errors="surrogatepass")
    if draw(st.integers(0, 7)) == 0:
        content, damage = draw(damaged(content))
        what = f"{what}, {damage}"
    return BadInput(kind, {"input.toml": content}, what)


def draw_inputs(count: int, number: int, folder: Path, visit: Callable[[BadInput], None]) -> None:
    """Call `visit` with so many bad inputs, the same for the same number (the seed)."""

    @seed(number)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(bad_inputs(folder))
    def each(bad: BadInput) -> None:
        visit(bad)

    each()


# -- what becomes of them --------------------------------------------------------------------------


def attempt(bad: BadInput, folder: Path) -> Outcome:
    """Use an input in this process, and judge what comes of it. folder : its files are written
    there"""
    for name, content in bad.files.items():
        (folder / name).write_bytes(content)
    begin = time.process_time()
    text = next(iter(bad.files.values())).decode(errors="backslashreplace")
    kind = bad.section or bad.kind
    outcome = Outcome(kind, "accepted", what=bad.what, content=text)
    try:
        outcome.fault = USES[bad.kind](folder)
        if bad.section and bad.kind == "gear train" and not outcome.fault:
            _run_train(folder)
    except SwgparError as error:
        outcome.status, outcome.sentence = "refused", str(error)
        outcome.fault = "" if is_sentence(str(error)) else "no printable sentence"
    except Exception as error:
        outcome.status, outcome.fault = "traceback", f"{type(error).__name__}: {error}"
    outcome.seconds = time.process_time() - begin
    if outcome.seconds > SLOWEST:
        outcome.fault = outcome.fault or f"takes {outcome.seconds:.0f} s"
    return outcome


def is_sentence(text: str) -> bool:
    """Whether a refusal is one printable line that is not too long."""
    return text.isprintable() and 10 < len(text) <= LONGEST and "Traceback" not in text


def _not_finite(values: Mapping[str, float]) -> str:
    wrong = [name for name, value in values.items() if not np.isfinite(value)]
    return f"not finite: {', '.join(wrong)}" if wrong else ""


def _use_design(folder: Path) -> str:
    design = swgpar.load_design(folder / "input.toml")
    derived = swgpar.check(design)
    system_of_section(design.system).remarks(design)
    fault = _not_finite(derived)
    return fault or (
        _use_mesh(design, load_recipe(RECIPE)) if isinstance(design, DriveDesign) else ""
    )


def _run_train(folder: Path) -> None:
    """Run a train with few samples and steps: it is refused where a result is not finite."""
    table = read_toml(folder / "input.toml")
    model = "ring_moving_load" if "moving_load" in table else table["gear_train"]["model"]
    small = [part for part in SMALL.get(model, ()) if part.partition(".")[0] in table]
    swgpar.run(swgpar.load_design(table, small))


def _use_recipe(folder: Path) -> str:
    recipe = load_recipe(folder / "input.toml")
    designs = [swgpar.load_design(REFERENCE)] if recipe.cup and recipe.face_width else []
    designs.append(swgpar.load_design(DRIVERS / "plane_half_turn.toml"))
    return next(filter(None, (_use_mesh(design, recipe) for design in designs)), "")


def _use_mesh(design: DriveDesign, recipe: swgpar.MeshRecipe) -> str:
    needs = forecast(design, recipe)
    if not (
        needs.elements > 0 < needs.unknowns and np.isfinite([needs.memory, needs.seconds]).all()
    ):
        return f"forecast {needs}"
    if needs.elements > MESHED * design.drive.teeth_fs:
        return ""
    meshes = build_sector_meshes(design.geometry, recipe)
    for mesh in meshes.values():
        if not (np.isfinite(mesh.coords).all() and mesh.quality["min_jacobian"] > 0.0):
            return f"mesh of {mesh.body}: {mesh.quality}"
    return ""


def _use_study(folder: Path) -> str:
    out = folder / "out"
    for job in expand(load_study(folder / "input.toml")):
        if out not in job.folder(out).parents or ".." in job.folder(out).parts:
            return f"the folder {job.folder(out)} is outside"
    return ""


def _use_pitch_file(folder: Path) -> str:
    column = (folder / "column").read_text(encoding="utf-8")
    gear = {"pitch_file": str(folder / "pitch.csv"), "pitch_column": column}
    table = apply_overrides(read_toml(DESIGN), PLANE)
    design = swgpar.load_design({**table, "deviations": {"ring_gear": gear}})
    errors = design.deviations.ring_gear.pitch_errors
    return (
        ""
        if len(errors) == design.drive.teeth_rg and np.isfinite(errors).all()
        else f"pitch errors {errors}"
    )


def _use_search(folder: Path) -> str:
    """Every first design is within the bounds, and every variable a key of the design."""
    problem = make_problem(load_specification(folder / "input.toml"))
    for first in problem.section.first:
        problem.applied(problem.table, first)
    return ""


def _use_curve_file(folder: Path) -> str:
    wave = {"type": "points", "file": str(folder / "cam.csv"), "face_width": 4.0}
    table = {**apply_overrides(read_toml(DESIGN), PLANE), "wave_generator": wave}
    return _not_finite(swgpar.check(swgpar.load_design(table)))


def _use_result(folder: Path) -> str:
    """What is read of a damaged result has finite answers, and figures."""
    run = (folder / "run").read_text(encoding="utf-8")
    copy = folder / "copy"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(FINISHED / run, copy)
    for file in folder.iterdir():
        if file.is_file() and (copy / file.name).exists():
            shutil.copy(file, copy / file.name)
    for file in folder.iterdir():
        if file.is_file():
            file.unlink()
    result = swgpar.open_result(copy)
    values = {answer.name: answer.value for answer in result.summary.values()}
    result.plot.save(copy)
    return _not_finite({name: value for name, value in values.items() if value is not None})


def _use_checkpoint(folder: Path) -> str:
    """A damaged checkpoint is refused, or all that it holds is what was written."""
    path, ranges = folder / CHECKPOINT, {name: (0, rows) for name, rows, _ in SHAPES}
    checkpoint.require_undamaged(path, MPI.COMM_SELF)
    record = checkpoint.read_checkpoint(path, MPI.COMM_SELF, RunRecord)
    arrays = parallel_hdf5.read_rows(path, MPI.COMM_SELF, ranges)
    rng = np.random.default_rng(1)
    same = all(np.array_equal(arrays[name], rng.random((rows, n, 3))) for name, rows, n in SHAPES)
    return "" if same and record == RECORD else "other content than was written"


SHAPES = (("flexible_spline", 20, 6), ("ring_gear", 21, 4))
"""Data sets of the right checkpoint: name, rows, nodes."""

RECORD = RunRecord(rows=[{"step": 1, "fs_s1": 312.5}] * 2, housing={"vm_MPa": 1.5})
"""Its content."""

USES: dict[str, Callable[[Path], str]] = {
    "drive": _use_design,
    "gear train": _use_design,
    "mesh recipe": _use_recipe,
    "study": _use_study,
    "optimisation": _use_search,
    "pitch file": _use_pitch_file,
    "curve file": _use_curve_file,
    "result": _use_result,
    "checkpoint": _use_checkpoint,
}
"""By kind of file: use it from a folder; returns what is wrong with an input that is accepted."""
