"""OpenBLAS' kernels by the instructions of the processor."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from swgpar.solve.blas_kernels import VARIABLE, choose_blas_kernels

AVX2 = "fpu sse2 avx avx2 fma"
AVX512 = f"{AVX2} avx512f avx512cd avx512bw avx512dq avx512vl"


def chosen(tmp_path: Path, flags: str, environment: dict[str, str] | None = None) -> str | None:
    """Kernels that are named on a processor with these flags."""
    processors = tmp_path / "cpuinfo"
    processors.write_text(f"processor\t: 0\nflags\t\t: {flags}\n\nprocessor\t: 1\nflags\t\t: fpu\n")
    environment = {} if environment is None else environment
    choose_blas_kernels(environment, processors)
    return environment.get(VARIABLE)


@pytest.mark.parametrize(
    ("flags", "name"),
    [
        (AVX512, "SkylakeX"),
        (AVX2, "Haswell"),
        (f"{AVX2} avx512f", "Haswell"),
        ("fpu sse2 avx", None),
    ],
)
def test_kernels_follow_the_instructions(tmp_path: Path, flags: str, name: str | None) -> None:
    assert chosen(tmp_path, flags) == name


def test_a_name_of_the_user_counts(tmp_path: Path) -> None:
    assert chosen(tmp_path, AVX512, {VARIABLE: "Zen"}) == "Zen"


def test_without_linux_openblas_chooses(tmp_path: Path) -> None:
    environment: dict[str, str] = {}
    choose_blas_kernels(environment, tmp_path / "no_such_file")
    assert not environment


def test_openblas_has_fast_kernels() -> None:
    """The library that PETSc has loaded, in a process that asked for nothing."""
    flags = re.search(r"^flags\s*:(.*)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    if not flags or not {"avx2", "fma"} <= set(flags[1].split()):
        pytest.skip("the processor has no AVX2: its kernels are OpenBLAS' own choice")
    code = (
        "import ctypes, re\n"
        "import swgpar\n"
        "from swgpar.petsc import PETSc\n"
        "loaded = set(re.findall(r'/\\S*openblas\\S*', open('/proc/self/maps').read()))\n"
        "for path in sorted(loaded):\n"
        "    name = getattr(ctypes.CDLL(path), 'openblas_get_corename', None)\n"
        "    if name:\n"
        "        name.restype = ctypes.c_char_p\n"
        "        print(name().decode())\n"
    )
    environment = {key: value for key, value in os.environ.items() if key != VARIABLE}
    printed = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    ).stdout.split()
    if not printed:
        pytest.skip("PETSc has another BLAS, or an OpenBLAS under another name")
    assert set(printed) <= {"SkylakeX", "Haswell"}
