"""strain_wave_spring.fmu: the spring model of a drive for multibody programs, after FMI 2.0.

The FMU is one C file and a header with the numbers of the drive. It has no states, so that it
serves co-simulation and model exchange alike. Its sources are in it; where a C compiler is found,
the binary for Linux on x86-64 as well.
"""

from __future__ import annotations

import hashlib
import os
import platform
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, NamedTuple
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np

from swgpar.errors import OutputError
from swgpar.exchange.spring_model import SpringModel, spring_model
from swgpar.log import logger
from swgpar.results.page import render
from swgpar.version import __version__

if TYPE_CHECKING:
    from swgpar.drive_results.drive_data import DriveData

NAME = "strain_wave_spring"
"""Of the FMU, its C file and its binary."""


class ScalarVariable(NamedTuple):
    """A variable of the FMU: its name, causality, unit and meaning; the number in VARIABLES is its
    reference."""

    name: str
    causality: str
    unit: str
    text: str


def _variables(causality: str, *rows: tuple[str, str, str]) -> tuple[ScalarVariable, ...]:
    return tuple(ScalarVariable(name, causality, unit, text) for name, unit, text in rows)


VARIABLES = (
    *_variables(
        "input",
        ("wave_generator_angle", "rad", "angle of the wave generator"),
        ("wave_generator_speed", "rad/s", "speed of the wave generator"),
        ("output_angle", "rad", "angle of the output"),
        ("output_speed", "rad/s", "speed of the output"),
    ),
    *_variables(
        "parameter",
        ("friction_torque", "N.m", "friction against the speed of the wind-up"),
        (
            "friction_speed",
            "rad/s",
            "speed of the wind-up at which 76 % of its friction act, above 0",
        ),
        ("loss_torque", "N.m", "friction against the speed of the wave generator"),
        ("load_loss", "1", "the same by the torque in the spring"),
        ("loss_speed", "rad/s", "speed of the wave generator at which 76 % of it act, above 0"),
        ("viscous_loss", "N.m.s/rad", "torque over the speed of the wave generator"),
        ("output_drag", "N.m", "friction against the speed of the output"),
        ("output_viscous_drag", "N.m.s/rad", "torque over the speed of the output"),
        ("damping", "N.m.s/rad", "viscous damping of the wind-up"),
        ("wave_generator_start_angle", "rad", "wave_generator_angle with the major axis on +y"),
        ("output_start_angle", "rad", "output_angle that belongs to it without torque and error"),
    ),
    *_variables(
        "output",
        ("wave_generator_torque", "N.m", "torque of the drive on the wave generator"),
        ("output_torque", "N.m", "torque of the drive on the output"),
        ("windup", "rad", "angle of the output beyond ratio and kinematic error"),
        ("kinematic_error", "rad", "kinematic error of the output"),
    ),
)
"""In the order of the C file."""

UNITS: dict[str, dict[str, str]] = {
    "rad": {"rad": "1"},
    "rad/s": {"rad": "1", "s": "-1"},
    "N.m": {"kg": "1", "m": "2", "s": "-2"},
    "1": {},
    "N.m.s/rad": {"kg": "1", "m": "2", "s": "-1", "rad": "-1"},
}
"""Exponents of SI units."""


def write_fmu(
    result: DriveData,
    folder: Path,
    periodic: DriveData | None = None,
    idle: DriveData | None = None,
) -> list[Path]:
    """Write strain_wave_spring.fmu; call it on one rank.

    result : with [stiffness];  periodic, idle : see `spring_model`

    Raises InputError as `spring_model`, OutputError where the C compiler fails.
    """
    model = spring_model(result, periodic, idle)
    source = files("swgpar.exchange").joinpath(f"{NAME}.c").read_text(encoding="utf-8")
    starts, body = start_values(model), header(model)
    guid = "{" + hashlib.sha256((body + source).encode()).hexdigest()[:32] + "}"
    body += f'#define GUID "{guid}"\n'
    parts = {
        "modelDescription.xml": model_description(guid, starts),
        f"sources/{NAME}.c": source.encode(),
        "sources/drive.h": body.encode(),
    }
    binary = compiled(source, body)
    if binary is not None:
        parts[f"binaries/linux64/{NAME}.so"] = binary
    path = folder / f"{NAME}.fmu"
    with ZipFile(path, "w") as archive:
        for name, data in parts.items():
            entry = ZipInfo(name)  # without the time: the same results give the same file
            entry.compress_type, entry.external_attr = ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, data)
    return [path]


def start_values(model: SpringModel) -> dict[str, float]:
    """Start values of all variables that are set from outside; zero but for friction and losses."""
    given = [one.name for one in VARIABLES if one.causality != "output"]
    return {name: float(getattr(model, name, 0.0)) for name in given}


def header(model: SpringModel) -> str:
    """Text of drive.h without its GUID."""
    starts = ", ".join(repr(value) for value in start_values(model).values())
    return (
        f"/* Numbers of a drive, written by swgpar {__version__} */\n"
        f"#define RATIO {model.ratio!r}\n#define PERIOD {model.period!r}\n"
        f"static const double START[] = {{{starts}}};\n"
        + _knots("SPRING", model.spring)
        + _knots("RIPPLE", model.ripple)
    )


def _knots(name: str, knots: np.ndarray) -> str:
    rows = ",\n".join("  {" + ", ".join(map(repr, knot)) + "}" for knot in knots.tolist())
    table = f"static const double {name}[N_{name}][3] = {{\n{rows}}};\n"
    return f"#define N_{name} {len(knots)}\n{table}"


def model_description(guid: str, starts: dict[str, float]) -> bytes:
    """Text of modelDescription.xml."""
    outputs = [index for index, one in enumerate(VARIABLES, start=1) if one.causality == "output"]
    facts = {"name": NAME, "guid": guid, "version": __version__, "units": UNITS}
    tables = {"variables": VARIABLES, "outputs": outputs, "starts": starts}
    return render("exchange/model_description.xml.j2", **facts, **tables).encode()


def compiled(source: str, body: str) -> bytes | None:
    """The binary for Linux on x86-64; None with a warning elsewhere and where no C compiler is
    found."""
    missing = (
        "the FMU has sources only: it is built by the program that imports it, or with fmpy compile"
    )
    if sys.platform != "linux" or platform.machine() != "x86_64":
        logger.warning(f"{missing}; binaries are made on Linux on x86-64 alone")
        return None
    compiler = c_compiler()
    if not compiler:
        logger.warning(
            f"{missing}; a binary needs a C compiler here: cc, gcc or clang, or one named in CC"
        )
        return None
    with TemporaryDirectory() as folder:
        code, binary = Path(folder) / f"{NAME}.c", Path(folder) / f"{NAME}.so"
        code.write_text(source, encoding="utf-8")
        (Path(folder) / "drive.h").write_text(body, encoding="utf-8")
        flags = ["-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden"]
        command = [*compiler, *flags, str(code), "-o", str(binary), "-lm"]
        run = subprocess.run(command, capture_output=True, text=True, errors="replace")
        if run.returncode:
            reason = (run.stderr.strip().splitlines() or [f"exit code {run.returncode}"])[0]
            raise OutputError(f"the C compiler {compiler[0]} cannot build the FMU: {reason}")
        return binary.read_bytes()


def c_compiler() -> Sequence[str]:
    """Command of a C compiler: that in CC, else the first of cc, gcc and clang; empty without
    any."""
    given = shlex.split(os.environ.get("CC", ""))
    if given:
        return given if shutil.which(given[0]) else []
    return [name for name in ("cc", "gcc", "clang") if shutil.which(name)][:1]
